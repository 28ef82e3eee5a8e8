//! The size of the states on the segments of cycles, as a test for a segment whose states vanish.

use super::solutions::Solutions;
use super::work::Work;

/// Heuristic: a segment counts as vanishing if it is shorter than this fraction of its cycle.
const BRIEF: f64 = 1e-3;
/// Heuristic: a segment counts as constant if no state changes by more than this fraction of the
/// largest state.
const MOVES: f64 = 0.1;
/// Rounding: a segment counts as constant if all its states are below this rounding error.
const ROUNDING: f64 = 1e-13;

/// Returns the size of the smallest segment of a cycle; the size of a segment is its largest state,
/// in units of the states' scales. The size is infinite for cycles with a single segment. Constant
/// segments and vanishing segments are ignored when the smallest segment is determined.
pub(super) fn least_size(solutions: &mut Solutions, x: &[f64]) -> f64 {
    let segments = solutions.equations.layout.segments.len();
    if solutions.equations.layout.cycle.is_none() || segments == 1 {
        return f64::INFINITY;
    }
    solutions.load(x);
    let (equations, Work { nodes, numbers, q, .. }) = (&solutions.equations, &solutions.plain);
    let lasts = |s: usize| equations.duration(numbers, |other| other == s).abs();
    let whole: f64 = (0..segments).map(lasts).sum();
    let size = |s: usize| {
        let (segment, scales) = (&equations.layout.segments[s], equations.problem.scales(s, q));
        let all = &nodes[segment.values..segment.values + segment.nodes * segment.states];
        let scaled = |(k, x): (usize, &f64)| {
            x.abs() / scales.get(k % segment.states).copied().unwrap_or(1.0)
        };
        let size = all.iter().enumerate().map(scaled).fold(0.0, f64::max);
        let change = |(k, (a, b)): (usize, (&f64, &f64))| scaled((k, &(a - b)));
        let changes = all.iter().zip(&all[segment.states..]).enumerate().map(change);
        let moves = size > ROUNDING && changes.fold(0.0, f64::max) > MOVES * size;
        if moves { size } else { f64::INFINITY }
    };
    let lasting = (0..segments).filter(|s| lasts(*s) > BRIEF * whole);
    lasting.map(size).fold(f64::INFINITY, f64::min)
}
