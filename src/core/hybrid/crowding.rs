//! Detection of ever more frequent events, for example in a system in which a relay drives the motion
//! to a state that is reached only after infinitely many switchings.
//!
//! Frequent events whose frequency rises over five windows, and then falls again, are mistaken for such a motion.

/// Heuristic: the number of successive events in each window in which the frequency of events is
/// measured.
const WINDOW: usize = 4000;
/// Heuristic: a window of events counts as shorter than the previous one if the ratio of their
/// durations is below this threshold.
const SHORTER: f64 = 0.97;
/// Heuristic: the number of successively shorter windows after which the simulation ends.
const MOST: usize = 5;
/// Heuristic: events can be simulated if the mean interval between them, in units of the time
/// scale, is larger than this threshold.
const SHORT: f64 = 1e-4;

/// A detector of too frequent events, which counts events in successive windows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crowd {
    /// The time of the last event that was later than the event before it, and the number of events
    /// since then.
    pub still: (f64, usize),
    /// The time at which the window starts.
    since: f64,
    /// The number of events in the window so far.
    count: usize,
    /// The duration of the previous window.
    before: f64,
    /// The number of successively shorter windows.
    shorter: usize,
}

impl Crowd {
    /// Creates a detector that starts counting at a given time.
    pub fn from(time: f64) -> Self {
        Crowd { still: (time, 0), since: time, count: 0, before: f64::INFINITY, shorter: 0 }
    }

    /// Counts an event. Returns the mean interval between events in the last window if events
    /// become too frequent.
    pub fn push(&mut self, time: f64, unit: f64) -> Option<f64> {
        self.count += 1;
        if self.count < WINDOW {
            return None;
        }
        let lasted = time - self.since;
        let shorter = if lasted < SHORTER * self.before { self.shorter + 1 } else { 0 };
        *self = Crowd { still: self.still, since: time, count: 0, before: lasted, shorter };
        let interval = lasted / WINDOW as f64;
        (shorter >= MOST && interval < SHORT * unit).then_some(interval)
    }

    /// Returns the least number of events before the simulation can end because of too frequent
    /// events.
    pub fn events() -> usize {
        MOST * WINDOW
    }
}
