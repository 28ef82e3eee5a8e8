//! The period in which time enters equations.

use super::duration::Duration;
use super::scope::Scope;
use super::source::{ModelError, Phrase, Source};
use crate::core::problem::Forcing;
use crate::core::scalar::Scalar;
use std::f64::consts::TAU;

/// The period of a forcing, if one is stated.
#[derive(Clone, Debug)]
pub(super) struct Period(Option<Duration>);

impl Period {
    /// Understands the formula of a period.
    ///
    /// # Errors
    /// As [`Duration::read`].
    pub fn read(scope: &Scope, stated: Option<&Phrase>) -> Result<Self, ModelError> {
        let read = stated.map(|period| Duration::read(scope, "the period", period));
        Ok(Period(read.transpose()?))
    }

    /// Whether none is stated.
    pub fn is_none(&self) -> bool {
        self.0.is_none()
    }

    /// The error of a value that is not positive.
    pub fn refused(&self, source: &Source, p: &[f64]) -> Option<ModelError> {
        self.0.as_ref()?.refused(source, p)
    }

    /// A periodic one, if a period is stated.
    pub fn forcing(&self) -> Forcing {
        self.0.as_ref().map_or(Forcing::None, |_| Forcing::Periodic { phase: TAU })
    }

    /// The period; 1 if none is stated.
    pub fn value<T: Scalar>(&self, p: &[T]) -> T {
        self.0.as_ref().map_or(T::one(), |period| period.value(p))
    }
}
