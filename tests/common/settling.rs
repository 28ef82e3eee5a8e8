//! Branches against simulations: motion that is disturbed a little comes back to an orbit exactly
//! where the orbit is called admissible and stable.

use std::ops::ControlFlow;
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::hybrid::{Event, HybridEquations, HybridFlow, HybridSettings, HybridState};
use tangency::core::ode::{Scheme, Settings};
use tangency::core::orbit::Itinerary;
use tangency::core::system::Kind;

/// How far motion is disturbed, relative to its largest state.
const DISTURBED: f64 = 1e-8;
/// Motion has come back where this part of the disturbance is left,
const LEFT: f64 = 0.02;
/// and is gone where it has grown so much, more than it does at times on its way back.
const GONE: f64 = 300.0;
/// The number of cycles after which an orbit is too near a bifurcation to be classified.
const CYCLES: usize = 4000;

/// A point of a branch of orbits, as the motion in the middle of its longest leg.
struct Orbit<'a> {
    system: &'a dyn HybridEquations,
    p: &'a [f64],
    middle: HybridState<f64>,
    period: f64,
}

impl<'a> Orbit<'a> {
    fn of(system: &'a dyn HybridEquations, branch: &Branch, point: &'a SpecialPoint) -> Self {
        let itinerary = Itinerary::read(&branch.itinerary, system).unwrap();
        let (modes, mut places) = (system.modes(), Vec::new());
        let mut place = 0;
        for group in &branch.unknowns {
            places.push((group.name.as_str(), place));
            place += group.length;
        }
        let value = |name: &str| {
            let place = places.iter().find(|(known, _)| *known == name)?.1;
            Some(point.state[place])
        };
        let p = &point.parameters[..];
        let periods = itinerary.periods as f64;
        let durations: Vec<f64> = match itinerary.legs.iter().all(|leg| leg.exit.is_none()) {
            true => vec![value("period").unwrap_or_else(|| periods * system.period(p))],
            false => (0..itinerary.legs.len())
                .map(|k| value(&format!("duration[{k}]")).unwrap())
                .collect(),
        };
        let longest = (0..durations.len()).max_by(|a, b| durations[*a].total_cmp(&durations[*b]));
        let longest = longest.unwrap();
        let count = |leg: usize| modes[itinerary.legs[leg].mode].states.len();
        let first: usize = (0..longest).map(count).sum();
        let x =
            places[first..first + count(longest)].iter().map(|(_, k)| point.state[*k]).collect();
        let before: f64 = durations[..longest].iter().sum();
        let time = value("start").unwrap_or(0.0) + before;
        let mut middle = HybridState { mode: itinerary.legs[longest].mode, time, x };
        let orbit = |middle| Orbit { system, p, middle, period: durations.iter().sum() };
        orbit(middle.clone()).follow(&mut middle, 0.5 * durations[longest]);
        orbit(middle)
    }

    /// Whether motion can go on for a time.
    fn follow(&self, state: &mut HybridState<f64>, time: f64) -> bool {
        let flow = Settings::new(Scheme::DormandPrince8, 1e-13);
        let settings = HybridSettings { flow, ..HybridSettings::default() };
        let mut flow = HybridFlow::new(self.system, settings).unwrap();
        let mut ignore = |_: &Event<f64>| ControlFlow::Continue(());
        flow.advance(state, time, self.p, &mut ignore).is_ok()
    }

    /// How far a motion is from the orbit; along an orbit without forcing it may have moved.
    fn distance(&self, state: &HybridState<f64>) -> f64 {
        let Orbit { system, p, middle, .. } = self;
        if state.mode != middle.mode {
            return f64::INFINITY;
        }
        let mut apart: Vec<f64> = state.x.iter().zip(&middle.x).map(|(a, b)| a - b).collect();
        if !system.forcing().is_periodic() {
            let mut f = vec![0.0; apart.len()];
            system.field(middle.mode, middle.time, &middle.x, p, &mut f);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let along = dot(&apart, &f) / dot(&f, &f);
            apart.iter_mut().zip(&f).for_each(|(apart, f)| *apart -= along * f);
        }
        apart.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Whether motion that is disturbed a little comes back; `None` if that takes too long to tell.
    fn attracts(&self) -> Option<bool> {
        let mut state = self.middle.clone();
        let size = state.x.iter().fold(1e-3_f64, |most, x| most.max(x.abs()));
        for (k, x) in state.x.iter_mut().enumerate() {
            *x += DISTURBED * size * (1.0 + 0.3 * k as f64);
        }
        let disturbed = self.distance(&state);
        for _ in 0..CYCLES {
            if !self.follow(&mut state, self.period) {
                return Some(false);
            }
            let left = self.distance(&state) / disturbed;
            if !(LEFT..=GONE).contains(&left) {
                return Some(left < LEFT);
            }
        }
        None
    }
}

/// The motion in the middle of the longest leg of an orbit, and its period.
pub fn middle(
    system: &dyn HybridEquations,
    branch: &Branch,
    point: &SpecialPoint,
) -> (HybridState<f64>, f64) {
    let orbit = Orbit::of(system, branch, point);
    (orbit.middle, orbit.period)
}

/// How many of the marked orbits of a branch attract, how many are unstable, how many virtual, and
/// for how many it takes too long to tell. Asserts that simulations and the branch agree.
#[track_caller]
pub fn settling(system: &dyn HybridEquations, branch: &Branch) -> [usize; 4] {
    let mut counts = [0; 4];
    for point in branch.of_kind(Kind::UZ) {
        let positive = |name: &str| {
            branch.column(name).and_then(|c| point.value(c)).is_none_or(|value| value > 0.0)
        };
        let admissible = ["approach", "shortest", "distance", "decision"].into_iter().all(positive);
        let Some(attracts) = Orbit::of(system, branch, point).attracts() else {
            counts[3] += 1;
            continue;
        };
        let stable = point.unstable == Some(0);
        assert_eq!(attracts, admissible && stable, "{}: {:?}", branch.name, point.parameters);
        counts[if !admissible { 2 } else { usize::from(!stable) }] += 1;
    }
    counts
}
