//! Surfaces along the motion of a mode: a guard, and where it is least.

use crate::core::hybrid::{FieldNumber, GuardNumber, HybridEquations, along, rate};
use num_dual::Dual;

/// A surface in time and state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Surface {
    /// Where a guard vanishes.
    Guard(usize),
    /// Where its rate along the motion does.
    Turning(usize),
}

impl Surface {
    /// The function that vanishes there.
    pub fn value<T: FieldNumber + GuardNumber>(
        self,
        system: &dyn HybridEquations,
        mode: usize,
        t: T,
        x: &[T],
        p: &[T],
    ) -> T
    where
        Dual<T>: GuardNumber,
    {
        match self {
            Surface::Guard(guard) => system.guard(guard, mode, t, x, p),
            Surface::Turning(guard) => rate(system, (guard, mode), t, x, p),
        }
    }

    /// The function with its rate along the motion of a mode.
    pub fn moving<T: FieldNumber>(
        self,
        system: &dyn HybridEquations,
        mode: usize,
        t: T,
        x: &[T],
        p: &[T],
    ) -> Dual<T>
    where
        Dual<T>: FieldNumber + GuardNumber,
        Dual<Dual<T>>: GuardNumber,
    {
        along(system, mode, t, x, p, |t, x, p| self.value(system, mode, t, x, p))
    }

    /// Its name, given those of the guards.
    pub fn name(self, system: &dyn HybridEquations) -> String {
        let (Surface::Guard(guard) | Surface::Turning(guard)) = self;
        let name = &system.guards()[guard].name;
        match self {
            Surface::Guard(_) => format!("the event `{name}`"),
            Surface::Turning(_) => format!("the section where guard `{name}` is least"),
        }
    }
}
