//! Maps given as text.

use super::assembling::{Assembling, Program};
use super::basis::{Basis, Kind, program_of};
use super::duration::Duration;
use super::source::{ModelError, Source};
use super::statement::Map;
use crate::core::problem::{DiscreteMap, Names};
use crate::core::scalar::Scalar;

/// A map (discrete-time system) given as text.
#[derive(Clone, Debug)]
pub struct Iteration {
    basis: Basis,
    next: Program,
}

/// Assembles the statement of a map, for a scene that gives values to some parameters.
pub(super) fn understood(
    source: &Source,
    statement: &Map,
    given: &[String],
) -> Result<Iteration, ModelError> {
    let (common, states) = (statement.common(), (&statement.states, "state"));
    let (mut basis, scope, next) = Basis::of_rates(source, common, states, given)?;
    Assembling::new(&scope).check_named()?;
    let next = program_of(&scope, &next)?;
    basis.finish(common, &[&scope], Duration::default(), false)?;
    scope.refuse_time("maps that depend on the number of the iteration are not supported")?;
    Ok(Iteration { basis, next })
}

impl Kind for Iteration {
    fn basis(&self) -> &Basis {
        &self.basis
    }

    fn undefined(&self, x: &[f64], p: &[f64]) -> Option<ModelError> {
        self.next.undefined(&self.basis.source, (0.0, x, p))
    }
}

impl DiscreteMap for Iteration {
    fn names(&self) -> Names {
        self.basis.names()
    }

    fn defaults(&self) -> Vec<f64> {
        self.basis.defaults.clone()
    }

    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        self.basis.sizes.clone()
    }

    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        self.next.evaluate(T::zero(), x, p, next);
    }

    fn monitor<T: Scalar>(&self, monitor: usize, x: &[T], p: &[T]) -> T {
        self.basis.monitor(monitor, 0, T::zero(), x, p)
    }
}
