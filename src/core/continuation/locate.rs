//! Locating events: bracketing on the branch itself, then Newton on the defining system.

use super::SpecialPoint;
use super::event::{Event, MakeCondition, Test};
use super::hermite::{Knot, hermite};
use super::stepper::{MATRIX_ERROR, Place, Stepper};
use crate::core::condition::Failure;
use crate::core::extended::{Closing, Extended};
use crate::core::newton::{Newton, NewtonError, Tolerances, scaled_norm};
use crate::core::vector::{along, difference};

/// A special point found between two points of the branch.
pub(super) struct Located {
    /// Which of the stepper's events it is; none of them, if it is unclassified.
    pub event: Option<usize>,
    /// How far behind the first point it lies, in scaled arclength.
    pub along: f64,
    pub special: SpecialPoint,
}

/// A special point found between two points of the branch, not described yet.
pub(super) struct Found {
    /// How far behind the first point it lies, in scaled arclength.
    pub along: f64,
    pub unknowns: Vec<f64>,
    /// The estimated error of the continued parameter.
    pub error: f64,
    pub converged: bool,
}

/// An event is not farther beside the branch, in units of its bracket's length.
const MOST_BESIDE: f64 = 0.5;

/// More halvings than this are hopeless.
const MOST_HALVINGS: usize = 40;

/// A part of the step from one place that holds the event.
struct Bracket {
    low: f64,
    high: f64,
    ends: [Vec<f64>; 2],
    tangents: [Vec<f64>; 2],
    tests: [f64; 2],
    /// How fast the test function grows at the second end, if that is known.
    slope: Option<f64>,
}

impl Bracket {
    /// Where the test function would vanish if it were linear; the middle if only its sign counts. At a fold
    /// it is the slope of the parameter (at this position in `X`), which a cubic knows better.
    fn guess(&self, test: Test, parameter: usize) -> Vec<f64> {
        let [low, high] = self.tests;
        let fraction = match test {
            Test::BranchPoint | Test::Hopf => 0.5,
            Test::Level(..) => match self.slope {
                Some(slope) => zero_of_parabola(low, high, slope * (self.high - self.low)),
                None => low / (low - high),
            },
            Test::Fold => {
                let rise = self.ends[1][parameter] - self.ends[0][parameter];
                turn_of_cubic(low, high, rise / (self.high - self.low))
            }
            _ => low / (low - high),
        };
        self.between(fraction.clamp(0.02, 0.98))
    }

    /// A place between the ends, on the cubic that has their tangents.
    fn between(&self, fraction: f64) -> Vec<f64> {
        let [a, b] = &self.ends;
        let [s, t] = &self.tangents;
        let length = self.high - self.low;
        // The tangents' lengths are those of scaled arclength, of which the bracket is a part.
        let knots = [
            Knot { u: 0.0, x: a, tangent: s, speed: 1.0 },
            Knot { u: length, x: b, tangent: t, speed: 1.0 },
        ];
        hermite(&knots, fraction * length)
    }
}

/// Where a parabola vanishes that goes from `low` to `high`, of the other sign, on the interval from 0 to 1, and
/// ends with this `slope`.
fn zero_of_parabola(low: f64, high: f64, slope: f64) -> f64 {
    // high + slope (s − 1) + c (s − 1)²
    let c = low - high + slope;
    let root = (slope * slope - 4.0 * c * high).max(0.0).sqrt();
    // Of both roots the one without cancellation: the parabola passes zero once between the ends.
    1.0 - 2.0 * high / (slope + root.copysign(high - low))
}

