//! Promise: measures mean the same on branches, in sweeps and of equilibria, and have the values of
//! closed forms.

use crate::common::{agree, close, difference, dot, ellipse, solved};
use std::f64::consts::TAU;
use tangency::core::attractor::{PeriodMap, StroboscopicMap};
use tangency::core::bvp::{
    BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, Monitor, Shooting, Watched,
};
use tangency::core::hybrid::{HybridSettings, HybridState, Member};
use tangency::core::orbit::{PeriodicOrbit, Smooth};
use tangency::core::problem::{Equilibria, Integral, Measure, Names, VectorField};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Functional, System};
use tangency::vector_field;

vector_field! {
    /// `x'' + x'/5 + x = cos ωt − cos 2ωt`, the displacement of which rises through zero twice in a
    /// period.
    struct Tones [x, v; frequency; t] {
        let [one, two] = [1.0, 2.0].map(|k| (frequency * t * k).cos());
        d/dt x = v;
        d/dt v = one * FORCES[0] + two * FORCES[1] - x - v * DAMPING;
        period = frequency.recip() * TAU;
        monitor energy = (x * x + v * v) * 0.5;
        monitor power = ((frequency * t).cos() * FORCES[0] + (frequency * t * 2.0).cos() * FORCES[1]) * v;
        fn measures(&self) -> Vec<(String, Measure)> {
            let Names { monitors, .. } = self.names();
            let mut measures = Measure::by_default(vec!["x".into()], monitors);
            let rising = |through: &str, value: &str| Measure::Rising {
                through: through.into(),
                value: value.into(),
            };
            measures.push(("norm".into(), Measure::norm(["x", "v"])));
            measures.push(("dissipated".into(), Measure::Integral(Integral::Norm, vec!["v".into()])));
            measures.push(("speed".into(), rising("x", "v")));
            measures.push(("lowest".into(), rising("v", "x")));
            measures.push(("energy_there".into(), rising("x", "energy")));
            measures
        }
    }
}

const DAMPING: f64 = 0.2;
const FORCES: [f64; 2] = [1.0, -1.0];

impl Tones {
    /// Displacement and velocity at a time, and the mean squares of both.
    fn closed_form(frequency: f64, t: f64) -> ([f64; 2], [f64; 2]) {
        let (mut state, mut squares) = ([0.0; 2], [0.0; 2]);
        for (k, force) in FORCES.into_iter().enumerate() {
            let w = (k + 1) as f64 * frequency;
            let [re, im] = [1.0 - w * w, DAMPING * w];
            let (size, phase) = (force / re.hypot(im), w * t - im.atan2(re));
            state[0] += size * phase.cos();
            state[1] -= size * w * phase.sin();
            squares[0] += 0.5 * size * size;
            squares[1] += 0.5 * (size * w).powi(2);
        }
        (state, squares)
    }
}

vector_field! {
    /// `x' = x(μ − r²) − ωy`, `y' = y(μ − r²) + ωx`: circles of radius `√μ`.
    struct Circle [x, y; mu, omega] {
        let rate = mu - x * x - y * y;
        d/dt x = x * rate - omega * y;
        d/dt y = y * rate + omega * x;
        monitor energy = (x * x + y * y) * 0.5;
        fn measures(&self) -> Vec<(String, Measure)> {
            let mut measures = Measure::by_default(vec!["x".into(), "y".into()], self.names().monitors);
            measures.push(("norm".into(), Measure::norm(["x", "y"])));
            measures.push(("action".into(), Measure::Integral(Integral::Total, vec!["energy".into()])));
            measures
        }
    }
}

fn value(system: &mut dyn System, x: &[f64], name: &str) -> f64 {
    let names = system.names().clone();
    let mut values = vec![0.0; names.monitors.len()];
    system.monitors(x, 0, &mut values).unwrap();
    values[names.monitor(name).unwrap()]
}

fn by_both(
    field: impl VectorField + Clone + 'static,
    periods: usize,
) -> (BoundarySystem, BoundarySystem) {
    let orbit = PeriodicOrbit::new(field, periods);
    let fine = vec![Mesh::uniform(60 * periods)];
    let collocation = BoundarySystem::new(orbit.clone(), Collocation::new(7).unwrap(), fine);
    let shooting = BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)]);
    (collocation.unwrap(), shooting.unwrap())
}

