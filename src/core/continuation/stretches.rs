//! Computation of the stretches of curves of bifurcations in two parameters (parts between special
//! points), and of the solutions on both sides of each stretch.

use super::branch::SpecialPoint;
use super::corrector::Corrector;
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::located::Located;
use super::stretch::Stretch;
use crate::core::bifurcation::{Sides, Stability};
use crate::core::linalg::dot;
use crate::core::system::Kind;

/// Heuristic: the largest cosine of the angle between a curve and its computed normal. The angle
/// between a curve and its computed normal is 90°, except for discretisation errors and for errors
/// near a codimension-two point.
const OBLIQUE: f64 = 0.05;

/// The stretches (parts between special points) of one half of a curve in two parameters, collected
/// while the curve is traced.
#[derive(Default)]
pub(super) struct Stretches {
    /// The completed stretches (parts of the curve between special points); the indices of their
    /// points are counted from the start of the curve, which has the index 0.
    found: Vec<Stretch>,
    /// The number of noncritical unstable directions on the current stretch (part of the curve
    /// between special points); `None` if no stretch has begun.
    open: Option<usize>,
    /// The direction of the curve at the last point, projected onto the plane of the two
    /// parameters, in units of their scales.
    direction: [f64; 2],
}

impl Stretches {
    /// Extends or ends the current stretch (part of the curve between special points) at the point
    /// with the index `position`; `special` specifies whether a special point lies between this
    /// point and the previous one. A point at which the solutions on the two sides of the curve are
    /// uncertain belongs to a stretch only if the stretch continues beyond this point.
    pub fn reach(&mut self, curve: &mut Curve, place: &CurvePoint, position: usize, special: bool) {
        let Some(kind) = curve.recorder.dividing else { return };
        let direction = in_plane(&curve.corrector, &place.tangent);
        // The curve reverses its direction at a cusp.
        if special || dot(&direction, &self.direction) < 0.0 {
            self.open = None;
        }
        self.direction = direction;
        let Some(spectrum) = &place.spectrum else { return };
        let dynamics = curve.corrector.equations.system().dynamics();
        let count = Stability::of(dynamics, spectrum).unstable;
        match self.found.last_mut().filter(|_| self.open == Some(count)) {
            Some(last) => last.points[1] = position,
            None => {
                let sides = sides(&mut curve.corrector, place, kind);
                let sides = sides.filter(|sides| sides.unstable == count);
                self.open = sides.as_ref().map(|_| count);
                self.found.extend(sides.and_then(|sides| begin(sides, direction, position)));
            }
        }
    }

    /// Joins the stretches (parts between special points) of the two halves of a curve, whose start
    /// has the index `before`; `special` contains the special points of the whole curve.
    pub fn join(self, ahead: Stretches, before: usize, special: &[SpecialPoint]) -> Vec<Stretch> {
        let behind = self.found.into_iter().rev().map(|stretch| {
            let points = stretch.points.map(|k| before - k);
            Stretch { points, ..stretch }.reversed()
        });
        let mut all: Vec<Stretch> = behind.collect();
        for mut next in ahead.found {
            next.points = next.points.map(|k| before + k);
            match all.last_mut().filter(|last| goes_on(last, &next, before, special)) {
                Some(last) => last.points[1] = next.points[1],
                None => all.push(next),
            }
        }
        all
    }
}

/// Whether the last stretch (part of the curve between special points) before the start and the
/// first stretch after the start form one stretch.
fn goes_on(last: &Stretch, next: &Stretch, start: usize, special: &[SpecialPoint]) -> bool {
    let [from, to] = [last.points[1], next.points[0]];
    let within = |it: &SpecialPoint| (from..to).contains(&it.after) && divides(it.kind);
    let at_start = from < start && start < to;
    at_start
        && (&last.left, &last.right) == (&next.left, &next.right)
        && !special.iter().any(within)
}

/// Whether a stretch of a bifurcation curve (a part between special points) ends at a special point
/// of this kind. A stretch (a part of a curve between special points) does not end at marked
/// values, saved regular points and ends of branches.
pub(super) fn divides(kind: Kind) -> bool {
    !matches!(kind, Kind::UZ | Kind::RG | Kind::EP)
}

/// Heuristic: no additional point is computed between special points closer to each other than this
/// threshold, in scaled arclength, because they coincide in a plot.
const APART: f64 = 1e-3;

/// Returns the position in a step at which an additional point must be computed; `None` if no
/// additional point is needed. The position lies halfway between the first two special points found
/// at which stability may change, so that the additional point shows the stability between these
/// two points.
pub(super) fn between_changes(found: &[Located]) -> Option<f64> {
    let changes = found.iter().filter(|it| divides(it.special.kind)).map(|it| it.along);
    let changes: Vec<f64> = changes.collect();
    let pair = changes.windows(2).find(|pair| pair[1] - pair[0] > APART)?;
    Some(0.5 * (pair[0] + pair[1]))
}

/// Projects a tangent onto the plane of the two parameters, in units of their scales.
fn in_plane(corrector: &Corrector, tangent: &[f64]) -> [f64; 2] {
    let first = corrector.equations.parameters_at();
    [first, first + 1].map(|k| corrector.norm.scaled(k, tangent[k]))
}

/// Computes the solutions on the two sides of a curve at one of its points, with the normal of the
/// curve in units of the scales of the parameters; `None` if the solutions are unknown, or if the
/// computed normal is not orthogonal to the curve.
fn sides(corrector: &mut Corrector, place: &CurvePoint, kind: Kind) -> Option<Sides> {
    corrector.equations.load(&place.unknowns);
    let sides = Sides::of(kind, corrector.equations.at()).ok()??;
    let first = corrector.equations.parameters_at();
    let scaled = |k: usize| sides.towards[k] / corrector.norm.scaled(first + k, 1.0);
    let towards = [scaled(0), scaled(1)];
    let direction = in_plane(corrector, &place.tangent);
    let length = |[x, y]: [f64; 2]| x.hypot(y);
    let right = dot(&towards, &direction).abs() < OBLIQUE * length(towards) * length(direction);
    right.then_some(Sides { towards, ..sides })
}

/// Creates a stretch (part of the curve between special points) that begins at the point with the
/// given index, from the direction of the curve at this point.
fn begin(sides: Sides, direction: [f64; 2], position: usize) -> Option<Stretch> {
    let Sides { towards, there, opposite, .. } = sides;
    let across = direction[0] * towards[1] - direction[1] * towards[0];
    let points = [position; 2];
    match across {
        across if across > 0.0 => Some(Stretch { points, left: there, right: opposite }),
        across if across < 0.0 => Some(Stretch { points, left: opposite, right: there }),
        _ => None,
    }
}
