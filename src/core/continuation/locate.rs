//! Locating events: bracketing on the branch itself, then Newton on the defining system.

use super::Kind;
use super::bracket::Bracket;
use super::event::{Event, MakeCondition};
use super::located::Located;
use super::stepper::{MATRIX_ERROR, Place, Stepper};
use crate::core::condition::Failure;
use crate::core::extended::Extended;
use crate::core::newton::{Newton, NewtonError, Tolerances, scaled_norm};
use crate::core::vector::{along, difference};

/// An event is not farther beside the branch, in units of its bracket's length.
const MOST_BESIDE: f64 = 0.5;

/// More halvings than this are hopeless.
const MOST_HALVINGS: usize = 40;

impl Stepper<'_> {
    /// Locates event `index` between two places, `length` apart. `None` if the change of sign was
    /// not this event after all: a neutral saddle instead of a Hopf point.
    ///
    /// # Errors
    /// [`Failure`] if the defining system does not apply there, or values cannot be recorded.
    pub fn locate(
        &mut self,
        index: usize,
        from: &Place,
        to: &Place,
        length: f64,
    ) -> Result<Option<Located>, Failure> {
        let event = self.events[index].clone();
        let row = self.covector(&from.tangent);
        let mut bracket = self.bracket(index, from, to, length);
        let located = if event.mirror {
            let limit = self.limit(index, from, to, length);
            limit.unwrap_or_else(|| self.between((event.kind, &event.name), from, to, length))
        } else if event.condition.is_none() {
            self.bracketed(from, &row, &mut bracket)
        } else {
            match self.solved(&event, from, &row, &mut bracket) {
                Ok(located) => located,
                Err(Failure::NoComplexPair) => return Ok(None),
                Err(cause) => return Err(cause),
            }
        };
        self.describe(index, ([from, to], length), located).map(Some)
    }

    /// The solution of an event's defining system in a bracket, which is halved until Newton's
    /// iteration converges to a point in it; the middle of the last bracket, as a point that has
    /// not converged, if it never does.
    ///
    /// # Errors
    /// [`Failure::NoComplexPair`] and [`Failure::Unsupported`] where the system does not apply.
    fn solved(
        &mut self,
        event: &Event,
        from: &Place,
        row: &[f64],
        bracket: &mut Bracket,
    ) -> Result<Located, Failure> {
        // Signs of test functions come from a matrix that differs slightly from the point's own.
        let slack = 1e-4 * (bracket.high - bracket.low);
        let (index, mut inapplicable) = (bracket.index, None);
        for _ in 0..MOST_HALVINGS {
            let guess = bracket.guess(event.test, self.equations.parameters_at());
            match self.finish(event, guess, (row, from)) {
                Ok(located) => {
                    let Located { along, unknowns, .. } = &located;
                    let inside = (bracket.low - slack..=bracket.high + slack).contains(along);
                    if inside && self.is_near(bracket, *along, unknowns) {
                        return Ok(located);
                    }
                }
                Err(NewtonError::Evaluation {
                    cause: cause @ (Failure::NoComplexPair | Failure::Unsupported(_)),
                    ..
                }) => inapplicable = Some(cause),
                Err(_) => {}
            }
            let middle = 0.5 * (bracket.low + bracket.high);
            if !self.narrow(from, row, bracket, middle) {
                break;
            }
        }
        if let Some(cause) = inapplicable {
            return Err(cause);
        }
        let unknowns = bracket.between(0.5);
        let parameter = self.equations.parameters_at();
        let reach = bracket.at_ends(parameter).map(|end| (end - unknowns[parameter]).abs());
        let error = reach.into_iter().fold(self.parameter_error(), f64::max);
        let along = 0.5 * (bracket.low + bracket.high);
        Ok(Located::of(index, event, along, unknowns, error).converged(false))
    }

    /// The middle of a step, as a point that has not converged.
    pub fn between(&self, event: (Kind, &str), from: &Place, to: &Place, length: f64) -> Located {
        let ends = from.unknowns.iter().zip(&to.unknowns);
        let unknowns: Vec<f64> = ends.map(|(a, b)| 0.5 * (a + b)).collect();
        let p = self.equations.parameters_at();
        let error = (to.unknowns[p] - from.unknowns[p]).abs() + self.parameter_error();
        Located::new(event, 0.5 * length, unknowns, error).converged(false)
    }

    /// Whether a solution of a defining system lies near the branch between the ends of a bracket,
    /// and not only between the hyperplanes through them.
    fn is_near(&self, bracket: &Bracket, along: f64, unknowns: &[f64]) -> bool {
        let length = bracket.high - bracket.low;
        let fraction = ((along - bracket.low) / length).clamp(0.0, 1.0);
        let distance = difference(unknowns, &bracket.between(fraction));
        scaled_norm(&distance, &self.weights) <= MOST_BESIDE * length
    }

    /// Newton on an event's defining system from a guess: the point, how far it lies behind a place
    /// along `row`, and the event's own unknowns.
    pub fn finish(
        &mut self,
        event: &Event,
        guess: Vec<f64>,
        (row, from): (&[f64], &Place),
    ) -> Result<Located, NewtonError> {
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
        let (unknowns, all, error) = outcome?;
        let kept = if event.instead.is_none() { own } else { 0 };
        let mut point = unknowns[..n + kept].to_vec();
        point.resize(n + own, 0.0);
        point.extend(&unknowns[unknowns.len() - (end - n)..]);
        // The unknowns of the curve come first.
        let names = event.condition.as_ref().map_or(&[][..], |make| make().names());
        let values = &all[all.len() - names.len()..];
        let along = along(row, &point, &from.unknowns);
        let mut located = Located::new((event.kind, &event.name), along, point, error);
        let numbers = names.iter().map(ToString::to_string).zip(values.iter().copied());
        located.special.numbers = numbers.collect();
        Ok(located)
    }

    /// Newton with further conditions held: the unknowns, the recorded auxiliary ones among them,
    /// and the estimated error of the continued parameter.
    fn finish_with<'m>(
        &mut self,
        makes: impl Iterator<Item = &'m MakeCondition>,
        guess: &[f64],
    ) -> Result<(Vec<f64>, Vec<f64>, f64), NewtonError> {
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
        Ok((unknowns, own, error))
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
