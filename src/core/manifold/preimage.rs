//! Preimages under a map of the plane.

use super::planar::{Matrix, PlanarMap, Vector, determinant, is_finite, minus, norm, solved};

/// Why a manifold does not go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum Lost {
    /// An image or its derivative is not finite.
    #[error("the map or its derivative is not finite at ({:.6}, {:.6})", at[0], at[1])]
    NotFinite { at: Vector },
    /// A preimage is across a fold of the map, or there is none.
    #[error(
        "a fold of the map: ({:.6}, {:.6}) has no preimage on this side of the curve where the derivative is singular; its \
         determinant comes to {determinant:.1e} at ({:.6}, {:.6})", of[0], of[1], at[0], at[1]
    )]
    Fold { of: Vector, at: Vector, determinant: f64 },
    /// The step was too long for Newton's method.
    #[error("Newton's method finds no preimage of ({:.6}, {:.6})", of[0], of[1])]
    NoPreimage { of: Vector },
}

impl Lost {
    /// The same failure with points in the units of the states.
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

/// (H) The most corrections of Newton's method.
const MOST: usize = 25;

/// (D) A correction of this part of the point is the last one: the next one would be its square.
const LAST: f64 = 1e-9;

/// The preimage of a point near a guess, and the derivative of the map there. The determinant of the
/// derivative must have the sign that it has at the guess: on the other side of a fold of the map
/// there is another preimage.
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
    // Where there is no preimage, the iteration goes to and fro across the fold.
    match (crossed, start) {
        (true, Some(determinant)) => Err(Lost::Fold { of, at: guess, determinant }),
        _ => Err(Lost::NoPreimage { of }),
    }
}
