//! Errors of hybrid simulations.

use crate::core::failure::FlowError;
use crate::core::ode::SettingsError;

/// The reason why a hybrid motion ends early.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum HybridError {
    /// A setting of the simulation is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Settings(#[from] SettingsError),
    /// The shortest time in which a guard changes, given by the system, is not positive.
    #[error(
        "the shortest time in which the guard {guard} changes (`Guard::changing_in`) is {time}, \
         but must be above 0"
    )]
    ChangesIn {
        /// The guard.
        guard: String,
        /// The duration.
        time: f64,
    },
    /// The number of states or parameters differs from the number that the mode requires.
    #[error("{found} {what} are given, but mode {mode} has {expected} {what}")]
    Length {
        /// The quantities whose number is wrong: `states` or `parameters`.
        what: &'static str,
        /// The mode.
        mode: String,
        /// The given number.
        found: usize,
        /// The required number.
        expected: usize,
    },
    /// The mode after an event, or at the start, does not exist.
    #[error(
        "at t = {time:.9e}, {after}the next mode has the number {mode}, but the system has only \
         {modes} modes, numbered from 0"
    )]
    NoMode {
        /// The time.
        time: f64,
        /// The requested mode.
        mode: usize,
        /// The number of modes of the system.
        modes: usize,
        /// A description of the preceding event; empty at the start of the motion.
        after: String,
    },
    /// The duration of the simulation is negative, but motion cannot be simulated backwards since
    /// resets have no inverse.
    #[error(
        "a hybrid motion cannot be simulated for the negative duration {0}: resets have no inverse"
    )]
    Backward(f64),
    /// A guard is negative at the start of a mode.
    #[error(
        "at t = {time:.9e}, {after}mode {mode} begins with the guard {guard} = {value:.3e}, but a \
         mode lasts only while all its guards are positive"
    )]
    #[diagnostic(help("start at another state, or let the event lead to another mode"))]
    Outside {
        /// The time.
        time: f64,
        /// The mode.
        mode: String,
        /// The guard.
        guard: String,
        /// The value of the negative guard.
        value: f64,
        /// A description of the preceding event; empty at the start of the motion.
        after: String,
    },
    /// An event leads to a mode with a different number of states, but its reset is not defined.
    #[error(
        "at t = {time:.9e} the event {guard} leads from mode {mode} with {before} states to mode \
         {next} with {after} states, but the event has no reset"
    )]
    #[diagnostic(help("define a reset (`HybridSystem::reset`)"))]
    NoReset {
        /// The time.
        time: f64,
        /// The event.
        guard: String,
        /// The mode before the event.
        mode: String,
        /// The mode after the event.
        next: String,
        /// The number of states of the mode before the event.
        before: usize,
        /// The number of states of the mode after the event.
        after: usize,
    },
    /// The integration of the flow of a mode ends early.
    #[error("the motion ends early in mode {mode}: {source}")]
    #[diagnostic(forward(source))]
    Flow {
        /// The mode.
        mode: String,
        /// The reason.
        source: FlowError,
    },
    /// The solution of a field without modes and events grows without bound.
    #[error("the solution grows without bound: at t = {time:.9e}, {state} = {value:.3e}")]
    #[diagnostic(help("simulate for a shorter time, or start at another state"))]
    Unbounded {
        /// The time at which the integration fails, because no further step succeeds.
        time: f64,
        /// The largest state.
        state: String,
        /// The value of the state that grows without bound, after the last step.
        value: f64,
    },
    /// Events accumulate, and the guard does not define a mode for the motion after the
    /// accumulation.
    #[error(
        "events of guard {guard} accumulate at t = {time:.9e}: in mode {mode} {events} events occurred at \
         intervals that shrink by {ratio:.4}, the last one of {interval:.1e}"
    )]
    #[diagnostic(help(
        "name the mode that follows the accumulation of events (`accumulates_to`, in Rust `Guard::accumulating_to`)"
    ))]
    Accumulation {
        /// The time of the accumulation.
        time: f64,
        /// The mode in which the events accumulate.
        mode: String,
        /// The guard.
        guard: String,
        /// The number of simulated events before the accumulation.
        events: usize,
        /// The ratio of the last two approach speeds.
        ratio: f64,
        /// The last interval.
        interval: f64,
    },
    /// Too many events occur without an advance of time.
    #[error(
        "at t = {time:.9e} the time does not advance: {events} events occurred within a time of \
         {span:.1e}, the last one at the guard {guard} in mode {mode}; a reset must not lead to a \
         state at which a guard immediately falls to zero"
    )]
    Standstill {
        /// The time.
        time: f64,
        /// The mode before the last event.
        mode: String,
        /// The guard of the last event.
        guard: String,
        /// The number of events that occurred without an advance of time.
        events: usize,
        /// The time between the first and the last of these events.
        span: f64,
    },
    /// Events become ever more frequent, so that the simulation is abandoned.
    #[error(
        "at t = {time:.9e} events become ever more frequent: the intervals between the last {events} shrink to \
         {interval:.1e}; the last event belongs to guard {guard} in mode {mode}. The motion reaches a state \
         only after infinitely many events"
    )]
    #[diagnostic(help(
        "add a mode for this state (`next`), or separate the events by a hysteresis"
    ))]
    Crowded {
        /// The time.
        time: f64,
        /// The mode before the last event.
        mode: String,
        /// The guard of the last event.
        guard: String,
        /// The number of successive events, up to the last one, between which the intervals shrink.
        events: usize,
        /// The mean interval between the last events.
        interval: f64,
    },
}
