//! The layout of panels, of the title above all panels, and of the legend below them.

use super::canvas::{Canvas, Painted, TEXT};
use super::legend::{Legend, NAMED as NUMBERED, Naming};
use super::panel::{Panel, heading, letter};
use crate::core::problem::distinct;
use crate::output::error::FigureError;
use crate::output::figure::Figure;
use std::ops::RangeInclusive;

/// The printed size of text that is [`TEXT`] units high, in points (72 per inch).
const POINTS: f64 = 7.5;
const INCH: f64 = 25.4;
/// The widths of pictures, and the smallest width of panels that are side by side, in millimetres.
const WIDTHS: RangeInclusive<f64> = 40.0..=1000.0;
const LEAST_PANEL: f64 = 70.0;
/// The height of a panel relative to its width, and the largest height of a panel in units.
const ASPECT: f64 = 0.72;
const HIGHEST: f64 = 430.0;
/// The height of the row that contains the title above all panels.
const TITLE_ROW: f64 = 30.0;
/// The maximum number of curves whose names are written next to the curves.
const NAMED_AT_CURVES: usize = 4;

/// The layout of panels, title and legend.
pub(super) struct Layout<'a> {
    panels: Vec<Panel<'a>>,
    legend: Legend<'a>,
    /// The title that is drawn above all panels.
    title: Option<&'a str>,
    width: f64,
    /// The vertical position of the lower end of the panels.
    bottom: f64,
}

impl<'a> Layout<'a> {
    /// Lays out figures in a picture with a width in millimetres.
    pub fn new(figures: &'a [Figure], width: f64) -> Result<Self, FigureError> {
        if !WIDTHS.contains(&width) {
            return Err(FigureError::Width { width, range: WIDTHS });
        }
        let Some(first) = figures.first() else {
            return Err(FigureError::Empty { title: String::new() });
        };
        let columns = ((width / LEAST_PANEL) as usize).clamp(1, figures.len());
        let width = width / (POINTS / 72.0 * INCH) * TEXT;
        let across = figures.len() == 1 || figures[1..].iter().all(|it| it.title.is_empty());
        let title = Some(first.title.as_str()).filter(|title| across && !title.is_empty());
        let mut top = if title.is_some() { TITLE_ROW } else { 0.0 };
        // The first panel takes the places that would stay empty.
        let spare = figures.len().next_multiple_of(columns) - figures.len();
        let mut panels: Vec<Panel> = Vec::new();
        let mut rest = figures;
        while let [next, ..] = rest {
            let spans = if panels.is_empty() { 1 + spare } else { 1 };
            let (row, others) = rest.split_at((columns + 1 - spans).min(rest.len()));
            let narrow = width / columns as f64;
            let wide = narrow * spans as f64;
            let height = HIGHEST.min(ASPECT * if row.len() == 1 { wide } else { narrow });
            let mut left = 0.0;
            for figure in row {
                let width = if std::ptr::eq(figure, next) { wide } else { narrow };
                let letter = (figures.len() > 1).then(|| letter(panels.len()));
                panels.push(Panel::new(figure, [left, top, width, height], letter, !across)?);
                left += width;
            }
            top += panels.last().map_or(0.0, Panel::height);
            rest = others;
        }
        let namings = named(&mut panels);
        panels.iter_mut().for_each(Panel::place_beside);
        let legend = Legend::new(figures, namings, width - 2.0 * MARGIN);
        Ok(Layout { panels, legend, title, width, bottom: top })
    }

    /// Returns the width and height of the picture, in units.
    pub fn size(&self) -> [f64; 2] {
        let legend = match self.legend.height() {
            0.0 => 0.0,
            height => height + 12.0,
        };
        [self.width, self.bottom + legend]
    }

    /// Draws everything.
    pub fn draw(&self, canvas: &Canvas) -> Painted {
        self.panels.iter().try_for_each(|panel| panel.draw(canvas))?;
        if let Some(title) = self.title {
            heading(canvas, title, [0.0, 0.0], self.width)?;
        }
        self.legend.draw(canvas, [MARGIN, self.bottom + 4.0])
    }
}

/// The margin on the left and right of the legend.
const MARGIN: f64 = 16.0;

/// Writes the names of curves next to the curves if the curves are few; each name is written in the
/// first panel that shows the curve and has space for the name. Panels share colours and entries in
/// the legend if their lists of curve names are equal, or if one list is the beginning of the
/// other. Returns the curve names that are not written next to curves, and therefore belong in the
/// legend.
fn named<'a>(panels: &mut [Panel<'a>]) -> Vec<Naming<'a>> {
    let mut namings: Vec<Naming> = Vec::new();
    for index in 0..panels.len() {
        let names = panels[index].figure.names();
        let alike =
            |naming: &&mut Naming| naming.all.starts_with(&names) || names.starts_with(&naming.all);
        match namings.iter_mut().find(alike) {
            Some(naming) => {
                naming.panels.push(index);
                if names.len() > naming.all.len() {
                    naming.all = names;
                }
            }
            None => namings.push(Naming { all: names, named: Vec::new(), panels: vec![index] }),
        }
    }
    for naming in &mut namings {
        // The only curve of a figure needs no name.
        let series = naming.panels.iter().flat_map(|index| &panels[*index].figure.series);
        if distinct(series.map(|series| &series.name)).len() < 2 {
            continue;
        }
        let shown = |panels: &[Panel], index: &usize, name: &str| panels[*index].shows(name);
        let seen: Vec<(usize, &str)> = naming.all.iter().copied().enumerate().collect();
        let seen = seen
            .into_iter()
            .filter(|(_, name)| naming.panels.iter().any(|index| shown(panels, index, name)));
        let seen: Vec<(usize, &str)> = seen.collect();
        // Either all names are beside their curves, or all are in the legend.
        let few = seen.len() <= NAMED_AT_CURVES;
        let all = few
            && seen.iter().all(|(colour, name)| {
                naming.panels.iter().any(|index| panels[*index].name(name, name, *colour))
            });
        if !all {
            naming.panels.iter().for_each(|index| panels[*index].forget_names());
            naming.named = seen;
            number(panels, naming);
        }
    }
    namings
}

/// Writes beside each curve the number that the curve's name has in the legend, if space is
/// available: pictures may be printed in grey, and the sequence of colours repeats.
fn number(panels: &mut [Panel], naming: &Naming) {
    for (k, (colour, name)) in naming.named.iter().take(NUMBERED).enumerate() {
        for index in &naming.panels {
            panels[*index].name(name, &(k + 1).to_string(), *colour);
        }
    }
}
