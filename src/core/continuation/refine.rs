//! Special points on finer discretisations, where the problem has them.

use super::Point;
use super::event::Event;
use super::locate::{converge, event_tolerances};
use super::stepper::Stepper;
use crate::core::condition::Condition;
use crate::core::extended::Extended;
use crate::core::newton::Newton;
use crate::core::zero::{Refinement, System};

impl Stepper<'_> {
    /// Finishes the special point loaded last on finer discretisations, until two of them agree to
    /// the accuracy asked for: the finest point, and how much the last refinement changed the
    /// continued parameter.
    pub fn refine(&mut self, event: &Event, point: &Point) -> Option<(Point, f64)> {
        let released = self.equations.released().to_vec();
        let at = self.equations.at();
        let mut refinement = at.system.refined(at.x)?;
        let mut coarse = point.clone();
        let mut found = None;
        loop {
            let curve = match &event.instead {
                Some(instead) => std::slice::from_ref(instead),
                None => &self.held[..],
            };
            let fresh = curve.iter().chain([&event.condition]).map(|make| make()).collect();
            let Refinement { system, x } = &mut refinement;
            let Some((fine, x)) = self.converge_refined(&mut **system, x, &released, fresh) else {
                return found;
            };
            let change = (fine.parameters[released[0]] - coarse.parameters[released[0]]).abs();
            let settled = self.settled(&coarse, &fine, &released);
            found = Some((fine.clone(), change));
            if settled {
                return found;
            }
            let Some(next) = refinement.system.refined(&x) else { return found };
            refinement = next;
            coarse = fine;
        }
    }

    /// Whether two discretisations agree: released parameters to the accuracy asked for, monitors to
    /// a hundred times that.
    fn settled(&self, coarse: &Point, fine: &Point, released: &[usize]) -> bool {
        let close = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance * b.abs();
        let accuracy = self.settings.accuracy;
        released.iter().all(|&p| close(coarse.parameters[p], fine.parameters[p], accuracy))
            && coarse
                .monitors
                .iter()
                .zip(&fine.monitors)
                .all(|(a, b)| close(*a, *b, 100.0 * accuracy) || (a - b).abs() < 100.0 * accuracy)
    }

    fn converge_refined(
        &mut self,
        system: &mut dyn System,
        x: &[f64],
        released: &[usize],
        conditions: Vec<Box<dyn Condition>>,
    ) -> Option<(Point, Vec<f64>)> {
        let mut weights = self.metric.weights(system.names(), 0);
        let own: usize = conditions.iter().map(|condition| condition.unknowns()).sum();
        let place = weights.len() - released.len();
        let measured = place - system.names().dimension();
        weights.splice(place..place, std::iter::repeat_n(0.0, own - measured.min(own)));
        let mut equations = Extended::new(system, x, released.to_vec());
        let mut unknowns = equations.unload(x);
        for condition in conditions {
            unknowns = equations.hold(condition, &unknowns).ok()?;
        }
        let mut newton = Newton::default();
        let tolerances = event_tolerances(&self.settings);
        converge(&mut newton, &mut equations, &mut unknowns, &weights, tolerances).ok()?;
        let x = equations.load(&unknowns).to_vec();
        let at = equations.at();
        let n = at.system.names().dimension();
        at.system.assemble(at.x).ok()?;
        let mut monitors = vec![0.0; at.system.names().monitors.len()];
        at.system.monitors(at.x, &mut monitors).ok()?;
        Some((Point { parameters: x[n..].to_vec(), monitors, unstable: None }, x))
    }
}
