//! Hybrid systems as users define them.

use super::tangency::Tangency;
use crate::core::failure::OutOfDomain;
use crate::core::problem::{Forcing, Measure};
use crate::core::scalar::{LaneWidth, Scalar};

/// A mode of motion: a name and the names of its states, which can differ from mode to mode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mode {
    /// The name of the mode.
    pub name: String,
    /// The names of the mode's states. Modes that share a name share a quantity in diagrams.
    pub states: Vec<String>,
    /// Whether motion in the mode stays on a surface, onto which
    /// [`constrain`](HybridSystem::constrain) projects states.
    pub on_surface: bool,
}

impl Mode {
    /// Creates a mode with states.
    pub fn new<S: Into<String>>(
        name: impl Into<String>,
        states: impl IntoIterator<Item = S>,
    ) -> Self {
        let states = states.into_iter().map(Into::into).collect();
        Mode { name: name.into(), states, on_surface: false }
    }

    /// Declares that motion in the mode stays on a surface, as sliding motion does. Orbits that never
    /// leave the mode close on that surface: deviations across it are lost.
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

/// A surface at which modes end.
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// The name of the event.
    pub name: String,
    /// The modes that the event ends.
    pub modes: Vec<usize>,
    /// The mode that follows an accumulation of events of this guard, infinitely many in a finite time
    /// (complete chatter); `None` if no accumulation is expected.
    pub accumulates_to: Option<usize>,
    /// The shortest time in which the guard changes, if shorter than the time scale of the field: an
    /// upper bound of steps.
    pub changes_in: Option<f64>,
    /// The number of events in each period of the forcing, at equal intervals, for an event at given
    /// times; the guard is then the [`time_left`]. 0 for an event at zeros of the guard.
    pub per_period: usize,
}

impl Guard {
    /// Creates a guard of some modes: an impact is one event in all modes in which it can occur.
    pub fn new(name: impl Into<String>, modes: impl IntoIterator<Item = usize>) -> Self {
        let (name, modes) = (name.into(), modes.into_iter().collect());
        Guard { name, modes, accumulates_to: None, changes_in: None, per_period: 0 }
    }

    /// Declares an event at given times, `per_period` times in each period of the forcing. The guard
    /// must be the [`time_left`] until the nearest of these times.
    ///
    /// Flows stop exactly at these times, without a search. A motion that begins at one of them begins
    /// just after the event.
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

    /// Sets the mode that follows an accumulation of events.
    pub fn accumulating_to(mut self, mode: usize) -> Self {
        self.accumulates_to = Some(mode);
        self
    }

    /// Sets the shortest time in which the guard changes. Guards are evaluated in the steps of the
    /// flow, which are as long as the field allows: without this bound, a faster guard, such as a
    /// narrow slot that a slow body passes, is missed.
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

/// The time left until the nearest of the times `first + n·interval`, for all integers `n`; negative
/// after that time. Used as the guard of an event [at given times](Guard::at).
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

/// The scales of a hybrid system: typical sizes of times and states, by order of magnitude. Tolerances
/// are relative to these sizes, so that a device of micrometres and microseconds can be described in
/// metres and seconds.
///
/// ```
/// use tangency::core::hybrid::Scales;
/// let scales = Scales::default().time(1e-6).state("displacement", 1e-9).state("velocity", 1e-3);
/// assert_eq!((scales.time, scales.states.len()), (Some(1e-6), 2));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scales {
    /// The scale of time; by default the time in which the phase of the forcing grows by 1, and 1
    /// without forcing.
    pub time: Option<f64>,
    /// Scales of states by name; 1 by default.
    pub states: Vec<(String, f64)>,
}

impl Scales {
    /// Sets the scale of time.
    pub fn time(mut self, scale: f64) -> Self {
        self.time = Some(scale);
        self
    }

    /// Sets the scale of a state.
    pub fn state(mut self, name: impl Into<String>, scale: f64) -> Self {
        self.states.push((name.into(), scale));
        self
    }

    /// The scale of a state.
    pub(super) fn of(&self, state: &str) -> f64 {
        self.states.iter().find(|(name, _)| name == state).map_or(1.0, |(_, scale)| *scale)
    }
}

/// One leg of a hybrid orbit, given by its ends.
#[derive(Clone, Copy, Debug)]
pub struct Passage<'a, T> {
    /// The mode.
    pub mode: usize,
    /// The guard at which the leg ends; `None` if it does not end.
    pub exit: Option<usize>,
    /// The state at the start.
    pub start: &'a [T],
    /// The state at the end, before the event.
    pub end: &'a [T],
}

