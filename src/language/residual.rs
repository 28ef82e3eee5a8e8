//! Equations `F = 0` given as text.

use super::assembling::{Assembling, Program};
use super::basis::{Basis, Kind, recorded, values_of};
use super::duration::Duration;
use super::implicit::Sides;
use super::source::{Fault, ModelError, Phrase, Source};
use super::statement::{Residual, Static};
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
    /// The products of the mass matrix with the rates, as functions of the unknowns and their rates;
    /// `None` for the identity matrix.
    mass: Option<Tape>,
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
    let (common, sides) = (statement.common(), Sides::of(source, &statement.unknowns));
    let unknowns = (&sides.right, "unknown");
    let (mut basis, scope, rows) = Basis::of_rates(source, common, unknowns, given)?;
    let mut assembling = Assembling::new(&scope);
    assembling.check_named()?;
    let mut residual = values_of(&mut assembling, &rows)?;
    if let Some(first) = sides.first().filter(|_| statement.dynamics != Static::Flow) {
        return Err(without_rates(source, first));
    }
    let left = sides.assemble(&scope, &rows)?;
    if let Some(left) = &left {
        left.subtract(&mut assembling, &mut residual)?;
    }
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
    let residual = assembling.program(residual);
    let dynamics = if left.is_some() { Dynamics::Implicit } else { statement.dynamics.into() };
    let (mass, recorded) = (left.map(|left| left.mass), (single, arrays));
    Ok(Zero { basis, names, residual, mass, recorded, monitors: tape, dynamics })
}

/// Returns the error for the left-hand side of an equation that does not describe a flow.
fn without_rates(source: &Source, left: &Phrase) -> ModelError {
    let what = format!("the left-hand side `{}`", left.text.trim());
    let reason = "only the equations of a flow have left-hand sides".into();
    source.fault_of(left, Fault::Misplaced { what, reason }).with_help(
        "set `dynamics: flow`, or write a formula that is zero at a solution; `==` compares two values",
    )
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

    fn mass_product<T: Scalar>(&self, z: &[T], p: &[T], rates: &[T], products: &mut [T]) {
        match &self.mass {
            Some(mass) => mass.evaluate(T::zero(), &[z, rates].concat(), p, products),
            None => products.copy_from_slice(rates),
        }
    }
}
