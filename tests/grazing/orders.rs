//! Promise: against event-driven simulation the error of the local map of order `n` is of the order
//! above, by the distance from grazing: with slip after the impact, through other impacts, for a
//! guard that moves and depends on several states, and without forcing.

use crate::grazing::points::{Touching, actuator, settings, simulated};
use std::f64::consts::TAU;
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::Continuation;
use tangency::core::hybrid::{HybridSystem, InMode};
use tangency::core::local_map::{GrazingPoint, LocalMap, MapSettings};
use tangency::core::ode::{Flow, Scheme};
use tangency::core::orbit::{HybridOrbit, Itinerary, Leg};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;
use tangency::core::system::{Kind, System};
use tangency::hybrid_system;
use tangency::problems::mita::Actuator;

/// The place of a virtual point of a depth, the other coordinates being aside by a number, at these
/// parameters.
pub type Virtual<'a> = dyn Fn(f64, f64, &[f64]) -> (f64, Vec<f64>) + 'a;

/// A system with its map and its grazing orbit, and virtual points on the section.
pub struct Case<'a, S> {
    pub system: &'a S,
    pub point: &'a GrazingPoint,
    pub map: &'a LocalMap,
    pub place: &'a Virtual<'a>,
    /// Positions of the parameters that deviate.
    pub parameters: &'a [usize],
}

/// Below this errors are those of the simulation.
const ROUNDING: f64 = 3e-12;

impl<S: Touching> Case<'_, S> {
    /// Coordinates on the section, as deviations; the state that the section determines is the
    /// second one.
    fn coordinates(&self, (t, x): &(f64, Vec<f64>), turn: f64, p: &[f64]) -> Vec<f64> {
        let states = (0..x.len()).filter(|i| *i != 1).map(|i| x[i] - self.point.x[i]);
        let phase = match self.system.forcing() {
            Forcing::None => None,
            Forcing::Periodic { phase } => {
                let unit = |p: &[f64]| self.system.period(p) / phase;
                let cycle = if turn > 0.0 { phase * self.point.periods as f64 } else { 0.0 };
                Some(t / unit(p) - self.point.time / unit(&self.point.p) - cycle)
            }
        };
        states.chain(phase).collect()
    }

    /// The largest errors of the maps of all orders at a distance from grazing.
    fn errors(&self, distance: f64) -> Vec<f64> {
        let mut p = self.point.p.clone();
        let change = 0.3 * distance;
        self.parameters.iter().for_each(|k| p[*k] += change);
        let start = (self.place)(distance, 0.5 * distance, &p);
        let turn = self.point.legs.iter().map(|leg| leg.1).sum::<f64>();
        let image = simulated(self.system, &start, turn, &p);
        let exact = self.coordinates(&image, turn, &p);
        let x = self.coordinates(&start, 0.0, &p);
        let error = |order: usize| {
            let mut x = x.clone();
            let p = vec![change; self.parameters.len()];
            self.map.iteration_to(order).apply(&mut x, &p);
            x.iter().zip(&exact).fold(0.0, |most: f64, (a, b)| (a - b).abs().max(most))
        };
        (1..=self.map.space().order()).map(error).collect()
    }

    /// Halving the distance divides the error by `2^{n+1}`, with a half of that for what is of
    /// higher order.
    pub fn orders_hold(&self, distance: f64) {
        let (far, near) = (self.errors(distance), self.errors(0.5 * distance));
        for (n, (far, near)) in far.iter().zip(&near).enumerate() {
            let order = (far / near).log2();
            assert!(
                order > n as f64 + 2.0 - 0.5 || *near < ROUNDING,
                "order {}: {far:.2e} → {near:.2e}, {order:.2}",
                n + 1
            );
        }
        // And the highest order is much better than the first.
        let best = near.iter().fold(f64::INFINITY, |best, error| error.min(best));
        assert!(best < 1e-3 * near[0], "{near:?}");
    }
}

