//! Surfaces along the motion of a mode: a guard, and where it is least.

use crate::core::hybrid::{FieldNumber, GuardNumber, HybridEquations, Moment};
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
    pub fn value<T: FieldNumber + GuardNumber>(self, at: Moment<T>) -> T
    where
        Dual<T>: GuardNumber,
    {
        match self {
            Surface::Guard(guard) => at.guard(guard),
            Surface::Turning(guard) => at.rate(guard),
        }
    }

    /// The function with its rate along the motion.
    pub fn moving<T: FieldNumber>(self, at: Moment<T>) -> Dual<T>
    where
        Dual<T>: FieldNumber + GuardNumber,
        Dual<Dual<T>>: GuardNumber,
    {
        at.along(|moving| self.value(moving))
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
