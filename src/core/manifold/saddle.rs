//! Correction of the saddle cycle by Newton's method, and the multipliers of the cycle.

use super::error::ManifoldError;
use super::planar::{Matrix, PlanarMap, Vector, determinant, norm, times};
use crate::core::continuation::RootSearch;
use crate::core::orbit::MapCycle;
use crate::core::problem::DiscreteMap;
use std::sync::Arc;

/// Heuristic: the smallest allowed `|ln |λ||` of a multiplier: near a weaker saddle, a point takes
/// tens of thousands of iterates to leave the neighbourhood.
pub(super) const WEAKEST: f64 = 1e-3;

/// Rounding: the smallest multiplier of a stable manifold; a smaller number is a rounding error of
/// the derivative.
const NO_INVERSE: f64 = 1e-13;

/// Heuristic: two states of a cycle count as equal if their distance is less than this fraction of
/// the cycle's size.
const REPEATS: f64 = 1e-8;

/// Computes the states of the cycle near a guess, iterate by iterate.
pub(super) fn corrected<M: DiscreteMap + 'static>(
    map: &Arc<M>,
    states: &[f64],
    p: &[f64],
    scales: Vector,
) -> Result<Vec<Vector>, ManifoldError> {
    let iterates = states.len() / 2;
    let mut cycles = MapCycle::shared(map.clone(), iterates);
    let start = cycles.unknowns(states);
    let sizes: Vec<f64> = (0..start.len())
        .map(|k| {
            let own = &start[k / iterates * iterates..][..iterates];
            own.iter().fold(scales[k / iterates], |most, x| most.max(x.abs()))
        })
        .collect();
    let found = RootSearch::default().near(&mut cycles, p, &start, &sizes);
    let near = [states[0], states[1]];
    let z = found.ok_or(ManifoldError::NoCycle { iterates, near })?;
    let cycle: Vec<Vector> = (0..iterates).map(|k| [z[k], z[iterates + k]]).collect();
    let repeats = |found: &usize| {
        let pairs = cycle.iter().zip(&cycle[*found..]);
        let same = |(a, b): (&Vector, &Vector)| {
            (0..2).all(|i| (a[i] - b[i]).abs() <= REPEATS * sizes[i * iterates])
        };
        iterates.is_multiple_of(*found) && pairs.into_iter().all(same)
    };
    match (1..iterates).find(repeats) {
        Some(found) => Err(ManifoldError::Shorter { found, wanted: iterates }),
        None => Ok(cycle),
    }
}

/// Computes the multipliers of a saddle from the derivatives at the points of the cycle; the
/// unstable multiplier is the first.
pub(super) fn multipliers(map: &dyn PlanarMap, cycle: &[Vector]) -> Result<Vector, ManifoldError> {
    let (product, det) = derivative(map, cycle);
    let half = 0.5 * (product[0][0] + product[1][1]);
    let square = half * half - det;
    if square < 0.0 {
        return Err(ManifoldError::Focus { re: half, im: (-square).sqrt() });
    }
    let larger = half + square.sqrt().copysign(half);
    let both = [larger, if larger == 0.0 { 0.0 } else { det / larger }];
    match both.iter().find(|multiplier| multiplier.abs().ln().abs() < WEAKEST) {
        Some(weak) => Err(ManifoldError::Weak { multiplier: *weak, least: WEAKEST }),
        None if both[0].abs() < 1.0 || both[1].abs() > 1.0 => {
            Err(ManifoldError::Node { multipliers: both })
        }
        None => Ok(both),
    }
}

/// Returns an error for a multiplier that is zero, for which the map has no inverse.
pub(super) fn require_inverse(multipliers: Vector) -> Result<(), ManifoldError> {
    let [_, multiplier] = multipliers;
    match multiplier.abs() <= NO_INVERSE {
        true => Err(ManifoldError::NoInverse { multiplier }),
        false => Ok(()),
    }
}

/// Computes the derivative, at the first point of a cycle, of the iterates of the map over the
/// whole cycle, and the determinant of this derivative.
pub(super) fn derivative(map: &dyn PlanarMap, cycle: &[Vector]) -> (Matrix, f64) {
    let mut columns = [[1.0, 0.0], [0.0, 1.0]];
    let mut det = 1.0;
    for u in cycle {
        let (_, slope) = map.linear(*u);
        columns = columns.map(|column| times(slope, column));
        det *= determinant(slope);
    }
    ([[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]], det)
}

/// Computes the eigenvector of length 1 of a matrix with two different real eigenvalues; the first
/// nonzero component of the eigenvector is positive.
pub(super) fn eigenvector(m: Matrix, eigenvalue: f64) -> Vector {
    let [a, b] = [[m[0][1], eigenvalue - m[0][0]], [eigenvalue - m[1][1], m[1][0]]];
    let longer = if norm(a) >= norm(b) { a } else { b };
    let size = norm(longer);
    let first = if longer[0] == 0.0 { longer[1] } else { longer[0] };
    longer.map(|part| part / size.copysign(first))
}
