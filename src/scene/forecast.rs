//! Estimates of the duration of runs and sweeps, which are made before the runs and sweeps start.

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

/// Heuristic: the processor time for which a motion is followed in order to estimate its speed.
const TRIAL: Duration = Duration::from_millis(20);
/// Heuristic: the maximum number of periods for which a motion is followed in order to estimate its
/// speed.
const TRIAL_PERIODS: u32 = 64;
/// Heuristic: the largest number of bisection steps that a forecast assumes; after this number of
/// steps, the two ends of nearly every interval are neighbouring floating-point numbers.
const MOST_HALVINGS: f64 = 106.0;
/// Heuristic: the cost of simulating a period with a tangent vector, relative to the cost of a
/// period without tangent vector.
const WITH_TANGENT: usize = 3;
/// Heuristic: the scaled arclength, measured from the start of a branch, at which the branch counts
/// as long.
const FAR: f64 = 10.0;

/// An observer that stops a simulated motion after a given processor time.
struct Until(ThreadTime);

impl HybridObserver<f64> for Until {
    fn ends(&self) -> bool {
        self.0.elapsed() >= TRIAL
    }

    fn event(&mut self, _event: &Event<f64>) -> ControlFlow<()> {
        if self.ends() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Estimates how long it will take to follow a motion for a given time, by following the beginning
/// of the motion; the estimate is reported unless this trial already covers the whole time.
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
    // A separate thread keeps the trial out of the work counts of this thread.
    let followed = std::thread::scope(|scope| scope.spawn(followed).join());
    // Errors of the trial occur again in the computation, and are reported there.
    if let Some((share, time)) = followed.ok().flatten().filter(|(share, _)| *share < 1.0) {
        observer.work(run, &format!("motion over a time of {duration}"), over(time, 1.0 / share));
    }
}

/// Estimates how long it will take to trace a branch, up to the arclength [`FAR`] in both
/// directions or up to the maximum number of points. The estimate assumes that the computation of
/// each point takes as long as the computation of the start point.
pub(super) fn branch(run: &str, steps: &Steps, start: Duration, observer: &mut dyn SceneObserver) {
    let settings = &steps.branch().settings;
    let each_way = settings.max_points.min((FAR / settings.max_step).ceil() as usize);
    let ways = steps.directions().iter().filter(|traced| **traced).count();
    let points = each_way.saturating_mul(ways).saturating_add(1);
    observer.work(run, &format!("a branch of {points} points"), over(start, points as f64));
}

/// An upper estimate of the work of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepForecast {
    /// The number of runs of the sweep that are not finished.
    pub runs: usize,
    /// The maximum number of periods of a run, where a period with a tangent vector counts as
    /// several periods.
    pub periods: usize,
    /// The number of threads that compute the sweep.
    pub threads: usize,
    /// The estimated maximum duration of the sweep, which is extrapolated from the first periods of
    /// the first run. Most runs end earlier than this estimate assumes, because they converge
    /// before the maximum number of periods.
    pub time: Duration,
}

impl SweepForecast {
    /// Returns an upper estimate of the work of a sweep that computes `runs` runs on `threads`
    /// threads; `None` if the trial motion ends with an error.
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

/// Returns the maximum number of periods of a run of a sweep.
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

/// Multiplies a duration by a number, which need not be an integer.
fn over(each: Duration, times: f64) -> Duration {
    Duration::try_from_secs_f64(each.as_secs_f64() * times).unwrap_or(Duration::MAX)
}
