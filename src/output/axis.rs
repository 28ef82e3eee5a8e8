//! Scales and ranges of axes: an axis shows either the values of a column, or the deviations of
//! these values from the value at a special point.

use super::document::{Deviation, Document};
use super::error::FigureError;
use super::figure::{Figure, Series, Style};

/// The scale of a column on an axis: the axis shows the values themselves, or their deviations from
/// the value at a special point.
pub(super) struct Scale<'a>(Option<(&'a Deviation, f64)>);

impl<'a> Scale<'a> {
    /// The scale that shows the values of a column unchanged.
    pub const PLAIN: Scale<'static> = Scale(None);

    /// Returns the scale of a column on the axes of a document's diagrams.
    pub fn of(document: &'a Document, column: &str) -> Result<Self, FigureError> {
        let meant = |deviation: &&Deviation| deviation.column == column;
        let Some(deviation) = document.plot.deviations.iter().find(meant) else {
            return Ok(Scale(None));
        };
        let value = document.branch(&deviation.branch).ok().and_then(|branch| {
            branch.of_kind(deviation.kind).next()?.value(branch.column(column)?)
        });
        let missing = || FigureError::NoOrigin {
            column: column.into(),
            kind: deviation.kind,
            branch: deviation.branch.clone(),
        };
        Ok(Scale(Some((deviation, value.ok_or_else(missing)?))))
    }

    /// Returns whether the scale shows values unchanged.
    pub fn is_plain(&self) -> bool {
        self.0.is_none()
    }

    /// Returns the number that the axis shows for a given value of the column.
    pub fn shown(&self, value: f64) -> f64 {
        self.0.map_or(value, |(deviation, at)| deviation.shown(value, at))
    }
}

/// Removes the parts of a figure that are outside the given ranges of its axes.
pub(super) fn clip(figure: &mut Figure, ranges: [[f64; 2]; 2]) {
    if ranges.iter().flatten().all(|end| end.is_infinite()) {
        return;
    }
    let inside = |at: &[f64; 2]| (0..2).all(|k| at[k] >= ranges[k][0] && at[k] <= ranges[k][1]);
    let mut series = Vec::new();
    for whole in &figure.series {
        let pieces = match (whole.style, whole.points.len()) {
            (Style::Dots | Style::Specks | Style::Blots, _) | (_, 1) => {
                let all = whole.points.iter().enumerate().filter(|(_, at)| inside(at));
                vec![all.map(|(index, at)| (*at, index)).collect()]
            }
            _ => pieces(&whole.points, ranges),
        };
        let pieces = pieces.into_iter().filter(|piece: &Vec<_>| !piece.is_empty());
        let before = series.len();
        series.extend(pieces.map(|piece| part_of(whole, piece)));
        if series.len() == before {
            // The empty series keeps its name, so that all other colours are unchanged.
            series.push(Series::new(&whole.name, whole.style, []));
        }
    }
    let widths = widths(figure, ranges);
    figure.series = series;
    for mark in &mut figure.marks {
        mark.at = [0, 1].map(|k| onto_border(mark.at[k], ranges[k], widths[k]));
    }
    figure.marks.retain(|mark| inside(&mark.at));
    figure.tiles.retain(|tile| inside(&tile.at));
}

/// The distance from the end of a range, as a fraction of the width of the range, up to which a mark
/// lies on the border.
const BORDER: f64 = 1e-3;

/// Returns the widths of the parts of a figure inside the given ranges; 0 for an empty figure.
fn widths(figure: &Figure, ranges: [[f64; 2]; 2]) -> [f64; 2] {
    let extent = figure.extent().unwrap_or([[0.0; 2]; 2]);
    [0, 1].map(|k| {
        let [low, high] = ranges[k];
        (high.min(extent[k][1]) - low.max(extent[k][0])).max(0.0)
    })
}

/// Moves a coordinate that is just outside a range, of the given width, onto the border.
fn onto_border(value: f64, [low, high]: [f64; 2], width: f64) -> f64 {
    let nearest = value.max(low).min(high);
    if (value - nearest).abs() <= BORDER * width { nearest } else { value }
}

/// Removes the points of a figure that logarithmic axes cannot show.
pub(super) fn keep_positive(figure: &mut Figure) {
    let axes = figure.logarithmic;
    let shown = |at: &[f64; 2]| (0..2).all(|k| !axes[k] || at[k] > 0.0);
    for whole in std::mem::take(&mut figure.series) {
        let mut pieces: Vec<Piece> = vec![Vec::new()];
        for (number, at) in whole.points.iter().enumerate() {
            match (shown(at), pieces.last_mut()) {
                (true, Some(last)) => last.push((*at, number)),
                _ => pieces.push(Vec::new()),
            }
        }
        // The first piece is kept even without points, so that the curve keeps its name and colour.
        let kept = pieces.into_iter().enumerate().filter(|(k, piece)| *k == 0 || !piece.is_empty());
        figure.series.extend(kept.map(|(_, piece)| part_of(&whole, piece)));
    }
    figure.marks.retain(|mark| shown(&mark.at));
    figure.tiles.retain(|tile| tile.corners().iter().all(shown));
    figure.walls.retain(|wall| !axes[wall.axis] || wall.at > 0.0);
}

/// Returns a part of a series of points as a separate series, where each point gets the origin
/// (document, branch and point) of the nearest point of the whole series.
fn part_of(whole: &Series, piece: Piece) -> Series {
    let (points, numbers): (Vec<[f64; 2]>, Vec<usize>) = piece.into_iter().unzip();
    let origins = numbers.iter().filter_map(|number| whole.origins.get(*number).copied());
    let (name, style, origins) = (whole.name.clone(), whole.style, origins.collect());
    Series { name, style, points, origins }
}

/// The points of a part of a line, each with the index of the nearest point of the whole line.
type Piece = Vec<([f64; 2], usize)>;

/// Returns the parts of a line inside the given ranges.
fn pieces(points: &[[f64; 2]], ranges: [[f64; 2]; 2]) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = vec![Vec::new()];
    for (number, pair) in points.windows(2).enumerate() {
        let Some([from, to]) = part(pair[0], pair[1], ranges) else { continue };
        let between = |part: f64| {
            let at = [0, 1].map(|k| pair[0][k] + part * (pair[1][k] - pair[0][k]));
            (at, if part < 0.5 { number } else { number + 1 })
        };
        let last = pieces.len() - 1;
        if from > 0.0 || pieces[last].is_empty() {
            pieces.push(vec![between(from)]);
        }
        let last = pieces.len() - 1;
        pieces[last].push(if to < 1.0 { between(to) } else { (pair[1], number + 1) });
        if to < 1.0 {
            pieces.push(Vec::new());
        }
    }
    pieces
}

/// Returns the part of a line segment inside the given ranges (algorithm of Liang and Barsky).
fn part(a: [f64; 2], b: [f64; 2], ranges: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for k in 0..2 {
        let length = b[k] - a[k];
        let [low, high] = ranges[k];
        if length == 0.0 {
            if a[k] < low || a[k] > high {
                return None;
            }
            continue;
        }
        let ends = [(low - a[k]) / length, (high - a[k]) / length];
        from = from.max(ends[0].min(ends[1]));
        to = to.min(ends[0].max(ends[1]));
    }
    (from < to).then_some([from, to])
}
