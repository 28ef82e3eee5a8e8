//! The typical sizes of a motion, which are the scales of a system that does not state its scales.

use super::erased::HybridEquations;
use super::error::HybridError;
use super::event::{Event, HybridObserver};
use super::scales::time_scale;
use super::simulation::{HybridFlow, HybridSettings, HybridState};
use super::system::Scales;
use crate::core::ode::Step;
use crate::core::problem::{FieldIn, Forcing, distinct, gradient};
use num_dual::Dual64;
use std::ops::ControlFlow;

/// Heuristic: the number of periods of a forcing over which a motion is observed.
const PERIODS: f64 = 10.0;
/// Heuristic: the largest number of steps and events over which a motion is observed.
const LONGEST: usize = 5000;
/// Heuristic: the number of observed states in an integration step.
const SAMPLES: usize = 4;
/// Heuristic: the largest number of times by which the observed duration of an autonomous motion is
/// doubled.
const DOUBLED: usize = 40;
/// Heuristic: the length of a state's path, relative to the state's range, at which a motion has
/// turned back often enough for an estimate of its period.
const TURNED: f64 = 3.0;
/// Heuristic: the size up to which a state is unusually small. With a scale that is a thousand times
/// too large, tolerances still leave nine digits of a state.
const SMALL: f64 = 1e-3;
/// Heuristic: the size from which a state is unusually large. Tolerances of larger states are
/// relative, so only conditions that compare states of different sizes need scales.
const LARGE: f64 = 1e6;
/// Heuristic: half a period up to which an oscillation is unusually fast, and half a period from
/// which it is unusually slow. A simulation lasts for some hundred units of time, so fast
/// oscillations take long.
const FAST: f64 = 0.1;
const SLOW: f64 = 1e3;
/// Rounding: a state counts as zero if it is smaller than this fraction of the changes that the terms
/// of its rate make together during the observed motion.
const VANISHES: f64 = 1e-13;

/// Estimates the scales of a system from its motion, which begins in a state of the first mode: if a
/// state remains smaller than about 1e-3, or larger than about 1e6, all states have their largest values
/// as scales. If the system has no forcing, and half the period of its oscillation is below about 0.1 or
/// above about 1e3, this time is the time scale. The scales are rounded to powers of ten, and are empty
/// if all sizes are usual.
///
/// A state counts as at least as large as the distance, along this state, from its initial value to
/// the zero of a guard. The motion is simulated with the scales that the system states; a second
/// estimate, with the scales of the first, is better.
pub(crate) fn observed_scales(system: &dyn HybridEquations, start: &[f64], p: &[f64]) -> Scales {
    let modes = system.modes();
    let states: Vec<Vec<String>> = modes.into_iter().map(|mode| mode.states).collect();
    let mut names: Vec<String> = Vec::new();
    names.extend(distinct(states.iter().flatten()).into_iter().map(String::from));
    let extents = vec![Extent::default(); names.len()];
    let mut seen = Seen { states, names, extents, elapsed: 0.0, part: 0, count: 0 };
    let Ok(mut flow) = HybridFlow::new(system, HybridSettings::default()) else {
        return Scales::default();
    };
    let mut state = flow.initial(HybridState { mode: 0, time: 0.0, x: start.to_vec() }, p);
    seen.begin(system, &state, p);
    // A motion that fails has been observed up to its failure.
    let half_period = seen.follow(&mut flow, &mut state, p).ok().flatten();
    let vanishing = seen.vanishing(system, &state, p);
    seen.scales(half_period, &vanishing)
}

/// Returns the power of ten that is nearest to a size.
fn rounded(size: f64) -> f64 {
    10f64.powf(size.log10().round())
}

/// The values of a motion's states so far.
struct Seen {
    /// The names of the states of each mode.
    states: Vec<Vec<String>>,
    /// The names of all states.
    names: Vec<String>,
    /// The values of all states.
    extents: Vec<Extent>,
    elapsed: f64,
    /// 0 in the first part of the motion, 1 in the last part.
    part: usize,
    /// The number of steps and events.
    count: usize,
}

/// The values of a state along a motion.
#[derive(Clone, Default)]
struct Extent {
    /// The smallest and the largest value; `None` before the first value.
    ends: Option<[f64; 2]>,
    /// The largest magnitude in the first and the last part of the motion.
    largest: [f64; 2],
    last: f64,
    /// The length of the path.
    path: f64,
    /// The distance of the initial value from the zero of the nearest guard.
    distance: Option<f64>,
}

