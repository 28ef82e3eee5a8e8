//! Promise: what motions near a grazing settle on is what the local map, iterated, settles on:
//! cycles, exponents and where attractors are lost.

use crate::common::close;
use crate::grazing::points::{actuator, oscillator, settings};
use crate::hybrid::systems::impact_oscillator::ClosedForm;
use num_dual::Dual64;
use tangency::core::attractor::{
    Attractor, AttractorSearch, CrisisSearch, Exponent, PeriodMap, StroboscopicError,
    StroboscopicMap,
};
use tangency::core::hybrid::{HybridSettings, HybridState, HybridSystem, Member};
use tangency::core::local_map::{GrazingError, Iterated, LocalMap};
use tangency::problems::mita::Actuator;

fn at(x: &[f64]) -> HybridState<f64> {
    HybridState { mode: 0, time: 0.0, x: x.to_vec() }
}

/// The actuator's map in the voltage at ω = 0.485, of type II, to the fourth order, and its grazing
/// voltage.
fn map() -> (LocalMap, f64) {
    let point = actuator(0.1717414232, 0.485, 5.406828312).located(&Actuator, "voltage").unwrap();
    let map = LocalMap::of(&Actuator, &point, &["voltage"], settings(4)).unwrap();
    (map, point.p[0])
}

/// Tangent vectors go as differences of images do, with an impact and without.
#[test]
fn tangents_are_pushed_forward() {
    let map = oscillator(&ClosedForm::usual(1.2), &["amplitude"], 4);
    let p = [map.origin().1[0] + 1e-4];
    let mut iterated = Iterated::of(map, &["amplitude".into()], &["penetration".into()]).unwrap();
    for (x, impacts) in [([4e-3, 1e-3], 1), ([-4e-3, 1e-3], 0)] {
        let (v, step) = ([0.6, -0.8], 1e-6);
        let mut image = |sign: f64| {
            let state = at(&[x[0] + sign * step * v[0], x[1] + sign * step * v[1]]);
            let mut member = Member { state, p: p.to_vec() };
            iterated.advance(&mut member).unwrap();
            member.state.x
        };
        let (ahead, behind) = (image(1.0), image(-1.0));
        let moving = (0..2).map(|k| Dual64::new(x[k], v[k])).collect();
        let state = HybridState { mode: 0, time: 0.0.into(), x: moving };
        let mut moving = Member { state, p: p.map(Dual64::from).to_vec() };
        let period = iterated.record(&mut Member { state: at(&x), p: p.to_vec() }).unwrap();
        assert_eq!((period.events.len(), period.measures[0] > 0.0), (impacts, impacts == 1));
        iterated.push_forward(&mut moving).unwrap();
        for k in 0..2 {
            close(moving.state.x[k].eps, (ahead[k] - behind[k]) / (2.0 * step), 1e-6);
        }
    }
}

/// What the map and the simulated motion settle on at a voltage so far beyond grazing.
fn both(beyond: f64, search: AttractorSearch) -> [Attractor; 2] {
    let (map, grazing) = map();
    let mut p = Actuator::DEFAULTS;
    (p[0], p[1]) = (grazing + beyond, 0.485);
    let mut iterated = Iterated::of(map, &Actuator.parameters(), &[]).unwrap();
    let mut motion = PeriodMap::of(&Actuator, HybridSettings::default(), &[]).unwrap();
    [
        search.follow(&mut iterated, at(&[-1e-4, 0.0]), &p).unwrap(),
        search.follow(&mut motion, at(&[0.1, -0.2]), &p).unwrap(),
    ]
}

/// Behind its period doubling, V = 0.176318773, P(1,1) attracts, and its exponent is that of the
/// flow.
#[test]
fn cycles_have_their_exponents() {
    let [map, flow] = both(6e-3, AttractorSearch { transient: 1000, ..AttractorSearch::default() });
    assert_eq!((map.periods, flow.periods), (Some(1), Some(1)));
    assert_eq!((map.count("impact"), flow.count("front")), (1.0, 1.0));
    let [map, flow] = [map, flow].map(|settled| settled.exponent.unwrap().value);
    assert!(flow < 0.0);
    close(map, flow, 5e-3 * flow.abs());
}

/// Chaos beyond grazing: both exponents are positive, and agree within their errors; so do the
/// shares of impacts.
#[test]
fn chaos_has_its_exponent() {
    let search = AttractorSearch {
        transient: 500,
        recorded_periods: 4000,
        lyapunov_periods: 4000,
        ..AttractorSearch::default()
    };
    let [map, flow] = both(1.5e-3, search);
    assert_eq!((map.periods, flow.periods), (None, None));
    let [a, b]: [Exponent; 2] = [&map, &flow].map(|settled| settled.exponent.unwrap());
    assert!(b.value > 5.0 * b.error, "{b:?}");
    close(a.value, b.value, 4.0 * a.error.hypot(b.error));
    close(map.count("impact"), flow.count("front"), 0.02);
}

/// Downwards at ω = 0.4793, of type III, chaos is lost to the orbit without impacts before this
/// grazes, as the map says and simulation: at the same voltage to the last steps of the bisection.
/// (Grazing and fold are 7.3e-5 apart.)
#[test]
fn chaos_is_lost_where_the_map_says() {
    let point = actuator(0.178194172275, 0.4793, 2.12430317154 + std::f64::consts::PI);
    let point = point.located(&Actuator, "voltage").unwrap();
    close(point.p[0], 0.178194172275, 1e-11);
    let map = LocalMap::of(&Actuator, &point, &["voltage"], settings(4)).unwrap();
    let mut iterated = Iterated::of(map, &Actuator.parameters(), &[]).unwrap();
    let mut motion = PeriodMap::of(&Actuator, HybridSettings::default(), &[]).unwrap();
    let search = AttractorSearch {
        transient: 6000,
        recorded_periods: 50,
        lyapunov_periods: 0,
        ..AttractorSearch::default()
    };
    let between = [0.1790, 0.1780];
    let lost = |motion: &mut dyn StroboscopicMap, start: &[f64]| {
        let sought = CrisisSearch::of(0, between, 1e-6);
        let crisis = search.crisis(motion, at(start), &point.p, &sought).unwrap();
        assert_eq!(crisis.beyond, Some(1));
        crisis.between[1]
    };
    let [map, flow] = [lost(&mut iterated, &[1e-4, 0.0]), lost(&mut motion, &[0.5, 0.05])];
    assert!(flow > point.p[0] && flow < 0.178267439255, "{flow}");
    close(map, flow, 2e-6);
}

/// A map that is left, and names that there are not.
#[test]
fn maps_that_are_left_say_so() {
    let (map, grazing) = map();
    let refused = Iterated::of(map.clone(), &["frequency".into()], &[]);
    assert!(matches!(refused.err(), Some(GrazingError::Unknown(_))));
    let refused = Iterated::of(map.clone(), &["voltage".into()], &["depth".into()]);
    assert!(matches!(refused.err(), Some(GrazingError::Unknown(_))));
    let mut iterated = Iterated::of(map, &["voltage".into()], &[]).unwrap();
    let mut member = Member { state: at(&[0.5, 0.9]), p: vec![grazing + 3.0] };
    let left = iterated.advance(&mut member).unwrap_err();
    assert!(
        matches!(left, StroboscopicError::Map(_)) && left.to_string().contains("start closer"),
        "{left}"
    );
}
