//! Special points on finer discretisations, where the problem has them.

use super::event::Event;
use super::locate::{converge, event_tolerances};
use super::stepper::Stepper;
use super::{Point, SpecialPoint};
use crate::core::condition::{Condition, Quantity};
use crate::core::extended::Extended;
use crate::core::ladder::error_of_last;
use crate::core::zero::{Refinement, System};

impl Stepper<'_> {
    /// The start of a curve is finished like a special point, with the parameter released last held where
    /// it is.
    pub fn refine_start(&mut self, start: &mut SpecialPoint) {
        let Some(&last) = self.equations.released().last() else { return };
        if self.settings.refinement == 0.0 {
            return;
        }
        let level = start.parameters[last];
        let event = Event::level("start", Quantity::Parameter(last), level);
        let point = Point {
            parameters: start.parameters.clone(),
            monitors: start.monitors.clone(),
            unstable: start.unstable,
            eigenvalues: Vec::new(),
            admissible: true,
        };
        if let Some((refined, error)) = self.refine(&event, &point, &point, usize::MAX) {
            (start.parameters, start.monitors) = (refined.parameters, refined.monitors);
            start.error += error;
        }
    }

    /// Finishes the special point loaded last on finer discretisations, until the accuracy asked for is
    /// met or `rungs` of them have been climbed: the finest point, and the estimated error of the
    /// continued parameter. `beside` is a point of the branch near it, which says how large settled columns
    /// are.
    pub fn refine(
        &mut self,
        event: &Event,
        point: &Point,
        beside: &Point,
        rungs: usize,
    ) -> Option<(Point, f64)> {
        let released = self.equations.released().to_vec();
        let sizes: Vec<f64> = self
            .settling(point)
            .zip(self.settling(beside))
            .map(|(here, there)| here.abs().max(there.abs()))
            .collect();
        let mut series: Vec<Vec<f64>> = self.settling(point).map(|value| vec![value]).collect();
        let at = self.equations.at();
        let mut refinement = at.system.refined(at.x)?;
        let mut found = None;
        for rung in 1.. {
            let curve = match &event.instead {
                Some(instead) => std::slice::from_ref(instead),
                None => &self.held[..],
            };
            let fresh = curve.iter().chain([&event.condition]).map(|make| make()).collect();
            let Refinement { system, x } = &mut refinement;
            let Some((fine, x)) = self.converge_refined(&mut **system, x, &released, fresh) else {
                return found;
            };
            series.iter_mut().zip(self.settling(&fine)).for_each(|(all, value)| all.push(value));
            let errors: Vec<f64> = series.iter().map(|values| error_of_last(values)).collect();
            let asked = self.settings.refinement;
            let settled = errors.iter().zip(&sizes).all(|(error, size)| *error <= asked * size);
            found = Some((fine, errors[0]));
            if settled || rung >= rungs {
                break;
            }
            let Some(next) = refinement.system.refined(&x) else { break };
            refinement = next;
        }
        found
    }

    /// The values that must settle at a point: the parameters that vary along the branch, and the
    /// columns that the setting `settle` names.
    fn settling<'a>(&'a self, point: &'a Point) -> impl Iterator<Item = f64> + 'a {
        let columns = self.equations.released().iter().chain(&self.settled);
        columns.filter_map(|&column| point.value(column))
    }

    fn converge_refined(
        &mut self,
        system: &mut dyn System,
        x: &[f64],
        released: &[usize],
        conditions: Vec<Box<dyn Condition>>,
    ) -> Option<(Point, Vec<f64>)> {
        let mut weights = self.metric.weights(system.names());
        let own: usize = conditions.iter().map(|condition| condition.unknowns()).sum();
        let place = weights.len() - released.len();
        let measured = place - system.names().dimension();
        weights.splice(place..place, std::iter::repeat_n(0.0, own - measured.min(own)));
        let mut equations = Extended::new(system, x, released.to_vec());
        let mut unknowns = equations.unload(x);
        for condition in conditions {
            unknowns = equations.hold(condition, &unknowns).ok()?;
        }
        let tolerances = event_tolerances(&self.settings);
        converge(&mut equations, &mut unknowns, &weights, tolerances).ok()?;
        let x = equations.load(&unknowns).to_vec();
        let at = equations.at();
        let n = at.system.names().dimension();
        let mut monitors = vec![0.0; at.system.names().monitors.len()];
        at.system.monitors(at.x, &mut monitors).ok()?;
        let parameters = x[n..].to_vec();
        let point = Point {
            parameters,
            monitors,
            unstable: None,
            eigenvalues: Vec::new(),
            admissible: true,
        };
        Some((point, x))
    }
}