impl Extent {
    /// Adds a value, which may continue the path.
    fn add(&mut self, x: f64, part: usize, continues: bool) {
        let [low, high] = self.ends.unwrap_or([x; 2]);
        self.largest[part] = self.largest[part].max(x.abs());
        if continues {
            self.path += (x - self.last).abs();
        }
        (self.ends, self.last) = (Some([low.min(x), high.max(x)]), x);
    }

    /// Returns the largest magnitude of the state, or its initial distance from a guard if this
    /// distance is larger.
    fn size(&self) -> f64 {
        self.largest.into_iter().fold(self.distance.unwrap_or(0.0), f64::max)
    }

    /// Returns the scale of the state, and whether the scale is unusual: the state's size if this size is
    /// unusually small, and otherwise the smaller of its sizes in both parts of the motion (at least the
    /// distance from a guard), or 1 for a state that vanishes in one part.
    fn scale(&self) -> (f64, bool) {
        let distance = self.distance.unwrap_or(0.0);
        let lasting = self.largest[0].min(self.largest[1]).max(distance);
        match [self.size(), lasting].map(rounded) {
            [size, _] if size <= SMALL => (size, true),
            [_, lasting] if lasting >= SMALL => (lasting, lasting >= LARGE),
            _ => (1.0, false),
        }
    }

    fn range(&self) -> f64 {
        self.ends.map_or(0.0, |[low, high]| high - low)
    }

    fn has_turned(&self) -> bool {
        self.range() > 0.0 && self.path >= TURNED * self.range()
    }
}

impl Seen {
    /// Follows the motion, and returns about half the period of an autonomous oscillation.
    fn follow(
        &mut self,
        flow: &mut HybridFlow<f64>,
        state: &mut HybridState<f64>,
        p: &[f64],
    ) -> Result<Option<f64>, HybridError> {
        let system = flow.system();
        if system.forcing() != Forcing::None {
            for part in 0..2 {
                self.part = part;
                flow.advance(state, PERIODS / 2.0 * time_scale(system, p), p, self)?;
            }
            return Ok(None);
        }
        let mut duration = self.shortest_time(system, state, p);
        for _ in 0..DOUBLED {
            flow.advance(state, duration, p, self)?;
            if self.extents.iter().any(Extent::has_turned) {
                return Ok(self.half_period());
            }
            if self.ends() {
                break;
            }
            // The last duration is the last half of the motion.
            for extent in &mut self.extents {
                let [first, last] = extent.largest;
                extent.largest = [first.max(last), 0.0];
            }
            self.part = 1;
            duration = self.elapsed.max(duration);
        }
        Ok(None)
    }

    /// Adds the initial state, and its distances from the zeros of the guards.
    fn begin(&mut self, system: &dyn HybridEquations, state: &HybridState<f64>, p: &[f64]) {
        let (mode, time, x) = state.place();
        self.add(mode, x, false);
        let guards = system.guards();
        let guards = guards.iter().enumerate().filter(|(_, it)| it.ends(mode) && !it.is_timed());
        for (guard, _) in guards {
            let value = system.guard(guard, mode, time, x, p).abs();
            let (slopes, _) = gradient((time, x), p, |t, x, p| system.guard(guard, mode, t, x, p));
            for (slope, k) in slopes.iter().zip(self.extents_of(mode)) {
                let extent = &mut self.extents[k];
                let distance = value / slope.abs();
                if distance.is_finite() && distance > 0.0 {
                    extent.distance = Some(extent.distance.map_or(distance, |it| it.min(distance)));
                }
            }
        }
    }

    /// Returns the shortest time in which a state of the initial mode changes by its size, or 1 if
    /// no state changes.
    fn shortest_time(
        &self,
        system: &dyn HybridEquations,
        state: &HybridState<f64>,
        p: &[f64],
    ) -> f64 {
        let (mode, time, x) = state.place();
        let mut rates = vec![0.0; x.len()];
        system.field(mode, time, x, p, &mut rates);
        let times = rates.iter().zip(self.extents_of(mode));
        let times = times.map(|(rate, k)| self.extents[k].size() / rate.abs());
        let shortest = times.filter(|time| time.is_finite() && *time > 0.0).reduce(f64::min);
        shortest.unwrap_or(1.0)
    }

