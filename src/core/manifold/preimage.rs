//! Preimages under a map of the plane.

use super::planar::{Matrix, PlanarMap, Vector, determinant, is_finite, minus, norm, solved};

/// The reason why a manifold cannot be continued.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
pub(super) enum Lost {
    /// An image under the map, or the derivative of the map, is not finite.
    #[error("the map or its derivative is not finite at the point ({:.6}, {:.6})", at[0], at[1])]
    NotFinite { at: Vector },
    /// The preimage lies on the other side of a fold of the map, or does not exist.
    #[error(
        "the manifold reaches a fold of the map: the point ({:.6}, {:.6}) has no preimage on this \
         side of the curve where the derivative is singular; the determinant of the derivative is \
         {determinant:.1e} at ({:.6}, {:.6})", of[0], of[1], at[0], at[1]
    )]
    Fold { of: Vector, at: Vector, determinant: f64 },
    /// The step along the manifold was too long for Newton's method.
    #[error("Newton's method finds no preimage of ({:.6}, {:.6})", of[0], of[1])]
    NoPreimage { of: Vector },
}

impl Lost {
    /// Converts the points in the error from units of the scales to the units of the states.
    pub fn in_units(self, scales: Vector) -> Self {
        let unit = |a: Vector| [a[0] * scales[0], a[1] * scales[1]];
        match self {
            Lost::NotFinite { at } => Lost::NotFinite { at: unit(at) },
            Lost::Fold { of, at, determinant } => {
                Lost::Fold { of: unit(of), at: unit(at), determinant }
            }
            Lost::NoPreimage { of } => Lost::NoPreimage { of: unit(of) },
        }
    }
}

/// Heuristic: the maximal number of Newton corrections.
const MOST: usize = 25;

/// Discretisation: Newton's method has converged if the last correction is smaller than this
/// fraction of the point: since convergence is quadratic, the next correction would be of the order
/// of the square of this fraction.
const LAST: f64 = 1e-9;

/// Computes the preimage of a point near a guess, and the derivative of the map at the preimage.
/// The determinant of the derivative at the preimage must have the same sign as at the guess,
/// because another preimage exists on the other side of a fold of the map.
pub(super) fn preimage(
    map: &dyn PlanarMap,
    of: Vector,
    guess: Vector,
) -> Result<(Vector, Matrix), Lost> {
    let mut at = guess;
    let mut start = None;
    let mut crossed = false;
    for _ in 0..MOST {
        let (image, slope) = map.linear(at);
        let det = determinant(slope);
        if !is_finite(image) || !det.is_finite() {
            return Err(Lost::NotFinite { at });
        }
        let first = *start.get_or_insert(det);
        crossed |= det * first <= 0.0;
        let way = solved(slope, minus(image, of));
        if !is_finite(way) {
            return Err(Lost::Fold { of, at, determinant: det });
        }
        at = minus(at, way);
        if norm(way) <= LAST * norm(at).max(norm(guess)).max(f64::MIN_POSITIVE) {
            let (_, slope) = map.linear(at);
            return match determinant(slope) {
                det if det * first > 0.0 => Ok((at, slope)),
                det => Err(Lost::Fold { of, at, determinant: det }),
            };
        }
    }
    // If there is no preimage, the iteration alternates across the fold.
    match (crossed, start) {
        (true, Some(determinant)) => Err(Lost::Fold { of, at: guess, determinant }),
        _ => Err(Lost::NoPreimage { of }),
    }
}
