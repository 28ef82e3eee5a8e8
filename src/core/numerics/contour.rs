//! Zero sets of functions of two variables, by marching squares.

use std::collections::BTreeMap;

/// The largest number of evaluations with which the zero on a grid edge is located.
const ROUNDS: usize = 60;
/// A zero on a grid edge is accurate enough if the value of the function there, relative to its
/// values at the ends of the edge, is at most this number.
const ACCURATE: f64 = 1e-12;
/// Heuristic: a change of sign on a grid edge counts as a pole or a jump, and not as a zero, if the
/// smallest value found there, relative to the values at the ends of the edge, is above this
/// number.
const SINGULAR: f64 = 1e-3;

/// An edge of the grid: the two indices of a node, and the axis along which the edge leads to the
/// next node.
type Edge = ([usize; 2], usize);

/// Returns the zero set of a function in a rectangle as lines. The values along the two axes must
/// increase; the rectangle is divided at these values, and a line has a point on each grid edge at
/// whose ends the function has different signs. The points are zeros to rounding error, and the
/// lines are straight between the points. A line that returns to its first point is closed.
///
/// Zeros without a change of sign between neighbouring grid nodes are not found. The lines have gaps
/// where the function is not finite, and at poles and jumps.
///
/// ```
/// use tangency::core::numerics::zero_set;
/// let axis: Vec<f64> = (0..41).map(|k| 0.1 * f64::from(k) - 2.05).collect();
/// let lines = zero_set([&axis, &axis], |[x, y]| x * x + y * y - 1.0);
/// assert!(lines.len() == 1 && lines[0].first() == lines[0].last());
/// assert!(lines[0].iter().all(|[x, y]| (x.hypot(*y) - 1.0).abs() < 1e-12));
/// ```
pub fn zero_set(axes: [&[f64]; 2], f: impl Fn([f64; 2]) -> f64) -> Vec<Vec<[f64; 2]>> {
    let [columns, rows] = axes.map(<[f64]>::len);
    let node = |k: usize| f([axes[0][k % columns], axes[1][k / columns]]);
    let grid = Grid { axes, values: (0..columns * rows).map(node).collect(), f: &f };
    let cells = |count: usize| 0..count.saturating_sub(1);
    let all = cells(columns).flat_map(|i| cells(rows).map(move |j| [i, j]));
    let segments: Vec<[Edge; 2]> = all.flat_map(|cell| grid.segments(cell)).collect();
    let mut zeros: BTreeMap<Edge, Option<[f64; 2]>> = BTreeMap::new();
    for edge in segments.iter().flatten() {
        zeros.entry(*edge).or_insert_with(|| grid.zero(*edge));
    }
    let has = |edge: &Edge| zeros.get(edge).is_some_and(Option::is_some);
    let segments: Vec<[Edge; 2]> =
        segments.into_iter().filter(|segment| segment.iter().all(has)).collect();
    let chains = chains(&segments).into_iter();
    chains.map(|chain| chain.iter().filter_map(|edge| zeros[edge]).collect()).collect()
}

/// The values of a function at the nodes of a grid.
struct Grid<'a, F> {
    axes: [&'a [f64]; 2],
    values: Vec<f64>,
    f: &'a F,
}

impl<F: Fn([f64; 2]) -> f64> Grid<'_, F> {
    fn value(&self, [i, j]: [usize; 2]) -> f64 {
        self.values[j * self.axes[0].len() + i]
    }

    fn place(&self, [i, j]: [usize; 2]) -> [f64; 2] {
        [self.axes[0][i], self.axes[1][j]]
    }

    /// Returns the segments of the zero set in a cell, each between two edges of the cell.
    fn segments(&self, [i, j]: [usize; 2]) -> Vec<[Edge; 2]> {
        let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
        let values = corners.map(|corner| self.value(corner));
        if values.iter().any(|value| !value.is_finite()) {
            return Vec::new();
        }
        let edges = [([i, j], 0), ([i + 1, j], 1), ([i, j + 1], 0), ([i, j], 1)];
        let above = values.map(|value| value >= 0.0);
        let crossed: Vec<Edge> =
            (0..4).filter(|k| above[*k] != above[(*k + 1) % 4]).map(|k| edges[k]).collect();
        match crossed[..] {
            [first, second] => vec![[first, second]],
            [bottom, right, top, left] => {
                // The middle decides which two corners with equal signs are connected.
                let [from, to] = [self.place(corners[0]), self.place(corners[2])];
                let middle = (self.f)([0, 1].map(|k| 0.5 * (from[k] + to[k]))) >= 0.0;
                match middle == above[0] {
                    true => vec![[bottom, right], [top, left]],
                    false => vec![[left, bottom], [right, top]],
                }
            }
            _ => Vec::new(),
        }
    }

    /// Returns the zero on an edge at whose ends the function has different signs; `None` at a pole
    /// or a jump.
    fn zero(&self, (node, axis): Edge) -> Option<[f64; 2]> {
        let mut next = node;
        next[axis] += 1;
        let from = self.place(node);
        let along = |at: f64| {
            let mut place = from;
            place[axis] = at;
            place
        };
        let ([mut a, mut b], [mut low, mut high]) =
            ([from[axis], self.place(next)[axis]], [self.value(node), self.value(next)]);
        let size = low.abs().max(high.abs());
        let (mut best, mut least) = if low.abs() <= high.abs() { (a, low) } else { (b, high) };
        for round in 0..ROUNDS {
            if least.abs() <= ACCURATE * size {
                break;
            }
            // Every third step halves the bracket.
            let secant = (a * high - b * low) / (high - low);
            let at = if round % 3 == 2 || !secant.is_finite() { 0.5 * (a + b) } else { secant };
            let value = (self.f)(along(at));
            if value.abs() < least.abs() {
                (best, least) = (at, value);
            }
            match (value >= 0.0) == (low >= 0.0) {
                true => (a, low) = (at, value),
                false => (b, high) = (at, value),
            }
        }
        (least.abs() <= SINGULAR * size).then(|| along(best))
    }
}

/// Joins segments at their common edges to chains; closed chains begin and end with the same edge.
fn chains(segments: &[[Edge; 2]]) -> Vec<Vec<Edge>> {
    let mut at: BTreeMap<Edge, Vec<usize>> = BTreeMap::new();
    for (k, segment) in segments.iter().enumerate() {
        segment.iter().for_each(|edge| at.entry(*edge).or_default().push(k));
    }
    let mut used = vec![false; segments.len()];
    // Open chains begin at their ends.
    let (open, closed): (Vec<Edge>, Vec<Edge>) = at.keys().partition(|edge| at[*edge].len() == 1);
    let mut chains = Vec::new();
    for start in open.into_iter().chain(closed) {
        let mut chain = vec![start];
        let mut last = start;
        while let Some(k) = at[&last].iter().copied().find(|k| !used[*k]) {
            used[k] = true;
            last = if segments[k][0] == last { segments[k][1] } else { segments[k][0] };
            chain.push(last);
        }
        if chain.len() > 1 {
            chains.push(chain);
        }
    }
    chains
}
