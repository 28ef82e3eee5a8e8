//! Promise: systems move, branch and graze alike in whatever units they are stated, if they state
//! their scales.

use crate::hybrid::systems::bouncing_ball::BouncingBall;
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use std::f64::consts::TAU;
use tangency::core::attractor::{AttractorSearch, PeriodMap, StroboscopicMap};
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation, TraceError};
use tangency::core::failure::OutOfDomain;
use tangency::core::hybrid::{
    Event, Guard, HybridFlow, HybridSettings, HybridState, HybridSystem, Member, Mode, Scales,
};
use tangency::core::local_map::{GrazingPoint, Iterated, LocalMap, MapSettings};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;
use tangency::core::system::Kind;
use tangency::problems::classic::ImpactOscillator;
use tangency::problems::mita::Actuator;

/// Times and lengths of the test, in the units of the systems.
const UNITS: [[f64; 2]; 12] = [
    [1e-8, 1.0],
    [1e-3, 1.0],
    [1e3, 1.0],
    [1e9, 1.0],
    [1.0, 1e-9],
    [1.0, 1e-6],
    [1.0, 1e3],
    [1e-8, 1e-9],
    [1e-8, 1e3],
    [1e-6, 1e-6],
    [1e9, 1e-9],
    [1e9, 1e3],
];

/// Those of the units in which attractors are searched, which takes longest: the ends of all ranges.
const EXTREME: [[f64; 2]; 6] =
    [[1e-8, 1.0], [1e9, 1.0], [1.0, 1e-9], [1.0, 1e3], [1e-8, 1e3], [1e9, 1e-9]];

/// A system with the same parameters, in other units: what was 1 is `time` or `length` now.
#[derive(Clone)]
struct Rescaled<S> {
    system: S,
    time: f64,
    length: f64,
    /// Whether the scale of time is stated, or the scale of the forcing.
    timed: bool,
    /// The sizes of the states of each mode.
    units: Vec<Vec<f64>>,
}

impl<S: HybridSystem> Rescaled<S> {
    fn new(system: S, [time, length]: [f64; 2], timed: bool) -> Self {
        let of = |mode: Mode| mode.states.iter().map(|it| unit(it, [time, length])).collect();
        let units = system.modes().into_iter().map(of).collect();
        Rescaled { system, time, length, timed, units }
    }

    /// A state in the units of the system.
    fn inner<T: Scalar>(&self, mode: usize, x: &[T]) -> Vec<T> {
        x.iter().zip(&self.units[mode]).map(|(x, unit)| *x / *unit).collect()
    }

    /// A state in these units.
    fn outer(&self, mode: usize, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.units[mode]).map(|(x, unit)| x * unit).collect()
    }
}

/// The size of a state that was 1, if the units of time and length are these.
fn unit(state: &str, [time, length]: [f64; 2]) -> f64 {
    if state.contains("velocity") { length / time } else { length }
}

impl<S: HybridSystem> HybridSystem for Rescaled<S> {
    fn modes(&self) -> Vec<Mode> {
        self.system.modes()
    }
    fn guards(&self) -> Vec<Guard> {
        self.system.guards()
    }
    fn parameters(&self) -> Vec<String> {
        self.system.parameters()
    }
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.system.field(mode, t / self.time, &self.inner(mode, x), p, f);
        f.iter_mut().zip(&self.units[mode]).for_each(|(f, unit)| *f *= *unit / self.time);
    }
    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        self.system.guard(guard, mode, t / self.time, &self.inner(mode, x), p) * self.length
    }
    fn reset<T: Scalar>(
        &self,
        guard: usize,
        modes: (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        self.system.reset(guard, modes, t / self.time, &self.inner(modes.0, x), p, after);
        after.iter_mut().zip(&self.units[modes.1]).for_each(|(x, unit)| *x *= *unit);
    }
    fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        self.system.next_mode(guard, mode, t / self.time, &self.inner(mode, x), p)
    }
    fn mode_after_accumulation(
        &self,
        guard: usize,
        mode: usize,
        t: f64,
        x: &[f64],
        p: &[f64],
    ) -> Option<usize> {
        let x = self.inner(mode, x);
        self.system.mode_after_accumulation(guard, mode, t / self.time, &x, p)
    }
    fn forcing(&self) -> Forcing {
        self.system.forcing()
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        self.system.period(p) * self.time
    }
    fn scales(&self, _p: &[f64]) -> Scales {
        let states = self.modes().into_iter().flat_map(|mode| mode.states);
        let time = self.timed.then_some(self.time);
        states.fold(Scales { time, ..Scales::default() }, |scales, state| {
            let unit = unit(&state, [self.time, self.length]);
            scales.state(state, unit)
        })
    }
    fn domain(&self, mode: usize, x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.system.domain(mode, &self.inner(mode, x), p)
    }
}

