//! Hybrid systems as a user states them.

use super::tangency::Tangency;
use crate::core::failure::OutOfDomain;
use crate::core::problem::{Forcing, Measure};
use crate::core::scalar::{LaneWidth, Scalar};

/// A mode of motion: a name and the names of its states, which need not be those of other modes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mode {
    /// The mode's name.
    pub name: String,
    /// The names of its states. Those that modes share are one quantity to a reader of their
    /// diagrams.
    pub states: Vec<String>,
    /// Whether its motion stays on a surface of its states, onto which
    /// [`constrain`](HybridSystem::constrain) moves states.
    pub on_surface: bool,
}

impl Mode {
    /// A mode with states.
    pub fn new<S: Into<String>>(
        name: impl Into<String>,
        states: impl IntoIterator<Item = S>,
    ) -> Self {
        let states = states.into_iter().map(Into::into).collect();
        Mode { name: name.into(), states, on_surface: false }
    }

    /// Says that its motion stays on a surface of its states, as sliding motion does. Orbits that
    /// never leave the mode close on that surface: deviations across it are lost.
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
    /// The event's name.
    pub name: String,
    /// The modes that end there.
    pub modes: Vec<usize>,
    /// The mode that follows where events of this guard accumulate, infinitely many in a finite
    /// time (complete chatter); `None` if they are not expected to.
    pub accumulates_to: Option<usize>,
    /// The shortest time in which it changes, where that is less than the field of its modes tells:
    /// steps are no longer.
    pub changes_in: Option<f64>,
    /// How many times in each period of the forcing its event comes, at equal intervals, if it comes
    /// at given times: its function is the [`time_left`] then. 0 for an event that comes where the
    /// function vanishes.
    pub per_period: usize,
}

impl Guard {
    /// A guard of some modes: an impact is one event in whichever mode it comes.
    pub fn new(name: impl Into<String>, modes: impl IntoIterator<Item = usize>) -> Self {
        let (name, modes) = (name.into(), modes.into_iter().collect());
        Guard { name, modes, accumulates_to: None, changes_in: None, per_period: 0 }
    }

    /// Says that its event comes at given times, `per_period` times in each period of the forcing. Its
    /// function must be the [`time_left`] until the nearest of these times.
    ///
    /// Flows stop at these times, and nothing is searched. A motion that begins at one of them
    /// begins just after the event.
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

    /// Whether its event comes at given times.
    pub(in crate::core) fn is_timed(&self) -> bool {
        self.per_period > 0
    }

    /// Sets the mode that follows where events accumulate.
    pub fn accumulating_to(mut self, mode: usize) -> Self {
        self.accumulates_to = Some(mode);
        self
    }

    /// Sets the shortest time in which it changes. A guard is watched in the steps of the flow, and
    /// these are as long as the field allows: one that is faster, such as a narrow slot that a slow
    /// body passes, is missed without it.
    ///
    /// ```
    /// use tangency::core::hybrid::Guard;
    /// assert_eq!(Guard::new("slot", [0]).changing_in(1e-3).changes_in, Some(1e-3));
    /// ```
    pub fn changing_in(mut self, time: f64) -> Self {
        self.changes_in = Some(time);
        self
    }

    /// Whether a mode ends there.
    pub(in crate::core) fn ends(&self, mode: usize) -> bool {
        self.modes.contains(&mode)
    }
}

/// The time left until the nearest of the times `first + n·interval`, for all integers `n`; negative
/// after that. It is the function of a guard whose event comes [at given times](Guard::at).
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

/// The scales of a hybrid system: typical sizes of times and states, by order of magnitude.
/// Tolerances are relative to them, so that a device of micrometres and microseconds may be stated
/// in metres and seconds.
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

/// One leg of a hybrid orbit, seen by its ends.
#[derive(Clone, Copy, Debug)]
pub struct Passage<'a, T> {
    /// The mode.
    pub mode: usize,
    /// The guard at which it ends; `None` if it does not end.
    pub exit: Option<usize>,
    /// The state where it begins.
    pub start: &'a [T],
    /// The state where it ends, before the event.
    pub end: &'a [T],
}

