//! Search for the attractors of motions.

use super::error::StroboscopicError;
use super::exponent::{Exponent, Growth, with_tangent};
use super::period::{Layout, Period};
use super::repetition::{Repetition, StateScales};
use super::stable_point::{REST, SAME, stable_point};
use super::stroboscopic::{StroboscopicMap, advance_each, push_forward_each};
use crate::core::cancel::CancelToken;
use crate::core::hybrid::{HybridState, Member};
use num_dual::Dual64;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// The settings of the search for attractors: durations, and criteria for periodic motion. All
/// durations of the search are numbers of periods.
///
/// ```
/// use tangency::core::attractor::AttractorSearch;
/// let patient = AttractorSearch { transient: 5000, ..AttractorSearch::default() };
/// assert!(patient.recorded_periods == 200 && patient.max_period == 16);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AttractorSearch {
    /// The number of transient periods, which are not recorded.
    pub transient: usize,
    /// The number of periods after the transient in which the search looks for a cycle; these
    /// periods are recorded if the motion is not periodic.
    pub recorded_periods: usize,
    /// The maximal number of periods in a cycle.
    pub max_period: usize,
    /// The distance between two states, in units of the largest state, below which a motion may be
    /// periodic. If a motion may be periodic, the periodic point is refined by Newton's method, and
    /// accepted if it is stable.
    pub tolerance: f64,
    /// The number of periods over which the Lyapunov exponent of a non-periodic motion is averaged;
    /// 0 if no exponent is required.
    pub lyapunov_periods: usize,
    /// A token that cancels the search between any two periods, without a result.
    #[serde(skip)]
    pub cancel: CancelToken,
}

impl Default for AttractorSearch {
    /// The default settings: a transient of 300 periods, 200 recorded periods, at most 16 periods
    /// in a cycle, a tolerance of 1e-5, and Lyapunov exponents averaged over 2000 periods.
    fn default() -> Self {
        AttractorSearch {
            transient: 300,
            recorded_periods: 200,
            max_period: 16,
            tolerance: 1e-5,
            lyapunov_periods: 2000,
            cancel: CancelToken::default(),
        }
    }
}

/// The attractor to which a motion converges.
#[derive(Clone, Debug, PartialEq)]
pub struct Attractor {
    /// The number of periods in a cycle; `None` if the motion did not repeat.
    pub periods: Option<usize>,
    /// The records of the periods of one cycle, or of all recorded periods if the motion did not
    /// repeat.
    pub records: Vec<Period>,
    /// The name of each event, with the number of its occurrences in a cycle, or per period if the
    /// motion did not repeat; this number is infinite if the events accumulate.
    pub events: Vec<(String, f64)>,
    /// The number of points in a cycle at which infinitely many events accumulate, or their number
    /// per period if the motion did not repeat.
    pub accumulations: f64,
    /// The largest Lyapunov exponent per period; `None` if not required, or if the motion rests so
    /// that its sampling event does not occur.
    pub exponent: Option<Exponent>,
    /// The last state.
    pub end: HybridState<f64>,
}

impl Attractor {
    /// Returns how often the named event occurs in a cycle, or per period if the motion did not
    /// repeat.
    pub fn count(&self, event: &str) -> f64 {
        self.events.iter().find(|(name, _)| name == event).map_or(0.0, |(_, count)| *count)
    }
}

/// A motion whose attractor is being searched for.
struct Run {
    member: Member<f64>,
    /// The number of transient periods simulated so far.
    periods: usize,
    repetition: Repetition,
    records: Vec<Period>,
    /// The number of recorded periods after which Newton's method is tried again.
    next_try: usize,
    /// The number of periods after which motion seems to have repeated.
    candidate: Option<usize>,
    /// The scales of the states in each mode.
    scales: StateScales,
    /// The size of the largest state at samples and events, in units of the scales.
    size: f64,
    exponent: Option<Exponent>,
    /// The cycle found, or the reason why the motion ended.
    outcome: Option<Result<Attractor, StroboscopicError>>,
}

impl Run {
    fn new(
        search: &AttractorSearch,
        map: &dyn StroboscopicMap,
        Member { state, p }: Member<f64>,
    ) -> Self {
        let member = Member { state: map.initial(state, &p), p };
        let AttractorSearch { max_period, tolerance, .. } = *search;
        let modes = map.layout().modes.len();
        let scales = StateScales::in_modes(modes, |mode| map.scales(mode, &member.p));
        Run {
            member,
            periods: 0,
            repetition: Repetition::new(max_period, tolerance, scales.clone()),
            scales,
            records: Vec::new(),
            next_try: 0,
            candidate: None,
            size: f64::MIN_POSITIVE,
            exponent: None,
            outcome: None,
        }
    }

