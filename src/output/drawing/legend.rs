//! The legend below all panels: names of curves, meanings of line styles, kinds of marks.

use super::canvas::{Anchor, Canvas, INK, Painted, TEXT, text_width};
use super::panel::letter;
use super::pen::{colour, curve, mark, spot_sizes, tint};
use crate::output::figure::{Figure, Mark, Style, Symbol};
use crate::output::regions::MEANING;
use plotters::style::RGBColor;

const ROW: f64 = 19.0;
const SAMPLE: f64 = 30.0;
const GAP: f64 = 22.0;
/// The smallest size of a text that is too wide, as a fraction of its usual size.
const LEAST: f64 = 0.4;
/// The maximum number of curves listed in the legend; the legend gives only the number of the
/// remaining curves.
pub(super) const NAMED: usize = 15;

/// A legend: the names of the curves, and below them the meanings of styles and marks.
pub(super) struct Legend<'a> {
    /// The entries of the legend, each with the middle of its left side relative to the upper left
    /// corner of the legend.
    entries: Vec<(Entry<'a>, [f64; 2])>,
    width: f64,
    height: f64,
}

struct Entry<'a> {
    sample: Sample<'a>,
    text: String,
}

/// The curve names of a group of panels; within the group, curves of the same name have the same
/// colour.
pub(super) struct Naming<'a> {
    /// All curve names of the panels in the group, in the order of their colours.
    pub all: Vec<&'a str>,
    /// The curve names in the legend, with the indices of their colours.
    pub named: Vec<(usize, &'a str)>,
    /// The indices of the panels in the group, among all panels of the picture.
    pub panels: Vec<usize>,
}

enum Sample<'a> {
    None,
    /// A curve, with the side lengths of its spots.
    Curve(Style, RGBColor, [f64; 2]),
    Tile(RGBColor),
    Mark(&'a Mark),
}

impl<'a> Legend<'a> {
    /// Creates the legend for the panels of a picture, with a given width in units.
    pub fn new(figures: &'a [Figure], namings: Vec<Naming<'a>>, width: f64) -> Self {
        let mut legend = Legend { entries: Vec::new(), width, height: 0.0 };
        let several = namings.iter().filter(|naming| !naming.named.is_empty()).count() > 1;
        for naming in namings {
            let letters = if several { letters(&naming.panels) } else { String::new() };
            legend.add(letters, names(figures, &naming), width);
        }
        legend.add(String::new(), meanings(figures), width);
        legend
    }

    /// Adds a heading and entries below the entries that the legend already contains: side by side
    /// if the new entries fit in one row, otherwise in aligned columns.
    fn add(&mut self, heading: String, group: Vec<Entry<'a>>, width: f64) {
        if group.is_empty() {
            return;
        }
        let mut indent = 0.0;
        if !heading.is_empty() {
            indent = text_width(&heading, TEXT) + GAP;
            let entry = Entry { sample: Sample::None, text: heading };
            self.entries.push((entry, [0.0, self.height + 0.5 * ROW]));
        }
        let width = width - indent;
        let total: f64 = group.iter().map(Entry::width).sum();
        let widest = group.iter().map(Entry::width).fold(0.0, f64::max);
        let one_row = total <= width + GAP;
        let columns = match one_row {
            true => group.len(),
            false => (((width + GAP) / widest).floor() as usize).max(1),
        };
        let rows = group.len().div_ceil(columns);
        let mut x = indent;
        for (index, entry) in group.into_iter().enumerate() {
            if index % columns == 0 {
                x = indent;
            }
            let at = [x, self.height + ROW * ((index / columns) as f64 + 0.5)];
            x += if one_row { entry.width() } else { widest };
            self.entries.push((entry, at));
        }
        self.height += ROW * rows as f64 + 4.0;
    }

    /// Returns the height of the legend in units.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Draws the legend with its upper left corner at the given point.
    pub fn draw(&self, canvas: &Canvas, [left, top]: [f64; 2]) -> Painted {
        let mut entries = self.entries.iter();
        let right = left + self.width;
        entries.try_for_each(|(entry, at)| entry.draw(canvas, [left + at[0], top + at[1]], right))
    }
}

/// Returns the letters of panels for a heading: `(a), (c)`, or `(a)–(d)` for consecutive panels.
fn letters(panels: &[usize]) -> String {
    let of = |index: &usize| format!("({})", letter(*index));
    match panels {
        [first, _, .., last] if last - first + 1 == panels.len() => {
            format!("{}–{}", of(first), of(last))
        }
        all => all.iter().map(of).collect::<Vec<_>>().join(", "),
    }
}