/// A hybrid system: modes, guards and resets, written once; derivatives come from automatic
/// differentiation. [`hybrid_system!`](crate::hybrid_system) states one mode by mode.
///
/// A mode lasts while all its guards are positive. The guard that vanishes first, falling, is the
/// event; of several that vanish together the one stated first counts. The state just before it is
/// `x`; motion goes on in the mode [`next_mode`](Self::next_mode), from the state that
/// [`reset`](Self::reset) gives. Where one of several modes [`may_follow`](Self::may_follow), stick
/// or slip, [`decision`](Self::decision) functions select it. Guards are numbered as
/// [`guards`](Self::guards) lists them, modes as [`modes`](Self::modes) does.
///
/// ```
/// use tangency::core::hybrid::{Guard, HybridSystem, Mode};
/// use tangency::core::scalar::Scalar;
/// /// A ball above the ground, `y'' = −g`, thrown back with the part `e` of its speed.
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

    /// The guards. Of those that vanish together the first one listed is the event.
    fn guards(&self) -> Vec<Guard>;

    /// The names of the parameters.
    fn parameters(&self) -> Vec<String>;

    /// The default values of all parameters, in order; empty if there are none.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The mode in which motion begins whose start is given as a state of a mode: by default that
    /// mode. Where the state alone decides, as on which side of a surface it is, another mode with
    /// the same states. Searches for cycles and attractors ask it of their starts, and so do
    /// scenes, which give them as states of the first mode.
    fn initial_mode(&self, mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        mode
    }

    /// The field of a mode, written into `f` (as long as `x`).
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// A guard in one of its modes, positive while the mode lasts.
    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T;

    /// The state just after an event that leads from the first of two modes to the second, written
    /// into `after` (as long as the states of the second). By default the state before it, if both
    /// modes have as many states; between others a reset must be stated.
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

    /// Moves a state of a mode onto the surface on which the mode's motion stays, by one step of
    /// Newton's method; states on the surface, and derivatives along it, stay what they are. By
    /// default nothing is moved. Called for modes that say so ([`Mode::on_surface`]).
    fn constrain<T: Scalar>(&self, _mode: usize, _t: T, _x: &mut [T], _p: &[T]) {}

    /// The modes that may follow an event in a mode, in the order in which
    /// [`decision`](Self::decision) functions select them: the first one whose function is
    /// positive, the last one if none is. Empty by default: no functions are known.
    fn may_follow(&self, _guard: usize, _mode: usize) -> Vec<usize> {
        Vec::new()
    }

    /// The function that selects a mode, by its position among those that
    /// [`may_follow`](Self::may_follow) an event: its zeros are where motion starts to stick
    /// instead of slip, to slide instead of cross. Along a branch of orbits they are located as
    /// grazings. Not called for the last mode.
    ///
    /// ```
    /// use tangency::prelude::*;
    /// hybrid_system! {
    ///     /// A block pulled by a spring, `x'' = −x − F sgn x'`, that sticks where friction holds it.
    ///     struct Block [F] {
    ///         mode up [x, v] {
    ///             d/dt x = v;
    ///             d/dt v = -x - F;
    ///             // Down where the spring pulls harder than friction holds, else at rest.
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
    /// // It stops at 1.5 and goes down, at 0.5 and sticks.
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

    /// The mode that follows an event in a mode, given the state just before it: by default what
    /// the [`decision`](Self::decision) functions select, and the same mode where none
    /// [`may_follow`](Self::may_follow). Where events accumulate,
    /// [`mode_after_accumulation`](Self::mode_after_accumulation) decides again.
    ///
    /// Where it is stated without decision functions it is compared with the itinerary at each
    /// point of a branch of orbits, and the place where it changes is bracketed.
    fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        let modes = self.may_follow(guard, mode);
        let Some((last, others)) = modes.split_last() else { return mode };
        let positive = |k: &usize| self.decision(*k, guard, mode, t, x, p) > 0.0;
        (0..others.len()).find(positive).map_or(*last, |k| others[k])
    }

    /// The mode that follows where the events of a guard in a mode accumulate, given the state
    /// there: by default [`Guard::accumulates_to`].
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

    /// What the field calls a place `(t, x)` where an orbit grazes, such as `grazing-sliding`: it
    /// is shown beside the point (`G`). By default it has no name of its own.
    fn kind_of_tangency(
        &self,
        _tangency: Tangency,
        _t: f64,
        _x: &[f64],
        _p: &[f64],
    ) -> Option<&'static str> {
        None
    }

    /// The widest registers in which [`field`](Self::field) and [`guard`](Self::guard) may be
    /// evaluated for several motions at once, each in a lane: what they compute with must not be
    /// compared, nor asked for its real part, since one decision cannot be right in all lanes.
    /// Modes and guards may be told apart. By default `None`: motions are followed one by one.
    ///
    /// [`LaneWidth::compiled`] is for any such equations. [`LaneWidth::widest`] is for those that
    /// become part of what is compiled for wide registers: `field`, `guard` and all functions that
    /// they call are `#[inline(always)]`, and closures are called once. (Others are right there,
    /// but take twice as long as in narrow lanes.)
    fn in_lanes(&self) -> Option<LaneWidth> {
        None
    }

    /// The forcing: by default there is none.
    fn forcing(&self) -> Forcing {
        Forcing::None
    }

    /// The period of a periodic [`forcing`](Self::forcing); without one, the unit of time in
    /// scenes.
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::one()
    }

    /// Typical sizes of times and states, which tolerances are relative to: to be stated where they
    /// are far from 1.
    fn scales(&self, _p: &[f64]) -> Scales {
        Scales::default()
    }

    /// The names of monitors: further scalars of a motion, which [`measures`](Self::measures) may
    /// name as they name states.
    fn monitors(&self) -> Vec<String> {
        Vec::new()
    }

    /// The value of a monitor in a mode, by its position among [`monitors`](Self::monitors).
    fn monitor<T: Scalar>(&self, _monitor: usize, _mode: usize, _t: T, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }

    /// What is recorded of orbits along branches and of periods in sweeps, by name: by default the
    /// extremes of every state, and mean and extremes of every monitor ([`Measure::by_default`]).
    fn measures(&self) -> Vec<(String, Measure)> {
        let states = self.modes().into_iter().flat_map(|mode| mode.states).collect();
        Measure::by_default(states, self.monitors())
    }

    /// The names of states that begin at zero in every mode they are in: histories show their sum.
    fn cumulative_states(&self) -> Vec<String> {
        Vec::new()
    }

    /// The number at a position that [`Measure::Ends`] names, from the legs of a cycle that takes
    /// so many periods of the forcing.
    fn measure<T: Scalar>(
        &self,
        _position: usize,
        _legs: &[Passage<T>],
        _periods: usize,
        _p: &[T],
    ) -> T {
        T::zero()
    }

    /// Refuses states at which a mode's field has no meaning.
    ///
    /// # Errors
    /// [`OutOfDomain`] with the quantity, its value and the domain.
    fn domain(&self, _mode: usize, _x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }

    /// Refuses places at which a mode must not begin or end, as on a surface that a field of
    /// sliding motion leaves. It is asked there only; [`domain`](Self::domain) is asked at every
    /// step.
    ///
    /// # Errors
    /// [`OutOfDomain`] with the quantity, its value and what to change.
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
