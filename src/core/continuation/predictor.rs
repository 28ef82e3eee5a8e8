//! Predictions that follow the curve's bend.

use super::corrector::Corrector;
use super::curve::CurvePoint;
use super::hermite::{Knot, MOST_KNOTS, hermite};
use crate::core::newton::scaled_norm;
use crate::core::vector::{advanced, difference, dot, norm};
use std::ops::Range;

/// A prediction that leaves the tangent by more than this share of the step is not trusted.
const MOST_CURVED: f64 = 0.2;

/// Bound on the difference of the curved and the tangent prediction in a group of unknowns,
/// relative to the group's norm.
const MOST_TURNED: f64 = 0.02;

/// A point with a tangent that is this far from the present one is of no use to the predictor.
const LEAST_SPEED: f64 = 0.5;

/// A point before the last one, for the predictor and for pairs of events.
pub(super) struct Earlier {
    pub place: CurvePoint,
    /// The length of the step from it.
    pub length: f64,
}

/// The points before the last one, the latest first.
#[derive(Default)]
pub(super) struct Predictor {
    earlier: Vec<Earlier>,
}

/// The point that Newton's iteration starts from, on the hyperplane of the step.
pub(super) struct Prediction {
    pub unknowns: Vec<f64>,
    /// Its error grows with this power of the step's length.
    pub order: i32,
}

impl Predictor {
    /// The point before the last one.
    pub fn last(&self) -> Option<&Earlier> {
        self.earlier.first()
    }

    /// Keeps a point that a step of this length has left.
    pub fn push(&mut self, place: CurvePoint, length: f64) {
        self.earlier.insert(0, Earlier { place, length });
        self.earlier.truncate(MOST_KNOTS - 1);
    }

    /// The points, to be carried over to a new mesh.
    pub fn places(&mut self) -> impl Iterator<Item = &mut CurvePoint> {
        self.earlier.iter_mut().map(|earlier| &mut earlier.place)
    }

    /// The polynomial through the last points with their tangents, extrapolated; the tangent where
    /// that is not trusted. Its parameter is the coordinate along the tangent,
    /// `u = ⟨row, X − from⟩`, so that the prediction lies on the hyperplane of the step.
    pub fn predict(
        &self,
        corrector: &Corrector,
        from: &CurvePoint,
        row: &[f64],
        length: f64,
    ) -> Prediction {
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
            if is_trusted(corrector, &difference(&curved, &line), from, length) {
                return Prediction { unknowns: curved, order: 4 };
            }
            knots.pop();
        }
        Prediction { unknowns: line, order: 2 }
    }
}

/// Whether a prediction's `bend` away from the tangent is small against the step; and, since a
/// group that is small on this part of the branch hardly counts in the norm, in each group by
/// itself: against the group's part of the step, or, where the group turns, against its size.
fn is_trusted(corrector: &Corrector, bend: &[f64], from: &CurvePoint, length: f64) -> bool {
    let small = |place: Range<usize>| {
        let step = length * norm(&from.tangent[place.clone()]);
        let turn = MOST_TURNED * norm(&from.unknowns[place.clone()]);
        norm(&bend[place]) <= turn.max(MOST_CURVED * step)
    };
    let mut start = 0;
    let groups = corrector.equations.names().unknowns.iter().all(|group| {
        let place = start..start + group.length;
        start = place.end;
        small(place)
    });
    let whole = scaled_norm(bend, &corrector.weights) <= MOST_CURVED * length;
    whole && groups && (start..bend.len()).all(|i| small(i..i + 1))
}
