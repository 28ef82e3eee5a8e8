//! Equations `F = 0` that are given as text.

use super::assembling::Assembling;
use super::basis::{Basis, monitors_of, recorded, sizes_of, states_of, undefined, values_of};
use super::source::{ModelError, Phrase, Source};
use super::statement::Residual;
use super::tape::Tape;
use crate::core::problem::{Dynamics, Names, ZeroProblem};
use crate::core::scalar::Scalar;

/// Equations `F = 0` that are given as text.
#[derive(Clone, Debug)]
pub struct Zero {
    pub(super) basis: Basis,
    statement: Residual,
    names: Names,
    residual: Tape,
    monitors: Tape,
    scales: Vec<f64>,
}

impl Zero {
    /// Understands a statement, for a scene that gives some parameters.
    pub(super) fn new(
        source: &Source,
        statement: Residual,
        given: &[String],
    ) -> Result<Self, ModelError> {
        let mut basis = Basis::of(source, statement.common(), given)?;
        let (unknowns, rows) =
            states_of(&basis, statement.common(), &statement.unknowns, "unknown")?;
        let scope = basis.scope(statement.common(), &unknowns)?;
        basis.begin(statement.common(), &scope)?;
        let mut assembling = Assembling::new(&scope);
        assembling.check_named()?;
        let values = values_of(&mut assembling, &rows)?;
        let residual = assembling.tape(&values);
        // Checked one by one, evaluated together.
        let further = monitors_of(&scope, &statement.monitors)?;
        let unknowns: Vec<String> = unknowns.into_iter().map(|(_, name)| name).collect();
        let (mut monitors, arrays) = recorded(&unknowns);
        let formulas = monitors.iter().cloned().chain(arrays.iter().map(|(_, all)| norm(all)));
        let formulas = formulas.map(Phrase::from).collect::<Vec<_>>();
        monitors.extend(arrays.into_iter().map(|(name, _)| name));
        monitors.extend(further.into_iter().map(|(name, _)| name));
        let stated = statement.monitors.iter().map(|(_, formula)| formula);
        let values = formulas.iter().chain(stated).map(|formula| assembling.read(formula));
        let values = values.collect::<Result<Vec<_>, _>>()?;
        let tape = assembling.tape(&values);
        scope.refuse_time("equations without motion have no time")?;
        basis.look_for_unused(&[&scope]);
        let scales = sizes_of(source, &statement.scales, &unknowns)?;
        let unknowns = unknowns.iter().map(String::as_str);
        let names = Names::new(unknowns, basis.parameters.clone()).with_monitors(monitors);
        Ok(Zero { basis, statement, names, residual, monitors: tape, scales })
    }

    /// The formula that has no finite value at `(z, p)`, if one has none.
    pub(super) fn undefined(&self, z: &[f64], p: &[f64]) -> Option<ModelError> {
        undefined(&self.basis, self.statement.common(), &self.statement.unknowns, (0.0, z, p))
    }
}

/// The formula of the norm of an array, `√Σu²`.
fn norm(elements: &[String]) -> String {
    format!("sqrt({})", elements.iter().map(|u| format!("{u}^2")).collect::<Vec<_>>().join(" + "))
}

impl ZeroProblem for Zero {
    fn names(&self) -> Names {
        self.names.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.basis.defaults.clone()
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        self.residual.evaluate(T::zero(), z, p, r);
    }

    fn monitors<T: Scalar>(&self, z: &[T], p: &[T], values: &mut [T]) {
        self.monitors.evaluate(T::zero(), z, p, values);
    }

    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        self.scales.clone()
    }

    fn dynamics(&self) -> Dynamics {
        self.statement.dynamics.into()
    }
}