/// Mita's actuator at ω = 0.5: an impact and a slip.
#[test]
fn impacts_with_slip() {
    let point = actuator(0.2271775831, 0.5, 5.985512558).located(&Actuator, "voltage").unwrap();
    let map = LocalMap::of(&Actuator, &point, &["voltage", "frequency"], settings(5)).unwrap();
    let place = |y: f64, aside: f64, p: &[f64]| {
        let phase = 0.5 * point.time + aside;
        (phase / p[1], vec![point.x[0] + y * y, 0.0])
    };
    let (system, point, map) = (&Actuator, &point, &map);
    Case { system, point, map, place: &place, parameters: &[0, 1] }.orders_hold(0.02);
}

/// The orbit with one impact in a period that touches the front stopper a second time, at V =
/// 0.733767719564: once around leads through an impact and a slip. The grazing point comes from the
/// branch that ends there.
#[test]
fn through_another_impact() {
    let start = actuator(0.2271775831, 0.5, 5.985512558).located(&Actuator, "voltage").unwrap();
    let itinerary = Itinerary::read("forward:rest stick:front", &Actuator).unwrap();
    let problem = HybridOrbit::of(Actuator, itinerary).unwrap();
    let method = Shooting::new(Scheme::DormandPrince8, 1e-13).unwrap();
    let mut orbits = BoundarySystem::new(problem, method, vec![Mesh::uniform(1); 2]).unwrap();
    let states = [0.5, 0.0, 0.0, 0.0, 0.5, 0.0];
    let extras = [start.time, 0.0, TAU];
    let z = orbits.flowed(&states, &extras, &start.p).unwrap();
    let names = orbits.names().parameters.clone();
    let run = Continuation::new(&mut orbits).from(&z);
    let run = names.iter().zip(&start.p).fold(run, |run, (name, p)| run.at(name, *p));
    let branch = run.along("voltage", 0.1..=0.8).trace().unwrap();
    let contact =
        branch.of_kind(Kind::G).max_by(|a, b| a.parameters[0].total_cmp(&b.parameters[0]));
    let contact = contact.unwrap();
    crate::common::close(contact.parameters[0], 0.733767719564, 1e-10);
    let point = GrazingPoint::at(&mut orbits, &branch.solution(contact)).unwrap();
    assert_eq!((point.legs.len(), point.following.len()), (3, 1));
    let point = point.located(&Actuator, "voltage").unwrap();
    let map = LocalMap::of(&Actuator, &point, &["voltage"], settings(4)).unwrap();
    let place =
        |y: f64, aside: f64, p: &[f64]| (point.time + aside / p[1], vec![point.x[0] + y * y, 0.0]);
    let (system, point, map) = (&Actuator, &point, &map);
    Case { system, point, map, place: &place, parameters: &[0] }.orders_hold(0.005);
}

hybrid_system! {
    /// A mass on a spring before a stop that moves; a further state, which the stop follows, is driven
    /// by the mass.
    struct Follower [drive, stop, restitution; t] {
        period = T::constant(TAU);
        mode free [x, v, w] {
            let followed = Follower::velocity(t, [x, w]);
            d/dt x = v;
            d/dt v = drive * (t + 0.4).cos() - x * 2.3 - v * 0.3 - x.powi(3) * 0.4 + w * 0.2;
            d/dt w = x * v * 0.3 - w;
            event hit: stop - x - w * w * 0.1 - t.sin() * 0.05
                => free { x, v: followed - (v - followed) * restitution, w };
        }
    }
}

impl Follower {
    /// The velocity at which the mass follows the stop.
    fn velocity<T: Scalar>(t: T, [x, w]: [T; 2]) -> T {
        (w * w * 0.2 - t.cos() * 0.05) / (w * x * 0.06 + 1.0)
    }
}

impl Touching for Follower {
    fn turning(&self, t: f64, x: &[f64], _p: &[f64]) -> f64 {
        (Follower::velocity(t, [x[0], x[2]]) - x[1]) * (1.0 + 0.06 * x[0] * x[2])
    }
}

