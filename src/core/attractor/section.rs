//! Sections across a motion, and their crossings.

use super::repetition::StateScales;
use crate::core::hybrid::{EventNumber, HybridEquations, HybridState, time_scale};
use crate::core::ode::{Roots, Sign, Step};
use crate::core::problem::{FieldIn, Watch};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// A plane across the motion at a given state, represented by a function that falls through zero
/// where a motion crosses the plane in the same direction as at the given state.
struct Across {
    base: Vec<f64>,
    normal: Vec<f64>,
    scale: f64,
}

impl Watch for Across {
    fn value<T: Scalar>(&self, _t: T, x: &[T], _p: &[T]) -> T {
        let parts = x.iter().zip(&self.base).zip(&self.normal).map(|((x, b), n)| (-*x + *b) * *n);
        parts.fold(T::zero(), |sum, part| sum + part)
    }

    fn scale(&self) -> f64 {
        self.scale
    }
}

/// A section across the motion through one of its states.
pub(super) struct Section<T> {
    mode: usize,
    across: Across,
    roots: Roots<T>,
    /// Whether the next integration step is the first step after the start of the motion.
    begins: bool,
}

/// Rounding: a crossing of the section within this fraction of the first step counts as the start
/// of the motion, because rounding may place the start slightly off the section.
const AT_START: f64 = 1e-6;

impl<T: EventNumber> Section<T> {
    /// Creates the section through a state of the motion.
    pub fn through(
        system: &dyn HybridEquations,
        p: &[f64],
        state: &HybridState<f64>,
        scales: &StateScales,
    ) -> Self {
        let HybridState { mode, time, ref x } = *state;
        let mut normal = vec![0.0; x.len()];
        system.field(mode, time, x, p, &mut normal);
        let scale = scales.size(mode, &normal).powi(2) * time_scale(system, p);
        let units = scales.of_mode(mode);
        normal.iter_mut().zip(units).for_each(|(normal, unit)| *normal /= unit * unit);
        let mut roots = Roots::default();
        // The start counts as a crossing that has already occurred.
        roots.resume(Sign::Fallen);
        Section { mode, across: Across { base: x.clone(), normal, scale }, roots, begins: true }
    }

    /// Returns the state at which motion crosses the section in an integration step, up to the
    /// fraction `end` of the step.
    pub fn crossing<F: FieldIn<T>>(
        &mut self,
        step: &mut Step<F, T>,
        end: T,
    ) -> Option<HybridState<T>> {
        let Section { mode, across, roots, begins } = self;
        let first = std::mem::replace(begins, false);
        let mut found = None;
        let _ = roots.search(across, step, |step, root| {
            if first && root.fraction.real() <= AT_START {
                return ControlFlow::Continue(());
            }
            if root.fraction.real() <= end.real() {
                let mut x: Vec<T> = across.base.iter().map(|x| T::constant(*x)).collect();
                step.state(root.fraction, &mut x);
                found = Some(HybridState { mode: *mode, time: step.time(root.fraction), x });
            }
            ControlFlow::Break(())
        });
        found
    }
}
