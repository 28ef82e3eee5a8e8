//! Complete chatter: events of one guard that accumulate in a finite time.
//!
//! Between impacts on a surface that the motion is pressed against, with acceleration `−a`, the approach speeds
//! `v_n` and the intervals `Δ_n = t_n − t_{n−1}` shrink by a ratio `r = v_n/v_{n−1}` that settles, so that the
//! events accumulate near
//!
//! ```text
//!     E_n = t_n + Δ_n r/(1 − r),
//! ```
//!
//! with an error that shrinks as `r^{2n}` where the acceleration changes: two estimates give the better one
//! `E_n + (E_n − E_{n−1}) r²/(1 − r²)`. The state at the accumulation is extrapolated alike.

use crate::core::scalar::Scalar;

/// Ratios of intervals and of approach speeds agree to this part of them where chatter is followed to its end.
const AGREEMENT: f64 = 0.1;
/// An interval of this part of the tolerance is none: events happen at once.
const INSTANT: f64 = 1e-5;

/// Where the events of a guard accumulate, if they do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Accumulation<T> {
    /// Nowhere as yet.
    None,
    /// At the last event itself: it came at once after the one before.
    Here,
    /// At this time, in the state that the series keeps.
    At(T),
}

/// The last events of one guard.
#[derive(Clone, Debug)]
pub(super) struct Series<T> {
    /// How many events have come in geometric succession.
    pub events: usize,
    /// The time of the last one.
    time: T,
    /// The last interval.
    pub interval: T,
    /// The last approach speed.
    speed: T,
    /// The last ratio of approach speeds.
    pub ratio: T,
    /// The state before the last one.
    state: Vec<T>,
    /// Where the last event alone would have them accumulate: time and state.
    estimate: (T, Vec<T>),
    /// The state at the accumulation.
    pub limit: Vec<T>,
}

impl<T: Scalar> Series<T> {
    pub fn new() -> Self {
        let zero = T::zero();
        Series {
            events: 0,
            time: zero,
            interval: zero,
            speed: zero,
            ratio: zero,
            state: Vec::new(),
            estimate: (zero, Vec::new()),
            limit: Vec::new(),
        }
    }

    /// Takes in an event, the time of it, the approach speed, and the state before it; the rest of a series
    /// that takes no longer than the tolerance need not be followed.
    pub fn push(&mut self, time: T, speed: T, state: &[T], tolerance: f64) -> Accumulation<T> {
        let (interval, ratio) = (time - self.time, speed / self.speed);
        let known = self.events;
        self.events = if known > 0 && self.continues(interval, ratio) { known + 1 } else { 1 };
        let at_once = known > 0 && interval.real() <= INSTANT * tolerance;
        let mut accumulation = if at_once { Accumulation::Here } else { Accumulation::None };
        if self.events > 1 {
            let rest = ratio / (T::one() - ratio);
            let limit = time + interval * rest;
            if self.events > 3 && (interval * rest).real() <= tolerance {
                accumulation = Accumulation::At(self.extrapolated(limit, rest, ratio, state));
            }
            let states = state.iter().zip(&self.state);
            self.estimate.1.clear();
            self.estimate.1.extend(states.map(|(new, old)| extrapolate(*new, *old, rest)));
            self.estimate.0 = limit;
        }
        (self.time, self.interval, self.speed, self.ratio) = (time, interval, speed, ratio);
        self.state.clear();
        self.state.extend_from_slice(state);
        accumulation
    }

    /// Whether an event goes on with the series.
    fn continues(&self, interval: T, ratio: T) -> bool {
        let r = ratio.real();
        let agrees = (interval / self.interval).real() - r;
        r > 0.0 && r < 1.0 && (self.events < 2 || agrees.abs() <= AGREEMENT * r)
    }

    /// The time of the accumulation, and the state into `limit`, from this estimate and the one before.
    fn extrapolated(&mut self, limit: T, rest: T, ratio: T, state: &[T]) -> T {
        let square = ratio * ratio;
        let rest_of_estimates = square / (T::one() - square);
        let states = state.iter().zip(&self.state).zip(&self.estimate.1);
        self.limit.clear();
        self.limit.extend(states.map(|((new, old), before)| {
            extrapolate(extrapolate(*new, *old, rest), *before, rest_of_estimates)
        }));
        extrapolate(limit, self.estimate.0, rest_of_estimates)
    }
}

/// The limit of a geometric sequence from its last two members, with `rest = r/(1 − r)`.
fn extrapolate<T: Scalar>(new: T, old: T, rest: T) -> T {
    new + (new - old) * rest
}
