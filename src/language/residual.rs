//! Equations `F = 0` given as text.

use super::assembling::{Assembling, Program};
use super::basis::{Basis, Kind, recorded, values_of};
use super::duration::Duration;
use super::source::{ModelError, Source};
use super::statement::Residual;
use super::tape::Tape;
use crate::core::problem::{Dynamics, Names, ZeroProblem};
use crate::core::scalar::Scalar;
use std::ops::Range;

/// Equations `F = 0` given as text.
#[derive(Clone, Debug)]
pub struct Zero {
    basis: Basis,
    names: Names,
    residual: Program,
    /// The unknowns that are shown in columns of their own, and the long arrays whose norms are
    /// shown in columns.
    recorded: (Vec<usize>, Vec<Range<usize>>),
    monitors: Tape,
    dynamics: Dynamics,
}

/// Assembles the statement of equations `F = 0`, for a scene that gives values to some parameters.
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
    // The equations are checked one by one and evaluated together.
    basis.finish(common, &[&scope], Duration::default(), false)?;
    let (single, arrays) = recorded(&basis.states);
    let (norms, arrays): (Vec<String>, _) = arrays.into_iter().unzip();
    let monitors = single.iter().map(|k| basis.states[*k].clone()).chain(norms);
    let monitors: Vec<String> = monitors.chain(basis.monitor_names()).collect();
    let stated = statement.monitors.iter().map(|(_, formula)| assembling.read(formula));
    let stated = stated.collect::<Result<Vec<_>, _>>()?;
    let tape = assembling.tape(&stated);
    scope.refuse_time("equations without dynamics cannot contain the time")?;
    let names = Names::new(basis.groups.clone(), basis.parameters.clone()).with_monitors(monitors);
    let (residual, dynamics) = (assembling.program(residual), statement.dynamics.into());
    let recorded = (single, arrays);
    Ok(Zero { basis, names, residual, recorded, monitors: tape, dynamics })
}

impl Kind for Zero {
    fn basis(&self) -> &Basis {
        &self.basis
    }

    fn undefined(&self, z: &[f64], p: &[f64]) -> Option<ModelError> {
        self.residual.undefined(&self.basis.source, (0.0, z, p))
    }
}

/// Computes the Euclidean norm of an array, `√Σu²`.
fn norm<T: Scalar>(array: &[T]) -> T {
    array.iter().fold(T::zero(), |sum, u| sum + *u * *u).sqrt()
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
        let (single, arrays) = &self.recorded;
        let norms = arrays.iter().map(|all| norm(&z[all.clone()]));
        let own = single.iter().map(|k| z[*k]).chain(norms);
        let (first, stated) = values.split_at_mut(single.len() + arrays.len());
        first.iter_mut().zip(own).for_each(|(value, own)| *value = own);
        self.monitors.evaluate(T::zero(), z, p, stated);
    }

    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        self.names.sizes_of_groups(&self.basis.sizes)
    }

    fn dynamics(&self) -> Dynamics {
        self.dynamics
    }
}