/// A hybrid system: modes, guards and resets, written once; derivatives come from automatic
/// differentiation. [`hybrid_system!`](crate::hybrid_system) defines a system mode by mode.
///
/// A mode lasts while all its guards are positive. The first guard that falls to zero causes an event;
/// of several simultaneous ones, the one defined first counts. From the state `x` just before the
/// event, motion continues in the mode [`next_mode`](Self::next_mode), from the state computed by
/// [`reset`](Self::reset). If several modes [`may_follow`](Self::may_follow), such as stick or slip,
/// [`decision`](Self::decision) functions select one. Guards are numbered as in
/// [`guards`](Self::guards), modes as in [`modes`](Self::modes).
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
    /// The modes, with the names of their states.
    fn modes(&self) -> Vec<Mode>;

    /// The guards. Of several simultaneous ones, the first one listed is the event.
    fn guards(&self) -> Vec<Guard>;

    /// The names of the parameters.
    fn parameters(&self) -> Vec<String>;

    /// The default values of all parameters, in order; empty without default values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The mode in which a motion begins, given its initial state as a state of `mode`: by default
    /// `mode`. If the state alone decides, for example by the side of a surface on which it lies,
    /// another mode with the same states. Used by searches for cycles and attractors, and by scenes,
    /// which give initial states in the first mode.
    fn initial_mode(&self, mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        mode
    }

    /// Computes the field of a mode and writes it into `f` (of the same length as `x`).
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// Computes a guard in one of its modes; the guard is positive while the mode lasts.
    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T;

    /// Computes the state just after an event that leads from the first of two modes to the second,
    /// and writes it into `after` (as long as the states of the second mode). By default the state is
    /// unchanged if both modes have equally many states; otherwise a reset must be defined.
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
    /// method; states on the surface, and derivatives along it, are unchanged. By default does
    /// nothing. Called only for modes with [`Mode::on_surface`].
    fn constrain<T: Scalar>(&self, _mode: usize, _t: T, _x: &mut [T], _p: &[T]) {}

    /// The possible next modes after an event in a mode, in the order in which
    /// [`decision`](Self::decision) functions select them: the first one whose function is positive,
    /// or the last one if all are negative. Empty by default: there are no decision functions.
    fn may_follow(&self, _guard: usize, _mode: usize) -> Vec<usize> {
        Vec::new()
    }

    /// Computes the function that selects a mode, by the mode's position among those that
    /// [`may_follow`](Self::may_follow) an event. At its zeros motion changes, for example from slip
    /// to stick, or from crossing to sliding. Along a branch of orbits these zeros are located as
    /// grazings. Not called for the last mode.
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

    /// The next mode after an event in a mode, given the state just before it: by default the mode
    /// that the [`decision`](Self::decision) functions select, and the same mode if no modes
    /// [`may_follow`](Self::may_follow). After an accumulation of events,
    /// [`mode_after_accumulation`](Self::mode_after_accumulation) decides.
    ///
    /// If this method is implemented without decision functions, its result is compared with the
    /// itinerary at each point of a branch of orbits, and the place of a change is bracketed.
    fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        let modes = self.may_follow(guard, mode);
        let Some((last, others)) = modes.split_last() else { return mode };
        let positive = |k: &usize| self.decision(*k, guard, mode, t, x, p) > 0.0;
        (0..others.len()).find(positive).map_or(*last, |k| others[k])
    }

    /// The next mode after an accumulation of the events of a guard in a mode, given the state there:
    /// by default [`Guard::accumulates_to`].
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

    /// The standard name of a grazing at `(t, x)`, such as `grazing-sliding`, shown with the point
    /// (`G`). By default the grazing has no name of its own.
    fn kind_of_tangency(
        &self,
        _tangency: Tangency,
        _t: f64,
        _x: &[f64],
        _p: &[f64],
    ) -> Option<&'static str> {
        None
    }

    /// The widest registers in which [`field`](Self::field) and [`guard`](Self::guard) can be
    /// evaluated for several motions together, each in a lane. Numbers must then not be compared or
    /// converted to real parts, since one decision cannot be valid in all lanes; branches on modes and
    /// guards are allowed. By default `None`: motions are simulated one by one.
    ///
    /// [`LaneWidth::compiled`] suits all such equations. [`LaneWidth::widest`] suits equations that
    /// are inlined into code compiled for wide registers: `field`, `guard` and all functions that they
    /// call are `#[inline(always)]`, and closures are called once. (Other equations give correct
    /// results but take twice as long as in narrow lanes.)
    fn in_lanes(&self) -> Option<LaneWidth> {
        None
    }

    /// The forcing; by default none.
    fn forcing(&self) -> Forcing {
        Forcing::None
    }

    /// The period of a periodic [`forcing`](Self::forcing); for an autonomous system, the unit of time
    /// in scenes.
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::one()
    }

    /// Typical sizes of times and states, used as units of tolerances; needed if they are far from 1.
    fn scales(&self, _p: &[f64]) -> Scales {
        Scales::default()
    }

    /// The names of monitors: further scalars of a motion. [`measures`](Self::measures) can refer to
    /// monitors as to states.
    fn monitors(&self) -> Vec<String> {
        Vec::new()
    }

    /// Computes a monitor in a mode, by its position among [`monitors`](Self::monitors).
    fn monitor<T: Scalar>(&self, _monitor: usize, _mode: usize, _t: T, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }

    /// The measures, by name, that branches record for orbits, and sweeps for periods: by default the
    /// extremes of every state, and the mean and extremes of every monitor ([`Measure::by_default`]).
    fn measures(&self) -> Vec<(String, Measure)> {
        let states = self.modes().into_iter().flat_map(|mode| mode.states).collect();
        Measure::by_default(states, self.monitors())
    }

    /// The names of states that start at zero in each mode; histories show their accumulated sum.
    fn cumulative_states(&self) -> Vec<String> {
        Vec::new()
    }

    /// Computes the number with an index that [`Measure::Ends`] refers to, from the legs of a cycle of
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

    /// Rejects states outside the domain of a mode's field.
    fn domain(&self, _mode: usize, _x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }

    /// Rejects places at which a mode must not begin or end, for example on a surface that the sliding
    /// field leaves. Called only there; [`domain`](Self::domain) is called at every step.
    ///
    /// # Errors
    /// [`OutOfDomain`] with the quantity, its value and the remedy.
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
