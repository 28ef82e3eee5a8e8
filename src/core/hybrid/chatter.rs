//! Complete chatter: accumulation of the events of one guard in a finite time.
//!
//! A motion is pressed against a surface with acceleration `−a`: between impacts, the approach
//! speeds `v_n` and the intervals `Δ_n = t_n − t_{n−1}` shrink by a ratio `r = v_n/v_{n−1}` that
//! converges. The time at which the events accumulate is estimated by `E_n`:
//!
//! ```text
//!     E_n = t_n + Δ_n r/(1 − r).
//! ```
//!
//! The error of `E_n` shrinks as `r^{2n}` if the acceleration varies. Two successive estimates give
//! the better estimate `E_n' = E_n + (E_n − E_{n−1}) r²/(1 − r²)`, and two successive values of
//! `E_n'` give the estimate `E_n' + (E_n' − E'_{n−1}) r³/(1 − r³)`, with an error like `r^{4n}`. The
//! state at the accumulation is extrapolated by the same formulas.

use crate::core::scalar::Scalar;

/// Heuristic: Chatter is extrapolated to its accumulation if the ratio of successive intervals and
/// the ratio of successive approach speeds differ by less than this fraction, since both ratios
/// have the same limit.
const AGREEMENT: f64 = 0.1;
/// Heuristic: the fraction of the tolerance below which an interval between events counts as zero,
/// so that the events are simultaneous.
const INSTANT: f64 = 1e-5;

/// The accumulation of a guard's events, if the series of events ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Accumulation<T> {
    /// The events have not accumulated so far.
    None,
    /// The events accumulate at the last event itself, which is simultaneous with the previous one.
    Here,
    /// The events accumulate at the given time, in the state [`Series::limit`].
    At(T),
}

/// The last events of one guard, which may accumulate.
#[derive(Clone, Debug)]
pub(super) struct Series<T> {
    /// The number of successive events whose intervals form a geometric progression.
    pub events: usize,
    /// The time of the last event in the series.
    time: T,
    /// The last interval.
    pub interval: T,
    /// The approach speed at the last event.
    speed: T,
    /// The ratio of the last two approach speeds.
    pub ratio: T,
    /// The state just before the last event.
    state: Vec<T>,
    /// The time and state of the accumulation, estimated from the events so far by each of the
    /// three extrapolation formulas.
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

    /// Adds an event, given its time, its approach speed, and the state before it. The series ends
    /// at its accumulation if the remaining time is at most the tolerance.
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

    /// Returns the estimated state at the accumulation.
    pub fn limit(&self) -> &[T] {
        &self.estimates[2].1
    }

    /// Whether an event continues the geometric progression of the series.
    fn continues(&self, interval: T, ratio: T) -> bool {
        let r = ratio.real();
        let agrees = (interval / self.interval).real() - r;
        r > 0.0 && r < 1.0 && (self.events < 2 || agrees.abs() <= AGREEMENT * r)
    }

    /// Estimates the accumulation by each formula for which the series contains enough events.
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

/// Returns the sum of all later terms of a geometric sequence, divided by the present term.
fn rest<T: Scalar>(ratio: T) -> T {
    ratio / (T::one() - ratio)
}

/// Returns the limit of a geometric sequence, given its last two terms and `rest = r/(1 − r)`.
fn extrapolate<T: Scalar>(new: T, old: T, rest: T) -> T {
    new + (new - old) * rest
}
