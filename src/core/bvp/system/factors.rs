//! Factored linearisations as values, which know the layout that they belong to.

use super::BoundarySystem;
use super::bordered::{Bordered, Form as Kept};
use super::factorisation::{Factorisation, form_of};
use super::layout::Layout;
use super::rotating::Rotating;
use crate::core::failure::Failure;
use crate::core::linear::{self, Factors};
use crate::core::zero::{Border, Form};
use std::sync::Arc;

/// The factors of a real linearisation.
struct Condensed {
    layout: Arc<Layout>,
    factors: Factorisation,
}

impl linear::Factorisation for Condensed {
    fn solve(&mut self, right: &mut [f64]) {
        self.factors.solve(&self.layout, right);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.factors.solve_transposed(&self.layout, right);
    }

    fn determinant_sign(&self) -> f64 {
        self.factors.determinant_sign()
    }
}

impl BoundarySystem {
    /// Factors a form of what is assembled. What is left of the first segment is kept for multipliers.
    pub(super) fn factor_form(
        &mut self,
        form: Form,
        border: Border,
        into: &mut Factors,
    ) -> Result<(), Failure> {
        if form != Form::Jacobian && !self.is_periodic() {
            return Err(Failure::Unsupported("the solutions are not periodic orbits".into()));
        }
        let shared = &self.equations.layout;
        let (layout, assembled): (&Layout, _) = (shared, &self.linearisation);
        if let Form::Oscillation(omega) = form {
            if border.width != 1 {
                let reason = "a complex linearisation of orbits takes a border of width 1";
                return Err(Failure::Unsupported(reason.into()));
            }
            let fits = |known: &Rotating| Arc::ptr_eq(&known.layout, shared);
            let rotating = into.reuse(fits, || Rotating::new(shared));
            return rotating.factor(assembled, omega, border);
        }
        let condensed = into.reuse(
            |known: &Condensed| Arc::ptr_eq(&known.layout, shared),
            || Condensed { layout: shared.clone(), factors: Factorisation::new(layout) },
        );
        let factors = &mut condensed.factors;
        let (form, mu) = match form {
            Form::Antiperiodic => (form_of(layout), -1.0),
            _ => (Kept::Jacobian, 1.0),
        };
        let outcome = factors.factor(Bordered { layout, assembled, form, border }, mu);
        if layout.closes() && factors.pencil(layout, assembled, &mut self.pencil) {
            self.pencil_of = assembled.count;
        }
        outcome
    }
}
