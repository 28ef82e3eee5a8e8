//! Promise: at compliant stops the discontinuity map has the order in the penetration that theory
//! says, with the coefficients of closed forms; the map agrees with event-driven simulation to its
//! order, and the orbit goes on.

use crate::common::close;
use crate::grazing::orders::Case;
use crate::grazing::points::{Touching, settings};
use crate::hybrid::systems::sliding::Sliding;
use std::f64::consts::TAU;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation};
use tangency::core::hybrid::HybridSystem;
use tangency::core::hybrid::filippov::Filippov;
use tangency::core::local_map::{GrazingError, GrazingPoint, LocalMap, LocalOrbit, Scenario};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::Kind;
use tangency::hybrid_system;

hybrid_system! {
    /// `x'' + 0.1 x' + x = A cos ωt − s(x − 1)`, where the stop at x = 1 presses by
    /// `s(z) = F + K z + L z²` from z = 0 on, and lets go at z = −gap.
    struct Stop [A, omega, F, K, L, gap; t] {
        period = omega.recip() * TAU;
        mode free [x, v] {
            d/dt x = v;
            d/dt v = A * (omega * t).cos() - v * 0.1 - x;
            event touch: -x + 1.0 => pressed;
        }
        mode pressed [x, v] {
            let deep = x - 1.0;
            let stop = F + K * deep + L * deep * deep;
            d/dt x = v;
            d/dt v = A * (omega * t).cos() - v * 0.1 - x - stop;
            event leave: x - 1.0 + gap => free;
        }
    }
}

/// A force without a preload, of a stiffness; one of the second degree; and one with a preload.
const LINEAR: [f64; 3] = [0.0, 10.0, 0.0];
const QUADRATIC: [f64; 3] = [0.0, 0.0, 10.0];
const PRELOADED: [f64; 3] = [0.3, 10.0, 0.0];

const FREE: usize = 0;
const FREQUENCY: f64 = 0.8;

/// The amplitude at which the orbit that touches no stop reaches it.
fn grazing() -> f64 {
    (1.0 - FREQUENCY * FREQUENCY).hypot(0.1 * FREQUENCY)
}

impl Touching for Stop {
    fn turning(&self, _t: f64, x: &[f64], _p: &[f64]) -> f64 {
        -x[1]
    }
}

/// Orbits that touch no stop, their branch, and the one that grazes.
fn grazing_orbit([preload, stiffness, second]: [f64; 3]) -> (BoundarySystem, Branch, GrazingPoint) {
    let orbit = HybridOrbit::of(Stop, Itinerary::smooth(FREE, 1)).unwrap();
    let mut orbits =
        BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)]).unwrap();
    let run = Continuation::new(&mut orbits).at("omega", FREQUENCY);
    let run = run.at("F", preload).at("K", stiffness).at("L", second);
    let branch = run.at("A", 0.2).along("A", 0.2..=0.6).trace().unwrap();
    let touch = branch.of_kind(Kind::G).next().unwrap();
    close(touch.parameters[0], grazing(), 1e-10);
    let point = GrazingPoint::at(&mut orbits, &branch.solution(touch)).unwrap();
    (orbits, branch, point.located(&Stop, "A").unwrap())
}

fn map_of(stop: [f64; 3], order: usize) -> LocalMap {
    LocalMap::of(&Stop, &grazing_orbit(stop).2, &["A"], settings(order)).unwrap()
}

/// With the deceleration `a = ω²` the stop is deep by `y² − a s²/2`, and its impulse moves the
/// section in time: `−(4K/3a) √(2/a) y³` and `−(16L/15a) √(2/a) y⁵`. A preload makes the stay
/// shorter, `−2F/(a + F) √(2/a) y`.
#[test]
fn the_order_is_that_of_the_theory() {
    let a = FREQUENCY * FREQUENCY;
    let root = (2.0 / a).sqrt();
    for (stop, power, time) in [
        (LINEAR, 3, -4.0 * 10.0 / (3.0 * a) * root),
        (QUADRATIC, 5, -16.0 * 10.0 / (15.0 * a) * root),
        (PRELOADED, 1, -2.0 * 0.3 / (a + 0.3) * root),
    ] {
        let map = map_of(stop, 5);
        assert_eq!(map.exponent(), Some(f64::from(power) / 2.0));
        assert_eq!(map.coordinates(), ["x", "phase"]);
        let [x, phase] = map.discontinuity() else { panic!("two coordinates") };
        close(phase.coefficient(&[power as u8, 0, 0]) / (FREQUENCY * time), 1.0, 1e-9);
        for lower in 1..power as u8 {
            assert!(phase.coefficient(&[lower, 0, 0]).abs() < 1e-9);
        }
        // The highest place is that of the virtual point but for higher orders.
        close(x.coefficient(&[1, 0, 0]), 0.0, 1e-10);
        assert!(map.to_string().contains(&format!("leading term y^{power}\n")));
    }
    // To second order the map of a soft stop is the identity.
    let map = map_of(LINEAR, 2);
    assert_eq!(map.exponent(), None);
    assert!(map.to_string().contains("the identity up to this order"));
}

/// Against event-driven simulation the error is of the order above.
#[test]
fn maps_agree_with_simulation() {
    for stop in [LINEAR, QUADRATIC, PRELOADED] {
        let (.., point) = grazing_orbit(stop);
        let map = LocalMap::of(&Stop, &point, &["A"], settings(5)).unwrap();
        let place = |y: f64, aside: f64, p: &[f64]| {
            (point.time + aside / p[1], vec![point.x[0] + y * y, 0.0])
        };
        let (system, point, map) = (&Stop, &point, &map);
        Case { system, point, map, place: &place, parameters: &[0] }.orders_hold(0.005);
    }
}

