//! Complete chatter: accumulation of the events of one guard in a finite time.
//!
//! Between impacts on a surface that the motion is pressed against, with acceleration `−a`, the
//! approach speeds `v_n` and the intervals `Δ_n = t_n − t_{n−1}` shrink by a ratio `r = v_n/v_{n−1}`
//! that converges, so that the events accumulate near
//!
//! ```text
//!     E_n = t_n + Δ_n r/(1 − r),
//! ```
//!
//! with an error that shrinks as `r^{2n}` if the acceleration varies. Two estimates give the better
//! one `E_n' = E_n + (E_n − E_{n−1}) r²/(1 − r²)`, and two of the latter give
//! `E_n' + (E_n' − E'_{n−1}) r³/(1 − r³)`, with an error like `r^{4n}`. The state at the accumulation
//! is extrapolated in the same way.

use crate::core::scalar::Scalar;

/// (H) Chatter is extrapolated to its end if the ratios of successive intervals and of approach
/// speeds differ by less than this fraction: they approach one limit.
const AGREEMENT: f64 = 0.1;
/// (H) Intervals shorter than this fraction of the tolerance count as zero: the events are
/// simultaneous.
const INSTANT: f64 = 1e-5;

/// The accumulation of a guard's events, if any.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Accumulation<T> {
    /// No accumulation so far.
    None,
    /// An accumulation at the last event itself, which is simultaneous with the previous one.
    Here,
    /// An accumulation at this time, in the state that the series stores.
    At(T),
}

/// The last events of one guard.
#[derive(Clone, Debug)]
pub(super) struct Series<T> {
    /// The number of events in geometric succession.
    pub events: usize,
    /// The time of the last event.
    time: T,
    /// The last interval.
    pub interval: T,
    /// The last approach speed.
    speed: T,
    /// The last ratio of approach speeds.
    pub ratio: T,
    /// The state before the last event.
    state: Vec<T>,
    /// The accumulation estimated from the events so far by each of the formulas: time and state.
    estimates: [(T, Vec<T>); 3],
    work: [(T, Vec<T>); 2],
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
            estimates: std::array::from_fn(|_| (zero, Vec::new())),
            work: std::array::from_fn(|_| (zero, Vec::new())),
        }
    }

    /// Adds an event, given its time, the approach speed, and the state before it. A series whose
    /// remainder is shorter than the tolerance ends here.
    pub fn push(&mut self, time: T, speed: T, state: &[T], tolerance: f64) -> Accumulation<T> {
        let (interval, ratio) = (time - self.time, speed / self.speed);
        let known = self.events;
        self.events = if known > 0 && self.continues(interval, ratio) { known + 1 } else { 1 };
        let at_once = known > 0 && interval.real() <= INSTANT * tolerance;
        let mut accumulation = if at_once { Accumulation::Here } else { Accumulation::None };
        if self.events > 1 {
            self.estimate(time, ratio, state);
            let rest = interval * rest(ratio);
            if self.events > 3 && rest.real() <= tolerance {
                accumulation = Accumulation::At(self.estimates[2].0);
            }
        }
        (self.time, self.interval, self.speed, self.ratio) = (time, interval, speed, ratio);
        state.clone_into(&mut self.state);
        accumulation
    }

    /// The state at the accumulation.
    pub fn limit(&self) -> &[T] {
        &self.estimates[2].1
    }

    /// Whether an event continues the series.
    fn continues(&self, interval: T, ratio: T) -> bool {
        let r = ratio.real();
        let agrees = (interval / self.interval).real() - r;
        r > 0.0 && r < 1.0 && (self.events < 2 || agrees.abs() <= AGREEMENT * r)
    }

    /// Estimates the accumulation by each formula for which there are enough events.
    fn estimate(&mut self, time: T, ratio: T, state: &[T]) {
        let Series { work: [new, old], estimates, .. } = self;
        (new.0, old.0) = (time, self.time);
        state.clone_into(&mut new.1);
        old.1.clone_from(&self.state);
        let mut power = ratio;
        for (k, estimate) in estimates.iter_mut().enumerate() {
            if self.events > k + 1 {
                let rest = rest(power);
                new.0 = extrapolate(new.0, old.0, rest);
                let states = new.1.iter_mut().zip(&old.1);
                states.for_each(|(new, old)| *new = extrapolate(*new, *old, rest));
            }
            std::mem::swap(old, estimate);
            estimate.0 = new.0;
            estimate.1.clone_from(&new.1);
            power *= ratio;
        }
    }
}

/// The sum of all later terms of a geometric sequence, in units of this one.
fn rest<T: Scalar>(ratio: T) -> T {
    ratio / (T::one() - ratio)
}

/// The limit of a geometric sequence from its last two terms, with `rest = r/(1 − r)`.
fn extrapolate<T: Scalar>(new: T, old: T, rest: T) -> T {
    new + (new - old) * rest
}
