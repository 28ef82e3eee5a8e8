//! Periods and lengths: formulas of parameters that must be positive.

use super::assembling::Assembling;
use super::scope::{Meaning, Scope};
use super::source::{Fault, ModelError, Phrase, Source};
use super::tape::Tape;
use crate::core::scalar::Scalar;

/// A period or a length, which may depend on parameters only.
#[derive(Clone, Debug)]
pub(super) struct Duration {
    /// `the period` or `the length`.
    what: &'static str,
    phrase: Phrase,
    tape: Tape,
    /// The parameters that it depends on: names and positions. Further unknown numbers stand behind
    /// the parameters.
    needs: Vec<(String, usize)>,
}

impl Duration {
    /// Understands a formula.
    ///
    /// # Errors
    /// [`ModelError`] for a formula of states or time, and for a number that is not positive.
    pub fn read(scope: &Scope, what: &'static str, phrase: &Phrase) -> Result<Self, ModelError> {
        let mut assembling = Assembling::new(scope);
        let value = assembling.read(phrase)?;
        if assembling.depends(value, |input| !input.is_parameter()) {
            let reason = "it may depend on parameters only, not on states or time".to_string();
            let fault = Fault::Misplaced { what: what.into(), reason };
            return Err(scope.source.fault_of(phrase, fault));
        }
        let needs = scope.names().filter_map(|name| match scope.meaning(name)? {
            Meaning::Parameter(k) => Some((name.to_string(), k)),
            _ => None,
        });
        let needs = needs.filter(|(_, k)| assembling.depends(value, |input| input.is_at(*k)));
        let needs: Vec<(String, usize)> = needs.collect();
        let tape = assembling.tape(&[value]);
        let duration = Duration { what, phrase: phrase.clone(), tape, needs };
        duration.refused(&scope.source, &[]).map_or(Ok(duration), Err)
    }

    /// The error of a value that is not positive, if all parameters that it needs are known.
    pub fn refused(&self, source: &Source, p: &[f64]) -> Option<ModelError> {
        if self.needs.iter().any(|(_, k)| *k >= p.len()) {
            return None;
        }
        let value = self.value(p);
        if value > 0.0 && value.is_finite() {
            return None;
        }
        let parameters = self.needs.iter().map(|(name, k)| format!("{name} = {}", p[*k]));
        let parameters = parameters.collect::<Vec<_>>();
        let at = if parameters.is_empty() { "" } else { " at " };
        let fault = Fault::NotPositive {
            what: self.what,
            formula: self.phrase.text.clone(),
            value: format!("{value}{at}{}", parameters.join(", ")),
        };
        Some(source.fault_of(&self.phrase, fault))
    }

    /// Its value for some parameters.
    #[inline]
    pub fn value<T: Scalar>(&self, p: &[T]) -> T {
        self.tape.value(T::zero(), &[], p)
    }
}
