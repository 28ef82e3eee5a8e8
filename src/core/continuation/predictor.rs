//! Prediction of the next point by extrapolation of the curve.

use super::curve_point::CurvePoint;
use super::hermite::{Knot, MOST_KNOTS, hermite};
use super::metric::ScaledNorm;
use crate::core::linalg::{advanced, difference, dot, norm as length_of};
use crate::core::problem::Names;
use std::ops::Range;

/// (H) The largest deviation of a prediction from the tangent, as a fraction of the step: the angle
/// of a step is limited to a similar value.
const MOST_CURVED: f64 = 0.3;

/// (H) The largest difference between the curved and the tangent prediction in a group of unknowns,
/// relative to the group's norm: at an extremum of a group its part of the step vanishes, and a
/// prediction may err by this fraction of its size.
const MOST_TURNED: f64 = 0.02;

/// (H) The predictor does not use points with a tangent more than 60° from the current one.
const LEAST_SPEED: f64 = 0.5;

/// An earlier point, for the predictor and for the detection of pairs of events.
pub(super) struct Earlier {
    pub place: CurvePoint,
    /// The length of the step after this point.
    pub length: f64,
}

/// The earlier points, the latest first.
#[derive(Default)]
pub(super) struct Predictor {
    earlier: Vec<Earlier>,
}

impl Predictor {
    /// Returns the point before the last one.
    pub fn last(&self) -> Option<&Earlier> {
        self.earlier.first()
    }

    /// Stores a point from which a step of this length was made.
    pub fn push(&mut self, place: CurvePoint, length: f64) {
        self.earlier.insert(0, Earlier { place, length });
        self.earlier.truncate(MOST_KNOTS - 1);
    }

    /// Iterates over the points, to interpolate them to a new mesh.
    pub fn places(&mut self) -> impl Iterator<Item = &mut CurvePoint> {
        self.earlier.iter_mut().map(|earlier| &mut earlier.place)
    }

    /// Extrapolates the polynomial through the last points with their tangents; returns the tangent
    /// prediction if the polynomial is not trusted. The polynomial's parameter is the coordinate
    /// along the tangent, `u = ⟨row, X − from⟩`, so that the prediction lies on the hyperplane of
    /// the step. The returned order is the power of the step's length with which the error grows.
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

/// Whether a prediction's `bend` away from the tangent is small relative to the step. Each group is
/// also checked separately, since a group that is small on this part of the branch has little
/// weight in the norm: relative to its part of the step, or, at an extremum of the group, relative
/// to its size.
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
