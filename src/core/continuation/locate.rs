//! Locating events: bracketing on the branch itself, then Newton on the defining system.

use super::bracket::Bracket;
use super::event::{Event, MakeCondition};
use super::found::{Finished, Found, Located};
use super::stepper::{MATRIX_ERROR, Place, Stepper};
use crate::core::condition::Failure;
use crate::core::extended::Extended;
use crate::core::newton::{Newton, NewtonError, Tolerances, scaled_norm};
use crate::core::test_function::Test;
use crate::core::vector::{along, difference};

/// An event is not farther beside the branch, in units of its bracket's length.
const MOST_BESIDE: f64 = 0.5;

/// More halvings than this are hopeless.
const MOST_HALVINGS: usize = 40;

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
        if event.mirror {
            let found = self.limit(index, from, to, length);
            let found = found.unwrap_or_else(|| self.between(from, to, length));
            return self.describe(index, ([from, to], length), found);
        }
        let row = self.covector(&from.tangent);
        let mut bracket = Bracket {
            low: 0.0,
            high: length,
            ends: [from.unknowns.clone(), to.unknowns.clone()],
            tangents: [from.tangent.clone(), to.tangent.clone()],
            tests: [from.tests[index]?, to.tests[index]?],
            slope: event.test.level().and_then(|(quantity, _)| self.slope_of(quantity, to)),
        };
        if event.condition.is_none() {
            let found = self.bracketed(index, from, &row, &mut bracket);
            // What an orbit's events decide has no value that vanishes: nothing converges.
            let converged = found.converged && event.test != Test::Itinerary;
            let found = Found { converged, ..found };
            return self.describe(index, ([from, to], length), found);
        }
        let mut applicable = true;
        for _ in 0..MOST_HALVINGS {
            match self.finish(&event, bracket.guess(event.test, self.equations.parameters_at())) {
                Ok(Finished { unknowns, own, error }) => {
                    let along = along(&row, &unknowns, &from.unknowns);
                    // Signs of test functions are those of a matrix that is not quite that of the
                    // point.
                    let slack = 1e-4 * length;
                    let inside = along >= bracket.low - slack && along <= bracket.high + slack;
                    if inside && self.is_near(&bracket, along, &unknowns) {
                        let at = Found { along, unknowns, own, error, converged: true };
                        return self.describe(index, ([from, to], length), at);
                    }
                }
                Err(NewtonError::Evaluation {
                    cause: Failure::NoComplexPair | Failure::Unsupported(_),
                    ..
                }) => applicable = false,
                Err(_) => {}
            }
            let middle = 0.5 * (bracket.low + bracket.high);
            if !self.narrow(index, from, &row, &mut bracket, middle) {
                break;
            }
        }
        if !applicable {
            return None;
        }
        self.describe(index, ([from, to], length), self.unfinished(&bracket))
    }

    /// The middle of a bracket, as a point that has not converged.
    fn unfinished(&self, bracket: &Bracket) -> Found {
        let unknowns = bracket.between(0.5);
        let p = self.equations.parameters_at();
        let reach = |end: &Vec<f64>| (end[p] - unknowns[p]).abs();
        let error = bracket.ends.iter().map(reach).fold(self.parameter_error(), f64::max);
        let along = 0.5 * (bracket.low + bracket.high);
        Found { along, unknowns, own: Vec::new(), error, converged: false }
    }

    /// The middle of a step, as a point that has not converged.
    pub fn between(&self, from: &Place, to: &Place, length: f64) -> Found {
        let ends = from.unknowns.iter().zip(&to.unknowns);
        let unknowns: Vec<f64> = ends.map(|(a, b)| 0.5 * (a + b)).collect();
        let p = self.equations.parameters_at();
        let error = (to.unknowns[p] - from.unknowns[p]).abs() + self.parameter_error();
        Found { along: 0.5 * length, unknowns, own: Vec::new(), error, converged: false }
    }

    /// Whether a solution of a defining system lies near the branch between the ends of a bracket,
    /// and not only between the hyperplanes through them.
    fn is_near(&self, bracket: &Bracket, along: f64, unknowns: &[f64]) -> bool {
        let length = bracket.high - bracket.low;
        let fraction = ((along - bracket.low) / length).clamp(0.0, 1.0);
        let distance = difference(unknowns, &bracket.between(fraction));
        scaled_norm(&distance, &self.weights) <= MOST_BESIDE * length
    }

    /// Newton on the defining system from a guess: the point, and the estimated error of the
    /// continued parameter.
    pub fn finish(&mut self, event: &Event, guess: Vec<f64>) -> Result<Finished, NewtonError> {
        let curve = self.equations.suspend();
        let (n, end) = (self.equations.dimension(), self.equations.length());
        let own: usize = curve.iter().map(|condition| condition.unknowns()).sum();
        let (outcome, mut conditions) = if let Some(instead) = &event.instead {
            let mut bare = guess;
            bare.drain(n..n + own);
            (self.finish_with([instead].into_iter().chain(&event.condition), &bare), curve)
        } else {
            self.equations.resume(curve);
            let outcome = self.finish_with(event.condition.iter(), &guess);
            (outcome, self.equations.suspend())
        };
        // Whatever was added for the event goes again; the curve's own unknowns are in their place.
        conditions.truncate(self.held.len());
        self.equations.resume(conditions);
        let Finished { unknowns, own: all, error } = outcome?;
        let kept = if event.instead.is_none() { own } else { 0 };
        let mut point = unknowns[..n + kept].to_vec();
        point.resize(n + own, 0.0);
        point.extend(&unknowns[unknowns.len() - (end - n)..]);
        // Those of the curve come first.
        let named = event.condition.as_ref().map_or(0, |make| make().names().len());
        let own_values = all[all.len() - named..].to_vec();
        Ok(Finished { unknowns: point, own: own_values, error })
    }

    /// Newton with further conditions held.
    fn finish_with<'m>(
        &mut self,
        makes: impl Iterator<Item = &'m MakeCondition>,
        guess: &[f64],
    ) -> Result<Finished, NewtonError> {
        let n = self.equations.dimension();
        let mut unknowns = guess.to_vec();
        for make in makes {
            unknowns = self.equations.hold(make(), &unknowns)?;
        }
        let measured = guess.len() - self.equations.released().len();
        let parameters = self.weights.len() - self.equations.released().len();
        let mut weights = self.weights[..measured.max(n)].to_vec();
        weights.resize(self.equations.parameters_at(), 0.0);
        weights.extend(&self.weights[parameters..]);
        let tolerances = self.settings.until(self.settings.event_tolerance);
        let error = converge(&mut self.equations, &mut unknowns, &weights, tolerances)?;
        self.equations.load(&unknowns);
        let own = self.equations.recorded().collect();
        Ok(Finished { unknowns, own, error })
    }

    /// How well Newton's tolerance determines the continued parameter of an ordinary point.
    pub fn parameter_error(&self) -> f64 {
        self.settings.tolerance / self.weights[self.equations.parameters_at()].sqrt()
    }
}

