//! Families of cycles at a constant value of the continued parameter, as in conservative systems.
//!
//! The cycles of a conservative system form families. To continue a family, the equations receive a
//! parameter that makes them dissipative; this parameter is zero, up to errors, along the family
//! (F. J. Muñoz-Almaraz, E. Freire, J. Galán, E. Doedel and A. Vanderbauwhede, *Physica D* 181 (2003)).
//! Each cycle of the family has a second multiplier 1, in addition to the multiplier 1 of the phase
//! ([`paired_multipliers`](super::paired_multipliers)).

use super::branch::Branch;
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::half::Half;
use super::log::Log;
use super::step_control::Step;
use crate::core::bifurcation::{At, Critical};
use crate::core::problem::Dynamics;

/// Rounding: the parameter is constant along a branch if its slope with respect to scaled arclength
/// is smaller than the first threshold, or smaller than the discretisation error and the second threshold.
/// Cycles that emanate from a Hopf point have such slopes only if the first Lyapunov coefficient vanishes.
const CONSTANT: [f64; 2] = [1e-9, 1e-5];

/// Discretisation: the second multiplier 1 may have an error of this size. It is double with one
/// eigenvector, so its error is the square root of the discretisation error.
const NEAR_ONE: f64 = 1e-3;

/// Whether the continued parameter is constant over the first step of a branch of cycles, and the
/// cycle at the end of the step has a second multiplier 1.
fn is_family(curve: &mut Curve, from: &CurvePoint, step: &Step) -> bool {
    let corrector = &mut curve.corrector;
    let (to, first) = (&step.place, corrector.equations.parameters_at());
    let constant = corrector.mesh_error(&to.unknowns).clamp(CONSTANT[0], CONSTANT[1]);
    let At { system, x, .. } = corrector.equations.at();
    let is_autonomous = system.traits(x).free_period.is_some();
    let change = corrector.norm.scaled(first, to.unknowns[first] - from.unknowns[first]);
    let slopes = [change / step.length, corrector.slope(&to.tangent)];
    let is_one = |mu: &(f64, f64)| Critical::One.distance(Dynamics::Periodic, mu) <= NEAR_ONE;
    let has_second = to.spectrum.as_ref().is_some_and(|all| all.iter().any(is_one));
    let is_constant = slopes.iter().all(|slope| slope.abs() <= constant);
    curve.recorder.solutions && is_autonomous && is_constant && has_second
}

/// Discretisation: the factor by which the change of the parameter along a family may exceed the
/// discretisation error of the cycles.
const LENIENCE: f64 = 10.0;

/// Whether the continued parameter has changed by more than its error since the start of a branch. Near
/// a degenerate Hopf point, a branch looks like a family until the parameter varies.
fn varies(curve: &mut Curve, start: &CurvePoint, place: &CurvePoint) -> bool {
    let corrector = &mut curve.corrector;
    let first = corrector.equations.parameters_at();
    let change = corrector.norm.scaled(first, place.unknowns[first] - start.unknowns[first]);
    change.abs() > CONSTANT[0].max(LENIENCE * corrector.mesh_error(&place.unknowns))
}

/// Whether a step must be tried again, because it shows that the branch is a family of cycles, or that
/// the branch leaves a family. The start of the branch and the half are updated.
pub(super) fn family_changes(
    (curve, log): (&mut Curve, &mut Log),
    (start, half): (&mut CurvePoint, &mut Half),
    step: &Step,
) -> bool {
    let varies = varies(curve, &half.start, &step.place);
    if curve.recorder.family && varies {
        let parameter = curve.corrector.equations.parameters_at();
        log.leaves_family(half.last.unknowns[parameter]);
        curve.leaves_family(&mut half.last);
        return true;
    }
    let begins = half.points.is_empty() && !curve.recorder.family && !varies;
    let begins = begins && is_family(curve, &half.last, step);
    if begins {
        curve.becomes_family([&mut half.last, &mut half.start, start]);
    }
    begins
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
