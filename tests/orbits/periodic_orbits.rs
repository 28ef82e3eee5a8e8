//! Promise: periodic orbits, their bifurcations and multipliers, by collocation and by shooting,
//! agree with published values and with each other.

use crate::common::{close, first};
use crate::orbits::cycles::{PredatorPrey, collocated, equilibria, label, precisely_shot, shot};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use tangency::core::continuation::{Branch, Continuation, End, Settings};
use tangency::core::hybrid::{HybridFlow, HybridSettings, HybridState};
use tangency::core::orbit::Smooth;
use tangency::core::problem::{Forcing, Names, VectorField};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Kind, System};
use tangency::problems::classic::{Isothermal, Lure};
use tangency::problems::mita::Block;

fn lure_at_rest() -> Branch {
    equilibria(Lure, &[0.0; 3], &[1.2, 1.0], [0.5, 1.5])
}

fn settings() -> Settings {
    Settings { max_step: 0.05, ..Settings::default() }
}

fn lure_orbits(system: &mut dyn System) -> Branch {
    let rest = lure_at_rest();
    Continuation::new(system)
        .restart(&rest, label(&rest, Kind::HB))
        .along("alpha", 0.5..=1.5)
        .settings(settings())
        .trace()
        .unwrap()
}

/// Every regular point on this side of a value of the first parameter has this many unstable
/// multipliers.
#[track_caller]
fn stable_between(branch: &Branch, low: f64, high: f64, unstable: usize) {
    let inside = |p: &&tangency::core::continuation::Point| (low..high).contains(&p.parameters[0]);
    let points: Vec<_> = branch.points.iter().filter(inside).collect();
    assert!(points.len() >= 2);
    // The first point may be the equilibrium itself.
    for point in &points[1..] {
        assert_eq!(point.unstable, Some(unstable), "at {}", point.parameters[0]);
    }
}

#[test]
fn lure_by_both_methods() {
    let rest = lure_at_rest();
    close(first(&rest, Kind::HB).parameters[0], 1.0, 1e-12);
    let (mut collocation, mut shooting) = (collocated(Lure, 20), shot(Lure, 1));
    for system in [&mut collocation as &mut dyn System, &mut shooting] {
        let branch = lure_orbits(system);
        let doubling = first(&branch, Kind::PD);
        close(doubling.parameters[0], 0.630302006160, 1e-10);
        close(doubling.monitors[0], 6.3640713394, 1e-10);
        assert!(doubling.converged && doubling.error < 1e-8);
        stable_between(&branch, 0.6304, 1.0, 0);
        stable_between(&branch, 0.5, 0.6303, 1);
        assert_eq!(branch.of_kind(Kind::PD).count(), 1);

        let doubled = Continuation::new(system)
            .restart(&branch, doubling.label)
            .switch()
            .along("alpha", 0.5..=1.5)
            .settings(settings())
            .trace()
            .unwrap();
        let next = first(&doubled, Kind::PD);
        // Printed as 0.57962985, 12.734366; by Taylor series of order 22:
        close(next.parameters[0], 0.579629840896, 1e-10);
        close(next.monitors[0], 12.734365542, 2e-9);
        stable_between(&doubled, 0.5797, 0.6303, 0);
        stable_between(&doubled, 0.5, 0.5796, 1);
    }
}

/// Where period doublings are not looked for, the multiplier that passes −1 is reported as an
/// unclassified point. Its error includes that of the mesh: without it, it would be too small by
/// orders of magnitude on 12 intervals.
#[test]
fn an_unclassified_point_knows_the_error_of_its_mesh() {
    for intervals in [12, 20, 40] {
        let rest = lure_at_rest();
        let mut orbits = collocated(Lure, intervals);
        let settings = Settings { detect: vec![Kind::LP], ..settings() };
        let branch = Continuation::new(&mut orbits)
            .restart(&rest, label(&rest, Kind::HB))
            .along("alpha", 0.5..=1.5)
            .settings(settings)
            .trace()
            .unwrap();
        assert_eq!(branch.of_kind(Kind::ND).count(), 1, "{intervals}");
        let passed = first(&branch, Kind::ND);
        let distance = (passed.parameters[0] - 0.630302006160).abs();
        println!("{intervals}: {distance:e} {:e}", passed.error);
        assert!(
            !passed.converged && distance <= passed.error,
            "{intervals}: {distance:e}, {:e}",
            passed.error
        );
        assert!(passed.error < 1e-2);
    }
}