/// A system in all units.
fn rescaled<S: HybridSystem + Clone>(system: &S, timed: bool) -> impl Iterator<Item = Rescaled<S>> {
    let rescale = |units: [f64; 2]| Rescaled::new(system.clone(), units, timed);
    UNITS.map(rescale).into_iter()
}

#[track_caller]
fn alike(found: f64, expected: f64, size: f64, units: &str) {
    assert!((found - expected).abs() <= 1e-9 * size, "{units}: {found:e}, not {expected:e}");
}

/// Events of a motion over a duration, all in the units of the system.
fn events<S: HybridSystem>(
    scaled: &Rescaled<S>,
    (mode, x): (usize, &[f64]),
    duration: f64,
    p: &[f64],
) -> Vec<Event<f64>> {
    let mut flow = HybridFlow::new(scaled, HybridSettings::default()).unwrap();
    let mut state = HybridState { mode, time: 0.0, x: scaled.outer(mode, x) };
    let mut events = flow.events(&mut state, duration * scaled.time, p).unwrap();
    for event in &mut events {
        event.time /= scaled.time;
        event.before = scaled.inner(event.mode, &event.before);
    }
    events
}

/// The same events come at the same times, accumulations among them.
fn moves_alike<S: HybridSystem + Clone>(
    system: &S,
    start: (usize, &[f64]),
    duration: f64,
    p: &[f64],
) {
    let usual = Rescaled::new(system.clone(), [1.0; 2], true);
    let expected = events(&usual, start, duration, p);
    assert!(expected.iter().any(|event| event.accumulation), "{expected:?}");
    for scaled in rescaled(system, true) {
        let units = format!("time {:e}, length {:e}", scaled.time, scaled.length);
        let found = events(&scaled, start, duration, p);
        let told = |events: &[Event<f64>]| -> Vec<_> {
            events.iter().map(|e| (e.guard, e.mode, e.next, e.accumulation)).collect()
        };
        assert_eq!(told(&found), told(&expected), "{units}");
        for (found, expected) in found.iter().zip(&expected) {
            alike(found.time, expected.time, 1.0 + expected.time, &units);
            found.before.iter().zip(&expected.before).for_each(|(a, b)| alike(*a, *b, 1.0, &units));
        }
    }
}

#[test]
fn motions_do_not_depend_on_units() {
    // Chatter, contact, and release.
    let p = [1.5, 0.4, 0.6, 0.1, 0.2];
    moves_alike(&ImpactOscillator, (ImpactOscillator::FLIGHT, &[0.0, 0.0]), 60.0, &p);
    moves_alike(&BouncingBall, (BouncingBall::FLIGHT, &[0.5, 0.0]), 40.0, &[0.9, 0.5]);
    let mut p = Actuator::DEFAULTS;
    p[0] = 0.88;
    moves_alike(&Actuator, (Actuator::STICK, &[0.4, 0.0]), 60.0, &p);
}

