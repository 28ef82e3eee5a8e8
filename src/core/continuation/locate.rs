//! Locating events: bracketing on the branch itself, then Newton on the defining system, then on
//! finer discretisations where the problem has them.

use super::event::{Event, Test};
use super::stepper::{Place, Stepper};
use super::{Kind, Point, SpecialPoint};
use crate::core::condition::{Condition, Quantity};
use crate::core::extended::{Closing, Extended};
use crate::core::newton::{Newton, NewtonError, Tolerances};
use crate::core::zero::{Refinement, System};

/// A special point found between two points of the branch.
pub(super) struct Located {
    /// Which of the stepper's events it is.
    pub event: usize,
    /// How far behind the first point it lies, in scaled arclength.
    pub along: f64,
    pub special: SpecialPoint,
}

/// More halvings than this are hopeless.
const MOST_HALVINGS: usize = 40;

/// A part of the step from one place that holds the event.
struct Bracket {
    low: f64,
    high: f64,
    ends: [Vec<f64>; 2],
    tests: [f64; 2],
}

impl Bracket {
    /// Where the test function would vanish if it were linear; the middle if only its sign counts.
    fn guess(&self, test: Test) -> Vec<f64> {
        let fraction = match test {
            Test::BranchPoint | Test::Hopf => 0.5,
            _ => (self.tests[0] / (self.tests[0] - self.tests[1])).clamp(0.02, 0.98),
        };
        self.between(fraction)
    }

    fn between(&self, fraction: f64) -> Vec<f64> {
        let [a, b] = &self.ends;
        a.iter().zip(b).map(|(a, b)| a + fraction * (b - a)).collect()
    }
}

