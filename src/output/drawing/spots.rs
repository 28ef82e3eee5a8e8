//! The spots of sweeps, drawn exactly at their places, and their short form in an SVG.

use std::collections::{BTreeMap, BTreeSet};

/// The side lengths of the spots of a sweep, in units of the canvas: of the last sweep in a
/// picture, and of earlier sweeps. Where sweeps have the same points, both sizes are visible.
const FEW_SPOTS: [f64; 2] = [3.0, 5.0];
const MANY_SPOTS: [f64; 2] = [1.2, 2.2];

/// The largest number of spots that are drawn in the larger sizes.
const FEW: usize = 400;

/// Returns the side lengths, in units, of the spots of the last sweep in a panel, and of the earlier
/// sweeps, given the largest number of points of a sweep.
pub(super) fn sizes(count: usize) -> [f64; 2] {
    if count <= FEW { FEW_SPOTS } else { MANY_SPOTS }
}

/// A vertical line that covers all spots of one column that touch each other: the column, and the
/// rows of the upper and the lower end, in backend pixels.
pub(super) type Stack = [i32; 3];

/// Returns the lines that cover square spots of a given size exactly, given the centres of the
/// spots. Spots at the same place are covered once.
pub(super) fn stacks(centres: impl Iterator<Item = (i32, i32)>, size: i32) -> Vec<Stack> {
    let mut columns: BTreeMap<i32, BTreeSet<i32>> = BTreeMap::new();
    for (column, row) in centres {
        columns.entry(column).or_default().insert(row);
    }
    let mut stacks: Vec<Stack> = Vec::new();
    for (column, rows) in columns {
        for row in rows {
            let top = row - size / 2;
            match stacks.last_mut() {
                Some([same, _, bottom]) if *same == column && top <= *bottom => {
                    *bottom = top + size
                }
                _ => stacks.push([column, top, top + size]),
            }
        }
    }
    stacks
}

/// The start of a line of two points in an SVG, as the plotters library writes it.
const LINE: &str = "<polyline ";
const POINTS: &str = " points=\"";

/// Joins two or more successive vertical lines of the same style in an SVG into one path, because an
/// element for each of many spots would make a large file.
pub(super) fn joined(svg: &str) -> String {
    let lines: Vec<&str> = svg.split_inclusive('\n').collect();
    let alike = |a: &&str, b: &&str| match (vertical(a), vertical(b)) {
        (Some((style, ..)), Some((other, ..))) => style == other,
        _ => false,
    };
    lines.chunk_by(alike).map(path).collect()
}

/// Returns one path for several vertical lines of the same style; other text is left as it is.
fn path(lines: &[&str]) -> String {
    let style = vertical(lines[0]).map(|(style, ..)| style);
    let Some(style) = style.filter(|_| lines.len() > 1) else { return lines.concat() };
    let ends = lines.iter().filter_map(|line| vertical(line));
    let strokes: String =
        ends.map(|(_, x, [top, bottom])| format!("M{x} {top}V{bottom}")).collect();
    format!("<path {style} d=\"{strokes}\"/>\n")
}

/// Returns the style and the ends of a vertical line that is the only element of a line of text.
fn vertical(line: &str) -> Option<(&str, &str, [&str; 2])> {
    let element = line.trim_end().strip_prefix(LINE)?.strip_suffix("\"/>")?;
    let (style, points) = element.split_once(POINTS)?;
    let mut points = points.split_whitespace().map(|at| at.split_once(','));
    let ends = [points.next()??, points.next()??];
    let [(x, top), (same, bottom)] = ends;
    (points.next().is_none() && x == same).then_some((style, x, [top, bottom]))
}