/// A saved orbit starts a branch on another mesh, and by another method.
#[test]
fn lure_restarted_in_the_middle() {
    let mut coarse = collocated(Lure, 20);
    let rest = lure_at_rest();
    let branch = Continuation::new(&mut coarse)
        .restart(&rest, label(&rest, Kind::HB))
        .along("alpha", 0.7..=1.5)
        .mark("alpha", 0.9)
        .settings(settings())
        .trace()
        .unwrap();
    let mut fine = collocated(Lure, 40);
    let on = |system: &mut dyn System, from: &Branch| {
        let branch = Continuation::new(system)
            .restart(from, label(from, Kind::UZ))
            .along("alpha", 0.55..=0.95)
            .settings(settings())
            .mark("alpha", 0.85)
            .trace()
            .unwrap();
        close(first(&branch, Kind::PD).parameters[0], 0.630302006160, 1e-10);
        branch
    };
    let finer = on(&mut fine, &branch);
    assert_eq!(fine.meshes()[0].intervals(), 40);
    let mut once = shot(Lure, 1);
    let by_shooting = on(&mut once, &branch);
    assert_eq!(once.meshes()[0].intervals(), 1);
    on(&mut shot(Lure, 3), &by_shooting);
    on(&mut coarse, &by_shooting);
    let periods = [&branch, &finer, &by_shooting].map(|b| b.points[b.points.len() - 1].monitors[0]);
    assert!(periods.iter().all(|period| *period > 6.0));
}

#[test]
fn isothermal_cascade() {
    let rest = equilibria(Isothermal, &[12.0, 8.0, 9.0], &[14.0], [5.0, 20.0]);
    // By Newton's method on equilibrium and trace · (sum of principal minors) = determinant.
    close(first(&rest, Kind::HB).parameters[0], 12.143462569889, 1e-11);
    let published = [(10.571047456, 0.751234), (10.146517655, 1.636055), (10.091209039, 3.344771)];
    let (mut shooting, mut collocation) = (shot(Isothermal, 4), collocated(Isothermal, 30));
    let [by_shooting, by_collocation] = [&mut shooting as &mut dyn System, &mut collocation]
        .map(|system| cascade(system, &rest, published.len()));
    for ((a, b), (lambda, period)) in by_shooting.iter().zip(&by_collocation).zip(published) {
        close(a[0], b[0], 1e-9);
        close(a[1], b[1], 1e-8);
        close(a[0], lambda, 2e-9);
        close(a[1], period, 5e-7);
    }
}

/// λ and period at so many period doublings, each found on the branch that the last one gave birth
/// to.
fn cascade(system: &mut dyn System, rest: &Branch, count: usize) -> Vec<[f64; 2]> {
    let settings = Settings { refinement: 1e-11, ..settings() };
    let mut branch = Continuation::new(system)
        .restart(rest, label(rest, Kind::HB))
        .along("lambda", 10.0..=20.0)
        .settings(settings.clone())
        .trace()
        .unwrap();
    let mut found = Vec::new();
    loop {
        let doubling = first(&branch, Kind::PD);
        found.push([doubling.parameters[0], doubling.monitors[0]]);
        if found.len() == count {
            return found;
        }
        let label = doubling.label;
        branch = Continuation::new(system)
            .restart(&branch, label)
            .switch()
            .along("lambda", 10.0..=20.0)
            .settings(Settings { max_points: 100, ..settings.clone() })
            .trace()
            .unwrap();
    }
}

