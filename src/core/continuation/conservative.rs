//! Families of cycles at a constant value of the continued parameter, as in conservative systems.
//!
//! The cycles of a conservative system form families. To continue a family, the equations receive a
//! parameter that makes them dissipative; this parameter is zero, up to errors, along the family
//! (F. J. Muñoz-Almaraz, E. Freire, J. Galán, E. Doedel and A. Vanderbauwhede, *Physica D* 181 (2003)).
//! Each cycle of the family has a second multiplier 1, in addition to the multiplier 1 of the phase,
//! and the other multipliers occur in pairs with the product 1.

use super::branch::Branch;
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::step_control::Step;
use crate::core::bifurcation::{At, Critical, Stability, without_critical};
use crate::core::linalg::Spectrum;
use crate::core::problem::Dynamics;

/// Rounding: the parameter is constant along a branch if its slope with respect to scaled arclength
/// is smaller than this threshold, or smaller than the discretisation error. Cycles that emanate
/// from a Hopf point have smaller slopes only if the first Lyapunov coefficient vanishes.
const CONSTANT: f64 = 1e-9;

/// Discretisation: the second multiplier 1 may have an error of this size. It is double with one
/// eigenvector, so its error is the square root of the discretisation error.
const NEAR_ONE: f64 = 1e-3;

/// Discretisation: the moduli of multipliers on the unit circle may have errors of this size.
const NEAR_CIRCLE: f64 = 1e-2;

/// Discretisation: the logarithm of the product of all multipliers may have an error of this size. On the
/// coarsest meshes, large multipliers have relative errors of a few percent.
const NEAR_PRODUCT: f64 = 0.1;

/// Whether the continued parameter is constant over the first step of a branch of cycles, and the
/// cycle at the end of the step has a second multiplier 1.
pub(super) fn is_family(curve: &mut Curve, from: &CurvePoint, step: &Step) -> bool {
    let corrector = &mut curve.corrector;
    let (to, first) = (&step.place, corrector.equations.parameters_at());
    let constant = CONSTANT.max(corrector.mesh_error(&to.unknowns));
    let At { system, x, .. } = corrector.equations.at();
    let is_autonomous = system.traits(x).free_period.is_some();
    let change = corrector.norm.scaled(first, to.unknowns[first] - from.unknowns[first]);
    let slopes = [change / step.length, corrector.slope(&to.tangent)];
    let is_one = |mu: &(f64, f64)| Critical::One.distance(Dynamics::Periodic, mu) <= NEAR_ONE;
    let has_second = to.spectrum.as_ref().is_some_and(|all| all.iter().any(is_one));
    let is_constant = slopes.iter().all(|slope| slope.abs() <= constant);
    curve.recorder.solutions && is_autonomous && is_constant && has_second
}

/// Returns the warning of a branch whose continued parameter is constant.
pub(super) fn warning(branch: &Branch) -> String {
    let name = &branch.released[0];
    let column = branch.column(name).unwrap_or_default();
    let values = || branch.points.iter().filter_map(|point| point.value(column));
    let change =
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
    format!(
        "`{name}` is constant along this branch up to {change:.0e}, as along a family of cycles of a conservative \
         system: folds are not sought, and neither `unstable` nor the saved multipliers include the second \
         multiplier 1, which all cycles of the family have"
    )
}

/// Returns the multipliers of a cycle of a family without the second multiplier 1. If the product of
/// the other multipliers is 1, complex multipliers near the unit circle lie on the circle, unless
/// they are half of a quadruple `μ, μ̄, 1/μ, 1/μ̄`.
pub(super) fn besides_second_one(spectrum: &[(f64, f64)]) -> Spectrum {
    let distance = |mu: &(f64, f64)| Critical::One.distance(Dynamics::Periodic, mu);
    let others = without_critical(spectrum, 1, distance);
    let product: f64 = others.iter().map(|(re, im)| re.hypot(*im).ln()).sum();
    if product.abs() > NEAR_PRODUCT {
        return others;
    }
    others.iter().map(|mu| on_circle(*mu, &others)).collect()
}

/// Counts the unstable multipliers of a cycle of a family. Pairs with a product larger than 1 are not
/// counted, because the products of real pairs are 1, up to errors.
pub(super) fn stability(others: &[(f64, f64)]) -> Stability {
    Stability { odd_pairs: false, ..Stability::of(Dynamics::Periodic, others) }
}

/// Returns a multiplier on the unit circle without its numerical error; other multipliers are
/// returned unchanged. The inverse of the conjugate of a multiplier on the circle is the multiplier
/// itself; otherwise it is another multiplier.
fn on_circle(mu: (f64, f64), all: &[(f64, f64)]) -> (f64, f64) {
    let size = mu.0.hypot(mu.1);
    let inverse = (mu.0 / (size * size), mu.1 / (size * size));
    let distance = |other: &(f64, f64)| (other.0 - inverse.0).hypot(other.1 - inverse.1);
    let own = distance(&mu);
    let is_other = |other: &&(f64, f64)| other.0 != mu.0 || other.1.abs() != mu.1.abs();
    let in_quadruple = all.iter().filter(is_other).any(|other| distance(other) < own);
    if mu.1 == 0.0 || (size - 1.0).abs() > NEAR_CIRCLE || in_quadruple {
        return mu;
    }
    (mu.0 / size, mu.1 / size)
}
