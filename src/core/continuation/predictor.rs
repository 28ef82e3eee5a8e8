//! Prediction of the next point of a curve by polynomial extrapolation.

use super::curve_point::CurvePoint;
use super::hermite::{Knot, MOST_KNOTS, hermite};
use super::metric::ScaledNorm;
use crate::core::linalg::{advanced, difference, dot, norm as length_of};
use crate::core::problem::Names;
use std::ops::Range;

/// Heuristic: the largest deviation of a prediction from the tangent, as a fraction of the step.
/// The angle between the tangents at both ends of a step is limited to a similar value.
const MOST_CURVED: f64 = 0.3;

/// Heuristic: the largest difference between the polynomial and the tangent prediction in a group
/// of unknowns, relative to the norm of the group. The bound on this difference applies near an
/// extremum of the group, where the group hardly changes in the step.
const MOST_TURNED: f64 = 0.02;

/// Heuristic: the smallest cosine of the angle between the tangents at an earlier and the current
/// point: the predictor ignores earlier points whose tangent deviates by more than 60°.
const LEAST_SPEED: f64 = 0.5;

/// An earlier point of the curve, stored for the predictor and for the detection of two events in
/// one step.
pub(super) struct Earlier {
    pub place: CurvePoint,
    /// The length of the step from this point to the next point.
    pub length: f64,
}

/// The predictor, which stores earlier points of the curve; the latest point comes first.
#[derive(Default)]
pub(super) struct Predictor {
    earlier: Vec<Earlier>,
}

impl Predictor {
    /// Returns the latest of the earlier points, which precedes the current point.
    pub fn last(&self) -> Option<&Earlier> {
        self.earlier.first()
    }

    /// Stores a point, and the length of the step made from it.
    pub fn push(&mut self, place: CurvePoint, length: f64) {
        self.earlier.insert(0, Earlier { place, length });
        self.earlier.truncate(MOST_KNOTS - 1);
    }

    /// Iterates over the stored points, so that they can be interpolated to a new mesh.
    pub fn places(&mut self) -> impl Iterator<Item = &mut CurvePoint> {
        self.earlier.iter_mut().map(|earlier| &mut earlier.place)
    }

    /// Extrapolates the polynomial through the last points with their tangents; returns the tangent
    /// prediction if the polynomial is unreliable. The polynomial is a function of the coordinate
    /// along the tangent, `u = ⟨row, X − from⟩`, so that the prediction lies on the hyperplane of
    /// the step. The returned order is the power of the step length with which the prediction error
    /// grows.
    pub fn predict(
        &self,
        norm: &ScaledNorm,
        names: &Names,
        from: &CurvePoint,
        row: &[f64],
        length: f64,
    ) -> (Vec<f64>, i32) {
        let origin = dot(row, &from.unknowns);
        let mut knots =
            vec![Knot { u: 0.0, x: &from.unknowns, tangent: &from.tangent, speed: 1.0 }];
        for Earlier { place: CurvePoint { unknowns, tangent, .. }, .. } in &self.earlier {
            let (u, speed) = (dot(row, unknowns) - origin, dot(row, tangent));
            if u >= knots[knots.len() - 1].u || speed <= LEAST_SPEED {
                break;
            }
            knots.push(Knot { u, x: unknowns, tangent, speed });
        }
        let line = advanced(&from.unknowns, length, &from.tangent);
        while knots.len() > 1 {
            let curved = hermite(&knots, length);
            if is_trusted((norm, names), &difference(&curved, &line), from, length) {
                return (curved, 4);
            }
            knots.pop();
        }
        (line, 2)
    }
}

/// Whether a polynomial prediction is reliable: its deviation `bend` from the tangent prediction
/// must be small relative to the step. Each group of unknowns is also checked separately, since a
/// group that is small on this part of the branch has little weight in the norm. The deviation of a
/// group is compared with the change of the group in the step, or, at an extremum of the group,
/// with the norm of the group.
fn is_trusted(
    (norm, names): (&ScaledNorm, &Names),
    bend: &[f64],
    from: &CurvePoint,
    length: f64,
) -> bool {
    let small = |place: Range<usize>| {
        let step = length * length_of(&from.tangent[place.clone()]);
        let turn = MOST_TURNED * length_of(&from.unknowns[place.clone()]);
        length_of(&bend[place]) <= turn.max(MOST_CURVED * step)
    };
    let mut start = 0;
    let groups = names.unknowns.iter().all(|group| {
        let place = start..start + group.length;
        start = place.end;
        small(place)
    });
    let whole = norm.of(bend) <= MOST_CURVED * length;
    whole && groups && (start..bend.len()).all(|i| small(i..i + 1))
}
