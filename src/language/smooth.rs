//! Vector fields given as text.

use super::assembling::{Assembling, Program};
use super::basis::{Basis, Kind, program_of};
use super::duration::Duration;
use super::observed::Scalable;
use super::source::{ModelError, Source};
use super::statement::Equations;
use crate::core::orbit::Smooth;
use crate::core::problem::{Forcing, Measure, Names, VectorField};
use crate::core::scalar::Scalar;

/// A vector field given as text.
#[derive(Clone, Debug)]
pub struct Field {
    basis: Basis,
    rates: Program,
}

/// Assembles the statement of a vector field, for a scene that gives values to some parameters.
pub(super) fn understood(
    source: &Source,
    statement: &Equations,
    given: &[String],
) -> Result<Field, ModelError> {
    let (common, states) = (statement.common(), (&statement.states, "state"));
    let (mut basis, scope, rates) = Basis::of_rates(source, common, states, given)?;
    Assembling::new(&scope).check_named()?;
    let rates = program_of(&scope, &rates)?;
    let period = Duration::read(&scope, "the period", statement.period.as_ref())?;
    basis.finish(common, &[&scope], period, false)?;
    Ok(Field { basis, rates })
}

impl Kind for Field {
    fn basis(&self) -> &Basis {
        &self.basis
    }

    fn undefined(&self, x: &[f64], p: &[f64]) -> Option<ModelError> {
        self.rates.undefined(&self.basis.source, (0.0, x, p))
    }

    fn may_jump(&self) -> bool {
        self.rates.may_jump()
    }
}

impl Scalable for Smooth<Field> {
    fn basis_mut(&mut self) -> &mut Basis {
        &mut self.0.basis
    }
}

impl VectorField for Field {
    fn names(&self) -> Names {
        self.basis.names()
    }

    fn defaults(&self) -> Vec<f64> {
        self.basis.defaults.clone()
    }

    #[inline]
    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.rates.evaluate(t, x, p, f);
    }

    fn forcing(&self) -> Forcing {
        self.basis.duration.forcing()
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        self.basis.duration.value(p)
    }

    fn monitor<T: Scalar>(&self, monitor: usize, t: T, x: &[T], p: &[T]) -> T {
        self.basis.monitor(monitor, 0, t, x, p)
    }

    fn measures(&self) -> Vec<(String, Measure)> {
        self.basis.measures.clone()
    }

    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        self.basis.sizes.clone()
    }
}
