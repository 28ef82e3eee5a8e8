//! Arclength, and the error of the piecewise cubic curve that interpolates the points of a branch
//! and their tangents.

use super::curve_point::CurvePoint;
use super::hermite::{Knot, hermite};
use super::metric::ScaledNorm;
use crate::core::linalg::{difference, dot};

/// Estimates the distance between the curve and its cubic interpolant between two points, in scaled
/// arclength. The distance is computed halfway between the two points, perpendicular to the chord,
/// by comparison with the quintic that also interpolates the point `before`. If `before` is not
/// given, returns the error of the cubic interpolant of a circular arc, `θ⁴/384` times the radius.
pub(super) fn curve_error(
    norm: &ScaledNorm,
    before: Option<&CurvePoint>,
    from: &CurvePoint,
    to: &CurvePoint,
) -> f64 {
    let length = arclength(norm, from.on_curve(), to.on_curve());
    let Some(before) = before else {
        return length * turn(norm, [&from.tangent, &to.tangent]).powi(3) / 384.0;
    };
    let knots = [
        knot(norm, -arclength(norm, before.on_curve(), from.on_curve()), before),
        knot(norm, 0.0, from),
        knot(norm, length, to),
    ];
    let [quintic, cubic] = [&knots[..], &knots[1..]].map(|knots| hermite(knots, 0.5 * length));
    let error = difference(&quintic, &cubic);
    // A shift along the curve is not an error.
    let mut chord = difference(&to.unknowns, &from.unknowns);
    norm.rescale(&mut chord);
    let along = dot(&norm.covector(&chord), &error);
    let across: Vec<f64> = error.iter().zip(&chord).map(|(e, c)| e - along * c).collect();
    norm.of(&across)
}

/// Creates the knot of the interpolant at a point of the curve; `u` is the position of the point,
/// which is the arclength measured in the given norm.
fn knot<'a>(norm: &ScaledNorm, u: f64, place: &'a CurvePoint) -> Knot<'a> {
    let CurvePoint { unknowns, tangent, .. } = place;
    Knot { u, x: unknowns, tangent, speed: norm.of(tangent) }
}

/// Returns the angle between the tangents at two points, in radians, accurate to third order.
fn turn(norm: &ScaledNorm, [from, to]: [&[f64]; 2]) -> f64 {
    let size = norm.of(from) / norm.of(to);
    let same: Vec<f64> = to.iter().map(|t| size * t).collect();
    norm.distance(from, &same) / norm.of(from)
}

/// Estimates the scaled arclength between two points from their tangents: the length of the chord,
/// corrected by the difference between arc and chord on a circle.
pub(super) fn arclength(norm: &ScaledNorm, from: [&[f64]; 2], to: [&[f64]; 2]) -> f64 {
    let turn = turn(norm, [from[1], to[1]]);
    norm.distance(from[0], to[0]) * (1.0 + turn * turn / 24.0)
}
