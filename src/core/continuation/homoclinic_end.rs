//! Location of the homoclinic orbits at which branches of cycles end.

use super::branch::{Number, SpecialPoint};
use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::defining_system::converge;
use super::event::Event;
use super::extended::Extended;
use super::meaning::{Meaning, spreads};
use super::metric::{Metric, StartSizes};
use super::newton::{NewtonError, Tolerances};
use super::quantities::Quantities;
use super::refiner::Refiner;
use super::settings::Settings;
use crate::core::cancel::CancelToken;
use crate::core::failure::{Failure, one_line};
use crate::core::linalg::norm;
use crate::core::numerics::error_of_last;
use crate::core::system::{
    Emanating, HOMOCLINIC_RADIUS, HOMOCLINIC_RATES, Kind, Refinement, Solution, System,
};

/// Heuristic: the ratio of the truncation distances of two approximations of a homoclinic orbit,
/// which begin and end at different distances from the equilibrium. The difference between the two
/// approximations serves as an estimate of the truncation error of the homoclinic orbit.
const WIDER: f64 = 10.0;

/// Heuristic: the truncation distances, in units of the usual distance, to try if Newton's method
/// fails at the usual distance. Each distance gives Newton's method another start.
const OTHER_RADII: [f64; 3] = [0.5, 0.25, 2.0];

/// Heuristic: the largest allowed difference between the parameter at the end of a branch and the
/// parameter of the homoclinic orbit, relative to the range or to the value of the parameter.
const FAR_OFF: f64 = 1e-3;

/// Rounding: the parameter of the homoclinic orbit has converged if its values on two successive
/// meshes differ by less than this fraction.
const SETTLED: f64 = 1e-12;

/// Heuristic: the discretisation error of the mesh with which the refinement starts.
const RESOLVED: f64 = 1e-6;

/// Heuristic: the maximal number of mesh refinements.
const REFINEMENTS: usize = 3;

/// A homoclinic orbit on one mesh.
struct Found {
    parameter: f64,
    /// The error of the parameter due to Newton's method.
    error: f64,
    meaning: Meaning,
    x: Vec<f64>,
    finer: Option<Refinement>,
}

/// Reasons why the homoclinic orbit was not found.
#[derive(Debug, miette::Diagnostic, thiserror::Error)]
pub(super) enum NotFound {
    /// No initial guess was available.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Guess(#[from] Failure),
    /// Newton's method failed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Newton(#[from] NewtonError),
    /// Newton's method converged on the first mesh, but on no finer mesh, so the discretisation
    /// error is unknown.
    #[error(
        "Newton's method converges on only one mesh, so the discretisation error of the homoclinic \
         orbit is unknown"
    )]
    #[diagnostic(help("use more `intervals` (the attempt on a finer mesh failed: {0})"))]
    Unrefined(String),
    /// Newton's method converged to another homoclinic orbit, whose parameter differs from the
    /// parameter at the end of the branch.
    #[error("Newton's method converges to {found:.6}, away from the end of the branch at {end:.6}")]
    FarOff {
        /// The parameter of the computed homoclinic orbit.
        found: f64,
        /// The parameter at the end of the branch.
        end: f64,
    },
}

impl NotFound {
    /// Whether the homoclinic orbit was not computed because the system does not support homoclinic
    /// orbits.
    pub fn is_unsupported(&self) -> bool {
        matches!(self, NotFound::Guess(Failure::Unsupported(_)))
    }
}

