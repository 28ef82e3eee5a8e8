//! Hybrid systems as users define them.

use super::tangency::Tangency;
use crate::core::failure::OutOfDomain;
use crate::core::problem::{Forcing, Measure};
use crate::core::scalar::{LaneWidth, Scalar};

/// A mode of motion: its name and the names of its states, which can differ from mode to mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mode {
    /// The name of the mode.
    pub name: String,
    /// The names of the mode's states. States of several modes with the same name represent one
    /// quantity in diagrams.
    pub states: Vec<String>,
    /// Whether motion in the mode stays on an invariant surface, onto which
    /// [`constrain`](HybridSystem::constrain) projects states.
    pub on_surface: bool,
}

impl Mode {
    /// Creates a mode with the given name and states.
    pub fn new<S: Into<String>>(
        name: impl Into<String>,
        states: impl IntoIterator<Item = S>,
    ) -> Self {
        let states = states.into_iter().map(Into::into).collect();
        Mode { name: name.into(), states, on_surface: false }
    }

    /// Declares that motion in the mode stays on an invariant surface, as sliding motion does. A
    /// periodic orbit that never leaves the mode must close only within the surface, since deviations
    /// normal to the surface are lost.
    ///
    /// ```
    /// use tangency::core::hybrid::Mode;
    /// assert!(Mode::new("sliding", ["x", "v"]).on_surface().on_surface);
    /// ```
    pub fn on_surface(mut self) -> Self {
        self.on_surface = true;
        self
    }
}

/// A guard: a function whose zeros are events, which end modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// The name of the events at the guard's zeros.
    pub name: String,
    /// The modes that an event of this guard ends.
    pub modes: Vec<usize>,
    /// The mode that follows an accumulation of events of this guard, that is, infinitely many events
    /// in a finite time (complete chatter); `None` if no accumulation is expected.
    pub accumulates_to: Option<usize>,
    /// The shortest time in which the guard changes, which limits the integration step; `None` if
    /// the guard does not change faster than the vector field.
    pub changes_in: Option<f64>,
    /// The number of events of the guard in each period of the forcing, if the events occur at given
    /// times at equal intervals; the guard is then the [`time_left`]. The number is 0 if the events
    /// are at zeros of the guard.
    pub per_period: usize,
}

impl Guard {
    /// Creates a guard of some modes; for example, an impact is one event in all modes in which it
    /// can occur.
    pub fn new(name: impl Into<String>, modes: impl IntoIterator<Item = usize>) -> Self {
        let (name, modes) = (name.into(), modes.into_iter().collect());
        Guard { name, modes, accumulates_to: None, changes_in: None, per_period: 0 }
    }

    /// Declares an event at given times, `per_period` times in each period of the forcing. The guard
    /// must be the [`time_left`] until the nearest event time.
    ///
    /// Integration stops exactly at the event times, without a search for zeros. A motion that begins
    /// at an event time begins just after the event.
    ///
    /// ```
    /// use tangency::core::hybrid::{Guard, time_left};
    /// // A pulse in every year, at the times 0.25 + n.
    /// assert_eq!(Guard::new("pulse", [0]).at(1).per_period, 1);
    /// assert_eq!([1.0, 1.5, 2.25].map(|t| time_left(t, 0.25, 1.0)), [0.25, -0.25, 0.0]);
    /// ```
    pub fn at(mut self, per_period: usize) -> Self {
        self.per_period = per_period;
        self
    }

    /// Whether the event occurs at given times.
    pub(in crate::core) fn is_timed(&self) -> bool {
        self.per_period > 0
    }

    /// Sets the mode that follows an accumulation of events of this guard.
    pub fn accumulating_to(mut self, mode: usize) -> Self {
        self.accumulates_to = Some(mode);
        self
    }

    /// Sets the shortest time in which the guard changes, which limits the integration step. Guards
    /// are evaluated once per integration step, whose length depends only on the vector field:
    /// without this limit, zeros of a guard that changes faster are missed, for example at a narrow
    /// slot that a slow body passes.
    ///
    /// ```
    /// use tangency::core::hybrid::Guard;
    /// assert_eq!(Guard::new("slot", [0]).changing_in(1e-3).changes_in, Some(1e-3));
    /// ```
    pub fn changing_in(mut self, time: f64) -> Self {
        self.changes_in = Some(time);
        self
    }

    /// Whether the guard ends a mode.
    pub(in crate::core) fn ends(&self, mode: usize) -> bool {
        self.modes.contains(&mode)
    }
}