/// Newton on a defining system, and the estimated error of the first released parameter: several
/// times what the second of two more corrections changes.
pub(super) fn converge(
    equations: &mut Extended,
    unknowns: &mut [f64],
    weights: &[f64],
    tolerances: Tolerances,
) -> Result<f64, NewtonError> {
    // Its own iteration: the curvature that another has met is that of other equations.
    let mut newton = Newton::default();
    let report = newton.solve(equations, unknowns, None, weights, tolerances)?;
    let parameter = equations.parameters_at();
    let rounding = 4.0 * f64::EPSILON * unknowns[parameter].abs();
    // The first correction is Newton's own last one; what the second one changes is the error left.
    let refactor = report.matrix_error > MATRIX_ERROR;
    let first = newton.residual_correction(equations, unknowns, refactor)?;
    let mut left = first[parameter].abs();
    unknowns.iter_mut().zip(first).for_each(|(x, d)| *x -= d);
    if left > rounding {
        // It is not made, so that what is assembled for it belongs to the point.
        equations.assemble(unknowns)?;
        let second = newton.residual_correction(equations, unknowns, false)?;
        left = second[parameter].abs();
        // What is left of a converged point is rounding, multiplied: one correction may be small by
        // chance.
        if left > 100.0 * rounding {
            for sample in 0..SAMPLES {
                let noise = newton.rounding(equations, None, unknowns, sample)?;
                left = left.max(noise[parameter].abs());
            }
        }
    }
    Ok(4.0 * left + rounding)
}

/// How many samples tell how large rounding is.
const SAMPLES: usize = 2;