/// Returns legend entries for the meanings of styles, marks and tiles.
fn meanings(figures: &[Figure]) -> Vec<Entry<'_>> {
    let mut meanings: Vec<Entry> = Vec::new();
    let mut add = |sample, text: String| {
        if !meanings.iter().any(|entry| entry.text == text) {
            meanings.push(Entry { sample, text });
        }
    };
    for figure in figures {
        let drawn = |style: Style| {
            let mut series = figure.series.iter();
            series.any(|series| series.style == style && series.points.len() > 1)
        };
        for (style, text) in figure.styles.iter().filter(|(style, _)| drawn(*style)) {
            add(Sample::Curve(*style, INK, spot_sizes(figure.series.iter())), text.clone());
        }
    }
    for mark in figures.iter().flat_map(|figure| &figure.marks) {
        match mark.symbol {
            // User's points are labelled with their own event, or not at all.
            Symbol::TriangleDown => add(Sample::Mark(mark), format!("UZ\u{2002}{}", mark.meaning)),
            Symbol::Doubtful => add(Sample::Mark(mark), format!("?\u{2002}{}", mark.meaning)),
            Symbol::Number => add(Sample::None, format!("numbers: {}", mark.meaning)),
            _ => add(Sample::Mark(mark), format!("{}\u{2002}{}", mark.label, mark.meaning)),
        }
    }
    if figures.iter().any(|figure| !figure.beside.is_empty()) {
        add(Sample::None, MEANING.into());
    }
    for tile in figures.iter().flat_map(|figure| &figure.tiles) {
        add(Sample::Tile(tint(tile.hue, tile.shade)), tile.meaning.clone());
    }
    meanings
}

/// Returns legend entries for the curve names of a group of panels.
fn names<'a>(figures: &'a [Figure], naming: &Naming<'a>) -> Vec<Entry<'a>> {
    let Naming { named, panels, .. } = naming;
    if named.is_empty() {
        return Vec::new();
    }
    let figures = || panels.iter().map(|index| &figures[*index]);
    let of = |name: &str| {
        let mut series = figures().flat_map(|figure| &figure.series);
        series.find(|s| s.name == name && !s.points.is_empty()).map(|series| series.style)
    };
    let styled = figures().any(|figure| !figure.styles.is_empty());
    let style = |name: &str| match of(name) {
        Some(style @ (Style::Specks | Style::Blots | Style::Dots)) => style,
        // The styles have separate entries, and a curve may have several styles.
        _ if styled => Style::Solid,
        style => style.unwrap_or(Style::Solid),
    };
    let spots = spot_sizes(figures().flat_map(|figure| &figure.series));
    let entry = |(k, (index, name)): (usize, &(usize, &str))| Entry {
        sample: Sample::Curve(style(name), colour(*index), spots),
        text: format!("{}\u{2002}{name}", k + 1),
    };
    let mut entries: Vec<Entry> = named.iter().take(NAMED).enumerate().map(entry).collect();
    if named.len() > NAMED {
        let text = format!("and {} more", named.len() - NAMED);
        entries.push(Entry { sample: Sample::None, text });
    }
    entries
}

impl Entry<'_> {
    fn sample_width(&self) -> f64 {
        match self.sample {
            Sample::Mark(_) | Sample::Tile(_) => 14.0,
            Sample::None => -6.0,
            Sample::Curve(..) => SAMPLE,
        }
    }

    /// Returns the width of an entry, including the gap after it.
    fn width(&self) -> f64 {
        self.sample_width() + 6.0 + text_width(&self.text, TEXT) + GAP
    }

    fn draw(&self, canvas: &Canvas, [x, y]: [f64; 2], right: f64) -> Painted {
        match self.sample {
            Sample::None => {}
            Sample::Curve(style, colour, spots) => {
                let points = match style {
                    Style::Dots => vec![[x + SAMPLE / 2.0, y]],
                    Style::Specks | Style::Blots => (0..9)
                        .map(|k| [x + 3.5 * f64::from(k), y + 1.5 * f64::from(k % 3)])
                        .collect(),
                    Style::DottedLine => vec![[x, y], [x + SAMPLE / 2.0, y], [x + SAMPLE, y]],
                    Style::Solid | Style::Dashed | Style::Thin | Style::Dotted => {
                        vec![[x, y], [x + SAMPLE, y]]
                    }
                };
                curve(canvas, style, &points, colour, spots)?;
            }
            Sample::Tile(colour) => {
                canvas.rectangle([[x, y - 6.0], [x + 14.0, y + 6.0]], colour)?
            }
            Sample::Mark(sample) => mark(canvas, sample.symbol, [x + 7.0, y])?,
        }
        // A text that is wider than the legend is shrunk.
        let left = x + self.sample_width() + 6.0;
        let size =
            TEXT * ((right - left) / text_width(&self.text, TEXT).max(1.0)).clamp(LEAST, 1.0);
        canvas.text(&self.text, [left, y], size, Anchor::Left)
    }
}
