//! Refinement of special points on finer discretisations, if the problem provides finer
//! discretisations.

use super::branch::{Point, SpecialPoint};
use super::corrector::Corrector;
use super::defining_system::solve_accurately;
use super::event::{Event, MakeCondition};
use super::extended::Extended;
use super::meaning::Meaning;
use super::mesh_share::{MeshShare, Shortfall};
use super::recorder::Recorder;
use crate::core::bifurcation::{DefiningSystem, Hopf, Quantity, deciding, unstable_besides};
use crate::core::linalg::{generic, normalise};
use crate::core::numerics::error_of_last;
use crate::core::problem::Dynamics;
use crate::core::system::{Kind, Refinement, System, SystemRef};

/// Heuristic: the factor by which a discretisation error may exceed the requested error without a
/// warning, because the error is only estimated.
const LENIENCE: f64 = 10.0;

/// Refines special points on finer discretisations; contains the settings of the refinement.
pub(super) struct Refiner {
    /// The constructors of the held defining systems.
    pub held: Vec<MakeCondition>,
    /// The indices of the parameters and monitors whose values must converge on finer
    /// discretisations, in addition to the released parameters.
    pub settled: Vec<usize>,
    /// The required relative accuracy of the released parameters and of the columns in `settled`; 0
    /// disables refinement.
    pub accuracy: f64,
    /// The tolerances of parameters, with their names.
    pub tolerances: Vec<(String, f64)>,
}

impl Refiner {
    /// Refines the start of a curve in the same way as a special point, while the last released
    /// parameter is held constant.
    pub fn refine_start(
        &self,
        corrector: &mut Corrector,
        recorder: &Recorder,
        start: &mut SpecialPoint,
    ) {
        let Some(&last) = corrector.equations.released.last() else { return };
        if self.accuracy == 0.0 {
            return;
        }
        let level = start.parameters[last];
        let event = Event::level("start", Quantity::Parameter(last), level);
        let beside = start.point();
        self.refine(corrector, recorder, &event, (start, &beside), usize::MAX);
    }

    /// Refines the last loaded special point on finer discretisations, until the requested accuracy
    /// is reached or `rungs` discretisations have been used. The special point receives the values
    /// on the finest of these discretisations, and the discretisation error is added to its error.
    /// If the problem has no finer discretisation, the discretisation error is estimated by
    /// [comparison](Self::compare) with a coarser one. `beside` is a nearby point of the branch,
    /// from which the sizes of parameters and monitors are estimated.
    pub fn refine(
        &self,
        corrector: &mut Corrector,
        recorder: &Recorder,
        event: &Event,
        (special, beside): (&mut SpecialPoint, &Point),
        rungs: usize,
    ) -> MeshShare {
        let released = corrector.equations.released.to_vec();
        let here = self.settling(&released, &special.point());
        let there = self.settling(&released, beside);
        let sizes: Vec<f64> = here.iter().zip(&there).map(|(a, b)| a.abs().max(b.abs())).collect();
        let mut series: Vec<Vec<f64>> = here.into_iter().map(|value| vec![value]).collect();
        let at = corrector.equations.at();
        let mut refinement = at.system.discretised().and_then(|system| system.refined(at.x));
        let (mut found, mut share) = (None, MeshShare::Sufficient);
        let mut coarser = vec![Meaning::taken_from(special)];
        for rung in 1.. {
            let Some(Refinement { system, x }) = refinement else { break };
            let converged = self.converge(corrector, recorder, (system, &x), event);
            let Some(Finer { mut equations, unknowns, point, x }) = converged else { break };
            let values = self.settling(&released, &point);
            series.iter_mut().zip(values).for_each(|(all, value)| all.push(value));
            let errors: Vec<f64> = series.iter().map(|values| error_of_last(values)).collect();
            let met = |(error, size): (&f64, &f64)| *error <= self.accuracy * size;
            let settled = rung >= rungs || errors.iter().zip(&sizes).all(met);
            share = match settled {
                true => MeshShare::Sufficient,
                false => self.share_of(corrector, &released, (&errors, &sizes)),
            };
            let finer = equations.system().discretised().filter(|_| !settled);
            let next = finer.and_then(|system| system.refined(&x));
            coarser.push(Meaning::of(&mut equations, event, &unknowns, 0.0));
            found = Some((Finer { equations, unknowns, point, x }, errors[0]));
            refinement = next;
        }
        let Some((Finer { mut equations, unknowns, point, .. }, error)) = found else {
            return self.compare(corrector, recorder, event, (special, &sizes));
        };
        let Point { parameters, monitors, .. } = point;
        let shift = |p: &usize| special.parameters[*p] - parameters[*p];
        special.mesh_shift = released.iter().map(shift).collect();
        (special.parameters, special.monitors) = (parameters, monitors);
        special.error += error;
        let mut meaning = coarser.pop().unwrap_or_default();
        if corrector.sensitivities {
            meaning.differentiate(&mut equations, event, &unknowns);
        }
        meaning.after(&coarser).give_to(special);
        if !special.eigenvalues.is_empty()
            && special.undetermined.is_none()
            && let Some(spectrum) = recorder.spectrum_at(&mut equations, &unknowns)
        {
            // Necessary at a fold of cycles, where the multiplier 1 is double with a single eigenvector: a
            // discretisation error changes the two multipliers by its square root.
            special.eigenvalues = deciding(&spectrum, SpecialPoint::EIGENVALUES);
            if special.unstable.is_some() && !event.mirror && !recorder.family {
                let dynamics = corrector.equations.system().dynamics();
                special.unstable = Some(unstable_besides(event.critical, dynamics, &spectrum));
            }
        }
        share
    }

