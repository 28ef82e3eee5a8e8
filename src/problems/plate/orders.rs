//! The numbers of functions for the displacements of a plate, and a sequence of successively larger
//! numbers.

use super::basis::LARGEST_COUNT;
use super::error::PlateError;
use crate::core::numerics::ladder;

/// The length of the sequence of successively larger numbers of basis functions.
const RUNGS: usize = 15;

/// The numbers of basis functions in each direction (x, then y): if the plate is symmetric in this
/// direction, only even functions are counted, otherwise functions of all degrees.
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
    /// The numbers of basis functions of the deflection along x and y.
    pub transverse: [usize; 2],
    /// The numbers of basis functions of each in-plane displacement along x and y.
    pub in_plane: [usize; 2],
}

impl Orders {
    /// Returns the default numbers of functions for a plate with the given aspect ratio: for plates
    /// without free edges the relative error of a pull-in load is 1e-6 or less up to `α₁ = 2`, and
    /// 6e-6 at `α₁ = 3`.
    ///
    /// A long plate needs more basis functions along its length, because its deflection is constant
    /// along its length except in layers at the short edges; the thickness of these layers is about
    /// the width of the plate.
    pub fn usual(symmetric: [bool; 2], aspect: f64) -> Orders {
        Orders::of(6, 8, symmetric, aspect)
    }

    /// Converts the numbers of transverse and in-plane functions of a square plate, symmetric in
    /// both directions, to a given symmetry and aspect ratio.
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

    /// Returns a sequence of successively larger numbers of basis functions, each for a more
    /// accurate discretisation. Up to the default numbers, the ratio of transverse to in-plane
    /// functions is chosen such that the computations with both kinds of functions take similar
    /// times. In this part of the sequence, each entry gives pull-in loads that are about one digit
    /// more accurate than the pull-in loads of the previous entry. Beyond the default numbers, each
    /// entry is followed, two places later, by the numbers that [`finer`](Orders::finer) gives for
    /// the entry.
    pub(super) fn ladder(symmetric: [bool; 2], aspect: f64) -> Vec<Orders> {
        let rung = |n: usize| Orders::of(n, n + n.div_ceil(3), symmetric, aspect);
        let rungs =
            ladder((2..=7).map(rung).collect(), RUNGS, |orders: &Orders| Some(orders.finer()));
        rungs.into_iter().filter(|orders| orders.check().is_ok()).collect()
    }

    /// Returns the larger numbers of basis functions with which special points are finally
    /// corrected. With two refinements of the default numbers, pull-in loads of plates without free
    /// edges are accurate to 1e-8 and deflections to 1e-6 (`0 ≤ α₁ ≤ 3`, `1 ≤ α ≤ 6`, every model
    /// of the in-plane supports).
    #[must_use]
    pub fn finer(self) -> Orders {
        Orders {
            transverse: self.transverse.map(|n| n + 2 + n / 8),
            in_plane: self.in_plane.map(|n| n + 3 + n / 8),
        }
    }

    /// Returns smaller numbers of basis functions, with which special points are compared if larger
    /// numbers are not allowed; `None` if the numbers are as small as possible.
    pub(super) fn coarser(self) -> Option<Orders> {
        let fewer = |n: usize, by: usize, least: usize| n.saturating_sub(by + n / 8).max(least);
        let coarser = Orders {
            transverse: self.transverse.map(|n| fewer(n, 2, 1)),
            in_plane: self.in_plane.map(|n| fewer(n, 3, 2)),
        };
        (coarser != self).then_some(coarser)
    }

    pub(super) fn check(&self) -> Result<(), PlateError> {
        let [[w_x, w_y], [s_x, s_y]] = [self.transverse, self.in_plane];
        PlateError::check("transverse functions along x", w_x, [1, LARGEST_COUNT])?;
        PlateError::check("transverse functions along y", w_y, [1, LARGEST_COUNT])?;
        PlateError::check("in-plane functions along x", s_x, [2, LARGEST_COUNT])?;
        PlateError::check("in-plane functions along y", s_y, [2, LARGEST_COUNT])
    }
}
