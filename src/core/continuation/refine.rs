//! Special points on finer discretisations, where the problem has them.

use super::event::Event;
use super::locate::converge;
use super::stepper::{Stepper, monitors_of};
use super::{Point, SpecialPoint};
use crate::core::condition::{Condition, Quantity};
use crate::core::extended::Extended;
use crate::core::ladder::error_of_last;
use crate::core::zero::{Refinement, System};

impl Stepper<'_> {
    /// The start of a curve is finished like a special point, with the parameter released last held
    /// where it is.
    pub fn refine_start(&mut self, start: &mut SpecialPoint) {
        let Some(&last) = self.equations.released().last() else { return };
        if self.settings.refinement == 0.0 {
            return;
        }
        let level = start.parameters[last];
        let event = Event::level("start", Quantity::Parameter(last), level);
        let beside = start.point();
        self.refine(&event, start, &beside, usize::MAX);
    }

    /// Finishes the special point loaded last on finer discretisations, until the accuracy asked
    /// for is met or `rungs` of them have been climbed. It then has the values of the finest one,
    /// and the estimated error of the continued parameter is added to its own; false if there is
    /// none. `beside` is a point of the branch near it, which says how large settled columns are.
    pub fn refine(
        &mut self,
        event: &Event,
        special: &mut SpecialPoint,
        beside: &Point,
        rungs: usize,
    ) -> bool {
        let here = self.settling(&special.point());
        let there = self.settling(beside);
        let sizes: Vec<f64> = here.iter().zip(&there).map(|(a, b)| a.abs().max(b.abs())).collect();
        let mut series: Vec<Vec<f64>> = here.into_iter().map(|value| vec![value]).collect();
        let at = self.equations.at();
        let mut refinement = at.system.discretised().and_then(|system| system.refined(at.x));
        let mut found = None;
        for rung in 1.. {
            let Some(Refinement { mut system, x }) = refinement else { break };
            let Some((fine, own, x)) = self.converge_refined(&mut *system, &x, event) else {
                break;
            };
            let values = self.settling(&fine);
            series.iter_mut().zip(values).for_each(|(all, value)| all.push(value));
            let errors: Vec<f64> = series.iter().map(|values| error_of_last(values)).collect();
            let asked = self.settings.refinement;
            let settled = errors.iter().zip(&sizes).all(|(error, size)| *error <= asked * size);
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
    /// columns that the setting `settle` names.
    fn settling(&self, point: &Point) -> Vec<f64> {
        let columns = self.equations.released().iter().chain(&self.settled);
        columns.filter_map(|&column| point.value(column)).collect()
    }

    /// Newton on the defining system of an event of this discretisation: the point, the event's own
    /// unknowns that have names, and `x`.
    fn converge_refined(
        &self,
        system: &mut dyn System,
        x: &[f64],
        event: &Event,
    ) -> Option<(Point, Vec<f64>, Vec<f64>)> {
        let curve = event.instead.as_ref().map_or(&self.held[..], std::slice::from_ref);
        let made = curve.iter().chain(&event.condition).map(|make| make());
        let conditions: Vec<Box<dyn Condition>> = made.collect();
        let released = self.equations.released();
        let mut weights = self.metric.weights(system.names());
        let own: usize = conditions.iter().map(|condition| condition.unknowns()).sum();
        let place = weights.len() - released.len();
        let measured = place - system.names().dimension();
        weights.splice(place..place, std::iter::repeat_n(0.0, own - measured.min(own)));
        let mut equations = Extended::new(system, x, released.to_vec());
        equations.cancel.clone_from(&self.equations.cancel);
        let mut unknowns = equations.unload(x);
        for condition in conditions {
            unknowns = equations.hold(condition, &unknowns).ok()?;
        }
        let tolerances = self.settings.until(self.settings.event_tolerance);
        converge(&mut equations, &mut unknowns, &weights, tolerances).ok()?;
        let x = equations.load(&unknowns).to_vec();
        let n = equations.dimension();
        let mut monitors = monitors_of(&self.attached, equations.at(), None).ok()?;
        let count = monitors.len() + self.equations.recorded().count();
        // The event's own unknowns come last; those of a curve that is singular there vanish.
        monitors.extend(equations.recorded());
        let own = monitors.split_off(count.min(monitors.len()));
        monitors.resize(count, 0.0);
        Some((Point::of(x[n..].to_vec(), monitors, None), own, x))
    }
}