/// Where the slope of a cubic vanishes that goes from `low` to `high`, of the other sign, on the interval
/// from 0 to 1, with this `mean`.
fn turn_of_cubic(low: f64, high: f64, mean: f64) -> f64 {
    // low (1 − s) + high s + 6 c s (1 − s), the integral of which is the mean.
    let c = mean - 0.5 * (low + high);
    let (a, b) = (-6.0 * c, high - low + 6.0 * c);
    let root = (b * b - 4.0 * a * low).sqrt();
    // Of both roots the one without cancellation, which is the one inside.
    -2.0 * low / (b + root.copysign(high - low))
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
            tests: [from.tests[index], to.tests[index]],
            slope: match event.test {
                Test::Level(quantity, _) => self.slope_of(quantity, to),
                _ => None,
            },
        };
        let mut applicable = true;
        for _ in 0..MOST_HALVINGS {
            match self.finish(&event, bracket.guess(event.test, self.equations.parameters_at())) {
                Ok((unknowns, error)) => {
                    let along = along(&row, &unknowns, &from.unknowns);
                    // Signs of test functions are those of a matrix that is not quite that of the point.
                    let slack = 1e-4 * length;
                    let inside = along >= bracket.low - slack && along <= bracket.high + slack;
                    if inside && self.is_near(&bracket, along, &unknowns) {
                        let at = Found { along, unknowns, error, converged: true };
                        return self.describe(index, ([from, to], length), at);
                    }
                }
                Err(NewtonError::Evaluation {
                    cause: Failure::NoComplexPair | Failure::Unsupported(_),
                    ..
                }) => applicable = false,
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
        let p = self.equations.parameters_at();
        let reach = |end: &Vec<f64>| (end[p] - middle[p]).abs();
        let error = bracket.ends.iter().map(reach).fold(self.parameter_error(), f64::max);
        let at = Found { along, unknowns: middle, error, converged: false };
        self.describe(index, ([from, to], length), at)
    }

    /// The middle of a step, as a point that has not converged.
    pub fn between(&self, from: &Place, to: &Place, length: f64) -> Found {
        let ends = from.unknowns.iter().zip(&to.unknowns);
        let unknowns: Vec<f64> = ends.map(|(a, b)| 0.5 * (a + b)).collect();
        let p = self.equations.parameters_at();
        let error = (to.unknowns[p] - from.unknowns[p]).abs() + self.parameter_error();
        Found { along: 0.5 * length, unknowns, error, converged: false }
    }

    /// Whether a solution of a defining system lies near the branch between the ends of a bracket, and not only between
    /// the hyperplanes through them.
    fn is_near(&self, bracket: &Bracket, along: f64, unknowns: &[f64]) -> bool {
        let length = bracket.high - bracket.low;
        let fraction = ((along - bracket.low) / length).clamp(0.0, 1.0);
        let distance = difference(unknowns, &bracket.between(fraction));
        scaled_norm(&distance, &self.weights) <= MOST_BESIDE * length
    }

    /// Halves the bracket at a corrected point of the branch; false if that fails.
    fn halve(&mut self, index: usize, from: &Place, row: &[f64], bracket: &mut Bracket) -> bool {
        let length = 0.5 * (bracket.low + bracket.high);
        let mut unknowns = bracket.between(0.5);
        let closing = Closing { row, base: &from.unknowns, length };
        let Ok(report) = self.correct(&mut unknowns, closing) else { return false };
        let stability = matches!(self.events[index].test, Test::Hopf | Test::PeriodDoubling);
        let arrived = self.arrive(unknowns, row, report.matrix_error, stability);
        let Ok(place) = arrived else { return false };
        let test = place.tests[index];
        let side = usize::from((test < 0.0) != (bracket.tests[0] < 0.0));
        bracket.ends[side] = place.unknowns;
        bracket.tangents[side] = place.tangent;
        bracket.tests[side] = test;
        bracket.slope = bracket.slope.filter(|_| side == 0);
        *(if side == 0 { &mut bracket.low } else { &mut bracket.high }) = length;
        bracket.high - bracket.low > 1e-12 * bracket.high
    }

    /// Newton on the defining system from a guess: the point, and the estimated error of the
    /// continued parameter.
    pub fn finish(
        &mut self,
        event: &Event,
        guess: Vec<f64>,
    ) -> Result<(Vec<f64>, f64), NewtonError> {
        let curve = self.equations.suspend();
        let (n, end) = (self.equations.dimension(), self.equations.length());
        let own: usize = curve.iter().map(|condition| condition.unknowns()).sum();
        let (outcome, mut conditions) = if let Some(instead) = &event.instead {
            let mut bare = guess;
            bare.drain(n..n + own);
            (self.finish_with(&[instead.clone(), event.condition.clone()], &bare), curve)
        } else {
            self.equations.resume(curve);
            let outcome = self.finish_with(std::slice::from_ref(&event.condition), &guess);
            (outcome, self.equations.suspend())
        };
        // Whatever was added for the event goes again; the curve's own unknowns are in their place.
        conditions.truncate(self.held.len());
        self.equations.resume(conditions);
        let (unknowns, error) = outcome?;
        let kept = if event.instead.is_none() { own } else { 0 };
        let mut point = unknowns[..n + kept].to_vec();
        point.resize(n + own, 0.0);
        point.extend(&unknowns[unknowns.len() - (end - n)..]);
        Ok((point, error))
    }

    /// Newton with further conditions held.
    fn finish_with(
        &mut self,
        makes: &[MakeCondition],
        guess: &[f64],
    ) -> Result<(Vec<f64>, f64), NewtonError> {
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
        let outcome = converge(&mut self.equations, &mut unknowns, &weights, tolerances);
        outcome.map(|error| (unknowns, error))
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
        // What is left of a converged point is rounding, multiplied: one correction may be small by chance.
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