    /// Records a period; returns false, which interrupts the simulation, if the motion may be
    /// periodic.
    fn record(&mut self, period: Period, state: &HybridState<f64>) -> bool {
        let size = |state: &HybridState<f64>| self.scales.size(state.mode, &state.x);
        let events = period.events.iter().map(|event| size(&event.before));
        self.size = events.fold(self.size.max(size(state)), f64::max);
        let numbers = period.events.iter().map(|e| (e.event, e.accumulation)).collect();
        let found = self.repetition.push(state.clone(), numbers, self.size.max(REST));
        self.records.push(period);
        self.candidate = found.filter(|_| self.records.len() >= self.next_try);
        self.candidate.is_none()
    }

    /// Refines the candidate for a cycle by Newton's method.
    fn improve(&mut self, map: &mut dyn StroboscopicMap) {
        let Some(q) = self.candidate.take() else { return };
        if let Some(period) = self.records.last().filter(|period| map.rests(period)) {
            let (records, end) = (vec![period.clone()], self.member.state.clone());
            let (events, accumulations) = counts(map.layout(), &records, 1);
            let rest =
                Attractor { periods: Some(1), records, events, accumulations, exponent: None, end };
            self.outcome = Some(Ok(rest));
            return;
        }
        // For slow motion that does not settle, Newton's method is not tried every time.
        self.next_try = 2 * self.records.len();
        let Run { member, size, scales, .. } = &*self;
        let push = &mut |member: &mut Member<Dual64>| map.push_forward(member).ok();
        if let Some((start, exponent)) = stable_point(push, member, q, (*size, scales)) {
            self.outcome = Some(periodic(map, (start, exponent), q, scales));
        }
    }

    /// Returns the attractor.
    fn finish(self, layout: &Layout) -> Result<Attractor, StroboscopicError> {
        let Run { records, exponent, member, outcome, .. } = self;
        outcome.unwrap_or_else(|| {
            let (events, accumulations) = counts(layout, &records, records.len());
            let end = member.state;
            Ok(Attractor { periods: None, records, events, accumulations, exponent, end })
        })
    }
}

/// Converts a flag to a control flow: `true` continues.
fn proceed(goes_on: bool) -> ControlFlow<()> {
    if goes_on { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
}

/// The way in which trajectories are simulated: in parallel or one by one.
struct Following<'m> {
    map: &'m mut dyn StroboscopicMap,
    /// Whether trajectories are simulated in parallel instead of one by one.
    abreast: bool,
    cancel: &'m CancelToken,
}

impl Following<'_> {
    /// Advances the motions that `wanted` selects, period by period.
    fn advance(
        &mut self,
        runs: &mut [Run],
        wanted: impl Fn(&Run) -> bool,
        recorded: bool,
        each: impl Fn(&mut Run, Option<Period>, &HybridState<f64>) -> bool,
    ) {
        let wanted: Vec<usize> = (0..runs.len()).filter(|k| wanted(&runs[*k])).collect();
        let mut members: Vec<_> = wanted.iter().map(|k| runs[*k].member.clone()).collect();
        let cancel = self.cancel;
        let each = &mut |k: usize, period: Option<Period>, state: &HybridState<f64>| {
            proceed(each(&mut runs[wanted[k]], period, state) && !cancel.is_cancelled())
        };
        let outcomes = match self.abreast {
            true => self.map.advance_all(&mut members, recorded, each),
            false => advance_each(self.map, &mut members, recorded, each),
        };
        for ((k, member), outcome) in wanted.into_iter().zip(members).zip(outcomes) {
            runs[k].member = member;
            runs[k].outcome = outcome.err().map(Err);
        }
    }

    fn follow(&mut self, search: &AttractorSearch, runs: &mut [Run]) {
        if search.transient > 0 {
            let transient = |run: &mut Run, _: Option<Period>, _: &HybridState<f64>| {
                run.periods += 1;
                run.periods < search.transient
            };
            self.advance(runs, |_| true, false, transient);
        }
        let lasts =
            |run: &Run| run.outcome.is_none() && run.records.len() < search.recorded_periods;
        while !self.cancel.is_cancelled() && runs.iter().any(lasts) {
            self.advance(runs, lasts, true, |run, period, state| {
                period.is_none_or(|period| run.record(period, state)) && lasts(run)
            });
            runs.iter_mut().for_each(|run| run.improve(self.map));
        }
        if search.lyapunov_periods > 0 && !self.cancel.is_cancelled() {
            self.exponents(search.lyapunov_periods, runs);
        }
    }

    /// Computes the Lyapunov exponents of motions that are not on a cycle.
    fn exponents(&mut self, periods: usize, runs: &mut [Run]) {
        let mut aperiodic: Vec<&mut Run> =
            runs.iter_mut().filter(|run| run.outcome.is_none()).collect();
        let ahead = |run: &&mut Run| with_tangent(&run.member, &run.scales, |_| 1.0);
        let mut members: Vec<Member<Dual64>> = aperiodic.iter().map(ahead).collect();
        let scales: Vec<StateScales> = aperiodic.iter().map(|run| run.scales.clone()).collect();
        let mut growths: Vec<Growth> = members.iter().map(|_| Growth::over(periods)).collect();
        let cancel = self.cancel;
        let each = &mut |k: usize, state: &mut HybridState<Dual64>| {
            proceed(growths[k].push(state, &scales[k]) && !cancel.is_cancelled())
        };
        let outcomes = match self.abreast {
            true => self.map.push_forward_all(&mut members, each),
            false => push_forward_each(self.map, &mut members, each),
        };
        for ((run, growth), outcome) in aperiodic.iter_mut().zip(growths).zip(outcomes) {
            run.exponent = Some(growth.exponent());
            run.outcome = outcome.err().map(Err);
        }
    }
}

