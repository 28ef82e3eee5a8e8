//! Grazing orbits, shared by tests of local maps.

use crate::hybrid::systems::impact_oscillator::ClosedForm;
use std::f64::consts::PI;
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState, HybridSystem, InMode};
use tangency::core::local_map::{GrazingPoint, LocalMap, MapSettings};
use tangency::core::ode::{Flow, Scheme, Settings};
use tangency::core::orbit::{HybridOrbit, Itinerary, Leg};
use tangency::problems::classic::ImpactOscillator;
use tangency::problems::mita::Actuator;

/// The grazing point of the actuator's front stopper at a voltage, a frequency and a phase: after
/// an impact the frame slips forward until it rests.
pub fn actuator(voltage: f64, frequency: f64, phase: f64) -> GrazingPoint {
    let front = Actuator::FRONT;
    let mut p = Actuator::DEFAULTS;
    (p[0], p[1]) = (voltage, frequency);
    GrazingPoint {
        guard: front,
        mode: Actuator::STICK,
        time: phase / frequency,
        x: vec![p[2], 0.0],
        p: p.to_vec(),
        following: vec![Leg::new(Actuator::FORWARD, Some(Actuator::REST))],
        legs: vec![(Leg::new(Actuator::STICK, Some(front)), PI / frequency)],
        periods: 1,
    }
}

pub fn settings(order: usize) -> MapSettings {
    MapSettings { order, ..MapSettings::default() }
}

/// A hybrid system with one guard that orbits touch in mode 0, of which a test knows the rate.
pub trait Touching: HybridSystem {
    /// `dh/dt` along the motion of mode 0.
    fn turning(&self, t: f64, x: &[f64], p: &[f64]) -> f64;
}

impl Touching for Actuator {
    fn turning(&self, _t: f64, x: &[f64], _p: &[f64]) -> f64 {
        -x[1]
    }
}

/// Motion is simulated from so long before a virtual point to so long before or after the image.
const ASIDE: f64 = 0.3;

/// Moves along the field of mode 0.
fn along<S: HybridSystem>(system: &S, time: f64, (t, x): &mut (f64, Vec<f64>), p: &[f64]) {
    let flow = Settings::new(Scheme::DormandPrince8, 1e-14);
    let mut flow = Flow::<f64>::new(flow).unwrap();
    flow.advance(&InMode { system, mode: 0 }, *t, time, x, p).unwrap();
    *t += time;
}

/// The image of a virtual point on the section by event-driven simulation: after one turn of a
/// duration, or, for none, by the discontinuity map.
pub fn simulated<S: Touching>(
    system: &S,
    start: &(f64, Vec<f64>),
    duration: f64,
    p: &[f64],
) -> (f64, Vec<f64>) {
    let mut begin = start.clone();
    along(system, -ASIDE, &mut begin, p);
    let flow = Settings::new(Scheme::DormandPrince8, 1e-14);
    let settings = HybridSettings { flow, ..HybridSettings::default() };
    let mut state = HybridState { mode: 0, time: begin.0, x: begin.1 };
    let mut flow = HybridFlow::new(system, settings).unwrap();
    let length = if duration == 0.0 { 2.0 * ASIDE } else { duration };
    flow.advance(&mut state, length, p, &mut ()).unwrap();
    assert_eq!(state.mode, 0, "the motion is in another mode at t = {}", state.time);
    let mut place = (state.time, state.x);
    // The secant method along the field, until the guard is least.
    let (mut step, mut before) = (1e-3, system.turning(place.0, &place.1, p));
    for _ in 0..30 {
        along(system, step, &mut place, p);
        let now = system.turning(place.0, &place.1, p);
        if now == before || step == 0.0 {
            break;
        }
        step = -now * step / (now - before);
        before = now;
    }
    place
}

/// The local map of the oscillator at its grazing, with phase ωt.
pub fn oscillator(form: &ClosedForm, parameters: &[&str], order: usize) -> LocalMap {
    let orbit =
        HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1)).unwrap();
    let p = [form.grazing(), form.frequency, form.restitution, form.damping, form.clearance];
    let point = GrazingPoint::of(&orbit, &form.motion(form.grazing(), 0.0), &p).unwrap();
    let point = point.located(&ImpactOscillator, "amplitude").unwrap();
    assert!((point.p[0] - form.grazing()).abs() < 1e-12);
    let settings = MapSettings { order, ..MapSettings::default() };
    LocalMap::of(&ImpactOscillator, &point, parameters, settings).unwrap()
}

/// The grazing orbit of the actuator without impacts at a frequency near 0.4878, from that point in
/// small steps.
pub fn along_grazings(frequency: f64) -> GrazingPoint {
    let mut point = actuator(0.171066688958, 0.487808700440, 5.496543861);
    let steps = 10;
    let change = (frequency - point.p[1]) / f64::from(steps);
    for _ in 0..steps {
        let before = point.p[1];
        point.p[1] += change;
        point.time *= before / point.p[1];
        point.legs[0].1 = PI / point.p[1];
        point = point.located(&Actuator, "voltage").unwrap();
    }
    point
}
