//! Crises: parameters at which an attractor disappears.

use super::error::{CrisisSearchError, MOST_STEPS, StroboscopicError};
use super::search::{Attractor, AttractorSearch};
use super::stroboscopic::StroboscopicMap;
use crate::core::hybrid::HybridState;

/// A crisis: a parameter at which an attractor other than a cycle disappears, because motion leaves
/// it for good.
#[derive(Clone, Debug, PartialEq)]
pub struct Crisis {
    /// Two values of the parameter: at the first, motion was still on the attractor after the
    /// transient; at the second, it had left the attractor.
    pub between: [f64; 2],
    /// The attractor at the first value of [`between`](Self::between).
    pub attractor: Attractor,
    /// The number of periods of the cycle on which motion settled beyond the crisis; `None` if
    /// motion ended instead.
    pub beyond: Option<usize>,
}

/// The settings of a search for a crisis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrisisSearch {
    /// The index of the varied parameter among the parameters of the system.
    pub parameter: usize,
    /// The first and the last value of the varied parameter.
    pub between: [f64; 2],
    /// The number of steps from the first to the last value of the parameter; the search brackets
    /// the crisis in the last step that begins on the attractor.
    pub steps: usize,
    /// The tolerance of the search: the largest allowed length of the parameter interval that
    /// brackets the crisis.
    pub tolerance: f64,
}

impl CrisisSearch {
    /// Creates a search that treats the whole parameter interval as one step, which is bisected;
    /// the first value of the parameter must be on the attractor.
    pub fn of(parameter: usize, between: [f64; 2], tolerance: f64) -> Self {
        CrisisSearch { parameter, between, steps: 1, tolerance }
    }

    /// Returns the value of the varied parameter after `step` steps.
    pub fn value(&self, step: usize) -> f64 {
        let ([from, to], part) = (self.between, step as f64 / self.steps.max(1) as f64);
        from + (to - from) * part
    }

    /// Checks the settings of the search for a system that has `parameters` parameters.
    ///
    /// ```
    /// use tangency::core::attractor::CrisisSearch;
    /// assert!(CrisisSearch::of(0, [0.71, 0.73], 1e-3).check(9).is_ok());
    /// let endless = CrisisSearch::of(0, [0.71, 0.73], 0.0).check(9);
    /// assert!(endless.unwrap_err().to_string().contains("tolerance"));
    /// ```
    ///
    /// # Errors
    /// [`CrisisSearchError`] names the invalid setting.
    pub fn check(&self, parameters: usize) -> Result<(), CrisisSearchError> {
        let &CrisisSearch { parameter, between, steps, tolerance } = self;
        if parameter >= parameters {
            return Err(CrisisSearchError::Parameter { parameter, parameters });
        }
        if !between.iter().all(|end| end.is_finite()) {
            return Err(CrisisSearchError::Interval { from: between[0], to: between[1] });
        }
        if !(1..=MOST_STEPS).contains(&steps) {
            return Err(CrisisSearchError::Steps(steps));
        }
        // NaN is also rejected.
        let usable = tolerance > 0.0 && tolerance.is_finite();
        if usable { Ok(()) } else { Err(CrisisSearchError::Tolerance(tolerance)) }
    }
}

/// Heuristic: the number of earlier states, besides the last state, from which motion must leave an
/// attractor before the attractor counts as lost.
const STARTS: usize = 3;

/// The outcome of a simulation at one value of the parameter: the attractor or cycle of the motion,
/// or the reason why the motion ended.
type Outcome = Result<Attractor, StroboscopicError>;

/// Whether motion has left the attractor, because it has settled on a cycle or has ended.
fn is_lost(outcome: &Outcome) -> bool {
    outcome.as_ref().map_or(true, |settled| settled.periods.is_some())
}

