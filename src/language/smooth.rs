//! Vector fields that are given as text.

use super::assembling::Assembling;
use super::basis::{Basis, measures, monitors_of, sizes_of, states_of, undefined, values_of};
use super::period::Period;
use super::source::{ModelError, Source};
use super::statement::Equations;
use super::tape::Tape;
use crate::core::problem::{Forcing, Measure, Names, VectorField};
use crate::core::scalar::Scalar;

/// A vector field that is given as text.
#[derive(Clone, Debug)]
pub struct Field {
    pub(super) basis: Basis,
    statement: Equations,
    names: Names,
    measures: Vec<(String, Measure)>,
    rates: Tape,
    period: Period,
    monitors: Vec<Tape>,
    scales: Vec<f64>,
    /// Whether time occurs though no period is stated.
    aperiodic: bool,
}

impl Field {
    /// Understands a statement, for a scene that gives some parameters.
    pub(super) fn new(
        source: &Source,
        statement: Equations,
        given: &[String],
    ) -> Result<Self, ModelError> {
        let mut basis = Basis::of(source, statement.common(), given)?;
        let (states, rates) = states_of(&basis, statement.common(), &statement.states, "state")?;
        let scope = basis.scope(statement.common(), &states)?;
        basis.begin(statement.common(), &scope)?;
        let mut assembling = Assembling::new(&scope);
        assembling.check_named()?;
        let values = values_of(&mut assembling, &rates)?;
        let rates = assembling.tape(&values);
        let monitors = monitors_of(&scope, &statement.monitors)?;
        let period = Period::read(&scope, statement.period.as_ref())?;
        basis.look_for_unused(&[&scope]);
        let states: Vec<String> = states.into_iter().map(|(_, name)| name).collect();
        let scales = sizes_of(source, &statement.scales, &states)?;
        let aperiodic = period.is_none() && scope.uses("t");
        let (monitor_names, monitors): (Vec<String>, Vec<Tape>) = monitors.into_iter().unzip();
        let measures = measures(&states, monitor_names.clone());
        let names = Names::new(states.iter().map(String::as_str), basis.parameters.clone());
        let names = names.with_monitors(monitor_names);
        Ok(Field { basis, statement, names, measures, rates, period, monitors, scales, aperiodic })
    }

    /// Whether time enters, but not with a period: there are no equilibria and no periodic orbits
    /// then.
    pub fn is_aperiodic(&self) -> bool {
        self.aperiodic
    }

    /// The error of a period that is not positive for some parameters.
    pub(super) fn refused_duration(&self, p: &[f64]) -> Option<ModelError> {
        self.period.refused(&self.basis.source, p)
    }

    /// The formula that has no finite value at `(t, x, p)`, if one has none.
    pub(super) fn undefined(&self, t: f64, x: &[f64], p: &[f64]) -> Option<ModelError> {
        undefined(&self.basis, self.statement.common(), &self.statement.states, (t, x, p))
    }
}

impl VectorField for Field {
    fn names(&self) -> Names {
        self.names.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.basis.defaults.clone()
    }

    #[inline]
    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.rates.evaluate(t, x, p, f);
    }

    fn forcing(&self) -> Forcing {
        self.period.forcing()
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        self.period.value(p)
    }

    fn monitor<T: Scalar>(&self, monitor: usize, t: T, x: &[T], p: &[T]) -> T {
        self.monitors[monitor].value(t, x, p)
    }

    fn measures(&self) -> Vec<(String, Measure)> {
        self.measures.clone()
    }

    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        self.scales.clone()
    }
}
