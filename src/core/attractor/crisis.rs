//! Where an attractor is lost.

use super::error::{CrisisSearchError, MOST_STEPS, StroboscopicError};
use super::search::{Attractor, AttractorSearch};
use super::stroboscopic::StroboscopicMap;
use crate::core::hybrid::HybridState;

/// Where an attractor that is no cycle is lost as a parameter goes on: in a crisis, motion leaves
/// it for good.
#[derive(Clone, Debug, PartialEq)]
pub struct Crisis {
    /// The parameter at which motion was still on it after the transient, and that at which it had
    /// left.
    pub between: [f64; 2],
    /// The attractor at the first of them.
    pub attractor: Attractor,
    /// The cycle on which motion settled beyond, by its number of periods; `None` if motion ended
    /// there.
    pub beyond: Option<usize>,
}

/// Where a crisis is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrisisSearch {
    /// The parameter, by its position.
    pub parameter: usize,
    /// From where on it goes, and where to.
    pub between: [f64; 2],
    /// In how many steps: the crisis is in the last one that begins on the attractor.
    pub steps: usize,
    /// How long the interval may be in which the crisis is.
    pub tolerance: f64,
}

impl CrisisSearch {
    /// A search in one step, which must begin on the attractor.
    pub fn of(parameter: usize, between: [f64; 2], tolerance: f64) -> Self {
        CrisisSearch { parameter, between, steps: 1, tolerance }
    }

    /// The parameter after so many steps.
    pub fn value(&self, step: usize) -> f64 {
        let ([from, to], part) = (self.between, step as f64 / self.steps.max(1) as f64);
        from + (to - from) * part
    }

    /// Checks the settings for a system with this number of parameters.
    ///
    /// ```
    /// use tangency::core::attractor::CrisisSearch;
    /// assert!(CrisisSearch::of(0, [0.71, 0.73], 1e-3).check(9).is_ok());
    /// let endless = CrisisSearch::of(0, [0.71, 0.73], 0.0).check(9);
    /// assert!(endless.unwrap_err().to_string().contains("tolerance"));
    /// ```
    ///
    /// # Errors
    /// [`CrisisSearchError`] names the setting.
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
        // Not a number is refused as well.
        let usable = tolerance > 0.0 && tolerance.is_finite();
        if usable { Ok(()) } else { Err(CrisisSearchError::Tolerance(tolerance)) }
    }
}

/// (H) An attractor is lost if none of this many of its states, nor its last one, stays on it.
const STARTS: usize = 3;

/// What motion does at one value of the parameter: it is on the attractor, on a cycle, or it ends.
type Outcome = Result<Attractor, StroboscopicError>;

/// Whether motion is not on the attractor: it has settled on a cycle, or ends.
fn is_lost(outcome: &Outcome) -> bool {
    outcome.as_ref().map_or(true, |settled| settled.periods.is_some())
}

impl AttractorSearch {
    /// Where the attractor is lost that motion from a state is on, if it is no cycle.
    ///
    /// The parameter goes on in steps, each from where the one before ended, which takes it over
    /// windows of cycles. The step after the last one in which motion does not settle on a cycle is
    /// halved until it is no longer than the tolerance, or until its ends are neighbouring numbers;
    /// several states of the attractor must leave it. The transient is how long an attractor must
    /// last to count: beyond a crisis motion stays near it for a time that grows without bound
    /// towards the crisis.
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
    /// cycles only, or on none where the search ends; another one if it ends where the search
    /// begins.
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
            // One state may happen to be outside of the basin already.
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