impl AttractorSearch {
    /// Locates the parameter at which an attractor that is not a cycle disappears.
    ///
    /// The parameter advances in steps, and each simulation starts in the last state of the
    /// preceding one; the attractor is thus continued across windows of cycles. The search bisects
    /// the step that follows the last parameter value without a cycle, until the length of this
    /// step is at most the tolerance, or until its ends are neighbouring floating-point numbers. At
    /// each parameter value, the attractor counts as lost only if motions that start in several
    /// states of the attractor all leave it. An attractor counts as present if motion stays on it
    /// throughout the transient. Beyond a crisis, motion stays near the former attractor for some
    /// time, and this time grows without bound as the parameter approaches the crisis.
    ///
    /// ```
    /// use tangency::core::attractor::{CrisisSearch, AttractorSearch, StroboscopicError, StroboscopicMap, PeriodMap};
    /// use tangency::core::hybrid::{HybridSettings, HybridState};
    /// use tangency::problems::mita::Actuator;
    /// // Chaos at ω = 0.5 ends where orbits with two impacts a period begin: at their fold, V = 0.717840.
    /// let mut motion = PeriodMap::of(&Actuator, HybridSettings::default(), &[])?;
    /// let attractors = AttractorSearch { transient: 300, recorded_periods: 100, lyapunov_periods: 0, ..AttractorSearch::default() };
    /// let start = HybridState { mode: 0, time: 0.0, x: vec![0.1, -0.2] };
    /// let search = CrisisSearch::of(0, [0.71, 0.73], 1e-3);
    /// let [chaos, cycle] = attractors.crisis(&mut motion, start, &Actuator::DEFAULTS, &search)?.between;
    /// assert!(chaos < 0.71784 + 1e-3 && cycle > 0.71784);
    /// # Ok::<(), StroboscopicError>(())
    /// ```
    ///
    /// # Errors
    /// [`StroboscopicError::CrisisSearch`] if a setting is invalid; `NoCrisis` if motion settles on
    /// a cycle at every step, or does not settle on a cycle at the last step; another error if
    /// motion ends at the first value of the parameter.
    pub fn crisis(
        &self,
        motion: &mut dyn StroboscopicMap,
        start: HybridState<f64>,
        p: &[f64],
        search: &CrisisSearch,
    ) -> Result<Crisis, StroboscopicError> {
        search.check(p.len())?;
        let mut p = p.to_vec();
        let mut follow = |value: f64, state: HybridState<f64>| {
            p[search.parameter] = value;
            self.follow(motion, state, &p)
        };
        let first = follow(search.value(0), start)?;
        let (mut state, mut last) = (first.end.clone(), None);
        let mut alive = Some((search.value(0), first)).filter(|(_, first)| first.periods.is_none());
        for step in (1..=search.steps).take_while(|_| !self.cancel.is_cancelled()) {
            let (value, outcome) = (search.value(step), follow(search.value(step), state.clone()));
            if let Ok(settled) = &outcome {
                state = settled.end.clone();
            }
            if is_lost(&outcome) {
                last.get_or_insert((value, outcome));
            } else if let Ok(settled) = outcome {
                (alive, last) = (Some((value, settled)), None);
            }
        }
        let (Some((mut on, mut attractor)), Some((mut off, mut lost))) = (alive, last) else {
            let [from, to] = search.between;
            return Err(StroboscopicError::NoCrisis { from, to, steps: search.steps });
        };
        while (off - on).abs() > search.tolerance && !self.cancel.is_cancelled() {
            let middle = on.midpoint(off);
            if middle == on || middle == off {
                break;
            }
            // A single state may already be outside the basin.
            let records = attractor.records.chunks(attractor.records.len().div_ceil(STARTS).max(1));
            let starts: Vec<_> = records.map(|part| part[0].start.clone()).collect();
            let mut outcome = follow(middle, attractor.end.clone());
            for start in starts {
                if is_lost(&outcome) {
                    outcome = follow(middle, start);
                }
            }
            if is_lost(&outcome) {
                (off, lost) = (middle, outcome);
            } else {
                (on, attractor) = (middle, outcome?);
            }
        }
        let beyond = lost.ok().and_then(|settled| settled.periods);
        Ok(Crisis { between: [on, off], attractor, beyond })
    }
}
