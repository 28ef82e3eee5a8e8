//! Why a hybrid motion cannot be followed.

use crate::core::failure::FlowError;
use crate::core::ode::SettingsError;

/// Why a hybrid motion ends before its time.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HybridError {
    /// A setting of the flow has no meaning.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The time in which a guard changes is no time.
    #[error(
        "the guard {guard} is said to change in a time of {time} (`Guard::changing_in`): it must be above 0"
    )]
    ChangesIn {
        /// The guard.
        guard: String,
        /// The time.
        time: f64,
    },
    /// A state or parameters of another length than the mode's.
    #[error("{found} {what} are given, but mode {mode} has {expected}")]
    Length {
        /// What is given: `states` or `parameters`.
        what: &'static str,
        /// The mode.
        mode: String,
        /// How many.
        found: usize,
        /// How many there are.
        expected: usize,
    },
    /// There is no mode of this number.
    #[error(
        "at t = {time:.9e}, {after}motion is to go on in mode {mode}, but there are {modes} modes, from 0 on: \
         name one of them"
    )]
    NoMode {
        /// When.
        time: f64,
        /// The mode asked for.
        mode: usize,
        /// How many there are.
        modes: usize,
        /// After which event, in words; empty at the start.
        after: String,
    },
    /// Events happen forwards in time only.
    #[error("a hybrid motion cannot be followed for a time of {0}: resets have no inverse")]
    Backward(f64),
    /// A guard is negative where its mode begins.
    #[error(
        "at t = {time:.9e}, {after}mode {mode} begins where its guard {guard} is {value:.3e}, though it lasts \
         only while guards are positive: start elsewhere, or let another mode follow"
    )]
    Outside {
        /// When.
        time: f64,
        /// The mode.
        mode: String,
        /// The guard.
        guard: String,
        /// Its value.
        value: f64,
        /// After which event, in words; empty at the start.
        after: String,
    },
    /// No state follows an event between modes of different states.
    #[error(
        "at t = {time:.9e} the event {guard} leads from mode {mode}, with {before} states, to mode {next}, with {after}, and gives it none \
         of them: state the reset (`HybridSystem::reset`)"
    )]
    NoReset {
        /// When.
        time: f64,
        /// The event.
        guard: String,
        /// The mode before it.
        mode: String,
        /// The mode behind it.
        next: String,
        /// How many states the mode before it has.
        before: usize,
        /// How many the mode behind it has.
        after: usize,
    },
    /// The flow of a mode ends.
    #[error("in mode {mode} the motion ends: {source}")]
    Flow {
        /// The mode.
        mode: String,
        /// Why.
        source: FlowError,
    },
    /// Events accumulate, and no mode is named that follows.
    #[error(
        "events of guard {guard} accumulate at t = {time:.9e}: in mode {mode} {events} of them came at intervals \
         that shrink by {ratio:.4}, the last of {interval:.1e}; name the mode in which motion goes on there \
         (`Guard::accumulating_to`)"
    )]
    Accumulation {
        /// Where they accumulate.
        time: f64,
        /// The mode that they end.
        mode: String,
        /// The guard.
        guard: String,
        /// How many were followed.
        events: usize,
        /// The ratio of successive approach speeds.
        ratio: f64,
        /// The last interval.
        interval: f64,
    },
    /// Events follow each other without progress of time.
    #[error(
        "at t = {time:.9e} time stands still: {events} events came within {span:.1e}, the last of guard {guard} \
         in mode {mode}; a reset must not land where a guard falls at once"
    )]
    Standstill {
        /// When.
        time: f64,
        /// The mode before the last event.
        mode: String,
        /// The guard of the last event.
        guard: String,
        /// How many events.
        events: usize,
        /// Within which time.
        span: f64,
    },
    /// Events become ever more frequent.
    #[error(
        "at t = {time:.9e} events become ever more frequent: the intervals between the last {events} shrink to {interval:.1e}; \
         the last event belongs to guard {guard} in mode {mode}. The motion reaches a state only after infinitely many events: \
         add a mode for this state (`next`), or separate the events by a hysteresis"
    )]
    Crowded {
        /// When.
        time: f64,
        /// The mode before the last event.
        mode: String,
        /// The guard of the last event.
        guard: String,
        /// How many events.
        events: usize,
        /// The mean interval of the last ones.
        interval: f64,
    },
}