/// The orbits of pp2 are born with the period 2π/ω, and their period grows without bound.
#[test]
fn predator_prey_approaches_a_heteroclinic_orbit() {
    let rest = equilibria(PredatorPrey, &[1.0 / 3.0, 1.0], &[0.5], [0.0, 1.0]);
    let hopf = first(&rest, Kind::HB);
    close(hopf.parameters[0], 0.671593847, 5e-10);
    // The Jacobian at x = 1/3 has the determinant ω² and no trace.
    let (x, y) = (hopf.state[0], hopf.state[1]);
    let omega = (x * 3.0 * y).sqrt();
    let mut collocation = collocated(PredatorPrey, 30);
    let branch = Continuation::new(&mut collocation)
        .restart(&rest, hopf.label)
        .along("p", 0.0..=1.0)
        .bound("period", 0.0..=36.0)
        .trace()
        .unwrap();
    close(branch.points[0].monitors[0], TAU / omega, 1e-12);
    close(branch.points[1].monitors[0], TAU / omega, 2e-2);
    assert!(matches!(&branch.ends[1], End::MonitorBound { name, .. } if name == "period"));
    assert!(branch.points.iter().skip(1).all(|point| point.unstable == Some(0)));
    // Without a bound there is an end, and a reason.
    let settings = Settings { max_points: 90, ..Settings::default() };
    let shooting = &mut shot(PredatorPrey, 4);
    let errors = [&mut collocated(PredatorPrey, 30) as &mut dyn System, shooting].map(|system| {
        let branch = Continuation::new(system)
            .restart(&rest, hopf.label)
            .along("p", 0.0..=1.0)
            .settings(settings.clone())
            .trace()
            .unwrap();
        let End::Homoclinic { period, .. } = branch.ends[1] else { panic!("{}", branch.ends[1]) };
        assert!(period > 36.0 && branch.points.last().unwrap().monitors[0] == period);
        branch.special.last().unwrap().error
    });
    // Where the end is depends on the mesh as much as the orbit does.
    assert!(errors[0] > 1e-9 && errors[1] < 1e-9, "{errors:?}");
}

fn vibration(system: &mut dyn System, frequency: f64) -> Branch {
    Continuation::new(system)
        .at("voltage", 0.01)
        .at("frequency", frequency)
        .at("damping", 0.04)
        .along("voltage", 0.01..=0.5)
        .bound("max_displacement", -1.0..=0.6)
        .mark("max_displacement", 0.5)
        .settings(Settings { refinement: 1e-12, tolerance: 1e-12, ..settings() })
        .trace()
        .unwrap()
}

#[test]
fn mita_block() {
    let (mut collocation, mut shooting) = (collocated(Block, 20), precisely_shot(Block, 1));
    for system in [&mut collocation as &mut dyn System, &mut shooting] {
        let branch = vibration(system, 0.45);
        let fold = first(&branch, Kind::LP);
        close(fold.parameters[0], 0.235565433583, 1e-11);
        close(first(&branch, Kind::UZ).parameters[0], 0.228618817738, 1e-11);
        assert!(fold.error < 1e-10 && fold.converged);
        let branch = vibration(system, 0.5);
        close(first(&branch, Kind::UZ).parameters[0], 0.227177583102, 1e-11);
    }
}

/// The folds of the nonimpacting motions in frequency and voltage meet in a cusp.
#[test]
fn mita_cusp_by_both_methods() {
    let (mut collocation, mut shooting) = (collocated(Block, 20), precisely_shot(Block, 1));
    let mut cusps = Vec::new();
    for system in [&mut collocation as &mut dyn System, &mut shooting] {
        let branch = vibration(system, 0.45);
        let curve = Continuation::new(system)
            .restart(&branch, label(&branch, Kind::LP))
            .hold(Kind::LP)
            .along("frequency", 0.4..=0.5)
            .along("voltage", 0.1..=0.4)
            .bound("max_displacement", -1.0..=0.9)
            .settings(Settings { refinement: 1e-10, ..settings() })
            .trace()
            .unwrap();
        let cusp = first(&curve, Kind::CP);
        assert!((0.48..0.485).contains(&cusp.parameters[1]));
        cusps.push([cusp.parameters[0], cusp.parameters[1]]);
    }
    close(cusps[0][0], cusps[1][0], 1e-9);
    close(cusps[0][1], cusps[1][1], 1e-9);
}

