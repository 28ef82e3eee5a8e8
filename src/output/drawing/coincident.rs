//! Draws coincident lines: a line that is covered by other lines is drawn as a pale band, wider
//! than the lines on top.

use super::labels::{SAMPLED, sampled};
use crate::output::figure::Style;
use std::collections::{BTreeSet, HashMap};

/// The width of the pale band for a line that is covered by one other line, and the increase of
/// this width for a second and for a third covering line, in units.
const BAND: f64 = 5.0;
const WIDER: f64 = 2.0;
/// Half the distance between the points at which lines are sampled.
const SPACING: f64 = 0.5 * SAMPLED;
/// The distance, in units, below which a line covers another line.
const NEAR: f64 = 1.2;
/// The length, in units: if two lines are close to each other only over a shorter length, they
/// count as crossing or touching, not as coincident.
const LEAST: f64 = 45.0;

/// A line, in units of the canvas, with the index of the curve name to which the line belongs.
pub(super) struct Line {
    pub style: Style,
    pub points: Vec<[f64; 2]>,
    pub name: usize,
}

impl Line {
    fn hides(&self) -> bool {
        matches!(self.style, Style::Solid | Style::Dashed | Style::DottedLine)
    }
}

/// A part of a line that is covered by other lines.
pub(super) struct Hidden {
    pub points: Vec<[f64; 2]>,
    /// The index of the curve name to which the covered line belongs.
    pub name: usize,
    /// The width of the band that is drawn for the covered part.
    pub width: f64,
}

/// Returns the parts of lines that are covered by later lines with other names; the lowest line
/// comes first.
pub(super) fn hidden(lines: &[Line]) -> Vec<Hidden> {
    let mut names = lines.iter().filter(|line| line.hides()).map(|line| line.name);
    let first = names.next();
    if names.all(|name| Some(name) == first) {
        return Vec::new();
    }
    let reach = SPACING.hypot(NEAR);
    let cell = |at: &[f64; 2], side: f64| at.map(|x| (x / side).floor() as i32);
    // The sampled points in each cell, without consecutive points that are close to each other.
    let mut in_cells: HashMap<[i32; 2], Vec<(usize, [f64; 2])>> = HashMap::new();
    let sampled: Vec<Vec<[f64; 2]>> = lines
        .iter()
        .map(|line| if line.hides() { sampled(&line.points) } else { Vec::new() })
        .collect();
    for (k, points) in sampled.iter().enumerate() {
        for some in points.chunk_by(|a, b| cell(a, NEAR) == cell(b, NEAR)) {
            in_cells.entry(cell(&some[0], reach)).or_default().push((k, some[0]));
        }
    }
    // Counts the lines of other names above a point of a line.
    let above = |k: usize, at: &[f64; 2]| {
        let [column, row] = cell(at, reach);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [column + i, row + j]));
        let others = around.filter_map(|cell| in_cells.get(&cell)).flatten();
        let near = others.filter(|(other, there)| {
            *other > k
                && lines[*other].name != lines[k].name
                && (at[0] - there[0]).hypot(at[1] - there[1]) <= reach
        });
        near.map(|(other, _)| lines[*other].name).collect::<BTreeSet<usize>>().len()
    };
    let mut all = Vec::new();
    for (k, points) in sampled.iter().enumerate() {
        let covered = points.iter().map(|at| (*at, above(k, at)));
        let covered: Vec<([f64; 2], usize)> = covered.collect();
        for run in covered.chunk_by(|a, b| (a.1 > 0) == (b.1 > 0)) {
            let most = run.iter().map(|(_, count)| *count).max().unwrap_or_default();
            let points: Vec<[f64; 2]> = run.iter().map(|(at, _)| *at).collect();
            if most > 0 && length(&points) >= LEAST {
                let width = BAND + WIDER * (most - 1).min(2) as f64;
                all.push(Hidden { points, name: lines[k].name, width });
            }
        }
    }
    // Wide bands are drawn first, because they would hide narrow ones.
    all.sort_by(|a, b| b.width.total_cmp(&a.width));
    all
}

fn length(points: &[[f64; 2]]) -> f64 {
    points.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum()
}
