//! The data recorded at a located special point.

use super::admissible::{AT_LIMIT, subkind};
use super::branch::{Point, SpecialPoint};
use super::corrector::Corrector;
use super::crossing::tangents_at_crossing;
use super::curve::Curve;
use super::curve_error::arclength;
use super::curve_point::Interval;
use super::event::Event;
use super::located::Located;
use super::meaning::spreads;
use super::mesh_share::{MeshShare, Shortfall};
use super::recorder::{Recorded, special_point};
use super::slopes::Slopes;
use crate::core::bifurcation::{Critical, Quantity, unstable_besides};
use crate::core::failure::Failure;
use crate::core::linalg::{Spectrum, dot};
use crate::core::problem::Dynamics;
use crate::core::system::{Kind, System};

/// Records the special point at which an event was located in an interval of the branch.
pub(super) fn describe(
    curve: &mut Curve,
    index: usize,
    interval: Interval,
    located: Located,
) -> Result<Located, Failure> {
    let Located { along, unknowns, special, .. } = located;
    let SpecialPoint { error, numbers, sensitivities, converged, subkind: case, .. } = special;
    let Curve { corrector, detector, recorder, .. } = &mut *curve;
    let event = detector.events[index].clone();
    let crossing = event.kind == Kind::BP && recorder.solutions;
    let share = along / interval.length;
    let tangent = tangent_between(corrector, crossing, &unknowns, interval, share)?;
    // Infinite multipliers, as at a limit, cannot be recorded.
    let recorded = recorder.record(&mut corrector.equations, recorder.stability);
    let again = |_| recorder.record(&mut corrector.equations, false);
    let Recorded { mut point, spectrum, .. } = recorded.or_else(again)?;
    let sides = [interval.from, interval.to].map(|place| place.point.unstable);
    let known = spectrum.as_ref().filter(|_| recorder.solutions);
    point.unstable = match known {
        // The critical eigenvalues of a mirror point mask the eigenvalues of the branch.
        Some(_) if event.mirror => sides[0],
        Some(all) => own_count(corrector.equations.system(), event.critical, all, sides),
        None if spectrum.is_none() && event.kind == AT_LIMIT => {
            point.undetermined = None;
            sides[0]
        }
        None => None,
    };
    // In a family of cycles, both multipliers of a pair are critical, up to errors.
    if !converged || recorder.family {
        point.unstable = common_count(event.critical, sides);
    }
    let spectrum = spectrum.unwrap_or_default();
    let bracket = interval.ends(corrector.equations.parameters_at());
    let at = [&unknowns[..], &tangent];
    let special = special_point(corrector, (event.kind, &event.name), point, &spectrum, at);
    let position = arclength(&corrector.norm, interval.from.on_curve(), at);
    let columns = corrector.slopes(at, special.monitors.len());
    let slopes = Some(Slopes { position, columns });
    corrector.equations.load(&unknowns);
    let x = [&special.state[..], &special.parameters].concat();
    let subkind = subkind(&event, corrector.equations.system(), &x).or(case);
    let special = SpecialPoint { subkind, error, bracket, converged, slopes, ..special };
    let special = SpecialPoint { numbers, sensitivities, ..special };
    let (mut special, shortfall) =
        with_error(curve, &event, special, &unknowns, &interval.from.point);
    if curve.recorder.solutions {
        let dynamics = curve.corrector.equations.system().dynamics();
        doubt_multipliers(&mut special, event.critical, dynamics, sides);
    }
    Ok(Located { event: Some(index), along, unknowns, special, shortfall })
}

/// Heuristic: the largest error of a critical multiplier for which the other multipliers are
/// considered reliable.
const INACCURATE: f64 = 1e-2;

/// Removes the multipliers of a converged special point of periodic orbits if all of them are far
/// from the critical value. If no multiplier is near the critical value, the critical multiplier is
/// lost in rounding or discretisation errors, and other multipliers may also be wrong. The number
/// of unstable multipliers at the special point is then determined from the neighbouring points on
/// both sides.
fn doubt_multipliers(
    special: &mut SpecialPoint,
    critical: Critical,
    dynamics: Dynamics,
    sides: [Option<usize>; 2],
) {
    let all = &special.eigenvalues;
    // Unless the list is full, the leading multipliers include the critical one.
    let includes_critical = !all.is_empty() && all.len() < SpecialPoint::EIGENVALUES;
    let single = critical.count() == 1;
    if dynamics != Dynamics::Periodic || !special.converged || !includes_critical || !single {
        return;
    }
    let distances = all.iter().map(|multiplier| critical.distance(dynamics, multiplier));
    let nearest = distances.fold(f64::INFINITY, f64::min);
    if nearest > INACCURATE {
        special.eigenvalues.clear();
        special.unstable = common_count(critical, sides);
        special.undetermined = Some(format!(
            "no computed Floquet multiplier is near the critical value: the nearest multiplier \
             differs from the critical value by {nearest:.1e}; use a finer mesh"
        ));
    }
}

