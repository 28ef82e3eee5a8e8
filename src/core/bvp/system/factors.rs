//! Factorised linearisations, each stored together with the layout of its unknowns.

use super::assembly::{AssembledJacobian, Bordered, Form as Kept};
use super::discretisation::DiscretisedProblem;
use super::factorisation::{Condensation, form_of, singular_by_growth};
use super::floquet::Floquet;
use super::layout::UnknownLayout;
use super::rotated_sparse::RotatedSparseLu;
use super::sparse_factors::SparseOrbitLu;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, CondensedLu, Factors, Form, RotatedLu};
use std::sync::Arc;

/// Factorises the assembled linearisation in the form given by `form`. The matrix pencil for
/// Floquet multipliers is kept for later use.
pub(super) fn factor(
    (equations, assembled): (&DiscretisedProblem, &AssembledJacobian),
    floquet: &mut Floquet,
    form: Form,
    border: Border,
    into: &mut Factors,
) -> Result<(), Failure> {
    let shared = &equations.layout;
    let layout: &UnknownLayout = shared;
    if form != Form::Jacobian && !layout.is_periodic() {
        return Err(Failure::Unsupported(
            "the solutions of the problem are not periodic orbits, but \
                                         the requested linearisation exists only for periodic \
                                         orbits"
                .into(),
        ));
    }
    let (kept, mu) = match form {
        Form::Antiperiodic => (form_of(layout), -1.0),
        _ => (Kept::Jacobian, 1.0),
    };
    if let Some(sparse) = assembled.structure.sparse() {
        if let Form::Oscillation(omega) = form {
            let rotated = into.reuse(|_| true, RotatedSparseLu::default);
            return rotated.factor(sparse, layout, omega, border);
        }
        let of = Bordered { layout, assembled, form: kept, border };
        return into.reuse(|_| true, SparseOrbitLu::default).factor(sparse, of, mu);
    }
    let outcome = if let Form::Oscillation(omega) = form {
        if border.width != 1 {
            let reason = "the complex linearisation of a periodic orbit needs a border of exactly \
                          one row and one column";
            return Err(Failure::Unsupported(reason.into()));
        }
        let fits = |known: &RotatedLu<Condensation>| Arc::ptr_eq(&known.condensed.layout, shared);
        let rotated = into.reuse(fits, || RotatedLu::new(Condensation::new(shared)));
        let border = RotatedLu::<Condensation>::border(border);
        let of = Bordered { layout, assembled, form: form_of(layout), border };
        rotated.factor(of, omega, &assembled.units)
    } else {
        let fits = |known: &CondensedLu<Condensation>| Arc::ptr_eq(&known.condensed.layout, shared);
        let factors = into.reuse(fits, || CondensedLu::new(Condensation::new(shared)));
        let of = Bordered { layout, assembled, form: kept, border };
        let outcome = factors.factor(of, mu, &assembled.units);
        if layout.closes() {
            floquet.keep(&factors.condensed, assembled);
        }
        outcome
    };
    outcome.map_err(|cause| singular_by_growth(assembled.growth(equations), cause))
}
