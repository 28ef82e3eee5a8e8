//! The times of an event that occurs at given times, which are stated by a formula such as
//! `n*period + phase`.

use super::assembling::Assembling;
use super::duration::Duration;
use super::scope::{Meaning, Scope};
use super::source::{Fault, ModelError, Phrase, Source};
use super::syntax::Formula;
use super::tape::Tape;
use crate::core::hybrid::time_left;
use crate::core::scalar::Scalar;

/// The name that denotes the number of the event in the formula of its time.
const NUMBER: &str = "n";
/// Rounding: the difference below which two event times count as equal, relative to the interval
/// between events.
const SAME: f64 = 1e-9;

/// The event times `first + n·interval`, where `first` and `interval` depend on parameters only.
#[derive(Clone, Debug)]
pub(super) struct Times {
    phrase: Phrase,
    /// The formulas of the times of the events with numbers 0, 1 and 2.
    tape: Tape,
}

impl Times {
    /// Parses the formula for the time of the event with number `n`.
    ///
    /// # Errors
    /// [`ModelError`] if the formula depends on states or time.
    pub fn read(scope: &Scope, phrase: &Phrase) -> Result<Self, ModelError> {
        if let Some(Meaning::Parameter(_)) = scope.meaning(NUMBER) {
            return Err(scope.source.twice(phrase, NUMBER, "a parameter"));
        }
        let (mut assembling, formula) =
            (Assembling::new(scope), Formula::read(&scope.source, phrase)?);
        let mut times = Vec::new();
        for n in [0.0, 1.0, 2.0] {
            times.push(assembling.indexed(&formula, &vec![(NUMBER.into(), n)])?);
        }
        if assembling.depends(&times, |input| !input.is_parameter()) {
            let reason =
                "the formula may contain `n` and parameters, but not states or time".into();
            let fault = Fault::Misplaced { what: "the time of an event".into(), reason };
            return Err(scope.source.fault_of(phrase, fault));
        }
        Ok(Times { phrase: phrase.clone(), tape: assembling.tape(&times) })
    }

    /// Returns the number of event times in one period of the forcing.
    ///
    /// # Errors
    /// [`ModelError`] if the event times are not periodic with the period of the forcing for all
    /// parameters.
    pub fn in_period(
        &self,
        source: &Source,
        period: &Duration,
        parameters: usize,
    ) -> Result<usize, ModelError> {
        let what = || format!("the time `{}`", self.phrase.text);
        if period.is_none() {
            let needed = "state the period of the forcing, as in `period: \"1\"`".into();
            let what = format!("{} has no period", what());
            return Err(source.fault_of(&self.phrase, Fault::Missing { what, needed }));
        }
        // Two generic choices of parameters.
        let counts = [0.618_033_98, 0.414_213_56].map(|part| {
            let p: Vec<f64> = (1..=parameters).map(|k| 0.5 + (part * k as f64).fract()).collect();
            let mut times = [0.0; 3];
            self.tape.evaluate(0.0, &[], &p, &mut times);
            let [interval, next] = [times[1] - times[0], times[2] - times[1]];
            let count = period.value(&p) / interval;
            let equal = (next - interval).abs() <= SAME * interval;
            let whole = count >= 0.5 && (count - count.round()).abs() <= SAME * count;
            if equal && whole { count.round() as usize } else { 0 }
        });
        match counts[0] > 0 && counts[0] == counts[1] {
            true => Ok(counts[0]),
            false => {
                let reason = "when `n` grows by 1, the time must grow by the period or by a \
                              fraction 1/k of the period, for all values of the parameters"
                    .to_string();
                let fault = Fault::Misplaced { what: what(), reason };
                Err(source
                    .fault_of(&self.phrase, fault)
                    .with_help("write, for example, `n*period + phase`"))
            }
        }
    }

    /// Returns the time that is left until the nearest event.
    pub fn left<T: Scalar>(&self, t: T, p: &[T]) -> T {
        let mut times = [T::zero(); 3];
        self.tape.evaluate(T::zero(), &[], p, &mut times);
        time_left(t, times[0], times[1] - times[0])
    }
}
