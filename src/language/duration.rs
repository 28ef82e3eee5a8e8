//! Periods of forcings and lengths of intervals: formulas of parameters whose values must be
//! positive.

use super::assembling::Assembling;
use super::scope::{Meaning, Scope};
use super::source::{Fault, ModelError, Phrase, Source};
use super::tape::Tape;
use crate::core::problem::Forcing;
use crate::core::scalar::Scalar;
use std::f64::consts::TAU;

/// A period of a forcing or a length of an interval, which may depend on parameters only; 1 by
/// default.
#[derive(Clone, Debug, Default)]
pub(super) struct Duration(Option<Stated>);

#[derive(Clone, Debug)]
struct Stated {
    /// The name of the quantity in messages: `the period` or `the length`.
    what: &'static str,
    phrase: Phrase,
    tape: Tape,
    /// The names and indices of the parameters that the formula contains. The indices of additional
    /// unknowns follow the indices of the parameters.
    needs: Vec<(String, usize)>,
}

impl Duration {
    /// Parses the formula of a period or a length, if the statement contains one.
    ///
    /// # Errors
    /// [`ModelError`] if the formula contains states or time, or if its value is a number that is
    /// not positive.
    pub fn read(
        scope: &Scope,
        what: &'static str,
        stated: Option<&Phrase>,
    ) -> Result<Self, ModelError> {
        let Some(phrase) = stated else { return Ok(Duration(None)) };
        let mut assembling = Assembling::new(scope);
        let value = assembling.read(phrase)?;
        if assembling.depends(&[value], |input| !input.is_parameter()) {
            let reason = "the formula may contain parameters, but not states or time".to_string();
            let fault = Fault::Misplaced { what: what.into(), reason };
            return Err(scope.source.fault_of(phrase, fault));
        }
        let needs = scope.names().filter_map(|name| match scope.meaning(name)? {
            Meaning::Parameter(k) => Some((name.to_string(), k)),
            _ => None,
        });
        let needs = needs.filter(|(_, k)| assembling.depends(&[value], |input| input.is_at(*k)));
        let needs: Vec<(String, usize)> = needs.collect();
        let tape = assembling.tape(&[value]);
        let duration = Duration(Some(Stated { what, phrase: phrase.clone(), tape, needs }));
        duration.refused(&scope.source, &[]).map_or(Ok(duration), Err)
    }

    /// Returns whether the statement contains no formula of the period or length.
    pub fn is_none(&self) -> bool {
        self.0.is_none()
    }

    /// Returns an error if the value is not positive; returns `None` if some required parameters
    /// are unknown.
    pub fn refused(&self, source: &Source, p: &[f64]) -> Option<ModelError> {
        let Stated { what, phrase, needs, .. } = self.0.as_ref()?;
        if needs.iter().any(|(_, k)| *k >= p.len()) {
            return None;
        }
        let value = self.value(p);
        if value > 0.0 && value.is_finite() {
            return None;
        }
        let parameters = needs.iter().map(|(name, k)| format!("{name} = {}", p[*k]));
        let parameters = parameters.collect::<Vec<_>>();
        let at = if parameters.is_empty() { "" } else { " at " };
        let value = format!("{value}{at}{}", parameters.join(", "));
        let fault = Fault::NotPositive { what, formula: phrase.text.clone(), value };
        Some(source.fault_of(phrase, fault))
    }

    /// Returns the period or the length for given parameters.
    #[inline]
    pub fn value<T: Scalar>(&self, p: &[T]) -> T {
        self.0.as_ref().map_or(T::one(), |stated| stated.tape.value(T::zero(), &[], p))
    }

    /// Returns the periodic forcing, or `None` if no period is stated.
    pub fn forcing(&self) -> Forcing {
        self.0.as_ref().map_or(Forcing::None, |_| Forcing::Periodic { phase: TAU })
    }
}