/// Sets the parameter of the special point at the end of a branch of cycles to the parameter of the
/// homoclinic orbit, with its error, and adds the named numbers of the equilibrium.
pub(super) fn locate(
    (corrector, refiner): (&mut Corrector, &Refiner),
    place: &CurvePoint,
    special: &mut SpecialPoint,
) -> Result<(), NotFound> {
    let cycle = corrector.solution_at(place);
    let guess = |corrector: &mut Corrector, radius: f64| -> Result<Emanating, Failure> {
        let system = corrector.equations.at().system.discretised();
        let unsupported = || Failure::Unsupported("only cycles have homoclinic ends".into());
        system.ok_or_else(unsupported)?.homoclinic(&cycle, radius)
    };
    let mut settled = |radius: f64| -> Result<Settled, NotFound> {
        let Emanating { system, z, .. } = guess(corrector, radius)?;
        settle(corrector, &cycle, (system, z))
    };
    let mut both = |factor: f64| -> Result<(Found, Settled), NotFound> {
        let wide = settled(WIDER * factor * HOMOCLINIC_RADIUS)?.found;
        Ok((wide, settled(factor * HOMOCLINIC_RADIUS)?))
    };
    let (wide, Settled { found, coarser, mesh_error }) = both(1.0).or_else(|cause| {
        OTHER_RADII.into_iter().find_map(|factor| both(factor).ok()).ok_or(cause)
    })?;
    let truncation = |narrow: f64, wide: f64| (narrow - wide).abs() / (WIDER * WIDER - 1.0);
    let continued = corrector.equations.released[0];
    let (value, end) = (found.parameter, special.parameters[continued]);
    let first = corrector.equations.parameters_at();
    let range = corrector.norm.weights[first].sqrt().recip();
    let off = (value - end).abs();
    if off.is_nan() || off > FAR_OFF * range.max(end.abs()) {
        return Err(NotFound::FarOff { found: value, end });
    }
    special.kind = Kind::HOM;
    special.event = Kind::HOM.meaning().into();
    special.parameters[continued] = value;
    special.error = found.error + truncation(value, wide.parameter) + mesh_error;
    special.bracket = [value; 2];
    found.meaning.after(&coarser).give_to(special);
    for number in &mut special.numbers {
        if let Some(wide) = wide.meaning.numbers.iter().find(|wide| wide.name == number.name) {
            number.error += truncation(number.value, wide.value);
        }
    }
    let released = [&*corrector.equations.names().parameters[continued]];
    special.numbers.extend(spreads(&special.sensitivities, &refiner.tolerances, &released));
    Ok(())
}

/// A homoclinic orbit on the finest mesh.
struct Settled {
    found: Found,
    /// The named numbers and sensitivities of the homoclinic orbit on coarser meshes.
    coarser: Vec<Meaning>,
    /// The discretisation error of the parameter.
    mesh_error: f64,
}

/// Computes the homoclinic orbit on successively finer meshes, if the system provides finer meshes.
fn settle(
    corrector: &Corrector,
    cycle: &Solution,
    (mut system, z): (Box<dyn System>, Vec<f64>),
) -> Result<Settled, NotFound> {
    let mut found = on_mesh(corrector, cycle, (&mut *system, &z))?;
    if let Some(fitted) = fitted(&mut *system, &found.x) {
        found = on_mesh(corrector, cycle, (&mut *system, &fitted))?;
    }
    let (mut values, mut coarser) = (vec![found.parameter], Vec::new());
    let mut unrefined = String::from("the discretisation method does not provide a finer mesh");
    for _ in 0..REFINEMENTS {
        let Some(Refinement { mut system, x }) = found.finer.take() else { break };
        let z = &x[..system.names().dimension()];
        match on_mesh(corrector, cycle, (&mut *system, z)) {
            Ok(next) => coarser.push(std::mem::replace(&mut found, next).meaning),
            Err(cause) => {
                unrefined = one_line(&cause);
                break;
            }
        }
        values.push(found.parameter);
        if error_of_last(&values) <= SETTLED * found.parameter.abs() {
            break;
        }
    }
    if values.len() == 1 {
        return Err(NotFound::Unrefined(unrefined));
    }
    Ok(Settled { found, coarser, mesh_error: error_of_last(&values) })
}

/// Returns the unknowns of an orbit interpolated to a mesh that resolves the orbit; `None` if the
/// mesh of the system already resolves the orbit.
fn fitted(system: &mut dyn System, x: &[f64]) -> Option<Vec<f64>> {
    let mut fitted = x.to_vec();
    let changed = system.discretised()?.fit(&mut fitted, &mut [], RESOLVED);
    fitted.truncate(system.names().dimension());
    changed.then_some(fitted)
}

