//! The legend below a figure: names of curves, meanings of line styles, kinds of marks.

use super::canvas::{Anchor, Canvas, INK, Painted, text_width};
use super::pen::{colour, curve, mark, tint};
use crate::output::figure::{Figure, Mark, Style, Symbol};
use plotters::style::RGBColor;

const SIZE: f64 = 12.0;
const ROW: f64 = 19.0;
const SAMPLE: f64 = 30.0;
const GAP: f64 = 22.0;
/// So many curves are named; of the others only the number is.
const NAMED: usize = 15;

/// A legend: the names of the curves, and below them what styles and marks mean.
pub(super) struct Legend<'a> {
    /// Each with the middle of its left side, seen from the upper left corner of the legend.
    entries: Vec<(Entry<'a>, [f64; 2])>,
    height: f64,
}

struct Entry<'a> {
    sample: Sample<'a>,
    text: String,
}

enum Sample<'a> {
    None,
    Curve(Style, RGBColor),
    Tile(RGBColor),
    Mark(&'a Mark),
}

impl<'a> Legend<'a> {
    /// The legend of a figure, in a width in pixels.
    pub fn new(figure: &'a Figure, width: f64) -> Self {
        let styles = figure.styles.iter().filter(|(style, _)| {
            figure.series.iter().any(|series| series.style == *style && series.points.len() > 1)
        });
        let mut meanings: Vec<Entry> = styles
            .map(|(style, text)| Entry { sample: Sample::Curve(*style, INK), text: text.clone() })
            .collect();
        // The user's points are labelled with their own event.
        for mark in figure.marks.iter().filter(|mark| mark.symbol != Symbol::TriangleDown) {
            let (sample, text) = match mark.symbol {
                Symbol::Doubtful => (Sample::Mark(mark), format!("?\u{2002}{}", mark.meaning)),
                Symbol::Number => (Sample::None, format!("numbers: {}", mark.meaning)),
                _ => (Sample::Mark(mark), format!("{}\u{2002}{}", mark.label, mark.meaning)),
            };
            if !meanings.iter().any(|entry| entry.text == text) {
                meanings.push(Entry { sample, text });
            }
        }
        for tile in &figure.tiles {
            if !meanings.iter().any(|entry| entry.text == tile.meaning) {
                let sample = Sample::Tile(tint(tile.hue, tile.shade));
                meanings.push(Entry { sample, text: tile.meaning.clone() });
            }
        }
        let mut legend = Legend { entries: Vec::new(), height: 0.0 };
        legend.add(names(figure), width);
        legend.add(meanings, width);
        legend
    }

    /// Adds entries below the others: side by side if one row holds them, else in aligned columns.
    fn add(&mut self, group: Vec<Entry<'a>>, width: f64) {
        if group.is_empty() {
            return;
        }
        let total: f64 = group.iter().map(Entry::width).sum();
        let widest = group.iter().map(Entry::width).fold(0.0, f64::max);
        let one_row = total <= width + GAP;
        let columns = match one_row {
            true => group.len(),
            false => (((width + GAP) / widest).floor() as usize).max(1),
        };
        let rows = group.len().div_ceil(columns);
        let mut x = 0.0;
        for (index, entry) in group.into_iter().enumerate() {
            if index % columns == 0 {
                x = 0.0;
            }
            let at = [x, self.height + ROW * ((index / columns) as f64 + 0.5)];
            x += if one_row { entry.width() } else { widest };
            self.entries.push((entry, at));
        }
        self.height += ROW * rows as f64 + 4.0;
    }

    /// Its height in pixels.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Draws it, with its upper left corner at a point.
    pub fn draw(&self, canvas: &Canvas, [left, top]: [f64; 2]) -> Painted {
        let mut entries = self.entries.iter();
        entries.try_for_each(|(entry, at)| entry.draw(canvas, [left + at[0], top + at[1]]))
    }
}

/// The names of the curves, if there is more than one.
fn names(figure: &Figure) -> Vec<Entry<'_>> {
    let names = figure.names();
    if names.len() < 2 {
        return Vec::new();
    }
    let of = |name: &str| figure.series.iter().find(|s| s.name == name).map(|s| s.style);
    let points = |name: &str| matches!(of(name), Some(Style::Specks | Style::Dots));
    let style = |name: &str| match figure.styles.is_empty() || points(name) {
        true => of(name).unwrap_or(Style::Solid),
        // The styles have entries of their own, and a curve may have several.
        false => Style::Solid,
    };
    let entry = |(index, name): (usize, &&str)| Entry {
        sample: Sample::Curve(style(name), colour(index)),
        text: (*name).to_owned(),
    };
    // What lies outside of a panel keeps its colour, and has no entry.
    let seen = |name: &str| figure.series.iter().any(|s| s.name == name && !s.points.is_empty());
    let seen: Vec<_> = names.iter().enumerate().filter(|(_, name)| seen(name)).collect();
    let mut entries: Vec<Entry> = seen.iter().copied().take(NAMED).map(entry).collect();
    if seen.len() > NAMED {
        let text = format!("and {} more", seen.len() - NAMED);
        entries.push(Entry { sample: Sample::None, text });
    }
    entries
}

impl Entry<'_> {
    fn sample_width(&self) -> f64 {
        match self.sample {
            Sample::Mark(_) | Sample::Tile(_) => 14.0,
            Sample::None | Sample::Curve(..) => SAMPLE,
        }
    }

    /// Its width with the gap behind it.
    fn width(&self) -> f64 {
        self.sample_width() + 6.0 + text_width(&self.text, SIZE) + GAP
    }

    fn draw(&self, canvas: &Canvas, [x, y]: [f64; 2]) -> Painted {
        match self.sample {
            Sample::None => {}
            Sample::Curve(style, colour) => {
                let points = match style {
                    Style::Dots => vec![[x + SAMPLE / 2.0, y]],
                    Style::Specks => (0..9)
                        .map(|k| [x + 3.5 * f64::from(k), y + 1.5 * f64::from(k % 3)])
                        .collect(),
                    Style::DottedLine => vec![[x, y], [x + SAMPLE / 2.0, y], [x + SAMPLE, y]],
                    Style::Solid | Style::Dashed | Style::Thin => vec![[x, y], [x + SAMPLE, y]],
                };
                curve(canvas, style, &points, colour)?;
            }
            Sample::Tile(colour) => {
                canvas.rectangle([[x, y - 6.0], [x + 14.0, y + 6.0]], colour)?
            }
            Sample::Mark(sample) => mark(canvas, sample.symbol, [x + 7.0, y])?,
        }
        canvas.text(&self.text, [x + self.sample_width() + 6.0, y], SIZE, Anchor::Left)
    }
}
