//! Sections across a motion, and where it crosses them.

use super::repetition::StateScales;
use crate::core::hybrid::{HybridEquations, HybridState, time_scale};
use crate::core::ode::{Roots, Sign, Step};
use crate::core::problem::{FieldIn, Watch};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// A plane across the motion through a state of it, as a function that falls through zero where
/// motion crosses it in the direction that it has in that state.
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

/// A section across the motion, and the crossings of it.
pub(in crate::core) struct Section {
    pub start: HybridState<f64>,
    scales: StateScales,
    across: Across,
    roots: Roots<f64>,
    /// The largest distance of the motion from the start.
    diameter: f64,
    /// The distances of the crossings from the start, in units of the diameter.
    pub distances: Vec<f64>,
}

impl Section {
    /// The section through a state of the motion.
    pub fn through(
        system: &dyn HybridEquations,
        p: &[f64],
        start: HybridState<f64>,
        scales: StateScales,
    ) -> Self {
        let mut normal = vec![0.0; start.x.len()];
        system.field(start.mode, start.time, &start.x, p, &mut normal);
        let scale = scales.size(start.mode, &normal).powi(2) * time_scale(system, p);
        let units = scales.of_mode(start.mode);
        normal.iter_mut().zip(units).for_each(|(normal, unit)| *normal /= unit * unit);
        let across = Across { base: start.x.clone(), normal, scale };
        let mut roots = Roots::default();
        // Motion counts as having crossed it where it begins.
        roots.resume(Sign::Fallen);
        Section { start, scales, across, roots, diameter: f64::MIN_POSITIVE, distances: Vec::new() }
    }

    /// The state in which motion crosses the section in a step, as far as the fraction `end` of it.
    pub fn crossing<F: FieldIn<f64>>(
        &mut self,
        step: &mut Step<F, f64>,
        end: f64,
    ) -> Option<HybridState<f64>> {
        let Section { start, scales, across, roots, diameter, distances } = self;
        let from_start = |x: &[f64]| scales.distance(start.mode, x, &start.x);
        *diameter = diameter.max(from_start(step.end()));
        let mut found = None;
        let _ = roots.search(across, step, |step, root| {
            let mut x = start.x.clone();
            step.state(root.fraction, &mut x);
            let crossing = HybridState { mode: start.mode, time: step.time(root.fraction), x };
            found = Some(crossing).filter(|_| root.fraction <= end);
            ControlFlow::Break(())
        });
        if let Some(crossing) = &found {
            distances.push(from_start(&crossing.x) / *diameter);
        }
        found
    }
}
