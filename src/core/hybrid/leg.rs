//! Modes as vector fields, and guards and other scalars as functions watched along a trajectory.

use super::erased::{FieldNumber, GuardNumber, HybridEquations, MeasureNumber};
use super::scales::{guard_scale, time_scale, typical_scale};
use super::system::HybridSystem;
use crate::core::failure::OutOfDomain;
use crate::core::problem::{
    Domains, Forcing, Names, Observable, VectorField, WatchIn, Watchable, forward,
};
use crate::core::scalar::Scalar;
use num_dual::{Dual, Dual2};

/// The vector field of one mode.
pub struct InMode<'a, S> {
    /// The hybrid system.
    pub system: &'a S,
    /// The mode.
    pub mode: usize,
}

impl<S: HybridSystem> VectorField for InMode<'_, S> {
    forward! { |self| self.system;
        fn forcing() -> Forcing;
        fn period<T>(p: &[T]) -> T;
    }

    fn names(&self) -> Names {
        let mode = self.system.modes().swap_remove(self.mode);
        Names::new(mode.states.iter().map(String::as_str), self.system.parameters())
    }

    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.system.field(self.mode, t, x, p, f);
    }

    fn scales(&self, p: &[f64]) -> Vec<f64> {
        self.system.scales_of(self.mode, p)
    }

    fn domain(&self, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.system.domain(self.mode, x, p)
    }
}

/// A time and a state of a motion, in a mode.
#[derive(Clone, Copy)]
pub(in crate::core) struct Moment<'a, T> {
    pub system: &'a dyn HybridEquations,
    pub mode: usize,
    pub t: T,
    pub x: &'a [T],
    pub p: &'a [T],
}

impl<T: GuardNumber> Moment<'_, T> {
    /// Returns the value of a guard at this time and state.
    pub fn guard(self, guard: usize) -> T {
        self.system.guard(guard, self.mode, self.t, self.x, self.p)
    }
}

impl Moment<'_, f64> {
    /// Returns the scale of a guard, which is the size of its typical changes.
    pub fn scale(self, guard: usize) -> f64 {
        guard_scale(self.system, (guard, self.mode), (self.t, self.x), self.p)
    }

    /// Returns the scale of a guard's rate of change.
    pub fn usual_rate(self, guard: usize) -> f64 {
        self.scale(guard) / time_scale(self.system, self.p)
    }
}

impl<T: FieldNumber> Moment<'_, T> {
    /// Returns the rate of change of a guard along the motion, `dh/dt = h_t + h_x f`.
    pub fn rate(self, guard: usize) -> T
    where
        Dual<T>: GuardNumber,
    {
        self.along(|moving| moving.guard(guard)).eps
    }

    /// Evaluates a function of time and state along the motion, with its time derivative.
    pub fn along(self, value: impl FnOnce(Moment<Dual<T>>) -> Dual<T>) -> Dual<T> {
        let Moment { system, mode, t, x, p } = self;
        let mut f = vec![T::zero(); x.len()];
        system.field(mode, t, x, p, &mut f);
        let x: Vec<_> = x.iter().zip(&f).map(|(x, f)| Dual::new(*x, *f)).collect();
        let p: Vec<_> = p.iter().map(|p| Dual::new(*p, T::zero())).collect();
        value(Moment { system, mode, t: Dual::new(t, T::one()), x: &x, p: &p })
    }
}

/// A guard as a watched function along the flow of one of its modes.
pub struct GuardOf<'a> {
    /// The hybrid system.
    pub system: &'a dyn HybridEquations,
    /// The guard.
    pub guard: usize,
    /// The mode.
    pub mode: usize,
    /// The size of typical changes of the guard, used as the unit of tolerances.
    pub scale: f64,
}

impl<'a> GuardOf<'a> {
    /// Creates the watched function of a guard, with the guard's scale for states at half their
    /// typical sizes.
    pub(in crate::core) fn typical(
        system: &'a dyn HybridEquations,
        guard: usize,
        mode: usize,
        p: &[f64],
    ) -> Self {
        let scale = typical_scale(system, mode, p, |t, x, p| system.guard(guard, mode, t, x, p));
        GuardOf { system, guard, mode, scale }
    }
}

impl<T: GuardNumber> WatchIn<T> for GuardOf<'_> {
    fn value_in(&self, t: T, x: &[T], p: &[T]) -> T {
        self.system.guard(self.guard, self.mode, t, x, p)
    }
}

impl<T: Scalar> Watchable<T> for GuardOf<'_>
where
    Dual<T>: GuardNumber,
    Dual2<T>: GuardNumber,
{
    fn size(&self) -> f64 {
        self.scale
    }
}

/// A state or a monitor as a watched function along the flow of a mode.
pub(in crate::core) struct ScalarOf<'a> {
    pub system: &'a dyn HybridEquations,
    pub observable: Observable,
    pub mode: usize,
    /// The size of typical changes of the scalar.
    pub scale: f64,
}

impl<'a> ScalarOf<'a> {
    pub fn new(
        system: &'a dyn HybridEquations,
        observable: Observable,
        mode: usize,
        p: &[f64],
    ) -> Self {
        let value = |t, x: &_, p: &_| system.observe(observable, mode, t, x, p);
        // The flow supplies the scales of states.
        let scale =
            observable.state().map_or_else(|| typical_scale(system, mode, p, value), |_| 1.0);
        ScalarOf { system, observable, mode, scale }
    }
}

impl<T: MeasureNumber> WatchIn<T> for ScalarOf<'_> {
    fn value_in(&self, t: T, x: &[T], p: &[T]) -> T {
        self.system.observe(self.observable, self.mode, t, x, p)
    }
}

impl Watchable<f64> for ScalarOf<'_> {
    fn state_index(&self) -> Option<usize> {
        self.observable.state()
    }

    fn size(&self) -> f64 {
        self.scale
    }
}
