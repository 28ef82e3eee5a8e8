//! How long runs and sweeps may take, told before they begin.

use super::observer::SceneObserver;
use crate::core::attractor::StroboscopicMap;
use crate::core::continuation::Steps;
use crate::core::hybrid::{
    Event, HybridEquations, HybridFlow, HybridObserver, HybridSettings, HybridState, Member,
};
use crate::core::sweep::Plan;
use cpu_time::ThreadTime;
use std::ops::ControlFlow;
use std::time::Duration;

/// (H) How long motion is followed, in time of the processor, to see how long it takes …
const TRIAL: Duration = Duration::from_millis(20);
/// (H) … and for how many periods at most.
const TRIAL_PERIODS: u32 = 64;
/// (H) The largest number of halvings that a forecast assumes: after as many the ends of nearly
/// every interval are neighbouring numbers.
const MOST_HALVINGS: f64 = 106.0;
/// (H) How many times as long a period takes that is followed with a tangent vector.
const WITH_TANGENT: usize = 3;
/// (H) A long branch goes as far as this from its start, in units of scaled arclength.
const FAR: f64 = 10.0;

/// Motion is followed for a time of the processor.
struct Until(ThreadTime);

impl HybridObserver<f64> for Until {
    fn ends(&self) -> bool {
        self.0.elapsed() >= TRIAL
    }

    fn event(&mut self, _event: &Event<f64>) -> ControlFlow<()> {
        if self.ends() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Tells how long it may take to follow a motion for a time, by its beginning, unless that is all
/// of it.
pub(super) fn motion(
    run: &str,
    system: &dyn HybridEquations,
    start: &HybridState<f64>,
    (duration, p): (f64, &[f64]),
    observer: &mut dyn SceneObserver,
) {
    let followed = || -> Option<(f64, Duration)> {
        let mut flow = HybridFlow::new(system, HybridSettings::default()).ok()?;
        let (mut state, begin) = (flow.initial(start.clone(), p), ThreadTime::now());
        let start = state.time;
        flow.advance(&mut state, duration, p, &mut Until(begin)).ok()?;
        Some(((state.time - start) / duration, begin.elapsed()))
    };
    // In a thread of its own, since this one's work is counted.
    let followed = std::thread::scope(|scope| scope.spawn(followed).join());
    // What fails fails again, and is said then.
    if let Some((share, time)) = followed.ok().flatten().filter(|(share, _)| *share < 1.0) {
        observer.work(run, &format!("motion over a time of {duration}"), over(time, 1.0 / share));
    }
}

/// Tells how long a branch may take that is traced as far as [`FAR`] each way, unless fewer points
/// are allowed; a point takes about as long as the start took.
pub(super) fn branch(run: &str, steps: &Steps, start: Duration, observer: &mut dyn SceneObserver) {
    let settings = &steps.branch().settings;
    let each_way = settings.max_points.min((FAR / settings.max_step).ceil() as usize);
    let ways = steps.directions().iter().filter(|traced| **traced).count();
    let points = each_way.saturating_mul(ways).saturating_add(1);
    observer.work(run, &format!("a branch of {points} points"), over(start, points as f64));
}

/// The work that a sweep does at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepForecast {
    /// The runs that are not done.
    pub runs: usize,
    /// The periods of a run, at most; one with a tangent vector counts as several.
    pub periods: usize,
    /// On how many threads.
    pub threads: usize,
    /// How long all may take, by the first periods of the first run: most runs end as soon as they
    /// have settled.
    pub time: Duration,
}

impl SweepForecast {
    /// An upper estimate of the work of `runs` runs on `threads` threads; `None` if the first
    /// motion ends early.
    pub(super) fn of(
        plan: &Plan,
        p: &[f64],
        map: &mut dyn StroboscopicMap,
        runs: usize,
        threads: usize,
    ) -> Option<SweepForecast> {
        let (p, state) = plan.setting(0, p);
        let state = map.initial(state, &p);
        let (mut member, begin, mut followed) = (Member { state, p }, ThreadTime::now(), 0);
        while followed < TRIAL_PERIODS && (followed == 0 || begin.elapsed() < TRIAL) {
            map.advance(&mut member).ok()?;
            followed += 1;
        }
        let (each, periods) = (begin.elapsed() / followed, most_periods(plan));
        let threads = threads.clamp(1, runs.max(1));
        let time = over(each, periods as f64 * runs as f64 / threads as f64);
        Some(SweepForecast { runs, periods, threads, time })
    }
}

/// The periods of a run, at most.
fn most_periods(plan: &Plan) -> usize {
    let search = &plan.search;
    let one = search.transient + search.recorded_periods + WITH_TANGENT * search.lyapunov_periods;
    let halvings = |[a, b]: [f64; 2], tolerance: f64| ((a - b).abs() / tolerance).log2().ceil();
    let times = plan.crisis.map_or(1, |crisis| {
        let halvings = halvings(crisis.between, crisis.tolerance).clamp(0.0, MOST_HALVINGS);
        crisis.steps.saturating_add(1 + 4 * halvings as usize)
    });
    one.saturating_mul(times)
}

/// So many times a duration.
fn over(each: Duration, times: f64) -> Duration {
    Duration::try_from_secs_f64(each.as_secs_f64() * times).unwrap_or(Duration::MAX)
}