/// Beyond a period doubling, where both points of a cycle are near each other, and where impacts
/// accumulate: the same periods, events and exponents in all units.
#[test]
fn attractors_do_not_depend_on_units() {
    let form = ClosedForm::usual(2.2);
    let doubled = form.amplitude(form.doubling());
    let oscillator = |amplitude| [amplitude, 2.2, form.restitution, form.damping, form.clearance];
    for share in [0.99, 1.001] {
        let p = oscillator(share * doubled);
        settle_alike(&ImpactOscillator, (ImpactOscillator::FLIGHT, &[0.0, 0.0]), &p);
    }
    let mut p = Actuator::DEFAULTS;
    for voltage in [0.57, 0.75, 0.875] {
        (p[0], p[1]) = (voltage, 0.5);
        settle_alike(&Actuator, (Actuator::STICK, &[0.1, -0.2]), &p);
    }
}

/// The attractor near the one on which a motion settles is the same one: transients may be chaotic
/// and end on several attractors.
fn settle_alike<S: HybridSystem + Clone>(system: &S, (mode, x): (usize, &[f64]), p: &[f64]) {
    let search = AttractorSearch { lyapunov_periods: 0, ..AttractorSearch::default() };
    let found = |scaled: &Rescaled<S>, (mode, x): (usize, &[f64])| {
        let mut map = PeriodMap::of(scaled, HybridSettings::default(), &[]).unwrap();
        let start = HybridState { mode, time: 0.0, x: scaled.outer(mode, x) };
        search.follow(&mut map, start, p).unwrap()
    };
    let usual = Rescaled::new(system.clone(), [1.0; 2], true);
    let expected = found(&usual, (mode, x));
    assert!(expected.periods.is_some(), "{expected:?}");
    let exponent = expected.exponent.expect("an exponent").value;
    let near: Vec<f64> = expected.end.x.iter().map(|x| x * (1.0 + 1e-4)).collect();
    let extreme = |scaled: &Rescaled<S>| EXTREME.contains(&[scaled.time, scaled.length]);
    for scaled in rescaled(system, true).filter(extreme) {
        let units = format!("time {:e}, length {:e}, {p:?}", scaled.time, scaled.length);
        let found = found(&scaled, (expected.end.mode, &near));
        assert_eq!((found.periods, &found.events), (expected.periods, &expected.events), "{units}");
        let other = found.exponent.expect("an exponent").value;
        assert!(other == exponent || (other - exponent).abs() < 1e-7, "{units}: {other}");
    }
}

/// A ball that falls on a table at rest, with a forcing that does nothing.
struct Ball;

impl HybridSystem for Ball {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("flight", ["height", "velocity"]), Mode::new("rest", [] as [&str; 0])]
    }
    fn guards(&self) -> Vec<Guard> {
        vec![Guard::new("impact", [0]).accumulating_to(1)]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["frequency".into()]
    }
    fn field<T: Scalar>(&self, mode: usize, _t: T, x: &[T], _p: &[T], f: &mut [T]) {
        if mode == 0 {
            (f[0], f[1]) = (x[1], -T::one());
        }
    }
    fn guard<T: Scalar>(&self, _guard: usize, _mode: usize, _t: T, x: &[T], _p: &[T]) -> T {
        x[0]
    }
    fn reset<T: Scalar>(
        &self,
        _guard: usize,
        (_, next): (usize, usize),
        _t: T,
        x: &[T],
        _p: &[T],
        after: &mut [T],
    ) {
        if next == 0 {
            (after[0], after[1]) = (T::zero(), x[1] * -0.7);
        }
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        p[0].recip() * TAU
    }
}

/// The scale of time of a system that states none is continuous along its frequency: it decides
/// from when on impacts that accumulate are not followed one by one.
#[test]
fn the_scale_of_time_is_continuous_along_the_frequency() {
    let impacts = |frequency: f64| {
        let mut flow = HybridFlow::new(&Ball, HybridSettings::default()).unwrap();
        let mut state = HybridState { mode: 0, time: 0.0, x: vec![0.5, 0.0] };
        flow.events(&mut state, 7.0, &[frequency]).unwrap().len()
    };
    for frequency in [0.01, 0.1, 1.0, 10.0, 100.0] {
        assert_eq!(impacts(frequency * (1.0 - 1e-9)), impacts(frequency * (1.0 + 1e-9)));
    }
    assert!(impacts(100.0) > impacts(1.0) && impacts(1.0) > impacts(0.01));
}

