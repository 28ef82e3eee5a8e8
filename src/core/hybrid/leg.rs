//! One mode as a vector field, guards and other scalars as watched functions.

use super::erased::{EventNumber, FieldNumber, GuardNumber, HybridEquations, MeasureNumber};
use super::scales::state_scales;
use super::simulation::HybridFlow;
use super::system::HybridSystem;
use crate::core::field::{Forcing, VectorField};
use crate::core::scalar::Scalar;
use crate::core::watch::{Observable, WatchIn, Watchable};
use crate::core::zero::{LeftDomain, Names};
use num_dual::{Dual, Dual2};

/// Steps are no longer than this part of the forcing's period: where a field vanishes, nothing but the guards
/// tells how fast things change.
const PART_OF_PERIOD: f64 = 0.125;

/// The vector field of one mode.
pub struct InMode<'a, S> {
    /// The hybrid system.
    pub system: &'a S,
    /// The mode.
    pub mode: usize,
}

impl<S: HybridSystem> VectorField for InMode<'_, S> {
    fn names(&self) -> Names {
        let mode = self.system.modes().swap_remove(self.mode);
        Names::new(mode.states.iter().map(String::as_str), self.system.parameters())
    }

    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.system.field(self.mode, t, x, p, f);
    }

    fn forcing(&self) -> Forcing {
        self.system.forcing()
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        self.system.period(p)
    }

    fn scales(&self, p: &[f64]) -> Vec<f64> {
        state_scales(self.system, self.mode, p)
    }

    fn domain(&self, x: &[f64], p: &[f64]) -> Result<(), LeftDomain> {
        self.system.domain(self.mode, x, p)
    }
}

/// A function of time and states along the motion of a mode, with its rate `d/dt`.
pub(in crate::core) fn along<T: FieldNumber>(
    system: &dyn HybridEquations,
    mode: usize,
    t: T,
    x: &[T],
    p: &[T],
    value: impl FnOnce(Dual<T>, &[Dual<T>], &[Dual<T>]) -> Dual<T>,
) -> Dual<T> {
    let mut f = vec![T::zero(); x.len()];
    system.field(mode, t, x, p, &mut f);
    let moving: Vec<_> = x.iter().zip(&f).map(|(x, f)| Dual::new(*x, *f)).collect();
    let fixed: Vec<_> = p.iter().map(|p| Dual::new(*p, T::zero())).collect();
    value(Dual::new(t, T::one()), &moving, &fixed)
}

/// How fast a guard changes along the motion of its mode, `dh/dt = h_t + h_x f`.
pub(in crate::core) fn rate<T: FieldNumber>(
    system: &dyn HybridEquations,
    (guard, mode): (usize, usize),
    t: T,
    x: &[T],
    p: &[T],
) -> T
where
    Dual<T>: GuardNumber,
{
    along(system, mode, t, x, p, |t, x, p| system.guard(guard, mode, t, x, p)).eps
}

/// One guard as a function to be watched along the flow of one of its modes.
pub struct GuardOf<'a> {
    /// The hybrid system.
    pub system: &'a dyn HybridEquations,
    /// The guard.
    pub guard: usize,
    /// The mode.
    pub mode: usize,
    /// The size of its typical changes, which tolerances are relative to.
    pub scale: f64,
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
    fn state_index(&self) -> Option<usize> {
        None
    }

    fn size(&self) -> f64 {
        self.scale
    }
}

/// A state or a monitor as a function to be watched along the flow of one of its system's modes.
pub struct ScalarOf<'a> {
    /// The hybrid system.
    pub system: &'a dyn HybridEquations,
    /// The scalar.
    pub observable: Observable,
    /// The mode.
    pub mode: usize,
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
        1.0
    }
}

impl<T: EventNumber> HybridFlow<'_, T> {
    /// Prepares the flow for a leg that lasts no longer than this.
    pub(super) fn prepare_leg(&mut self, left: f64) {
        let period = match self.system.forcing() {
            Forcing::None => f64::INFINITY,
            Forcing::Periodic { .. } => self.system.period(&self.p),
        };
        let largest = self.settings.flow.largest_step;
        self.flow.settings.largest_step = largest.min(PART_OF_PERIOD * period / left);
        // Fields of different modes have much in common: the forcing, and most of the forces.
        let pace = self.pace.map(|pace| (pace / left).min(1.0));
        self.flow.settings.first_step = pace.or(self.settings.flow.first_step);
    }
}
