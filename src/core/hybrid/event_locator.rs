//! Which guard ends a mode within a step, and where.

use super::erased::{EventNumber, HybridEquations};
use super::event::Event;
use super::leg::GuardOf;
use crate::core::ode::{Root, Roots, Step};
use crate::core::problem::{FieldIn, Watchable};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// (H) Events within this time, in units of its scale, come at the same time: their number is
/// limited, so that motion with infinitely many events ends with an error.
pub(super) const INSTANT: f64 = 1e-9;

/// (R) Guards that vanish within this part of a step vanish together: a root is no better known.
const TOGETHER: f64 = 1e-12;

/// Where a mode ends within a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocatedEvent<T> {
    pub guard: usize,
    pub root: Root<T>,
}

impl<T: Scalar> LocatedEvent<T> {
    /// An event at a given time, where a flow ends: its guard falls like time.
    pub fn at_time(guard: usize) -> Self {
        LocatedEvent { guard, root: Root { fraction: T::one(), rate: -T::one() } }
    }
}

/// (H) The first step of a leg is at most this many times as long as the leg before: in chatter
/// each is shorter than the last one, and must not be lost in a step.
const LEGS: f64 = 4.0;

/// (R) A guard that falls no faster at the beginning of a leg, in units of the scales, may be
/// lifted.
const RESTING: f64 = 1e-12;

/// (H) Fractions of a step at which a guard that is lifted is positive.
const LIFTED: [f64; 5] = [0.01, 0.03, 0.1, 0.3, 1.0];

/// What looks for the end of a leg in its steps.
pub(super) struct EventLocator<'l, 'a, T> {
    pub system: &'a dyn HybridEquations,
    pub mode: usize,
    /// The guards to look at.
    pub watched: &'l [usize],
    pub roots: &'l mut [Roots<T>],
    /// The scales of the guards.
    pub scales: &'l [f64],
    /// Time and state where the leg ends are written here.
    pub event: &'l mut Event<T>,
    /// How long the step was in which the leg ends is written here.
    pub pace: &'l mut Option<f64>,
    /// Real parts of the parameters.
    pub p: &'l [f64],
    /// The scale of time.
    pub unit: f64,
    /// When the leg begins, and how long it may last.
    pub leg: (T, T),
}

impl<'a, T: EventNumber> EventLocator<'_, 'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// Where the leg ends in a step, if it does.
    pub fn locate<F: FieldIn<T>>(&mut self, step: &mut Step<F, T>) -> Option<LocatedEvent<T>> {
        let event = self.first(step).filter(|event| !self.lifts(event, step))?;
        self.arrive(step, event, step.length())
    }

    /// Where the leg ends in a step that goes to the root of a guard, as is known.
    pub fn reach<F: FieldIn<T>>(
        &mut self,
        step: &mut Step<F, T>,
        (guard, fraction): (usize, f64),
        whole: f64,
    ) -> Option<LocatedEvent<T>> {
        let root = self.roots[guard].at_once(&self.guard(guard), step, fraction);
        self.arrive(step, LocatedEvent { guard, root }, whole * step.length())
    }

    /// Writes down where the leg ends; without the event, the step would have had this length.
    fn arrive<F: FieldIn<T>>(
        &mut self,
        step: &mut Step<F, T>,
        located: LocatedEvent<T>,
        length: f64,
    ) -> Option<LocatedEvent<T>> {
        let ((begin, left), end) = (self.leg, located.root.fraction);
        self.event.time = step.time(end);
        step.state(end, &mut self.event.before);
        let lasted = (self.event.time - begin).real();
        let longest = (length * left.real()).min(LEGS * lasted);
        *self.pace = (longest > INSTANT * self.unit).then_some(longest);
        Some(located)
    }

    /// Whether a guard that seems to fall at the very beginning of a leg has no speed there, and is
    /// positive soon and stays so: a body that leaves a support rises as the cube of time, and
    /// rounding decides how it begins.
    fn lifts<F: FieldIn<T>>(&self, located: &LocatedEvent<T>, step: &mut Step<F, T>) -> bool {
        let (LocatedEvent { guard, root }, mode) = (located, self.mode);
        let begins = step.span().0 == 0.0 && root.fraction.real().abs() <= f64::EPSILON;
        let slowest = RESTING * self.scales[*guard] / self.unit;
        if !begins || root.rate.real() < -slowest {
            return false;
        }
        let mut x = step.start().to_vec();
        LIFTED.into_iter().all(|fraction| {
            let fraction = T::constant(fraction);
            step.interpolate(fraction, &mut x);
            let real: Vec<f64> = x.iter().map(T::real).collect();
            self.system.guard(*guard, mode, step.time(fraction).real(), &real, self.p) > 0.0
        })
    }

    /// A guard to be watched.
    fn guard(&self, guard: usize) -> GuardOf<'a> {
        GuardOf { system: self.system, guard, mode: self.mode, scale: self.scales[guard] }
    }

    /// The first guard to fall through zero in a step; of several together the one stated first.
    fn first<F: FieldIn<T>>(&mut self, step: &mut Step<F, T>) -> Option<LocatedEvent<T>> {
        let mut found: Option<LocatedEvent<T>> = None;
        for &guard in self.watched {
            let watch = self.guard(guard);
            let _ = self.roots[guard].search(&watch, step, |_, root| {
                let earlier = |other: &LocatedEvent<T>| {
                    root.fraction.real() < other.root.fraction.real() - TOGETHER
                };
                if found.as_ref().is_none_or(earlier) {
                    found = Some(LocatedEvent { guard, root });
                }
                ControlFlow::Break(())
            });
        }
        found
    }
}
