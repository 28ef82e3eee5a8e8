//! The numbers of functions for a plate's displacements, and the ladder of finer ones.

use super::basis::LARGEST_COUNT;
use super::error::PlateError;
use crate::core::numerics::ladder;

/// The number of orders to choose from.
const RUNGS: usize = 15;

/// Numbers of functions in each direction (x, then y): only even functions if the plate is
/// symmetric in that direction, all degrees otherwise.
///
/// ```
/// use tangency::problems::plate::Orders;
/// let orders = Orders::usual([true, true], 1.0);
/// assert_eq!((orders.transverse, orders.in_plane), ([6, 6], [8, 8]));
/// assert_eq!(orders.finer().in_plane, [12, 12]);
/// // A side four times as long needs twice as many functions.
/// assert_eq!(Orders::usual([true, true], 4.0).transverse, [6, 12]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Orders {
    /// The numbers of functions for the deflection.
    pub transverse: [usize; 2],
    /// The numbers of functions for each displacement in the plane.
    pub in_plane: [usize; 2],
}

impl Orders {
    /// Returns orders for tracing a branch of a plate with the given aspect ratio: for plates
    /// without free edges the error in a pull-in load is 1e-6 or less up to `α₁ = 2`, 6e-6 at 3.
    ///
    /// A long plate needs more functions along its length: the deflection is flat except in layers
    /// at the short edges, about one width long.
    pub fn usual(symmetric: [bool; 2], aspect: f64) -> Orders {
        Orders::of(6, 8, symmetric, aspect)
    }

    /// Converts numbers of transverse and in-plane functions of a square plate, symmetric in both
    /// directions, to a given symmetry and aspect ratio.
    fn of(transverse: usize, in_plane: usize, symmetric: [bool; 2], aspect: f64) -> Orders {
        let stretch = [1.0 / aspect, aspect].map(|length| length.clamp(1.0, 8.0).sqrt());
        let count = |base: usize, axis: usize| {
            let even = (base as f64 * stretch[axis]).round() as usize;
            if symmetric[axis] { even } else { 2 * even - 2 }
        };
        Orders {
            transverse: [count(transverse, 0), count(transverse, 1)],
            in_plane: [count(in_plane, 0), count(in_plane, 1)],
        }
    }

    /// Returns orders from the fewest functions to many. Up to the default orders, their ratio
    /// balances the work on the two displacements, and each gains about a digit of a pull-in load;
    /// then follow [`finer`](Orders::finer) ones, with one between each two.
    pub(super) fn ladder(symmetric: [bool; 2], aspect: f64) -> Vec<Orders> {
        let rung = |n: usize| Orders::of(n, n + n.div_ceil(3), symmetric, aspect);
        let rungs =
            ladder((2..=7).map(rung).collect(), RUNGS, |orders: &Orders| Some(orders.finer()));
        rungs.into_iter().filter(|orders| orders.check().is_ok()).collect()
    }

    /// Returns the finer orders for the refinement of special points, two rungs up the ladder. Two
    /// refinements above the default orders, pull-in loads of plates without free edges are
    /// accurate to 1e-8 and deflections to 1e-6 (`0 ≤ α₁ ≤ 3`, `1 ≤ α ≤ 6`, every model of the
    /// edges).
    #[must_use]
    pub fn finer(self) -> Orders {
        Orders {
            transverse: self.transverse.map(|n| n + 2 + n / 8),
            in_plane: self.in_plane.map(|n| n + 3 + n / 8),
        }
    }

    pub(super) fn check(&self) -> Result<(), PlateError> {
        let [[w_x, w_y], [s_x, s_y]] = [self.transverse, self.in_plane];
        PlateError::check("transverse functions along x", w_x, [1, LARGEST_COUNT])?;
        PlateError::check("transverse functions along y", w_y, [1, LARGEST_COUNT])?;
        PlateError::check("in-plane functions along x", s_x, [2, LARGEST_COUNT])?;
        PlateError::check("in-plane functions along y", s_y, [2, LARGEST_COUNT])
    }
}