/// Seven states that decay towards a common motion; evaluations are counted.
struct Counted;

static EVALUATIONS: AtomicUsize = AtomicUsize::new(0);

impl VectorField for Counted {
    fn names(&self) -> Names {
        Names::new(["a", "b", "c", "d", "e", "f", "g"], ["amplitude", "offset"])
    }
    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
        EVALUATIONS.fetch_add(1, Relaxed);
        f.iter_mut().zip(x).for_each(|(f, x)| *f = p[0] * t.cos() + p[1] - *x);
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::constant(TAU)
    }
}

/// Seven states and one parameter fill a chunk of eight directions; a second parameter doubles the
/// number of evaluations, as long as its derivative is asked for.
#[test]
fn parameters_that_are_not_asked_for_are_not_differentiated() {
    let mut system = collocated(Counted, 4);
    let z = system.sampled(&[], |_, _, x| x.fill(0.5));
    let (mut x, mut out) = ([&z[..], &[1.0, 0.2]].concat(), vec![0.0; z.len()]);
    let mut evaluations = |parameters: &[usize]| {
        x[0] += 1e-3;
        let before = EVALUATIONS.load(Relaxed);
        for parameter in parameters {
            let mut direction = vec![0.0; x.len()];
            direction[z.len() + parameter] = 1.0;
            system.derivative(&x, &[&direction], &mut out).unwrap();
        }
        EVALUATIONS.load(Relaxed) - before
    };
    evaluations(&[0]);
    let one = evaluations(&[0]);
    evaluations(&[0, 1]);
    let two = evaluations(&[0, 1]);
    assert!(two > one);
    let later: Vec<usize> = (0..40).map(|_| evaluations(&[0])).collect();
    assert!(later[0] == two && later[39] == one, "{one} {two} {later:?}");
}

/// A ring of Brusselators whose states are two arrays.
struct Ring(usize);

impl VectorField for Ring {
    fn names(&self) -> Names {
        Names::new([("u", self.0), ("v", self.0)], ["b", "d"])
    }

    fn field<T: Scalar>(&self, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        let n = self.0;
        let diffusion = |part: &[T], i: usize| {
            (part[(i + n - 1) % n] + part[(i + 1) % n] - part[i] * 2.0) * p[1]
        };
        let (u, v) = x.split_at(n);
        for i in 0..n {
            let reaction = u[i] * u[i] * v[i];
            f[i] = reaction - (p[0] + 1.0) * u[i] + 1.0 + diffusion(u, i);
            f[n + i] = p[0] * u[i] - reaction + diffusion(v, i) * 3.0;
        }
    }
}

/// The elements of arrays are states with names of their own, in branches, starts and simulations.
#[test]
fn states_in_arrays_have_names() {
    let mut start = vec![1.0; 6];
    start[3..].fill(1.5);
    let rest = equilibria(Ring(3), &start, &[1.5, 1.0], [1.5, 2.5]);
    let hopf = first(&rest, Kind::HB);
    close(hopf.parameters[0], 2.0, 1e-10);
    assert_eq!(rest.columns().nth(2), Some("u[1]"));
    let mut system = collocated(Ring(3), 10);
    let cycles = Continuation::new(&mut system).restart(&rest, hopf.label).along("b", 1.5..=2.5);
    let cycles = cycles.trace().unwrap();
    let last = cycles.points.last().expect("points");
    let column = |name: &str| last.value(cycles.column(name).expect("a column")).unwrap();
    close(column("max_u[1]"), column("max_u[3]"), 1e-9);
    assert!(column("max_u[1]") > 1.1 && column("max_v[2]") > 2.0);
    let mut flow = HybridFlow::new(&Smooth(Ring(3)), HybridSettings::default()).unwrap();
    let mut state = HybridState { mode: 0, time: 0.0, x: start };
    flow.advance(&mut state, 1.0, &[1.5, 1.0], &mut ()).unwrap();
    state.x.iter().zip([1.0, 1.0, 1.0, 1.5, 1.5, 1.5]).for_each(|(x, y)| close(*x, y, 1e-9));
}