impl AttractorSearch {
    /// Follows a motion and returns its attractor. The motion begins in the system's initial mode
    /// ([`HybridSystem::initial_mode`](crate::core::hybrid::HybridSystem::initial_mode)).
    ///
    /// # Errors
    /// [`StroboscopicError`] if the motion ends before the search is complete.
    pub fn follow(
        &self,
        map: &mut dyn StroboscopicMap,
        state: HybridState<f64>,
        p: &[f64],
    ) -> Result<Attractor, StroboscopicError> {
        let mut run = [Run::new(self, map, Member { state, p: p.to_vec() })];
        Following { map, abreast: false, cancel: &self.cancel }.follow(self, &mut run);
        let [run] = run;
        run.finish(map.layout())
    }

    /// Follows many motions in parallel ([`StroboscopicMap::advance_all`]). The result for each
    /// motion is bitwise independent of the other motions.
    ///
    /// # Errors
    /// Each motion has its own result, with the errors of [`follow`](Self::follow).
    pub fn follow_all(
        &self,
        map: &mut dyn StroboscopicMap,
        members: Vec<Member<f64>>,
    ) -> Vec<Result<Attractor, StroboscopicError>> {
        let begin = |member| Run::new(self, map, member);
        let mut runs: Vec<Run> = members.into_iter().map(begin).collect();
        Following { map, abreast: true, cancel: &self.cancel }.follow(self, &mut runs);
        runs.into_iter().map(|run| run.finish(map.layout())).collect()
    }
}

/// Returns a cycle of `q` periods as the attractor of a motion.
fn periodic(
    map: &mut dyn StroboscopicMap,
    (start, exponent): (Member<f64>, Exponent),
    q: usize,
    scales: &StateScales,
) -> Result<Attractor, StroboscopicError> {
    let mut member = start.clone();
    let mut records: Vec<Period> =
        (0..q).map(|_| map.record(&mut member)).collect::<Result<_, _>>()?;
    let (mode, x) = (start.state.mode, &start.state.x);
    let same = |period: &Period| {
        let near = || scales.distance(mode, &period.start.x, x) <= SAME * scales.size(mode, x);
        period.start.mode == mode && near()
    };
    // A spiralling motion may first repeat after a multiple of the period.
    let q = (1..q).find(|part| q.is_multiple_of(*part) && same(&records[*part])).unwrap_or(q);
    records.truncate(q);
    let (events, accumulations) = counts(map.layout(), &records, 1);
    let (periods, exponent) = (Some(q), Some(exponent));
    Ok(Attractor { periods, records, events, accumulations, exponent, end: start.state })
}

/// Counts the events of each name, and the accumulations of infinitely many events, as means over a
/// number of cycles.
fn counts(layout: &Layout, records: &[Period], cycles: usize) -> (Vec<(String, f64)>, f64) {
    let all = || records.iter().flat_map(|period| &period.events);
    let mean = |count: usize| count as f64 / cycles.max(1) as f64;
    let count = |(number, name): (usize, &String)| {
        let own = || all().filter(|e| e.event == number);
        let infinite = own().any(|e| e.accumulation);
        (name.clone(), if infinite { f64::INFINITY } else { mean(own().count()) })
    };
    let events = layout.events.iter().enumerate().map(count).collect();
    (events, mean(all().filter(|e| e.accumulation).count()))
}