/// The largest displacements, velocities … that rises and extremes have, by bisection in the closed
/// form.
fn rises(frequency: f64, through: usize) -> Vec<[f64; 2]> {
    let (count, period) = (1000, TAU / frequency);
    let at = |t: f64| Tones::closed_form(frequency, t).0;
    let times = (0..count).map(|k| [k, k + 1].map(|k| period * f64::from(k) / f64::from(count)));
    let rising = times.filter(|[a, b]| at(*a)[through] <= 0.0 && at(*b)[through] > 0.0);
    let refined = rising.map(|[mut low, mut high]| {
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if at(middle)[through] > 0.0 { &mut high } else { &mut low }) = middle;
        }
        at(low)
    });
    refined.collect()
}

/// Two rises in a leg of one period, four in one of two: the largest counts on branches as in
/// sweeps.
#[test]
fn forced_orbits_by_both_methods_and_in_a_period_of_a_sweep() {
    let frequency = 0.4;
    let (start, [x, v]) = Tones::closed_form(frequency, 0.0);
    let (by_x, by_v) = (rises(frequency, 0), rises(frequency, 1));
    let largest = |rises: &[[f64; 2]], of: fn(&[f64; 2]) -> f64| {
        rises.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    };
    assert!(by_x.len() == 2 && by_x[0][1] < by_x[1][1] - 0.1, "{by_x:?}");
    let exact = [
        ("norm", (x + v).sqrt()),
        ("dissipated", v.sqrt()),
        ("energy", 0.5 * (x + v)),
        ("power", DAMPING * v),
        ("speed", largest(&by_x, |x| x[1])),
        ("lowest", largest(&by_v, |x| x[0])),
        ("energy_there", largest(&by_x, |x| 0.5 * x[1] * x[1])),
    ];
    let system = Smooth(Tones);
    let names: Vec<String> = system.0.measures().into_iter().map(|(name, _)| name).collect();
    let mut map = PeriodMap::of(&system, HybridSettings::default(), &names).unwrap();
    let state = HybridState { mode: 0, time: 0.0, x: start.to_vec() };
    let swept = map.record(&mut Member { state, p: vec![frequency] }).unwrap().measures;
    for periods in [1, 2] {
        let trajectory = |_: usize, tau: f64, x: &mut [f64]| {
            let t = tau * periods as f64 * TAU / frequency;
            x.copy_from_slice(&Tones::closed_form(frequency, t).0);
        };
        let (mut collocation, mut shooting) = by_both(Tones, periods);
        let guesses = [collocation.sampled(&[], trajectory), shooting.sampled(&[], trajectory)];
        let systems: [&mut dyn System; 2] = [&mut collocation, &mut shooting];
        for (system, z) in systems.into_iter().zip(guesses) {
            let solution = solved(system, &z, &[frequency]).unwrap();
            for (name, exact) in exact {
                close(value(system, &solution, name), exact, 1e-9);
            }
            for (name, swept) in names.iter().zip(&swept) {
                close(value(system, &solution, name), *swept, 1e-9);
            }
        }
    }
}

vector_field! {
    /// `x' = sin t + cos t − x`, with the orbit `x = sin t`; its monitor is positive where `x > 0.9999`,
    /// for 0.03 in a period of 2π.
    struct Pulse [x; offset; t] {
        d/dt x = t.sin() + t.cos() - x + offset;
        period = T::constant(TAU);
        monitor pulse = x - 0.9999;
        fn measures(&self) -> Vec<(String, Measure)> {
            let rising = Measure::Rising { through: "pulse".into(), value: "x".into() };
            vec![("brief".into(), rising)]
        }
    }
}

/// A function that is positive for a small part of a step has its upward crossing.
#[test]
fn brief_rises_are_seen() {
    let orbit = PeriodicOrbit::new(Pulse, 1);
    let mut shooting =
        BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)]).unwrap();
    close(value(&mut shooting, &[0.0; 3], "brief"), 0.9999, 1e-11);
    let (system, names) = (Smooth(Pulse), ["brief".to_string()]);
    let mut map = PeriodMap::of(&system, HybridSettings::default(), &names).unwrap();
    let state = HybridState { mode: 0, time: 0.0, x: vec![0.0] };
    let swept = map.record(&mut Member { state, p: vec![0.0] }).unwrap().measures;
    close(swept[0], 0.9999, 1e-11);
}

