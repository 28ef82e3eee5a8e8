//! Event location in an integration step: the first guard that vanishes, and the time at which it
//! vanishes.

use super::erased::{EventNumber, HybridEquations};
use super::event::Event;
use super::leg::GuardOf;
use crate::core::ode::{Root, Roots, Step};
use crate::core::problem::{FieldIn, Watchable};
use crate::core::scalar::Scalar;
use std::ops::ControlFlow;

/// Heuristic: the time, in units of the time scale, within which events count as simultaneous. The
/// number of simultaneous events is limited, so that a motion with infinitely many events ends with
/// an error.
pub(super) const INSTANT: f64 = 1e-9;

/// Rounding: guards count as vanishing simultaneously if their zeros differ by less than this
/// fraction of a step, which is the accuracy of a root.
const TOGETHER: f64 = 1e-12;

/// The end of a leg (the part of the motion between two events) within an integration step.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocatedEvent<T> {
    pub guard: usize,
    pub root: Root<T>,
}

impl<T: Scalar> LocatedEvent<T> {
    /// Creates an event at a given time: the flow ends at the event, and the guard is the time that
    /// remains until the event.
    pub fn at_time(guard: usize) -> Self {
        LocatedEvent { guard, root: Root { fraction: T::one(), rate: -T::one() } }
    }
}

/// Heuristic: the first integration step of a leg (the part of the motion between two events) is at
/// most this multiple of the previous leg's duration: in chatter the legs become shorter and
/// shorter, and a longer step could miss them.
const LEGS: f64 = 4.0;

/// Rounding: a guard that falls from zero at the start of a leg faster than this rate, in units of
/// the scales, does not count as lifting off.
const RESTING: f64 = 1e-12;

/// Heuristic: the fractions of a step at which a guard must be positive to count as lifting off.
const LIFTED: [f64; 5] = [0.01, 0.03, 0.1, 0.3, 1.0];

/// The search for the end of a leg (the part of the motion between two events) in the integration
/// steps of the leg.
pub(super) struct EventLocator<'l, 'a, T> {
    pub system: &'a dyn HybridEquations,
    pub mode: usize,
    /// The watched guards.
    pub watched: &'l [usize],
    pub roots: &'l mut [Roots<T>],
    /// The scales of the guards of the mode.
    pub scales: &'l [f64],
    /// The record that receives the time and state at the end of the leg.
    pub event: &'l mut Event<T>,
    /// The variable that receives the length of the step in which the leg ends.
    pub pace: &'l mut Option<f64>,
    /// The real parts of the parameters.
    pub p: &'l [f64],
    /// The time scale of the system.
    pub unit: f64,
    /// The start time of the leg (the part of the motion between two events), and the longest
    /// duration of the leg.
    pub leg: (T, T),
}

impl<'a, T: EventNumber> EventLocator<'_, 'a, T>
where
    GuardOf<'a>: Watchable<T>,
{
    /// Returns the end of the leg (the part of the motion between two events) if it lies in the
    /// integration step; `None` otherwise.
    pub fn locate<F: FieldIn<T>>(&mut self, step: &mut Step<F, T>) -> Option<LocatedEvent<T>> {
        let event = self.first(step).filter(|event| !self.lifts(event, step))?;
        self.arrive(step, event, step.length())
    }

    /// Returns the end of the leg (the part of the motion between two events) in an integration
    /// step that is known to end at the zero of a guard.
    pub fn reach<F: FieldIn<T>>(
        &mut self,
        step: &mut Step<F, T>,
        (guard, fraction): (usize, f64),
        whole: f64,
    ) -> Option<LocatedEvent<T>> {
        let root = self.roots[guard].at_once(&self.guard(guard), step, fraction);
        self.arrive(step, LocatedEvent { guard, root }, whole * step.length())
    }

    /// Stores the end of the leg; `length` is the length that the step would have without the
    /// event.
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

    /// Whether a guard that seems to fall at the start of a leg (the part of the motion between two
    /// events) has zero rate there and is positive afterwards. For example, the distance of a body
    /// that leaves a support grows with the cube of time, and rounding errors determine its initial
    /// sign.
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

    /// Returns a guard as a watched function.
    fn guard(&self, guard: usize) -> GuardOf<'a> {
        GuardOf { system: self.system, guard, mode: self.mode, scale: self.scales[guard] }
    }

    /// Returns the first guard that falls through zero in a step; of several simultaneous guards,
    /// the first one defined.
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
