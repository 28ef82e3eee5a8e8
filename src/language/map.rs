//! Maps that are given as text.

use super::assembling::Assembling;
use super::basis::{Basis, monitors_of, sizes_of, states_of, undefined, values_of};
use super::source::{ModelError, Source};
use super::statement;
use super::tape::Tape;
use crate::core::problem::DiscreteMap;
use crate::core::problem::Names;
use crate::core::scalar::Scalar;

/// A map that is given as text.
#[derive(Clone, Debug)]
pub struct Iteration {
    pub(super) basis: Basis,
    statement: statement::Map,
    names: Names,
    next: Tape,
    monitors: Vec<Tape>,
    scales: Vec<f64>,
}

impl Iteration {
    /// Understands a statement, for a scene that gives some parameters.
    pub(super) fn new(
        source: &Source,
        statement: statement::Map,
        given: &[String],
    ) -> Result<Self, ModelError> {
        let common = statement.common();
        let mut basis = Basis::of(source, common, given)?;
        let (states, formulas) = states_of(&basis, common, &statement.states, "state")?;
        let scope = basis.scope(common, &states)?;
        basis.begin(common, &scope)?;
        let mut assembling = Assembling::new(&scope);
        assembling.check_named()?;
        let values = values_of(&mut assembling, &formulas)?;
        let next = assembling.tape(&values);
        let monitors = monitors_of(&scope, &statement.monitors)?;
        scope.refuse_time("maps that depend on the number of the iterate are not supported")?;
        basis.look_for_unused(&[&scope]);
        let states: Vec<String> = states.into_iter().map(|(_, name)| name).collect();
        let scales = sizes_of(source, &statement.scales, &states)?;
        let (monitor_names, monitors): (Vec<String>, Vec<Tape>) = monitors.into_iter().unzip();
        let names = Names::new(states.iter().map(String::as_str), basis.parameters.clone());
        Ok(Iteration {
            basis,
            statement,
            names: names.with_monitors(monitor_names),
            next,
            monitors,
            scales,
        })
    }
}

impl Iteration {
    /// The formula that has no finite value at `(x, p)`, if one has none.
    pub(super) fn undefined(&self, x: &[f64], p: &[f64]) -> Option<ModelError> {
        undefined(&self.basis, self.statement.common(), &self.statement.states, (0.0, x, p))
    }
}

impl DiscreteMap for Iteration {
    fn names(&self) -> Names {
        self.names.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.basis.defaults.clone()
    }

    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        self.scales.clone()
    }

    fn next<T: Scalar>(&self, x: &[T], p: &[T], next: &mut [T]) {
        self.next.evaluate(T::zero(), x, p, next);
    }

    fn monitor<T: Scalar>(&self, monitor: usize, x: &[T], p: &[T]) -> T {
        self.monitors[monitor].value(T::zero(), x, p)
    }
}
