//! Which guard ends a mode within a step, and where.

use super::leg::GuardOf;
use super::system::{Guard, HybridSystem};
use crate::core::field::VectorField;
use crate::core::flow::{Root, Roots, Step};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// Guards that vanish within this part of a step do so together.
const TOGETHER: f64 = 1e-12;

/// Where a mode ends within a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Landing<T> {
    pub guard: usize,
    pub root: Root<T>,
}

/// The first guard of a mode to fall through zero in a step; of several together the one stated first.
pub(super) fn first<S: HybridSystem, F: VectorField, T: Scalar>(
    guards: &[Guard],
    roots: &mut [Roots<T, GuardOf<S>>],
    mode: usize,
    step: &mut Step<F, T>,
) -> Option<Landing<T>> {
    let mut found: Option<Landing<T>> = None;
    for guard in (0..guards.len()).filter(|g| guards[*g].mode == mode) {
        let _ = roots[guard].search(step, |_, root| {
            let earlier =
                |other: &Landing<T>| root.fraction.real() < other.root.fraction.real() - TOGETHER;
            if found.as_ref().is_none_or(earlier) {
                found = Some(Landing { guard, root });
            }
            ControlFlow::Break(())
        });
    }
    found
}