    /// Returns the positions of a mode's states in the list of all states.
    fn extents_of(&self, mode: usize) -> Vec<usize> {
        let place = |state: &String| self.names.iter().position(|name| name == state);
        self.states[mode].iter().filter_map(place).collect()
    }

    fn add(&mut self, mode: usize, x: &[f64], continues: bool) {
        for (x, k) in x.iter().zip(self.extents_of(mode)) {
            self.extents[k].add(*x, self.part, continues);
        }
    }

    /// Returns half the period of the slowest state that has turned back.
    fn half_period(&self) -> Option<f64> {
        let turned = self.extents.iter().filter(|extent| extent.has_turned());
        turned.map(|extent| extent.range() / extent.path * self.elapsed).reduce(f64::max)
    }

    /// Returns the scales of an autonomous motion with half its period, or of a forced motion.
    fn scales(&self, half_period: Option<f64>, vanishing: &[String]) -> Scales {
        let moves =
            |(name, extent): &(&String, &Extent)| extent.size() > 0.0 && !vanishing.contains(name);
        let states = self.names.iter().zip(&self.extents).filter(moves);
        let states: Vec<(String, (f64, bool))> =
            states.map(|(name, extent)| (name.clone(), extent.scale())).collect();
        let is_usual = states.iter().all(|(_, (_, unusual))| !unusual);
        let states = states.into_iter().map(|(name, (scale, _))| (name, scale));
        let unusual = |time: &f64| *time <= FAST || *time >= SLOW;
        Scales {
            time: half_period.map(rounded).filter(unusual),
            states: if is_usual { Vec::new() } else { states.collect() },
        }
    }

    /// Returns the names of the states whose values are rounding errors, at the end of the motion: the
    /// terms of their rates cancel each other.
    fn vanishing(
        &self,
        system: &dyn HybridEquations,
        state: &HybridState<f64>,
        p: &[f64],
    ) -> Vec<String> {
        let terms = sizes_of_terms(system, state.place(), p);
        let vanishes =
            |(k, term): (usize, f64)| self.extents[k].size() <= VANISHES * self.elapsed * term;
        let all = self.extents_of(state.mode).into_iter().zip(terms);
        all.filter(|(k, term)| vanishes((*k, *term))).map(|(k, _)| self.names[k].clone()).collect()
    }
}

impl HybridObserver<f64> for Seen {
    fn step<F: FieldIn<f64>>(&mut self, mode: usize, step: &mut Step<F, f64>, end: f64) {
        let mut x = vec![0.0; step.start().len()];
        for k in 1..=SAMPLES {
            step.interpolate(end * k as f64 / SAMPLES as f64, &mut x);
            self.add(mode, &x, true);
        }
        self.elapsed += step.time(end) - step.time(0.0);
        self.count += 1;
    }

    fn ends(&self) -> bool {
        self.count >= LONGEST
    }

    fn event(&mut self, event: &Event<f64>) -> ControlFlow<()> {
        self.add(event.next, &event.after, false);
        self.count += 1;
        if self.ends() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Returns, for the rate of each state of a mode, the size of its terms: the sum of the absolute changes
/// of the rate, to first order, when each state and each parameter changes by its own value. Where the
/// terms cancel each other, the rate is smaller than its terms.
fn sizes_of_terms(
    system: &dyn HybridEquations,
    (mode, time, x): (usize, f64, &[f64]),
    p: &[f64],
) -> Vec<f64> {
    let [mut x, mut p] = [x, p].map(|v| v.iter().map(|v| Dual64::from(*v)).collect::<Vec<_>>());
    let (mut rates, mut terms) = (x.clone(), vec![0.0; x.len()]);
    for k in 0..x.len() + p.len() {
        let own = |x: &mut [Dual64], p: &mut [Dual64], share: f64| {
            let varied = if k < x.len() { &mut x[k] } else { &mut p[k - x.len()] };
            varied.eps = share * varied.re;
        };
        own(&mut x, &mut p, 1.0);
        system.field(mode, time.into(), &x, &p, &mut rates);
        terms.iter_mut().zip(&rates).for_each(|(term, rate)| *term += rate.eps.abs());
        own(&mut x, &mut p, 0.0);
    }
    terms
}
