//! Special points on finer discretisations, where the problem has them.

use super::branch::{Point, SpecialPoint};
use super::corrector::Corrector;
use super::defining_system::converge;
use super::event::{Event, MakeCondition};
use super::extended::Extended;
use super::recorder::Recorder;
use crate::core::bifurcation::{DefiningSystem, Quantity};
use crate::core::numerics::error_of_last;
use crate::core::system::{Refinement, System};

/// How special points are finished on finer discretisations.
pub(super) struct Refiner {
    /// Makers of the conditions held along the curve.
    pub held: Vec<MakeCondition>,
    /// The columns of points that settle at special points, beside the released parameters.
    pub settled: Vec<usize>,
    /// The relative error of settled columns; 0 for no refinement.
    pub accuracy: f64,
}

impl Refiner {
    /// Finishes the start of a curve like a special point, with the parameter released last held
    /// where it is.
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

    /// Finishes the special point loaded last on finer discretisations, until the accuracy asked
    /// for is met or `rungs` of them have been climbed. It then has the values of the finest one,
    /// and the estimated error of the continued parameter is added to its own; false if there is
    /// none. `beside` is a point of the branch near it, which says how large settled columns are.
    pub fn refine(
        &self,
        corrector: &mut Corrector,
        recorder: &Recorder,
        event: &Event,
        (special, beside): (&mut SpecialPoint, &Point),
        rungs: usize,
    ) -> bool {
        let released = corrector.equations.released.to_vec();
        let here = self.settling(&released, &special.point());
        let there = self.settling(&released, beside);
        let sizes: Vec<f64> = here.iter().zip(&there).map(|(a, b)| a.abs().max(b.abs())).collect();
        let mut series: Vec<Vec<f64>> = here.into_iter().map(|value| vec![value]).collect();
        let at = corrector.equations.at();
        let mut refinement = at.system.discretised().and_then(|system| system.refined(at.x));
        let mut found = None;
        for rung in 1.. {
            let Some(Refinement { mut system, x }) = refinement else { break };
            let converged = self.converge(corrector, recorder, (&mut *system, &x), event);
            let Some((fine, own, x)) = converged else { break };
            let values = self.settling(&released, &fine);
            series.iter_mut().zip(values).for_each(|(all, value)| all.push(value));
            let errors: Vec<f64> = series.iter().map(|values| error_of_last(values)).collect();
            let met = |(error, size): (&f64, &f64)| *error <= self.accuracy * size;
            let settled = errors.iter().zip(&sizes).all(met);
            found = Some((fine, own, errors[0]));
            if settled || rung >= rungs {
                break;
            }
            refinement = system.discretised().and_then(|system| system.refined(&x));
        }
        let Some((Point { parameters, monitors, .. }, own, error)) = found else { return false };
        (special.parameters, special.monitors) = (parameters, monitors);
        special.numbers.iter_mut().zip(own).for_each(|((_, value), own)| *value = own);
        special.error += error;
        true
    }

    /// The values that must settle at a point: the parameters that vary along the branch, and the
    /// columns that the setting `refine` names.
    fn settling(&self, released: &[usize], point: &Point) -> Vec<f64> {
        let columns = released.iter().chain(&self.settled);
        columns.filter_map(|&column| point.value(column)).collect()
    }

    /// Newton on the defining system of an event on a finer discretisation: the point, the event's
    /// auxiliary unknowns that have names, and `x`.
    fn converge(
        &self,
        corrector: &Corrector,
        recorder: &Recorder,
        (system, x): (&mut dyn System, &[f64]),
        event: &Event,
    ) -> Option<(Point, Vec<f64>, Vec<f64>)> {
        let curve = event.instead.as_ref().map_or(&self.held[..], std::slice::from_ref);
        let made = curve.iter().chain(&event.condition).map(|make| make());
        let conditions: Vec<Box<dyn DefiningSystem>> = made.collect();
        let released = &corrector.equations.released;
        let mut weights = corrector.norm.metric.weights(system.names());
        let own: usize = conditions.iter().map(|condition| condition.unknowns()).sum();
        let place = weights.len() - released.len();
        let measured = place - system.names().dimension();
        weights.splice(place..place, std::iter::repeat_n(0.0, own - measured.min(own)));
        let mut equations = Extended::new(system, x, released.to_vec());
        equations.cancel.clone_from(&corrector.equations.cancel);
        let mut unknowns = equations.unload(x);
        for condition in conditions {
            unknowns = equations.hold(condition, &unknowns).ok()?;
        }
        converge(&mut equations, &mut unknowns, &weights, corrector.event_tolerances).ok()?;
        let x = equations.load(&unknowns).to_vec();
        let n = equations.dimension();
        let mut monitors = recorder.monitors(equations.at(), None).ok()?;
        let count = monitors.len() + corrector.equations.recorded().count();
        // The event's auxiliary unknowns come last; those of a curve that is singular there vanish.
        monitors.extend(equations.recorded());
        let own = monitors.split_off(count.min(monitors.len()));
        monitors.resize(count, 0.0);
        Some((Point::new(x[n..].to_vec(), monitors, None), own, x))
    }
}
