//! Predictions that follow the curve's bend.

use super::hermite::{Knot, hermite};
use super::stepper::{Before, Place, Stepper};
use crate::core::newton::scaled_norm;
use crate::core::vector::{advanced, difference, dot, norm};
use std::ops::Range;

/// A prediction that leaves the tangent by more than this share of the step is not trusted.
const MOST_CURVED: f64 = 0.2;

/// Of a group that turns, it may leave the tangent by this share of the group's size.
const MOST_TURNED: f64 = 0.02;

/// A place with a tangent that is this far from the present one is of no use to the predictor.
const LEAST_SPEED: f64 = 0.5;

/// The two ends of a step, with the coordinate along the first one's tangent;
/// `length` is that of the step.
pub(super) fn knots_of<'a>(
    a: &'a Place,
    (b, length): (&'a Place, f64),
    row: &[f64],
) -> [Knot<'a>; 2] {
    [
        Knot { u: 0.0, x: &a.unknowns, tangent: &a.tangent, speed: 1.0 },
        Knot { u: length, x: &b.unknowns, tangent: &b.tangent, speed: dot(row, &b.tangent) },
    ]
}

impl Stepper<'_> {
    /// The polynomial through the last places with their tangents, extrapolated. Its parameter is
    /// the coordinate along the tangent, `u = ⟨row, X − from⟩`, so that the prediction lies on the
    /// hyperplane of the step.
    pub fn curved(
        &self,
        before: &[Before],
        from: &Place,
        row: &[f64],
        length: f64,
    ) -> Option<Vec<f64>> {
        let origin = dot(row, &from.unknowns);
        let mut knots =
            vec![Knot { u: 0.0, x: &from.unknowns, tangent: &from.tangent, speed: 1.0 }];
        for Before { place: Place { unknowns, tangent, .. }, .. } in before {
            let (u, speed) = (dot(row, unknowns) - origin, dot(row, tangent));
            if u >= knots[knots.len() - 1].u || speed <= LEAST_SPEED {
                break;
            }
            knots.push(Knot { u, x: unknowns, tangent, speed });
        }
        let line = advanced(&from.unknowns, length, &from.tangent);
        while knots.len() > 1 {
            let curved = hermite(&knots, length);
            if self.is_trusted(&difference(&curved, &line), from, length) {
                return Some(curved);
            }
            knots.pop();
        }
        None
    }

    /// Whether a prediction's `bend` away from the tangent is small against the step; and, since a
    /// group that is small on this part of the branch hardly counts in the norm, in each group by
    /// itself: against the group's part of the step, or, where the group turns, against its size.
    fn is_trusted(&self, bend: &[f64], from: &Place, length: f64) -> bool {
        let small = |place: Range<usize>| {
            let step = length * norm(&from.tangent[place.clone()]);
            let turn = MOST_TURNED * norm(&from.unknowns[place.clone()]);
            norm(&bend[place]) <= turn.max(MOST_CURVED * step)
        };
        let mut start = 0;
        let groups = self.equations.names().unknowns.iter().all(|group| {
            let place = start..start + group.length;
            start = place.end;
            small(place)
        });
        let whole = scaled_norm(bend, &self.weights) <= MOST_CURVED * length;
        whole && groups && (start..bend.len()).all(|i| small(i..i + 1))
    }
}
