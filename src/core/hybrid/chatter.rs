//! Complete chatter: events of one guard that accumulate in a finite time.
//!
//! Between impacts on a surface that the motion is pressed against, with acceleration `−a`, the
//! approach speeds `v_n` and the intervals `Δ_n = t_n − t_{n−1}` shrink by a ratio
//! `r = v_n/v_{n−1}` that settles, so that the events accumulate near
//!
//! ```text
//!     E_n = t_n + Δ_n r/(1 − r),
//! ```
//!
//! with an error that shrinks as `r^{2n}` where the acceleration changes: two estimates give the
//! better one `E_n' = E_n + (E_n − E_{n−1}) r²/(1 − r²)`, and two of these
//! `E_n' + (E_n' − E'_{n−1}) r³/(1 − r³)`, with an error like `r^{4n}`. The state at the
//! accumulation is extrapolated alike.

use crate::core::scalar::Scalar;

/// (H) Ratios of successive intervals and of approach speeds differ by less than this part where
/// chatter is followed to its end: they approach one limit.
const AGREEMENT: f64 = 0.1;
/// (H) Intervals shorter than this fraction of the tolerance count as zero: the events are
/// simultaneous.
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
    /// Where the events so far would have them accumulate, estimated by each of the formulas: time
    /// and state.
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

    /// Takes in an event, the time of it, the approach speed, and the state before it; the rest of
    /// a series that takes no longer than the tolerance need not be followed.
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

    /// Whether an event goes on with the series.
    fn continues(&self, interval: T, ratio: T) -> bool {
        let r = ratio.real();
        let agrees = (interval / self.interval).real() - r;
        r > 0.0 && r < 1.0 && (self.events < 2 || agrees.abs() <= AGREEMENT * r)
    }

    /// Estimates the accumulation by each formula, as soon as there are events enough for it.
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

/// The sum of all later members of a geometric sequence, in units of this one.
fn rest<T: Scalar>(ratio: T) -> T {
    ratio / (T::one() - ratio)
}

/// The limit of a geometric sequence from its last two members, with `rest = r/(1 − r)`.
fn extrapolate<T: Scalar>(new: T, old: T, rest: T) -> T {
    new + (new - old) * rest
}
