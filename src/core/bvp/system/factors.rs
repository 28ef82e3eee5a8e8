//! Factored linearisations as values, which know the layout that they belong to.

use super::BoundarySystem;
use super::factorisation::{Condensation, form_of};
use super::layout::Layout;
use super::linearisation::{Bordered, Form as Kept};
use crate::core::failure::{Failure, SINGULAR};
use crate::core::linear::{CondensedLu, Factors, RotatedLu};
use crate::core::zero::{Border, Form};
use std::sync::Arc;

impl BoundarySystem {
    /// Factors a form of what is assembled. What is left of the first segment is kept for
    /// multipliers.
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
            let fits =
                |known: &RotatedLu<Condensation>| Arc::ptr_eq(&known.condensed.layout, shared);
            let rotated = into.reuse(fits, || RotatedLu::new(Condensation::new(shared)));
            let border = RotatedLu::<Condensation>::border(border);
            let of = Bordered { layout, assembled, form: form_of(layout), border };
            let outcome = rotated.factor(of, omega, &assembled.units);
            return outcome.map_err(|cause| self.singular_by_growth(cause));
        }
        let fits = |known: &CondensedLu<Condensation>| Arc::ptr_eq(&known.condensed.layout, shared);
        let factors = into.reuse(fits, || CondensedLu::new(Condensation::new(shared)));
        let (form, mu) = match form {
            Form::Antiperiodic => (form_of(layout), -1.0),
            _ => (Kept::Jacobian, 1.0),
        };
        let of = Bordered { layout, assembled, form, border };
        let outcome = factors.factor(of, mu, &assembled.units);
        if layout.closes() && factors.condensed.pencil(assembled, &mut self.pencil) {
            self.pencil_of = assembled.count;
        }
        outcome.map_err(|cause| self.singular_by_growth(cause))
    }

    /// By how much deviations grow, at most, over an interval of what is assembled.
    pub(super) fn growth_of_deviations(&self) -> f64 {
        let (method, layout) = (&self.equations.method, &self.equations.layout);
        let segments = layout.segments.iter().zip(&self.linearisation.blocks);
        let intervals = segments.flat_map(|(s, blocks)| {
            let rows = layout.degree * s.states;
            blocks
                .chunks_exact(rows * (rows + s.states))
                .map(|nodes| method.growth(nodes, s.states))
        });
        intervals.fold(1.0, f64::max)
    }

    /// Where deviations grow by `G` over an interval, pivots as small as `1/G²` belong to regular
    /// matrices: those of the states at its end, and of the border. If these count as zero nothing
    /// is known of the matrix.
    pub(super) fn singular_by_growth(&self, cause: Failure) -> Failure {
        let growth = self.growth_of_deviations();
        match cause {
            Failure::Singular { .. } if growth * growth * SINGULAR >= 1.0 => {
                Failure::Growth(growth)
            }
            cause => cause,
        }
    }
}
