//! Equations `F = 0` that are given as text.

use super::assembling::{Assembling, Program};
use super::basis::{Basis, Kind, recorded, values_of};
use super::duration::Duration;
use super::source::{ModelError, Phrase, Source};
use super::statement::Residual;
use super::tape::Tape;
use crate::core::problem::{Dynamics, Names, ZeroProblem};
use crate::core::scalar::Scalar;

/// Equations `F = 0` that are given as text.
#[derive(Clone, Debug)]
pub struct Zero {
    basis: Basis,
    names: Names,
    residual: Program,
    monitors: Tape,
    dynamics: Dynamics,
}

/// Understands a statement, for a scene that gives some parameters.
pub(super) fn understood(
    source: &Source,
    statement: &Residual,
    given: &[String],
) -> Result<Zero, ModelError> {
    let (common, unknowns) = (statement.common(), (&statement.unknowns, "unknown"));
    let (mut basis, scope, rows) = Basis::of_rates(source, common, unknowns, given)?;
    let mut assembling = Assembling::new(&scope);
    assembling.check_named()?;
    let residual = values_of(&mut assembling, &rows)?;
    // Checked one by one, evaluated together.
    basis.finish(common, &[&scope], Duration::default(), false)?;
    let (mut monitors, arrays) = recorded(&basis.states);
    let formulas = monitors.iter().cloned().chain(arrays.iter().map(|(_, all)| norm(all)));
    let formulas = formulas.map(Phrase::from).collect::<Vec<_>>();
    monitors.extend(arrays.into_iter().map(|(name, _)| name));
    monitors.extend(basis.monitor_names());
    let stated = statement.monitors.iter().map(|(_, formula)| formula);
    let values = formulas.iter().chain(stated).map(|formula| assembling.read(formula));
    let values = values.collect::<Result<Vec<_>, _>>()?;
    let tape = assembling.tape(&values);
    scope.refuse_time("equations without motion have no time")?;
    let unknowns = basis.states.iter().map(String::as_str);
    let names = Names::new(unknowns, basis.parameters.clone()).with_monitors(monitors);
    let (residual, dynamics) = (assembling.program(residual), statement.dynamics.into());
    Ok(Zero { basis, names, residual, monitors: tape, dynamics })
}

impl Kind for Zero {
    fn basis(&self) -> &Basis {
        &self.basis
    }

    fn undefined(&self, z: &[f64], p: &[f64]) -> Option<ModelError> {
        self.residual.undefined(&self.basis.source, (0.0, z, p))
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
        self.basis.sizes.clone()
    }

    fn dynamics(&self) -> Dynamics {
        self.dynamics
    }
}
