//! Contour maps of fields: arrays with two indices that are saved at special points.

use super::document::{Document, Plot};
use super::error::FigureError;
use super::figure::Figure;
use super::number::significant;
use super::profiles::{Shown, shown};
use super::tile::{Hue, Tile};
use crate::core::problem::{PlaneField, distinct};

/// The maximum number of levels of a contour map, which is also the number of shades.
const LEVELS: usize = 9;
/// The number of significant digits with which the legend shows the levels.
const DIGITS: usize = 6;

/// Returns a contour map for each field at each special point that is shown, as
/// [`figures`](super::figures) describes. All contour maps of fields with the same name have the
/// same levels. If the document chooses kinds of profiles to draw, no fields are shown.
pub(super) fn fields(documents: &[(&str, &Document)]) -> Result<Vec<Figure>, FigureError> {
    let Some((_, Document { plot, .. })) = documents.first() else { return Ok(Vec::new()) };
    if !plot.profiles.is_empty() {
        return Ok(Vec::new());
    }
    let shown = shown(documents)?;
    let all = || shown.iter().flat_map(|shown| &shown.point.fields);
    let mut figures = Vec::new();
    for name in distinct(all().map(|field| &field.name)) {
        let Some(levels) = Levels::of(all().filter(|field| field.name == name)) else { continue };
        for shown in &shown {
            let own = shown.point.fields.iter().filter(|field| field.name == name);
            figures.extend(own.map(|field| map(plot, shown, field, &levels)));
        }
    }
    Ok(figures)
}

/// Returns the contour map of a field at a special point.
fn map(plot: &Plot, shown: &Shown, field: &PlaneField, levels: &Levels) -> Figure {
    let label = plot.label(&field.name);
    let title = format!("{label} at {}", shown.name);
    let mut figure = Figure::new(title, "first index", "second index");
    let [rows, columns] = &field.along;
    let sizes = [widths(rows), widths(columns)];
    for (i, values) in field.values.chunks_exact(columns.len().max(1)).enumerate() {
        for (j, value) in values.iter().enumerate() {
            let (shade, meaning) = levels.level(label, *value);
            let (at, size) = ([middle(rows, i), middle(columns, j)], [sizes[0][i], sizes[1][j]]);
            Tile { at, size, hue: Hue::Level, shade, meaning }.add_to(&mut figure.tiles, 1);
        }
    }
    // The legend lists the levels in increasing order.
    figure.tiles.sort_by_key(|tile| tile.shade);
    figure
}

/// Returns the ends of the cell of the grid around an index; they are half-way to the neighbouring
/// indices.
fn ends(along: &[i64], k: usize) -> [f64; 2] {
    let at = along[k] as f64;
    let half = |other: Option<&i64>| other.map(|other| 0.5 * (*other as f64 - at));
    let (before, after) =
        (half(k.checked_sub(1).and_then(|k| along.get(k))), half(along.get(k + 1)));
    let [low, high] = [before.or(after.map(|it| -it)), after.or(before.map(|it| -it))];
    [at + low.unwrap_or(-0.5), at + high.unwrap_or(0.5)]
}

/// Returns the middle of the cell of the grid around an index.
fn middle(along: &[i64], k: usize) -> f64 {
    let [low, high] = ends(along, k);
    0.5 * (low + high)
}

/// Returns the widths of the cells of the grid around all indices.
fn widths(along: &[i64]) -> Vec<f64> {
    let width = |k| {
        let [low, high] = ends(along, k);
        high - low
    };
    (0..along.len()).map(width).collect()
}

/// Levels of a contour map at multiples of a step.
struct Levels {
    step: f64,
    /// The first level as a multiple of the step, and the number of levels.
    first: f64,
    count: usize,
}

impl Levels {
    /// Returns levels that several fields have in common; `None` if the fields contain no values.
    fn of<'a>(fields: impl Iterator<Item = &'a PlaneField>) -> Option<Self> {
        let values = fields.flat_map(|field| &field.values);
        let range = values.fold(None, |range: Option<[f64; 2]>, value| {
            let [low, high] = range.unwrap_or([*value; 2]);
            Some([low.min(*value), high.max(*value)])
        });
        let [low, high] = range?;
        // Values that differ only by rounding have one level.
        let least = ((high - low) / (LEVELS - 2) as f64).max(1e-9 * low.abs().max(high.abs()));
        let power = 10f64.powf(least.max(f64::MIN_POSITIVE).log10().floor());
        let step = [1.0, 2.0, 5.0].map(|digit| digit * power).into_iter().find(|it| *it >= least);
        let step = step.unwrap_or(10.0 * power);
        let first = (low / step).floor();
        let count = ((high / step).floor() - first) as usize + 1;
        Some(Levels { step, first, count: count.min(LEVELS) })
    }

    /// Returns the shade for a value of a field, and the meaning of the shade for the legend.
    fn level(&self, label: &str, value: f64) -> (usize, String) {
        let k = ((value / self.step).floor() - self.first).clamp(0.0, (self.count - 1) as f64);
        let shade = (LEVELS - 1) * k as usize / (self.count - 1).max(1);
        let [low, high] =
            [0.0, 1.0].map(|end| significant((self.first + k + end) * self.step, DIGITS));
        (shade, format!("{label} from {low} to {high}"))
    }
}