/// Adds the discretisation error to the error of a special point, and refines the special point on
/// a finer mesh if its kind requires refinement; `beside` is a nearby point of the branch.
fn with_error(
    curve: &mut Curve,
    event: &Event,
    mut special: SpecialPoint,
    unknowns: &[f64],
    beside: &Point,
) -> (SpecialPoint, Option<Shortfall>) {
    if event.condition.is_none() {
        special.error += curve.corrector.mesh_share(unknowns);
        refine_numbers(curve, event, &mut special, beside);
        special.subkind = special.subkind.filter(|_| special.converged);
        return (special, None);
    }
    let Curve { corrector, recorder, refiner, .. } = curve;
    // For a branch of solutions cut at a bound, the error of the branch is sufficient.
    let end_of_branch = event.kind == Kind::EP && recorder.solutions;
    let rungs = if end_of_branch { 1 } else { usize::MAX };
    let share = match special.converged && refiner.accuracy > 0.0 {
        true => refiner.refine(corrector, recorder, event, (&mut special, beside), rungs),
        false => MeshShare::Sufficient,
    };
    if share == MeshShare::Unknown {
        // The discretisation error is unknown, so no digit is certain.
        special.converged = false;
        special.numbers.iter_mut().for_each(|number| number.error = number.value.abs());
        special.error = unknowns[corrector.equations.parameters_at()].abs();
    }
    if !special.converged {
        // The standard name depends on the solution, which has not converged.
        special.subkind = None;
        special.sensitivities.clear();
    }
    let released = corrector.equations.released.iter();
    let parameters = &corrector.equations.names().parameters;
    let released: Vec<&str> = released.map(|p| parameters[*p].as_str()).collect();
    special.numbers.extend(spreads(&special.sensitivities, &refiner.tolerances, &released));
    let shortfall = match share {
        MeshShare::TooLarge(shortfall) if special.kind != Kind::EP => Some(shortfall),
        _ => None,
    };
    (special, shortfall)
}

/// Adds the discretisation error to the errors of the named numbers of a special point that is
/// located by bracketing. The discretisation error is computed by comparison with a point of the
/// curve on a finer discretisation, at the same value of the last parameter.
fn refine_numbers(curve: &mut Curve, event: &Event, special: &mut SpecialPoint, beside: &Point) {
    let Curve { corrector, recorder, refiner, .. } = curve;
    let Some(&last) = corrector.equations.released.last() else { return };
    let on_mesh = corrector.equations.system().representation().is_on_mesh();
    if special.numbers.is_empty() || !on_mesh || refiner.accuracy == 0.0 {
        return;
    }
    let held = Event::level(&event.name, Quantity::Parameter(last), special.parameters[last]);
    let held = Event { normal_form: event.normal_form, ..held };
    let share = refiner.refine(corrector, recorder, &held, (special, beside), usize::MAX);
    if share == MeshShare::Unknown {
        special.numbers.iter_mut().for_each(|number| number.error = number.value.abs());
        special.subkind = None;
    }
}

/// Returns the number of noncritical unstable eigenvalues at a special point; `None` if stability
/// is unknown on both sides.
fn own_count(
    system: &dyn System,
    critical: Critical,
    spectrum: &Spectrum,
    [before, after]: [Option<usize>; 2],
) -> Option<usize> {
    before.or(after)?;
    Some(unstable_besides(critical, system.dynamics(), spectrum))
}

/// Returns the number of unstable eigenvalues at a special point that has not converged: the
/// smaller of the numbers on the two sides; `None` if these two numbers differ by more than the
/// number of critical eigenvalues, as they do on the two sides of a singularity.
fn common_count(critical: Critical, [before, after]: [Option<usize>; 2]) -> Option<usize> {
    let (before, after) = (before?, after?);
    (before.abs_diff(after) <= critical.count()).then_some(before.min(after))
}

/// Returns the tangent at a special point, and assembles the matrix at this point; `share` is the
/// relative position of the special point in the interval. At a branch point, which has several
/// tangents, returns the tangent closest to the direction of the branch.
fn tangent_between(
    corrector: &mut Corrector,
    crossing: bool,
    unknowns: &[f64],
    Interval { from, to, .. }: Interval,
    share: f64,
) -> Result<Vec<f64>, Failure> {
    let parts = from.tangent.iter().zip(&to.tangent);
    let mut expected: Vec<f64> = parts.map(|(a, b)| (1.0 - share) * a + share * b).collect();
    corrector.norm.rescale(&mut expected);
    let row = corrector.norm.covector(&expected);
    corrector.equations.assemble(unknowns)?;
    if crossing {
        let tangents = tangents_at_crossing(corrector, unknowns, 1).unwrap_or_default();
        corrector.equations.assemble(unknowns)?;
        let cosine = |t: &Vec<f64>| dot(&row, t);
        let nearest =
            tangents.into_iter().max_by(|a, b| cosine(a).abs().total_cmp(&cosine(b).abs()));
        let Some(mut tangent) = nearest else { return Ok(expected) };
        let sign = cosine(&tangent).signum();
        tangent.iter_mut().for_each(|t| *t *= sign);
        return Ok(tangent);
    }
    let mut residual = vec![0.0; unknowns.len()];
    corrector.equations.residual(unknowns, None, &mut residual)?;
    if corrector.equations.factor(Some(&row)).is_err() {
        return Ok(expected);
    }
    let tangent = corrector.factored_tangent();
    Ok(if dot(&row, &tangent) > 0.5 { tangent } else { expected })
}
