//! Special points on finer discretisations, where the problem has them.

use super::event::Event;
use super::locate::{converge, event_tolerances};
use super::stepper::Stepper;
use super::{Point, SpecialPoint};
use crate::core::condition::{Condition, Quantity};
use crate::core::extended::Extended;
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
    /// continued parameter. `beside` is a point of the branch near it, which says how large monitors
    /// are.
    pub fn refine(
        &mut self,
        event: &Event,
        point: &Point,
        beside: &Point,
        rungs: usize,
    ) -> Option<(Point, f64)> {
        let released = self.equations.released().to_vec();
        let sizes: Vec<f64> = settling(point, &released)
            .zip(settling(beside, &released))
            .map(|(here, there)| here.abs().max(there.abs()))
            .collect();
        let mut ladder = Ladder::new(settling(point, &released).collect());
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
            let errors = ladder.climb(settling(&fine, &released).collect());
            let asked = self.settings.refinement;
            let settled = errors.iter().zip(&sizes).enumerate().all(|(i, (error, size))| {
                let tolerance = if i < released.len() { asked } else { 100.0 * asked };
                *error <= tolerance * size
            });
            found = Some((fine, errors[0]));
            if settled || rung >= rungs {
                break;
            }
            let Some(next) = refinement.system.refined(&x) else { break };
            refinement = next;
        }
        found
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

/// What must settle: the released parameters of a point and its first monitor. Others may be meant to
/// vanish there, like a frequency at a fold, and would be compared with rounding.
fn settling<'a>(point: &'a Point, released: &'a [usize]) -> impl Iterator<Item = f64> + 'a {
    let parameters = released.iter().map(|&p| point.parameters[p]);
    parameters.chain(point.monitors.first().copied())
}

/// Values on one discretisation after another, and what is still to come.
struct Ladder {
    values: Vec<f64>,
    changes: Option<Vec<f64>>,
}

impl Ladder {
    fn new(values: Vec<f64>) -> Self {
        Ladder { values, changes: None }
    }

    /// Takes the values of the next rung, and estimates their errors.
    ///
    /// A single change `d` bounds the error of the finer value if each rung at least halves it. With
    /// two, changes are taken to go on shrinking by their ratio `ρ ≤ ½`: what is to come is
    /// `d(ρ + ρ² + …) = dρ/(1 − ρ)`, of which four times is the estimate. A ratio below 0.1 is not
    /// relied on, nor is a change below a hundredth of the one before: spectral convergence may turn
    /// algebraic where a corner singularity takes over, and changes pass zero where errors change sign.
    fn climb(&mut self, values: Vec<f64>) -> Vec<f64> {
        let changes: Vec<f64> =
            values.iter().zip(&self.values).map(|(new, old)| (new - old).abs()).collect();
        let errors = match &self.changes {
            None => changes.clone(),
            Some(before) => changes
                .iter()
                .zip(before)
                .map(|(&change, &before)| {
                    let change = change.max(0.01 * before);
                    let ratio = (change / before.max(f64::MIN_POSITIVE)).clamp(0.1, 0.5);
                    4.0 * change * ratio / (1.0 - ratio)
                })
                .collect(),
        };
        (self.values, self.changes) = (values, Some(changes));
        errors
    }
}
