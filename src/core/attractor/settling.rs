//! Following a motion until it is known what it settles on.

use super::Strobed;
use super::error::StrobeError;
use super::exponent::{Exponent, Monodromy, correction, monodromy, of_matrix};
use super::period::Period;
use crate::core::hybrid::{HybridState, Repetition};
use serde::{Deserialize, Serialize};

/// How long a motion is followed, and when it counts as periodic. All times are periods.
///
/// ```
/// use tangency::core::attractor::Settling;
/// let patient = Settling { transient: 5000, ..Settling::default() };
/// assert!(patient.recorded == 200 && patient.most == 16);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settling {
    /// The transient, before which nothing is looked at.
    pub transient: usize,
    /// How many periods are looked at, and recorded of a motion that is not periodic.
    pub recorded: usize,
    /// The largest number of periods in a cycle.
    pub most: usize,
    /// A motion may be periodic when it comes back this near, in units of its largest state. The periodic point is
    /// then improved by Newton's method, and counts if it is stable.
    pub tolerance: f64,
    /// Over how many periods the exponent of a motion that is not periodic is averaged; 0 if it is not asked for.
    pub exponent: usize,
}

impl Default for Settling {
    /// A transient of 300 periods, then 200, up to 16 in a cycle, a tolerance of 1e-5, exponents over 2000.
    fn default() -> Self {
        Settling { transient: 300, recorded: 200, most: 16, tolerance: 1e-5, exponent: 2000 }
    }
}

/// What a motion has settled on.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// The periods in a cycle; `None` if the motion did not repeat.
    pub periods: Option<usize>,
    /// One cycle, or all periods recorded.
    pub records: Vec<Period>,
    /// The events by name, and how often each came in a cycle (in a period, if there is no cycle): infinitely often
    /// where they accumulate.
    pub events: Vec<(String, f64)>,
    /// How often infinitely many events came in a finite time, likewise.
    pub accumulations: f64,
    /// The largest Lyapunov exponent, per period.
    pub exponent: Option<Exponent>,
    /// The state in the end.
    pub end: HybridState<f64>,
}

impl Settled {
    /// How often an event came in a cycle (in a period, if there is no cycle).
    pub fn count(&self, event: &str) -> f64 {
        self.events.iter().find(|(name, _)| name == event).map_or(0.0, |(_, count)| *count)
    }
}

/// A periodic point counts if Newton's method ends there, with steps below this in units of the largest state …
const CONVERGED: f64 = 1e-11;
/// … after no more than so many …
const ROUNDS: usize = 8;
/// … no farther away than this.
const NEAR: f64 = 0.03;

/// A stable periodic point.
struct Cycle {
    start: HybridState<f64>,
    exponent: Exponent,
}

impl Settling {
    /// Follows a motion and tells what it has settled on.
    ///
    /// # Errors
    /// [`StrobeError`] if the motion ends.
    pub fn follow(
        &self,
        motion: &mut dyn Strobed,
        mut state: HybridState<f64>,
        p: &[f64],
    ) -> Result<Settled, StrobeError> {
        for _ in 0..self.transient {
            motion.advance(&mut state, p)?;
        }
        let mut repetition = Repetition::new(self.most, self.tolerance);
        let (mut records, mut next_try) = (Vec::new(), 0);
        while records.len() < self.recorded {
            let period = motion.record(&mut state, p)?;
            let told = period.events.iter().map(|e| 2 * e.event + usize::from(e.accumulation));
            let found = repetition.push(period.start.clone(), told.collect(), &state);
            records.push(period);
            if let Some(q) = found.filter(|_| records.len() >= next_try) {
                // Where motion is slow but does not settle, Newton's method need not be asked every time.
                next_try = 2 * records.len();
                if let Some(cycle) = improved(motion, &state, p, q) {
                    return periodic(motion, cycle, p, q);
                }
            }
        }
        let mut ahead = state.clone();
        let exponent = match self.exponent {
            0 => None,
            periods => Some(Exponent::of(motion, &mut ahead, p, periods)?),
        };
        let (events, accumulations) = counts(motion, &records, records.len());
        Ok(Settled { periods: None, records, events, accumulations, exponent, end: state })
    }
}

/// One cycle of `q` periods as what a motion has settled on.
fn periodic(
    motion: &mut dyn Strobed,
    Cycle { start, exponent }: Cycle,
    p: &[f64],
    q: usize,
) -> Result<Settled, StrobeError> {
    let mut state = start.clone();
    let records: Vec<Period> =
        (0..q).map(|_| motion.record(&mut state, p)).collect::<Result<_, _>>()?;
    let (events, accumulations) = counts(motion, &records, 1);
    let (periods, exponent) = (Some(q), Some(exponent));
    Ok(Settled { periods, records, events, accumulations, exponent, end: start })
}

/// Events by name, and accumulations, as means over so many cycles.
fn counts(motion: &dyn Strobed, records: &[Period], cycles: usize) -> (Vec<(String, f64)>, f64) {
    let all = || records.iter().flat_map(|period| &period.events);
    let mean = |count: usize| count as f64 / cycles.max(1) as f64;
    let count = |(number, name): (usize, &String)| {
        let own = || all().filter(|e| e.event == number);
        let infinite = own().any(|e| e.accumulation);
        (name.clone(), if infinite { f64::INFINITY } else { mean(own().count()) })
    };
    let events = motion.layout().events.iter().enumerate().map(count).collect();
    (events, mean(all().filter(|e| e.accumulation).count()))
}

/// The stable point of period `q` near a state, by Newton's method; `None` if there is none. A motion that ends on
/// the way says no more than that.
fn improved(
    motion: &mut dyn Strobed,
    near: &HybridState<f64>,
    p: &[f64],
    q: usize,
) -> Option<Cycle> {
    let (mut start, n) = (near.clone(), near.x.len());
    let size = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let largest = size(&near.x).max(f64::MIN_POSITIVE);
    let mut last = f64::INFINITY;
    for _ in 0..ROUNDS {
        let Monodromy { matrix, end } = monodromy(motion, &start, p, q).ok()??;
        let value = of_matrix(&matrix, n, q);
        let step = correction(&matrix, &start.x, &end.x)?;
        let away: Vec<f64> =
            start.x.iter().zip(&step).zip(&near.x).map(|((x, s), near)| x + s - near).collect();
        if size(&away) > NEAR * largest {
            return None;
        }
        if size(&step) <= CONVERGED * largest {
            // What is left of the orbit's error moves the exponent less than the last step did.
            let moved = (value - last).abs();
            let error = if moved.is_finite() { moved } else { 0.0 };
            return (value < 0.0).then_some(Cycle { start, exponent: Exponent { value, error } });
        }
        start.x.iter_mut().zip(&step).for_each(|(x, step)| *x += step);
        last = value;
    }
    None
}