/// Computes the homoclinic orbit on the current mesh of its system.
fn on_mesh(
    corrector: &Corrector,
    cycle: &Solution,
    (system, z): (&mut dyn System, &[f64]),
) -> Result<Found, NotFound> {
    let names = system.names().clone();
    // The parameter has the same scale as on the branch.
    let weight = corrector.norm.weights[corrector.equations.parameters_at()];
    let units = system.unknown_scales(&cycle.parameters);
    let mut weights = Vec::with_capacity(z.len() + 1);
    for (group, unit) in names.unknowns.iter().zip(&units) {
        let part = &z[weights.len()..][..group.length];
        // Groups that are zero up to rounding have their unit as the scale.
        let scale = norm(part).max(*unit);
        weights.extend(part.iter().map(|_| (scale * scale).recip()));
    }
    weights.push(weight);
    let released = (corrector.equations.released.clone(), weights);
    let cancel = corrector.equations.cancel.clone();
    let Solved { mut equations, event, unknowns, error } =
        solve((system, z, cancel), &cycle.parameters, released, corrector.event_tolerances)?;
    let parameter = unknowns[equations.parameters_at()];
    let meaning = meaning(&mut equations, &event, &unknowns, &names.monitors)?;
    let x = equations.load(&unknowns).to_vec();
    let finer = equations.system().discretised().and_then(|system| system.refined(&x));
    Ok(Found { parameter, error, meaning, x, finer })
}

/// Whether Newton's method finds a homoclinic orbit near a guess, with one released parameter. The
/// argument `(released, way, range)` contains the index of the parameter, the difference between
/// its value and its value at the start of the curve, and its range. The scales of the unknowns are
/// the same as at the start of a curve.
pub(super) fn is_near(
    guess: &mut Emanating,
    parameters: &[f64],
    (released, way, range): (usize, f64, [f64; 2]),
    settings: &Settings,
) -> Result<(), NotFound> {
    let Emanating { system, z, .. } = guess;
    let units = system.unknown_scales(parameters);
    let (p, p_tangent) = (&parameters[released..=released], &[way][..]);
    let z_tangent = &vec![0.0; z.len()][..];
    let sizes = StartSizes { z, z_tangent, p, p_tangent, units: &units, reach: None };
    let mut weights = Metric::new(system.names(), &sizes, &[range], &[]).weights(system.names());
    // The orbit belongs to the point if the parameter changes by little, relative to the distance.
    weights.truncate(z.len());
    weights.push((way * way).recip());
    let (tolerances, cancel) = (settings.until(settings.tolerance), settings.cancel.clone());
    let released = (vec![released], weights);
    solve((&mut **system, z, cancel), parameters, released, tolerances).map(|_| ())
}

/// A homoclinic orbit computed by Newton's method.
struct Solved<'s> {
    equations: Extended<'s>,
    event: Event,
    unknowns: Vec<f64>,
    error: f64,
}

/// Computes the homoclinic orbit near a guess by Newton's method, with one released parameter and
/// the given weights of the unknowns and the parameter.
fn solve<'s>(
    (system, z, cancel): (&'s mut dyn System, &[f64], CancelToken),
    parameters: &[f64],
    (released, weights): (Vec<usize>, Vec<f64>),
    tolerances: Tolerances,
) -> Result<Solved<'s>, NotFound> {
    let names = system.names().clone();
    let unsupported = || Failure::Unsupported("the orbit has no gap".into());
    let event = Quantities::new(&names, &[]).homoclinic().ok_or_else(unsupported)?;
    let x = [z, parameters].concat();
    let mut equations = Extended::new(system, &x, released);
    equations.cancel = cancel;
    let mut unknowns = equations.unload(&x);
    if let Some(condition) = &event.condition {
        unknowns = equations.hold(condition(), &unknowns)?;
    }
    let left = converge(&mut equations, &mut unknowns, &weights, tolerances)?;
    let error = left[equations.parameters_at()];
    Ok(Solved { equations, event, unknowns, error })
}

/// Computes the leading eigenvalues of the equilibrium, and the sensitivities of the parameter of
/// the homoclinic orbit to other parameters.
fn meaning(
    equations: &mut Extended,
    event: &Event,
    unknowns: &[f64],
    names: &[String],
) -> Result<Meaning, Failure> {
    let mut meaning = Meaning::default();
    meaning.differentiate(equations, event, unknowns);
    equations.load(unknowns);
    let at = equations.at();
    let mut values = vec![0.0; names.len()];
    at.system.monitors(at.x, 0, &mut values)?;
    let rates = names.iter().zip(values);
    let rates: Vec<_> =
        rates.filter(|(name, _)| HOMOCLINIC_RATES.contains(&name.as_str())).collect();
    // The two rates cancel in their sum.
    let error = 4.0 * f64::EPSILON * rates.iter().map(|(_, value)| value.abs()).sum::<f64>();
    let number = |(name, value): (&String, f64)| Number { name: name.clone(), value, error };
    meaning.numbers = rates.into_iter().map(number).collect();
    Ok(meaning)
}