/// Returns the time left until the nearest of the times `first + n·interval`, for all integers `n`;
/// the value is negative after that time. The function serves as the guard of an event [at given
/// times](Guard::at).
///
/// ```
/// use tangency::core::hybrid::time_left;
/// assert_eq!(time_left(7.75, 0.0, 2.0), 0.25);
/// ```
pub fn time_left<T: Scalar>(t: T, first: T, interval: T) -> T {
    let passed = t - first;
    let nearest = (passed.real() / interval.real()).round();
    interval * nearest - passed
}

/// The scales of a hybrid system: typical sizes of its times and states, by order of magnitude.
/// Tolerances are relative to the scales, so that a device of micrometres and microseconds can be
/// described in metres and seconds.
///
/// ```
/// use tangency::core::hybrid::Scales;
/// let scales = Scales::default().time(1e-6).state("displacement", 1e-9).state("velocity", 1e-3);
/// assert_eq!((scales.time, scales.states.len()), (Some(1e-6), 2));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scales {
    /// The time scale; by default the time in which the phase of the forcing grows by 1, and 1 in a
    /// system without forcing.
    pub time: Option<f64>,
    /// The scales of states, by the name of the state; 1 for states without an entry.
    pub states: Vec<(String, f64)>,
}

impl Scales {
    /// Sets the time scale.
    pub fn time(mut self, scale: f64) -> Self {
        self.time = Some(scale);
        self
    }

    /// Sets the scale of a state, given by name.
    pub fn state(mut self, name: impl Into<String>, scale: f64) -> Self {
        self.states.push((name.into(), scale));
        self
    }

    /// Returns the scale of a state, given by name.
    pub(super) fn of(&self, state: &str) -> f64 {
        self.states.iter().find(|(name, _)| name == state).map_or(1.0, |(_, scale)| *scale)
    }
}

/// One leg of a hybrid orbit (the part between two successive events), represented by the states at
/// its ends.
#[derive(Clone, Copy, Debug)]
pub struct Passage<'a, T> {
    /// The mode.
    pub mode: usize,
    /// The guard at which the leg ends; `None` if no event ends the leg.
    pub exit: Option<usize>,
    /// The state at the start of the leg.
    pub start: &'a [T],
    /// The state at the end of the leg, before the event.
    pub end: &'a [T],
}

/// A hybrid system: modes, guards and resets, written once for all scalar types; derivatives come
/// from automatic differentiation. [`hybrid_system!`](crate::hybrid_system) defines a system mode
/// by mode.
///
/// A mode lasts while all its guards are positive. The first guard that falls to zero causes an event;
/// if several guards fall to zero simultaneously, the event belongs to the guard that is defined
/// first. From the state `x` just before the event, motion continues in the mode
/// [`next_mode`](Self::next_mode), from the state computed by [`reset`](Self::reset). If several modes
/// are possible after an event ([`may_follow`](Self::may_follow)), for example stick or slip,
/// [`decision`](Self::decision) functions select the next mode. Guards are numbered by their order in
/// [`guards`](Self::guards), and modes by their order in [`modes`](Self::modes).
///
/// ```
/// use tangency::core::hybrid::{Guard, HybridSystem, Mode};
/// use tangency::core::scalar::Scalar;
/// /// A ball above the ground, `y'' = −g`, that rebounds with the fraction `e` of its speed.
/// struct Ball;
/// impl HybridSystem for Ball {
///     fn modes(&self) -> Vec<Mode> {
///         vec![Mode::new("flight", ["height", "velocity"])]
///     }
///     fn guards(&self) -> Vec<Guard> {
///         vec![Guard::new("bounce", [0])]
///     }
///     fn parameters(&self) -> Vec<String> {
///         vec!["gravity".into(), "restitution".into()]
///     }
///     fn field<T: Scalar>(&self, _mode: usize, _t: T, x: &[T], p: &[T], f: &mut [T]) {
///         f[0] = x[1];
///         f[1] = -p[0];
///     }
///     fn guard<T: Scalar>(&self, _guard: usize, _mode: usize, _t: T, x: &[T], _p: &[T]) -> T {
///         x[0]
///     }
///     fn reset<T: Scalar>(
///         &self, _guard: usize, _modes: (usize, usize), _t: T, x: &[T], p: &[T], after: &mut [T],
///     ) {
///         after[0] = x[0];
///         after[1] = -p[1] * x[1];
///     }
///     fn next_mode(&self, _guard: usize, _mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
///         0
///     }
/// }
/// let mut after = [0.0; 2];
/// Ball.reset(0, (0, 0), 0.0, &[0.0, -2.0], &[9.81, 0.8], &mut after);
/// assert_eq!(after, [0.0, 1.6]);
/// ```
pub trait HybridSystem: Send + Sync {
    /// Returns the modes, with the names of their states.
    fn modes(&self) -> Vec<Mode>;