/// Returns the place at which the settled motion of a system is nearest to a guard, as a guess of a
/// grazing point.
fn settled<S: HybridSystem>(
    system: &S,
    start: &[f64],
    mut p: Vec<f64>,
    stop: usize,
    period: f64,
) -> GrazingPoint {
    let (mut x, mut flow) = (start.to_vec(), Flow::<f64>::default());
    let field = InMode { system, mode: 0 };
    // The guard is the stop's place less what is touched.
    let reach = |t: f64, x: &[f64], p: &[f64]| p[stop] - system.guard(0, 0, t, x, p);
    for _ in 0..60 {
        flow.advance(&field, 0.0, period, &mut x, &p).unwrap();
    }
    let (steps, mut nearest) = (20_000, (f64::MIN, 0.0, Vec::new()));
    for k in 0..steps {
        let t = period * f64::from(k) / f64::from(steps);
        if reach(t, &x, &p) > nearest.0 {
            nearest = (reach(t, &x, &p), t, x.clone());
        }
        flow.advance(&field, t, period / f64::from(steps), &mut x, &p).unwrap();
    }
    p[stop] = nearest.0;
    let (guard, mode, following) = (0, 0, Vec::new());
    let legs = vec![(Leg::new(0, Some(0)), period)];
    GrazingPoint { guard, mode, time: nearest.1, x: nearest.2, p, following, legs, periods: 1 }
}

/// A guard of time and two states, neither of which is its normal.
#[test]
fn a_system_of_the_test() {
    let rough = settled(&Follower, &[0.3, 0.0, 0.0], vec![1.0, 10.0, 0.7], 1, TAU);
    let point = rough.located(&Follower, "stop").unwrap();
    let names = ["drive", "stop", "restitution"];
    let order = MapSettings { order: 4, ..MapSettings::default() };
    let map = LocalMap::of(&Follower, &point, &names, order).unwrap();
    assert_eq!(map.coordinates(), ["x", "w", "phase"]);
    let place = |y: f64, aside: f64, p: &[f64]| {
        let (t, w) = (point.time + aside, point.x[2] - aside);
        let x = p[1] - 0.1 * w * w - 0.05 * t.sin() + y * y;
        (t, vec![x, Follower::velocity(t, [x, w]), w])
    };
    let (system, point, map) = (&Follower, &point, &map);
    Case { system, point, map, place: &place, parameters: &[0, 1, 2] }.orders_hold(0.05);
}

hybrid_system! {
    /// Van der Pol's oscillator with a stop: no forcing, one coordinate.
    struct Bounded [stop, restitution, mu] {
        mode free [x, v] {
            d/dt x = v;
            d/dt v = mu * (-x * x + 1.0) * v - x;
            event hit: stop - x => free { x, v: -restitution * v };
        }
    }
}

impl Touching for Bounded {
    fn turning(&self, _t: f64, x: &[f64], _p: &[f64]) -> f64 {
        -x[1]
    }
}

#[test]
fn without_forcing() {
    // The limit cycle of μ = 1: amplitude 2.00862, period 6.66329.
    let point = GrazingPoint {
        guard: 0,
        mode: 0,
        time: 0.0,
        x: vec![2.00862, 0.0],
        p: vec![2.00862, 0.6, 1.0],
        following: Vec::new(),
        legs: vec![(Leg::new(0, Some(0)), 6.66329)],
        periods: 1,
    };
    let point = point.located(&Bounded, "stop").unwrap();
    let order = MapSettings { order: 5, ..MapSettings::default() };
    let map = LocalMap::of(&Bounded, &point, &["stop", "mu"], order).unwrap();
    assert_eq!(map.coordinates(), ["x"]);
    let place = |y: f64, _aside: f64, p: &[f64]| (0.0, vec![p[0] + y * y, 0.0]);
    let (system, point, map) = (&Bounded, &point, &map);
    Case { system, point, map, place: &place, parameters: &[0, 2] }.orders_hold(0.1);
}