/// Of integrals over a time that is unknown itself, and of a rise that is not the first one.
#[test]
fn gradients_are_those_of_differences() {
    let radius = 0.5_f64.sqrt();
    let (mut collocation, mut shooting) = by_both(Circle, 1);
    let z = collocation.sampled(&[TAU / 1.5], ellipse(radius, radius));
    gradients(&mut collocation, &[&z[..], &[0.5, 1.5]].concat(), &["norm", "energy", "action"]);
    let z = shooting.sampled(&[TAU / 1.5], ellipse(radius, radius));
    gradients(&mut shooting, &[&z[..], &[0.5, 1.5]].concat(), &["norm", "energy", "action"]);
    let (mut collocation, mut shooting) = by_both(Tones, 1);
    let trajectory = |_: usize, tau: f64, x: &mut [f64]| {
        x.copy_from_slice(&Tones::closed_form(0.4, tau * TAU / 0.4).0);
    };
    let z = collocation.sampled(&[], trajectory);
    gradients(&mut collocation, &[&z[..], &[0.4]].concat(), &["norm", "power", "speed"]);
    let z = shooting.sampled(&[], trajectory);
    gradients(&mut shooting, &[&z[..], &[0.4]].concat(), &["norm", "power", "max_energy"]);
}

#[track_caller]
fn gradients(system: &mut dyn System, x: &[f64], monitors: &[&str]) {
    let names = system.names().clone();
    let released: Vec<usize> = (0..names.parameters.len()).collect();
    let direction: Vec<f64> = (0..x.len()).map(|i| (1.0 + i as f64).sin()).collect();
    for name in monitors {
        let mut gradient = vec![0.0; x.len()];
        system
            .gradient(
                x,
                Functional::Monitor(names.monitor(name).unwrap()),
                &released,
                &mut gradient,
            )
            .unwrap();
        let quotient = difference(x, &direction, 1e-3, |x| vec![value(system, x, name)]);
        agree(&[dot(&gradient, &direction)], &quotient, 1e-7);
    }
}

/// An autonomous orbit has the norm and the mean of its radius, an equilibrium those of where it
/// is.
#[test]
fn circles_and_their_centre() {
    let (mu, omega) = (0.5_f64, 1.5);
    let (mut collocation, mut shooting) = by_both(Circle, 1);
    let guess = ellipse(mu.sqrt(), mu.sqrt());
    let guesses =
        [collocation.sampled(&[TAU / omega], guess), shooting.sampled(&[TAU / omega], guess)];
    let systems: [&mut dyn System; 2] = [&mut collocation, &mut shooting];
    for (system, z) in systems.into_iter().zip(guesses) {
        let x = [&z[..], &[mu, omega]].concat();
        close(value(system, &x, "norm"), mu.sqrt(), 1e-11);
        for name in ["energy", "max_energy", "min_energy"] {
            close(value(system, &x, name), 0.5 * mu, 1e-11);
        }
        close(value(system, &x, "action"), 0.5 * mu * TAU / omega, 1e-11);
    }
    let mut rest = Dense::new(Equilibria::new(Circle));
    assert_eq!(rest.names().monitors, ["x", "y", "energy", "norm"]);
    let mut values = [0.0; 4];
    rest.monitors(&[0.3, 0.4, mu, omega], 0, &mut values).unwrap();
    assert_eq!(values, [0.3, 0.4, 0.125, 0.5]);
}

/// `u = size (2 + cos 4πt)` on `0 ≤ t ≤ 1`, with its scale, and `u` as a function as well.
struct Ripple;

impl BoundaryProblem for Ripple {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![vec!["u".into()]]
    }

    fn parameters(&self) -> Vec<String> {
        vec!["size".into()]
    }

    fn field<T: Scalar>(&self, _segment: usize, t: T, _x: &[T], q: &[T], f: &mut [T]) {
        f[0] = -(t * (2.0 * TAU)).sin() * q[0] * (2.0 * TAU);
    }

    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        b[0] = ends.start[0] - q[0] * 3.0;
    }

    fn watch<T: Scalar>(&self, _function: usize, _segment: usize, _t: T, x: &[T], _q: &[T]) -> T {
        x[0]
    }

    fn scales(&self, _segment: usize, q: &[f64]) -> Vec<f64> {
        vec![q[0]]
    }

    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("clearance".into(), Monitor::Distance(vec![Watched::function(0, 0)]))]
    }
}

/// The least distance is found in any unit: functions of states are measured by the scales of the
/// states.
#[test]
fn functions_of_small_states_have_minima() {
    for size in [1.0, 1e-13] {
        let meshes = vec![Mesh::uniform(20)];
        let mut system = BoundarySystem::new(Ripple, Collocation::new(6).unwrap(), meshes).unwrap();
        let z = system.sampled(&[], |_, t, x| x[0] = size * (2.0 + (2.0 * TAU * t).cos()));
        let x = [&z[..], &[size]].concat();
        close(value(&mut system, &x, "clearance") / size, 1.0, 1e-9);
    }
}