    /// The guards. If several guards vanish simultaneously, the event belongs to the guard that is
    /// listed first.
    fn guards(&self) -> Vec<Guard>;

    /// Returns the names of the parameters.
    fn parameters(&self) -> Vec<String>;

    /// Returns the default values of all parameters, in order; an empty list if the system has no
    /// default values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the mode in which a motion begins, given its initial state as a state of `mode`; the
    /// default is `mode`. If the state alone determines the mode, for example by the side of a
    /// surface on which the state lies, an implementation returns another mode with the same states.
    /// This method is called in searches for cycles and attractors, and for scene files, whose
    /// initial states are states of the first mode.
    fn initial_mode(&self, mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        mode
    }

    /// Computes the vector field of a mode and writes it into `f`, which has the same length as
    /// `x`.
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// Computes the value of a guard in one of its modes; the guard is positive while the mode
    /// lasts.
    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T;

    /// Computes the state just after an event that leads from the first of two modes to the second,
    /// and writes it into `after`, whose length is the number of states of the second mode. By
    /// default the state is unchanged if both modes have the same number of states; otherwise a reset
    /// must be defined.
    fn reset<T: Scalar>(
        &self,
        _guard: usize,
        _modes: (usize, usize),
        _t: T,
        x: &[T],
        _p: &[T],
        after: &mut [T],
    ) {
        match after.len() == x.len() {
            true => after.copy_from_slice(x),
            false => after.fill(T::from(f64::NAN)),
        }
    }

    /// Projects a state of a mode onto the invariant surface of the mode by one step of Newton's
    /// method; states that already lie on the surface, and derivatives along the surface, must not
    /// change. The default implementation leaves the state unchanged. The method is called only in
    /// modes with [`Mode::on_surface`].
    fn constrain<T: Scalar>(&self, _mode: usize, _t: T, _x: &mut [T], _p: &[T]) {}

    /// Returns the possible next modes after an event in a mode, in the order in which
    /// [`decision`](Self::decision) functions select a mode: the first mode whose function is
    /// positive, or the last mode if all functions are negative. The list is empty by default: no
    /// decision functions are used.
    fn may_follow(&self, _guard: usize, _mode: usize) -> Vec<usize> {
        Vec::new()
    }

    /// Computes the decision function of a possible next mode after an event; the mode is given by
    /// its index in [`may_follow`](Self::may_follow). The motion changes at zeros of a decision
    /// function, for example from slip to stick, or from crossing to sliding. Along a branch of
    /// orbits the zeros of decision functions are located as grazings. The last mode in the list has
    /// no decision function.
    ///
    /// ```
    /// use tangency::prelude::*;
    /// hybrid_system! {
    ///     /// A block pulled by a spring, `x'' = −x − F sgn x'`, that sticks where friction exceeds the pull.
    ///     struct Block [F] {
    ///         mode up [x, v] {
    ///             d/dt x = v;
    ///             d/dt v = -x - F;
    ///             // Down if the spring force exceeds friction, else at rest.
    ///             event stop: v => down { x, v: T::zero() } if x - F, stick { x };
    ///         }
    ///         mode down [x, v] {
    ///             d/dt x = v;
    ///             d/dt v = -x + F;
    ///             event stop: -v => up { x, v: T::zero() } if -x - F, stick { x };
    ///         }
    ///         mode stick [x] {
    ///             d/dt x = T::zero();
    ///         }
    ///     }
    /// }
    /// // A block that stops at 1.5 moves down; one that stops at 0.5 sticks.
    /// let next = |x: f64| Block.next_mode(0, 0, 0.0, &[x, 0.0], &[1.0]);
    /// assert_eq!((next(1.5), next(0.5)), (1, 2));
    /// ```
    fn decision<T: Scalar>(
        &self,
        _position: usize,
        _guard: usize,
        _mode: usize,
        _t: T,
        _x: &[T],
        _p: &[T],
    ) -> T {
        T::from(f64::NAN)
    }

