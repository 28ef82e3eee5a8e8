//! How long a sweep may take, before it begins.

use super::plan::Plan;
use crate::core::attractor::StroboscopicMap;
use crate::core::hybrid::Member;
use cpu_time::ThreadTime;
use std::time::Duration;

/// How long periods are followed, in time of the processor, to see how long one takes, whatever
/// else the machine does …
const TRIAL: Duration = Duration::from_millis(20);
/// … and how many at most.
const TRIAL_PERIODS: u32 = 64;
/// The largest number of halvings that a forecast assumes (H): after as many the ends of nearly
/// every interval are neighbouring numbers.
const MOST_HALVINGS: f64 = 106.0;
/// How many times as long a period takes that is followed with a tangent vector.
const WITH_TANGENT: usize = 3;

/// What a sweep does at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// The runs that are not done.
    pub runs: usize,
    /// The periods of a run, at most.
    pub periods: usize,
    /// On how many threads.
    pub threads: usize,
    /// How long all may take, by the first periods of the first run: most runs end as soon as they
    /// have settled.
    pub time: Duration,
}

impl Plan {
    /// The periods of a run, at most; one with a tangent vector counts as several.
    fn most_periods(&self) -> usize {
        let search = &self.search;
        let one =
            search.transient + search.recorded_periods + WITH_TANGENT * search.lyapunov_periods;
        let halvings = |[a, b]: [f64; 2], tolerance: f64| ((a - b).abs() / tolerance).log2().ceil();
        let times = self.crisis.map_or(1, |crisis| {
            let halvings = halvings(crisis.between, crisis.tolerance).clamp(0.0, MOST_HALVINGS);
            crisis.steps.saturating_add(1 + 4 * halvings as usize)
        });
        one.saturating_mul(times)
    }

    /// An upper estimate of the work of `runs` runs on `threads` threads; `None` if the first
    /// motion ends early.
    ///
    /// ```
    /// use tangency::core::attractor::{AttractorSearch, PeriodMap};
    /// use tangency::core::hybrid::{HybridSettings, HybridState};
    /// use tangency::core::sweep::{Axis, Order, Plan, Quantity};
    /// use tangency::problems::classic::ImpactOscillator;
    /// let start = HybridState { mode: 0, time: 0.0, x: vec![0.0, 0.0] };
    /// let axis = Axis { quantity: Quantity::Parameter(0), low: 1.0, high: 5.0, count: 30 };
    /// let plan = Plan { axes: vec![axis], starts: vec![start], order: Order::Anew, strands: 1,
    ///     search: AttractorSearch::default(), crisis: None };
    /// let mut map = PeriodMap::of(&ImpactOscillator, HybridSettings::default(), &[]).expect("a map");
    /// let work = plan.work(&[1.0, 2.2, 0.8, 0.1, 1.0], &mut map, 30, 2).expect("a motion");
    /// assert_eq!(work.periods, 300 + 200 + 3 * 2000);
    /// ```
    pub fn work(
        &self,
        p: &[f64],
        map: &mut dyn StroboscopicMap,
        runs: usize,
        threads: usize,
    ) -> Option<Work> {
        let (p, state) = self.setting(0, p);
        let state = map.initial(state, &p);
        let (mut member, begin, mut followed) = (Member { state, p }, ThreadTime::now(), 0);
        while followed < TRIAL_PERIODS && (followed == 0 || begin.elapsed() < TRIAL) {
            map.advance(&mut member).ok()?;
            followed += 1;
        }
        let (each, periods) = (begin.elapsed() / followed, self.most_periods());
        let threads = threads.clamp(1, runs.max(1));
        let seconds = each.as_secs_f64() * periods as f64 * runs as f64 / threads as f64;
        let time = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        Some(Work { runs, periods, threads, time })
    }
}