/// The branch without impacts to its grazing, and the branch that begins there.
fn branches(orbits: &mut BoundarySystem, form: &ClosedForm) -> Result<[Branch; 2], TraceError> {
    let end = 2.0 * form.grazing();
    let run = Continuation::new(orbits).at("amplitude", 0.5 * form.grazing());
    let run = run.at("frequency", form.frequency).at("restitution", form.restitution);
    let run = run.at("damping", form.damping).at("clearance", form.clearance);
    let smooth = run.along("amplitude", 0.5 * form.grazing()..=end).trace()?;
    let grazing = smooth.of_kind(Kind::G).next().expect("a grazing").label;
    let run = Continuation::new(orbits).restart(&smooth, grazing).switch();
    let impacting = run.along("amplitude", 0.5 * form.grazing()..=end).trace()?;
    Ok([smooth, impacting])
}

/// Grazings and folds or period doublings of the branches from grazing are where closed forms say,
/// and so is what the local map says of the grazing.
#[test]
fn branches_and_local_maps_do_not_depend_on_units() {
    let parameters = ["amplitude"];
    for (frequency, kind) in [(1.0, Kind::LP), (2.2, Kind::PD)] {
        let form = ClosedForm::usual(frequency);
        let expected = match kind {
            Kind::LP => form.fold_amplitude(),
            _ => form.amplitude(form.doubling()),
        };
        let mut growth = None;
        let usual = Rescaled::new(ImpactOscillator, [1.0; 2], false);
        for scaled in std::iter::once(usual).chain(rescaled(&ImpactOscillator, false)) {
            let units = format!("time {:e}, length {:e}", scaled.time, scaled.length);
            let orbit = HybridOrbit::of(scaled.clone(), Itinerary::smooth(0, 1)).unwrap();
            let mut orbits =
                BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)]).unwrap();
            let [smooth, impacting] =
                branches(&mut orbits, &form).unwrap_or_else(|cause| panic!("{units}: {cause}"));
            let grazing = smooth.of_kind(Kind::G).next().expect("a grazing");
            alike(grazing.parameters[0], form.grazing(), form.grazing(), &units);
            let special = impacting.of_kind(kind).next();
            let special = special.unwrap_or_else(|| panic!("{units}: no {kind}")).parameters[0];
            alike(special, expected, expected, &units);
            let orbit = HybridOrbit::of(scaled.clone(), Itinerary::smooth(0, 1)).unwrap();
            let mut orbits =
                BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)]).unwrap();
            let point = GrazingPoint::at(&mut orbits, &smooth.solution(grazing)).unwrap();
            let point = point.located(&scaled, "amplitude").unwrap();
            let settings = MapSettings { order: 3, ..MapSettings::default() };
            let map = LocalMap::of(&scaled, &point, &parameters, settings).unwrap();
            let found = map.classified("amplitude").unwrap();
            // The multiplier is growth/y, with y the root of a length.
            let found = found.growth / scaled.length.sqrt();
            alike(found, *growth.get_or_insert(found), found.abs(), &units);
            // Iterates near the grazing are accepted, and those a length away are refused.
            let p = vec![form.grazing()];
            let mut iterated = Iterated::of(map, &parameters.map(String::from), &[]).unwrap();
            for (deviation, accepted) in [(1e-3, true), (100.0, false)] {
                let x = vec![deviation * scaled.length, 0.0];
                let state = HybridState { mode: 0, time: 0.0, x };
                let moved = iterated.advance(&mut Member { state, p: p.clone() });
                assert_eq!(moved.is_ok(), accepted, "{units}: {moved:?}");
            }
        }
    }
}