    /// Returns the next mode after an event in a mode, given the state just before the event. By
    /// default, the [`decision`](Self::decision) functions select the mode; without modes in
    /// [`may_follow`](Self::may_follow), the mode does not change. After an accumulation of events,
    /// [`mode_after_accumulation`](Self::mode_after_accumulation) determines the next mode.
    ///
    /// If this method is implemented without decision functions, its result is compared with the
    /// itinerary at each point of a branch of orbits, and the point at which the result changes is
    /// bracketed.
    fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        let modes = self.may_follow(guard, mode);
        let Some((last, others)) = modes.split_last() else { return mode };
        let positive = |k: &usize| self.decision(*k, guard, mode, t, x, p) > 0.0;
        (0..others.len()).find(positive).map_or(*last, |k| others[k])
    }

    /// Returns the next mode after an accumulation of the events of a guard in a mode, given the
    /// state at the accumulation; the default is [`Guard::accumulates_to`].
    fn mode_after_accumulation(
        &self,
        guard: usize,
        _mode: usize,
        _t: f64,
        _x: &[f64],
        _p: &[f64],
    ) -> Option<usize> {
        self.guards()[guard].accumulates_to
    }

    /// Returns the standard name of a grazing bifurcation at `(t, x)`, such as `grazing-sliding`,
    /// which is reported with the point (`G`). By default a grazing bifurcation has no specific
    /// name.
    fn kind_of_tangency(
        &self,
        _tangency: Tangency,
        _t: f64,
        _x: &[f64],
        _p: &[f64],
    ) -> Option<&'static str> {
        None
    }

    /// Returns the widest vector registers in which [`field`](Self::field) and [`guard`](Self::guard)
    /// can be evaluated for several motions together, one motion per lane. Code that is evaluated in
    /// vector lanes must not compare numbers or convert them to real parts, since one comparison
    /// cannot be valid in all lanes; branches on the mode and on the guard are allowed. The default is
    /// `None`: motions are simulated one by one.
    ///
    /// [`LaneWidth::compiled`] is suitable for all equations that can be evaluated in lanes.
    /// [`LaneWidth::widest`] is suitable for equations that are inlined into code compiled for wide
    /// registers: `field`, `guard` and all functions that they call are `#[inline(always)]`, and each
    /// closure is called at only one place. (Other equations give correct results but take twice as
    /// long as in narrow lanes.)
    fn in_lanes(&self) -> Option<LaneWidth> {
        None
    }

    /// Returns the kind of forcing; none by default.
    fn forcing(&self) -> Forcing {
        Forcing::None
    }

    /// Returns the period of a periodic [`forcing`](Self::forcing); in an autonomous system, the unit
    /// of time in scene files.
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::one()
    }

    /// Returns the typical sizes of times and states, which are the units of tolerances; they must be
    /// given if they are far from 1.
    fn scales(&self, _p: &[f64]) -> Scales {
        Scales::default()
    }

    /// Returns the names of monitors: further scalar functions of time and state along a motion.
    /// [`measures`](Self::measures) can refer to monitors in the same way as to states.
    fn monitors(&self) -> Vec<String> {
        Vec::new()
    }

    /// Computes the value of a monitor in a mode; the monitor is given by its index in
    /// [`monitors`](Self::monitors).
    fn monitor<T: Scalar>(&self, _monitor: usize, _mode: usize, _t: T, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }

    /// Returns the named measures that branches record for orbits and that sweeps record for
    /// periods; the default is the extremes of every state, and the mean and extremes of every
    /// monitor ([`Measure::by_default`]).
    fn measures(&self) -> Vec<(String, Measure)> {
        let states = self.modes().into_iter().flat_map(|mode| mode.states).collect();
        Measure::by_default(states, self.monitors())
    }

    /// Returns the names of states that start at zero in each mode; a history shows each such state
    /// plus its values at the ends of all earlier modes of the motion.
    fn cumulative_states(&self) -> Vec<String> {
        Vec::new()
    }

    /// Computes a measure of the kind [`Measure::Ends`], given its index, from the legs of a cycle of
    /// `periods` forcing periods.
    fn measure<T: Scalar>(
        &self,
        _position: usize,
        _legs: &[Passage<T>],
        _periods: usize,
        _p: &[T],
    ) -> T {
        T::zero()
    }

    /// Returns an error for states outside the domain of a mode's vector field.
    fn domain(&self, _mode: usize, _x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }

    /// Returns an error for times and states at which a mode must not begin or end, for example on a
    /// surface to which the sliding field is not tangent. The method is called only at the start and
    /// end of a mode; [`domain`](Self::domain) is called at every integration step.
    ///
    /// # Errors
    /// [`OutOfDomain`] with the name of the quantity, its value and the remedy.
    fn domain_at_ends(
        &self,
        _mode: usize,
        _t: f64,
        _x: &[f64],
        _p: &[f64],
    ) -> Result<(), OutOfDomain> {
        Ok(())
    }
}