    /// Compares the last loaded special point with the same point on a coarser discretisation,
    /// because no solution on a finer one is available, and adds the difference to the errors of
    /// the special point. `sizes` are the sizes of the values that must converge.
    fn compare(
        &self,
        corrector: &mut Corrector,
        recorder: &Recorder,
        event: &Event,
        (special, sizes): (&mut SpecialPoint, &[f64]),
    ) -> MeshShare {
        let released = corrector.equations.released.to_vec();
        let at = corrector.equations.at();
        let coarser = at.system.discretised().and_then(|system| system.coarser(at.x));
        let Some(Refinement { system, x }) = coarser else {
            let on_mesh = corrector.equations.system().representation().is_on_mesh();
            return if on_mesh { MeshShare::Unknown } else { MeshShare::Sufficient };
        };
        let converged = self.converge(corrector, recorder, (system, &x), event);
        let Some(Finer { mut equations, unknowns, point, .. }) = converged else {
            return MeshShare::Unknown;
        };
        let here = self.settling(&released, &special.point());
        let there = self.settling(&released, &point);
        let errors: Vec<f64> =
            here.iter().zip(there).map(|(a, b)| error_of_last(&[b, *a])).collect();
        special.error += errors[0];
        let mut coarse = Meaning::of(&mut equations, event, &unknowns, 0.0);
        let mut sensitivities = std::mem::take(&mut special.sensitivities);
        if sensitivities.is_empty() && corrector.sensitivities {
            coarse.differentiate(&mut equations, event, &unknowns);
            sensitivities = std::mem::take(&mut coarse.sensitivities);
        }
        let own = Meaning { sensitivities, ..Meaning::taken_from(special) };
        own.after(&[coarse]).give_to(special);
        self.share_of(corrector, &released, (&errors, sizes))
    }