impl Stepper<'_> {
    /// Finds event `index` between two places, `length` apart. `None` if what changed sign was not
    /// this event after all (a neutral saddle instead of a Hopf point, a pole of a test function).
    pub fn locate(
        &mut self,
        index: usize,
        from: &Place,
        to: &Place,
        length: f64,
    ) -> Option<Located> {
        let event = self.events[index].clone();
        let row = self.covector(&from.tangent);
        let mut bracket = Bracket {
            low: 0.0,
            high: length,
            ends: [from.unknowns.clone(), to.unknowns.clone()],
            tests: [from.tests[index], to.tests[index]],
        };
        let mut applicable = true;
        for _ in 0..MOST_HALVINGS {
            match self.finish(&event, bracket.guess(event.test)) {
                Ok((unknowns, error)) => {
                    let along: f64 = row
                        .iter()
                        .zip(unknowns.iter().zip(&from.unknowns))
                        .map(|(r, (x, a))| r * (x - a))
                        .sum();
                    let slack = 1e-6 * length;
                    if along >= bracket.low - slack && along <= bracket.high + slack {
                        return self.describe(index, from, to, along, unknowns, Some(error));
                    }
                }
                Err(NewtonError::NotApplicable { .. }) => applicable = false,
                Err(_) => {}
            }
            if !self.halve(index, from, &row, &mut bracket) {
                break;
            }
        }
        if !applicable {
            return None;
        }
        let middle = bracket.between(0.5);
        let along = 0.5 * (bracket.low + bracket.high);
        self.describe(index, from, to, along, middle, None)
    }

    /// Halves the bracket at a corrected point of the branch; false if that fails.
    fn halve(&mut self, index: usize, from: &Place, row: &[f64], bracket: &mut Bracket) -> bool {
        let length = 0.5 * (bracket.low + bracket.high);
        let mut unknowns = bracket.between(0.5);
        let closing = Closing { row, base: &from.unknowns, length };
        if self.correct(&mut unknowns, closing).is_err() {
            return false;
        }
        let Ok(place) = self.arrive(unknowns, row) else { return false };
        let test = place.tests[index];
        let side = usize::from((test < 0.0) != (bracket.tests[0] < 0.0));
        bracket.ends[side] = place.unknowns;
        bracket.tests[side] = test;
        *(if side == 0 { &mut bracket.low } else { &mut bracket.high }) = length;
        bracket.high - bracket.low > 1e-12 * bracket.high
    }

    /// Newton on the defining system from a guess: the point, and the estimated error of the
    /// continued parameter.
    fn finish(&mut self, event: &Event, guess: Vec<f64>) -> Result<(Vec<f64>, f64), NewtonError> {
        let condition = (event.condition)();
        let own = condition.unknowns();
        let mut weights = self.weights.clone();
        let place = self.equations.parameters_at();
        weights.splice(place..place, std::iter::repeat_n(0.0, own));
        let mut unknowns = self
            .equations
            .hold(condition, &guess)
            .map_err(|cause| NewtonError::from_evaluation(0, cause))?;
        let tolerances = event_tolerances(&self.settings);
        let outcome =
            converge(&mut self.newton, &mut self.equations, &mut unknowns, &weights, tolerances);
        self.equations.let_go(&mut unknowns);
        outcome.map(|error| (unknowns, error))
    }

    /// The special point with everything that is recorded of it.
    fn describe(
        &mut self,
        index: usize,
        from: &Place,
        to: &Place,
        along: f64,
        unknowns: Vec<f64>,
        error: Option<f64>,
    ) -> Option<Located> {
        let event = &self.events[index].clone();
        let parameter = self.equations.parameters_at();
        let bracket = [from.unknowns[parameter], to.unknowns[parameter]];
        let mut residual = vec![0.0; unknowns.len()];
        self.equations.residual(&unknowns, None, &mut residual).ok()?;
        let assembled = {
            let at = self.equations.at();
            at.system.assemble(at.x)
        };
        assembled.ok()?;
        let (mut point, _) = self.record(event.kind == Kind::UZ).ok()?;
        if point.unstable.is_none() {
            // At a bifurcation an eigenvalue is zero but for rounding and would be counted at random.
            point.unstable = from.point.unstable.min(to.point.unstable);
        }
        let at = self.equations.at();
        let profiles = at.system.profiles(at.x);
        let converged = error.is_some();
        let width = (bracket[1] - bracket[0]).abs();
        let mut error = error.unwrap_or(width);
        let state = unknowns[..self.equations.dimension()].to_vec();
        // Where a bound happens to cut a branch of solutions nobody asks for more than the branch has.
        let end_of_branch = event.kind == Kind::EP && self.held.is_empty();
        if converged
            && !end_of_branch
            && self.settings.accuracy > 0.0
            && let Some((refined, change)) = self.refine(event, &point, &from.point)
        {
            error += change;
            point = Point { unstable: point.unstable, ..refined };
        }
        let n = self.equations.dimension();
        let mut tangent = from.tangent[..n].to_vec();
        tangent.extend(&from.tangent[parameter..]);
        let special = SpecialPoint {
            label: 0,
            kind: event.kind,
            event: event.name.clone(),
            after: 0,
            parameters: point.parameters,
            monitors: point.monitors,
            unstable: point.unstable,
            error,
            bracket,
            converged,
            state,
            tangent,
            profiles,
        };
        Some(Located { event: index, along, special })
    }

    /// A curve of events starts at a special point: it is finished like one, with the parameter
    /// released last held where it is.
    pub fn refine_start(&mut self, start: &mut SpecialPoint) {
        let Some(&last) = self.equations.released().last() else { return };
        if self.held.is_empty() || self.settings.accuracy == 0.0 {
            return;
        }
        let level = start.parameters[last];
        let event = Event::level("start", Quantity::Parameter(last), level);
        let point = Point {
            parameters: start.parameters.clone(),
            monitors: start.monitors.clone(),
            unstable: start.unstable,
        };
        if let Some((refined, change)) = self.refine(&event, &point, &point) {
            (start.parameters, start.monitors) = (refined.parameters, refined.monitors);
            start.error += change;
        }
    }

    /// Finishes the special point loaded last on finer discretisations, until the accuracy asked for is
    /// met: the finest point, and the estimated error of the continued parameter. `beside` is a
    /// point of the branch near it, which says how large monitors are.
    fn refine(&mut self, event: &Event, point: &Point, beside: &Point) -> Option<(Point, f64)> {
        let released = self.equations.released().to_vec();
        let sizes: Vec<f64> = values(point, &released)
            .zip(values(beside, &released))
            .map(|(here, there)| here.abs().max(there.abs()))
            .collect();
        let mut ladder = Ladder::new(values(point, &released).collect());
        let at = self.equations.at();
        let mut refinement = at.system.refined(at.x)?;
        let mut found = None;
        loop {
            let conditions =
                self.held.iter().chain([&event.condition]).map(|make| make()).collect();
            let Refinement { system, x } = &mut refinement;
            let Some((fine, x)) = self.converge_refined(&mut **system, x, &released, conditions)
            else {
                return found;
            };
            let errors = ladder.climb(values(&fine, &released).collect());
            let accuracy = self.settings.accuracy;
            let settled = errors.iter().zip(&sizes).enumerate().all(|(i, (error, size))| {
                let tolerance = if i < released.len() { accuracy } else { 100.0 * accuracy };
                *error <= tolerance * size
            });
            found = Some((fine, errors[0]));
            if settled {
                return found;
            }
            let Some(next) = refinement.system.refined(&x) else { return found };
            refinement = next;
        }
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

/// What must settle: the released parameters of a point and its first monitor. Others may be meant to
/// vanish there, like a frequency at a fold, and would be compared with rounding.
fn values<'a>(point: &'a Point, released: &'a [usize]) -> impl Iterator<Item = f64> + 'a {
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
    /// relied on: spectral convergence may turn algebraic where a corner singularity takes over.
    fn climb(&mut self, values: Vec<f64>) -> Vec<f64> {
        let changes: Vec<f64> =
            values.iter().zip(&self.values).map(|(new, old)| (new - old).abs()).collect();
        let errors = match &self.changes {
            None => changes.clone(),
            Some(before) => changes
                .iter()
                .zip(before)
                .map(|(&change, &before)| {
                    let ratio = (change / before.max(f64::MIN_POSITIVE)).clamp(0.1, 0.5);
                    4.0 * change * ratio / (1.0 - ratio)
                })
                .collect(),
        };
        (self.values, self.changes) = (values, Some(changes));
        errors
    }
}

fn event_tolerances(settings: &super::Settings) -> Tolerances {
    Tolerances { tolerance: settings.event_tolerance, max_iterations: settings.max_iterations }
}

/// Newton on a defining system, and the estimated error of the first released parameter: several
/// times what one more correction, with a fresh factorisation, would change.
fn converge(
    newton: &mut Newton,
    equations: &mut Extended,
    unknowns: &mut [f64],
    weights: &[f64],
    tolerances: Tolerances,
) -> Result<f64, NewtonError> {
    newton.solve(equations, unknowns, None, weights, tolerances)?;
    let parameter = equations.parameters_at();
    let left = newton.correction_left(equations, unknowns, None)?[parameter].abs();
    Ok(4.0 * left + 4.0 * f64::EPSILON * unknowns[parameter].abs())
}