/// A soft stop changes nothing at once; the branch of the map beyond the grazing is that of the
/// flow.
#[test]
fn motion_goes_on_at_a_soft_stop() {
    let map = map_of(LINEAR, 5);
    let found = map.classified("A").unwrap();
    assert_eq!(found.scenario, Scenario::Persistent);
    assert!(found.distance < 0.0 && found.depth > 0.0 && found.growth == 0.0);
    // |μ| = exp(−0.05 T).
    let (re, im) = found.multipliers[0];
    close(re.hypot(im), (-0.05 * TAU / FREQUENCY).exp(), 1e-9);
    assert_eq!(map_of(LINEAR, 1).classified("A"), Err(GrazingError::NoRoot));
}

/// A stop that lets go elsewhere than it is touched lets go there for an orbit of no speed alike
/// only by chance.
#[test]
fn surfaces_that_agree_at_one_point_only_are_refused() {
    let point = grazing_orbit(LINEAR).2;
    let error = LocalMap::of(&Stop, &point, &["A", "gap"], settings(3)).unwrap_err();
    let GrazingError::Apart { touched, back, left } = &error else { panic!("{error}") };
    assert_eq!((touched.as_str(), back.as_str()), ("touch", "leave"));
    close(*left, 1.0, 1e-6);
}

/// Near the grazing orbits that press the stop double their period: their local map finds the same
/// place, the nearer the higher its order.
#[test]
fn the_map_follows_the_orbits_of_the_flow() {
    let (mut orbits, free, point) = grazing_orbit([0.0, 100.0, 0.0]);
    let touch = free.of_kind(Kind::G).next().unwrap().label;
    let run = Continuation::new(&mut orbits).restart(&free, touch).switch();
    let pressed = run.along("A", 0.3687..=0.369).trace().unwrap();
    let exact = pressed.of_kind(Kind::PD).next().unwrap().parameters[0];
    let error = |order: usize| {
        let map = LocalMap::of(&Stop, &point, &["A"], settings(order)).unwrap();
        let mut points = LocalOrbit::of(map, &[false]).system().unwrap();
        let run = Continuation::new(&mut points).at("A", -1e-5);
        let free = run.along("A", -1e-4..=1e-4).trace().unwrap();
        let touch = free.of_kind(Kind::G).next().unwrap().label;
        let run = Continuation::new(&mut points).restart(&free, touch).switch();
        let pressed = run.along("A", -1e-4..=1e-4).trace().unwrap();
        // No multiplier can be told where both orbits meet, or it is that of the orbit that is
        // free.
        assert_ne!(pressed.special[0].unstable, Some(1));
        let doubling = pressed.of_kind(Kind::PD).next().unwrap();
        (point.p[0] + doubling.parameters[0] - exact).abs()
    };
    // Odd powers of y alone count: even orders gain little.
    let errors = [3, 5, 7].map(error);
    let gains = errors.is_sorted_by(|a, b| *a > 30.0 * b);
    assert!(gains && errors[2] < 1e-9, "{errors:?}");
}

/// The friction oscillator on a belt, where it slips.
type Belt = Filippov<Sliding>;

impl Touching for Belt {
    fn turning(&self, t: f64, x: &[f64], p: &[f64]) -> f64 {
        let mut f = [0.0; 2];
        HybridSystem::field(self, Belt::ABOVE, t, x, p, &mut f);
        -f[1]
    }
}

/// Where an orbit begins to slide its map is piecewise linear in the penetration, and motion goes
/// on with a stay on the surface (M. di Bernardo, P. Kowalczyk, A. Nordmark, *Physica D*
/// 170:175, 2002).
#[test]
fn the_map_of_a_grazing_sliding_has_no_root() {
    let belt = Filippov(Sliding::Friction);
    let orbit = HybridOrbit::of(belt, Itinerary::smooth(Belt::ABOVE, 1)).unwrap();
    let mut orbits =
        BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)]).unwrap();
    let run = Continuation::new(&mut orbits);
    let run = Sliding::Friction.parameters().iter().fold(run, |run, (name, p)| run.at(name, *p));
    let branch = run.at("nu", 4.0).along("nu", 3.0..=4.0).trace().unwrap();
    let touch = branch.of_kind(Kind::G).next().unwrap();
    close(touch.parameters[0], 3.20856896212, 1e-8);
    let point = GrazingPoint::at(&mut orbits, &branch.solution(touch)).unwrap();
    let point = point.located(&belt, "A").unwrap();
    let map = LocalMap::of(&belt, &point, &["A"], settings(4)).unwrap();
    assert_eq!(map.exponent(), Some(1.0));
    assert_eq!(map.classified("A").unwrap().scenario, Scenario::Persistent);
    let place = |y: f64, aside: f64, p: &[f64]| {
        let (t, w) = (point.time + aside / p[0], -y * y);
        // At rest against the belt: u = A cos νt + a₀ − a₁ w + a₂ w³.
        let u = p[1] * (p[0] * t).cos() + p[2] - p[3] * w + p[4] * w.powi(3);
        (t, vec![u, 1.0 - w])
    };
    let (system, point, map) = (&belt, &point, &map);
    Case { system, point, map, place: &place, parameters: &[1] }.orders_hold(0.005);
}