    /// Returns what is known of the discretisation error, given the errors and the sizes of the
    /// values that must converge. The size of a released parameter near zero is its scale.
    fn share_of(
        &self,
        corrector: &Corrector,
        released: &[usize],
        (errors, sizes): (&[f64], &[f64]),
    ) -> MeshShare {
        let columns = released.iter().chain(&self.settled);
        let first = corrector.equations.parameters_at();
        let size = |(k, size): (usize, &f64)| match k < corrector.equations.released.len() {
            true => size.max(corrector.norm.scaled(first + k, 1.0).recip()),
            false => *size,
        };
        let sizes = sizes.iter().enumerate().map(size);
        let relative = errors.iter().zip(sizes).map(|(error, size)| error / size);
        let worst = columns.zip(relative).filter(|(_, relative)| relative.is_finite());
        match worst.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((column, relative)) if relative > LENIENCE * self.accuracy => {
                let names = corrector.equations.names();
                let mut all = names.parameters.iter().chain(&names.monitors);
                let column = all.nth(*column).cloned().unwrap_or_default();
                MeshShare::TooLarge(Shortfall { column, relative })
            }
            _ => MeshShare::Sufficient,
        }
    }

    /// Returns the shortfall of a special point that is not refined, if the error of its continued
    /// parameter is larger than requested.
    pub fn shortfall(&self, corrector: &Corrector, special: &SpecialPoint) -> Option<Shortfall> {
        let released = &corrector.equations.released;
        let size = special.parameters[released[0]].abs();
        match self.share_of(corrector, released, (&[special.error], &[size])) {
            MeshShare::TooLarge(shortfall) if self.accuracy > 0.0 => Some(shortfall),
            _ => None,
        }
    }

    /// Returns the period at the last loaded point on the next finer discretisation, while one
    /// released parameter is fixed; `None` if Newton's method fails on the finer discretisation.
    pub fn period_on_finer_mesh(
        &self,
        corrector: &mut Corrector,
        recorder: &Recorder,
        (parameter, value): (usize, f64),
    ) -> Option<f64> {
        let event = Event::level("point on a finer mesh", Quantity::Parameter(parameter), value);
        let at = corrector.equations.at();
        let Refinement { system, x } = at.system.discretised()?.refined(at.x)?;
        let mut finer = self.converge(corrector, recorder, (system, &x), &event)?;
        finer.equations.system().traits(&finer.x).free_period
    }

    /// Returns the values that must converge at a point: the values of the parameters that vary
    /// along the branch, and of the parameters and monitors in the setting `refine`.
    fn settling(&self, released: &[usize], point: &Point) -> Vec<f64> {
        let columns = released.iter().chain(&self.settled);
        columns.filter_map(|&column| point.value(column)).collect()
    }

    /// Solves the defining system of an event on a finer discretisation.
    fn converge(
        &self,
        corrector: &Corrector,
        recorder: &Recorder,
        (system, x): (Box<dyn System>, &[f64]),
        event: &Event,
    ) -> Option<Finer> {
        let curve = event.instead.as_ref().map_or(&self.held[..], std::slice::from_ref);
        // If two pairs are critical, the pair of the curve is the one it had so far.
        let (known, periodic) = (corrector.equations.recorded().next(), system.dynamics());
        let periodic = periodic == Dynamics::Periodic;
        let of_curve = |make: &MakeCondition| -> Box<dyn DefiningSystem> {
            let condition = make();
            match (condition.kind(), known) {
                (Kind::HB | Kind::TR, Some(known)) if event.instead.is_none() => {
                    Box::new(Hopf::near(known, periodic))
                }
                _ => condition,
            }
        };
        let of_event = event.condition.iter().map(|make| make());
        let conditions: Vec<_> = curve.iter().map(of_curve).chain(of_event).collect();
        let released = &corrector.equations.released;
        let mut weights = corrector.norm.metric.weights(system.names());
        let own: usize = conditions.iter().map(|condition| condition.unknowns()).sum();
        let place = weights.len() - released.len();
        let measured = place - system.names().dimension();
        weights.splice(place..place, std::iter::repeat_n(0.0, own - measured.min(own)));
        let mut equations = Extended::of(SystemRef::Owned(system), x, released.to_vec());
        equations.cancel.clone_from(&corrector.equations.cancel);
        let mut unknowns = equations.unload(x);
        for condition in conditions {
            unknowns = equations.hold(condition, &unknowns).ok()?;
        }
        let tolerances = corrector.event_tolerances;
        let start = unknowns.clone();
        let mut solve = |unknowns: &mut Vec<f64>| {
            solve_accurately(&mut equations, unknowns, &weights, tolerances).is_ok()
        };
        if !solve(&mut unknowns) {
            let mut starts = DISPLACEMENTS.iter().map(|by| displaced(&start, &weights, *by));
            unknowns = starts.find_map(|mut start| solve(&mut start).then_some(start))?;
        }
        let x = equations.load(&unknowns).to_vec();
        let n = equations.dimension();
        let mut monitors = recorder.monitors(equations.at(), None).ok()?;
        let count = monitors.len() + corrector.equations.recorded().count();
        // The event's auxiliary unknowns come last. If the curve is singular, its own auxiliary
        // unknowns have the event's level.
        monitors.extend(equations.recorded());
        let level = event.test.auxiliary().map_or(0.0, |(_, level)| level);
        monitors.resize(count, level);
        let point = Point::new(x[n..].to_vec(), monitors, None);
        Some(Finer { equations, unknowns, point, x })
    }
}

/// Heuristic: the scaled distances from a solution, and the numbers of the pseudo-random directions,
/// at which Newton's method starts after it failed at the solution itself. Of 16 branches of symmetric
/// orbits that end where two events become tangential (`tests/hybrid/sliding_switches.rs`), Newton's
/// method fails on three from the solution, and on none from these starts.
const DISPLACEMENTS: [(f64, usize); 4] = [(5e-5, 0), (5e-4, 0), (5e-5, 2), (5e-4, 2)];

/// Returns a start of Newton's method beside a solution at which the matrix is singular. If
/// several events of a symmetric orbit become tangential at the same point, the defining system holds
/// only one of these events: the others have double roots, from whose neighbourhood Newton's method
/// converges linearly, while rounding errors dominate its corrections at the point itself.
fn displaced(unknowns: &[f64], weights: &[f64], (by, seed): (f64, usize)) -> Vec<f64> {
    let scale = |weight: f64| if weight > 0.0 { weight.sqrt().recip() } else { 0.0 };
    let mut direction = generic(unknowns.len(), seed);
    normalise(&mut direction);
    let parts = unknowns.iter().zip(weights).zip(direction);
    parts.map(|((x, weight), along)| x + by * scale(*weight) * along).collect()
}

/// A special point on a finer discretisation.
struct Finer {
    equations: Extended<'static>,
    unknowns: Vec<f64>,
    point: Point,
    x: Vec<f64>,
}
