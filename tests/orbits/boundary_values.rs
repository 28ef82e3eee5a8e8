//! Promise: boundary-value problems are discretised and continued like any other zero problem.

use crate::common::{agree, close, difference, dot, ellipse, solved};
use crate::orbits::boundary::{
    Eigenvalue, FOLD, Glued, TrivialBranch, VanDerPol, collocated, strings,
};
use proptest::prelude::*;
use std::f64::consts::PI;
use tangency::core::bvp::{
    BoundaryError, BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, MeshError, Monitor,
    Shape, reduced_pencil,
};
use tangency::core::continuation::{Continuation, Settings};
use tangency::core::failure::one_line;
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Functional, Kind, System};
use tangency::problems::classic::Bratu;

/// Bratu's branch through its fold, finished on the finer discretisation; the error is honest.
#[test]
fn bratu_folds() {
    for intervals in [10, 20] {
        let mut system = collocated(Bratu, 4, intervals);
        let branch = Continuation::new(&mut system)
            .settings(Settings { refinement: 1e-12, ..Settings::default() })
            .at("lambda", 0.5)
            .along("lambda", 0.0..=10.0)
            .bound("max_u", 0.0..=5.0)
            .trace()
            .unwrap();
        let fold = branch.of_kind(Kind::LP).next().unwrap();
        close(fold.parameters[0], FOLD, 1e-12);
        assert!(fold.error < 1e-11 && (fold.parameters[0] - FOLD).abs() <= fold.error);
        // The largest u of the fold's solution: 2 ln cosh θ.
        close(fold.monitors[0], 1.186842168634389, 1e-12);
    }
}

/// Branch points on a trivial branch, and the branch that leaves the second one: there `u` has one
/// node.
#[test]
fn branches_are_switched() {
    let mut system = collocated(TrivialBranch, 4, 12);
    let branch = Continuation::new(&mut system).at("a", 0.1).along("a", 0.1..=5.0).trace().unwrap();
    let points: Vec<_> = branch.of_kind(Kind::BP).collect();
    assert_eq!(points.len(), 2);
    for (k, point) in points.iter().enumerate() {
        let exact = ((k + 1) as f64 * PI).powi(2) / 10.0;
        close(point.parameters[0], exact, 1e-12);
        assert!((point.parameters[0] - exact).abs() <= point.error);
    }
    let label = points[1].label;
    let bifurcated = Continuation::new(&mut system)
        .restart(&branch, label)
        .switch()
        .along("a", 3.0..=4.5)
        .bound("max", -1.0..=0.5)
        .trace()
        .unwrap();
    let end = bifurcated.points.last().unwrap();
    assert!(end.monitors[0] > 0.1 && end.monitors[1] < -0.1, "{:?}", end.monitors);
}

/// An unknown number determined by an integral condition.
#[test]
fn an_eigenvalue_is_an_unknown() {
    let mut system = collocated(Eigenvalue, 5, 10);
    let guess = |_, tau: f64, x: &mut [f64]| {
        x.copy_from_slice(&[4.0 * tau * (1.0 - tau), 4.0 - 8.0 * tau]);
    };
    let z = system.sampled(&[9.0], guess);
    let x = solved(&mut system, &z, &[1.0]).unwrap();
    close(x[x.len() - 2], PI * PI, 1e-12);
    close(system.states(&x, 0, 0.5).unwrap()[0], 2.0_f64.sqrt(), 1e-10);
}

/// Two segments: `x = exp(a sin t)` reaches 2 at `t = arcsin(ln 2/a)`; with `b = 0` the second is a
/// rotation, `y = 2 cos t + ½a sin t`.
#[test]
fn two_segments_are_glued() {
    let mut system = collocated(Glued, 5, 8);
    let guess = |s: usize, tau: f64, x: &mut [f64]| match s {
        0 => x[0] = 1.0 + tau,
        _ => x.copy_from_slice(&[2.0, 0.5]),
    };
    let z = system.sampled(&[0.8, 1.0], guess);
    let (a, c) = (1.2_f64, 1.5_f64);
    let x = solved(&mut system, &z, &[a, 0.0, c]).unwrap();
    let n = x.len() - 3;
    close(x[n - 2], (2.0_f64.ln() / a).asin(), 1e-12);
    close(x[n - 1], 2.0 * c.sin() + 0.5 * a * (1.0 - c.cos()), 1e-12);
    let mut monitors = [0.0; 4];
    system.monitors(&x, 0, &mut monitors).unwrap();
    close(monitors[0], x[n - 2] + c, 1e-15);
    // w = ½a cos t − 2 sin t decreases, and so does y = 2 cos t + ½a sin t beyond its maximum.
    close(monitors[1], 0.5 * a, 1e-10);
    close(monitors[2], 2.0 * c.cos() + 0.5 * a * c.sin(), 1e-10);
    let names: Vec<_> =
        system.names().unknowns.iter().map(|g| (g.name.as_str(), g.length)).collect();
    assert_eq!(names, [("x[0]", 41), ("x[1]", 41), ("w", 41), ("d", 1), ("area", 1)]);
}

/// Van der Pol's period and amplitude at μ = 1, known to many
/// digits: 6.66328685932313, 2.008619860874843.
#[test]
fn periods_are_unknowns() {
    let mut system = collocated(VanDerPol, 7, 40);
    let z = system.sampled(&[6.5], ellipse(2.0, -2.0));
    let x = solved(&mut system, &z, &[1.0]).unwrap();
    let mut monitors = [0.0; 3];
    system.monitors(&x, 0, &mut monitors).unwrap();
    close(monitors[0], 6.663_286_859_323_13, 1e-12);
    close(monitors[1], 2.008619860874843, 1e-10);
    // The pencil of the ends has the multiplier 1: P + Q is singular.
    system.assemble(&x).unwrap();
    let (p, q) = reduced_pencil(&mut system).unwrap();
    let sum: Vec<f64> = p.iter().zip(q).map(|(p, q)| p + q).collect();
    let size = sum.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
    assert!((sum[0] * sum[3] - sum[1] * sum[2]).abs() < 1e-9 * size * size);
}

/// A branch of periodic solutions ends where solving there at once does.
#[test]
fn periodic_solutions_are_continued() {
    let mut system = collocated(VanDerPol, 5, 40);
    let z = system.sampled(&[6.3], ellipse(2.0, -2.0));
    let branch = Continuation::new(&mut system)
        .from(&z)
        .at("mu", 0.3)
        .along("mu", 0.2..=1.0)
        .trace()
        .unwrap();
    let end = branch.special.iter().find(|point| point.parameters[0] == 1.0).unwrap();
    close(end.monitors[0], 6.66328685932313, 1e-11);
    close(end.monitors[1], 2.008619860874843, 1e-11);
    // Folds and branch points, of which there are none.
    assert_eq!(branch.special.iter().filter(|point| point.kind != Kind::EP).count(), 0);
}

/// A solution followed over two of its periods, on a mesh from 0 to 2, has the same period.
#[test]
fn meshes_may_hold_several_periods() {
    let mesh = vec![Mesh::uniform(80).stretched(2.0)];
    let mut system = BoundarySystem::new(VanDerPol, Collocation::new(7).unwrap(), mesh).unwrap();
    let z = system.sampled(&[6.5], ellipse(2.0, -2.0));
    let x = solved(&mut system, &z, &[1.0]).unwrap();
    let mut monitors = [0.0; 3];
    system.monitors(&x, 0, &mut monitors).unwrap();
    close(monitors[0], 2.0 * 6.66328685932313, 1e-11);
}

/// Histories are smooth curves over the whole time, and the portrait is theirs.
#[test]
fn profiles_are_drawn() {
    let mut system = collocated(Bratu, 4, 10);
    let z = system.sampled(&[], |_, _, _| {});
    let x = solved(&mut system, &z, &[2.0]).unwrap();
    let profiles = system.profiles(&x);
    let names: Vec<_> = profiles.iter().map(|p| (p.name.as_str(), p.along.as_str())).collect();
    assert_eq!(names, [("u", "time"), ("v", "time"), ("v", "u")]);
    assert!(profiles.iter().all(|profile| profile.points.len() == 101));
    let [first, last] = [profiles[0].points[0], profiles[0].points[100]];
    close(first[0], 0.0, 0.0);
    close(last[0], 1.0, 1e-15);
    close(last[1], 0.0, 1e-14);
}

/// A problem whose sizes may be wrong.
struct Wrong {
    phase: bool,
    integrals: usize,
    segments: usize,
    monitor: usize,
}

impl BoundaryProblem for Wrong {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["x"]); self.segments]
    }
    fn parameters(&self) -> Vec<String> {
        Vec::new()
    }
    fn field<T: Scalar>(&self, _s: usize, _t: T, _x: &[T], _q: &[T], f: &mut [T]) {
        f[0] = T::zero();
    }
    fn integrals(&self) -> usize {
        self.integrals
    }
    fn shape(&self) -> Shape {
        Shape::Periodic { phase: self.phase }
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("max".into(), Monitor::maximum(0, self.monitor))]
    }
}

/// Sizes that do not fit are refused with what is wrong.
#[test]
fn sizes_are_checked() {
    let collocation = || Collocation::new(4).unwrap();
    let refused = |meshes| BoundarySystem::new(Glued, collocation(), meshes).err().unwrap();
    assert_eq!(refused(vec![Mesh::uniform(3)]), BoundaryError::Meshes { segments: 2, meshes: 1 });
    let (uniform, points) = (Mesh::uniform(3), |points: &[f64]| Mesh::new(points.to_vec()));
    let wrong = |phase, integrals, segments, monitor| Wrong { phase, integrals, segments, monitor };
    let refused = |problem: Wrong| {
        let meshes = vec![uniform.clone(); problem.segments];
        one_line(&BoundarySystem::new(problem, collocation(), meshes).err().unwrap())
    };
    let many = "the problem has 2 integral and phase conditions, but only 1 unknowns (states and extra unknowns)";
    assert!(refused(wrong(true, 1, 1, 0)).contains(many));
    assert!(
        refused(wrong(true, 0, 2, 0))
            .contains("2 segments with 1 boundary conditions and 1 integral")
    );
    assert!(
        refused(wrong(false, 0, 1, 3))
            .contains("state 3 on segment 0, but this state does not exist")
    );
    assert_eq!(points(&[0.0]), Err(MeshError::Empty(1)));
    assert_eq!(points(&[0.5, 1.0]), Err(MeshError::Start(0.5)));
    let order = MeshError::Order { index: 2, before: 0.5, next: 0.5 };
    assert_eq!(points(&[0.0, 0.5, 0.5, 1.0]), Err(order));
    assert!(points(&[0.0, f64::NAN]).is_err());
    assert!(Collocation::new(1).unwrap_err().to_string().contains("between 2 and 7"));
}

/// The step of differences.
const H: f64 = 2e-4;

/// All derivatives of a system against differences of what they differentiate.
fn derivatives_agree(system: &mut BoundarySystem, x: &[f64], seed: u64) {
    let n = system.names().dimension();
    let monitor_count = system.names().monitors.len();
    let released: Vec<usize> = (0..x.len() - n).collect();
    let wave = |k: u64, length: usize| -> Vec<f64> {
        (0..length).map(|i| ((seed + k) as f64 + 1.7 * i as f64 * (k + 1) as f64).sin()).collect()
    };
    let (d, e, f, w) = (wave(1, x.len()), wave(2, x.len()), wave(3, x.len()), wave(4, n));
    let mut out = vec![0.0; n];
    system.set_reference(x).unwrap();
    system.derivative(x, &[&d], &mut out).unwrap();
    let residual = |system: &mut BoundarySystem, x: &[f64]| {
        let mut r = vec![0.0; n];
        system.residual(x, &mut r).unwrap();
        r
    };
    agree(&out, &difference(x, &d, H, |x| residual(system, x)), 1e-7);
    let mut second = vec![0.0; n];
    system.derivative(x, &[&d, &e], &mut second).unwrap();
    let along = |system: &mut BoundarySystem, x: &[f64]| {
        let mut r = vec![0.0; n];
        system.derivative(x, &[&d], &mut r).unwrap();
        r
    };
    agree(&second, &difference(x, &e, H, |x| along(system, x)), 1e-7);
    let mut third = vec![0.0; n];
    system.derivative(x, &[&d, &e, &f], &mut third).unwrap();
    let expected = difference(x, &f, H, |x| {
        let mut r = vec![0.0; n];
        system.derivative(x, &[&d, &e], &mut r).unwrap();
        r
    });
    agree(&third, &expected, 1e-7);
    let (mut gradient, mut second_gradient) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    system.gradient(x, Functional::First(&w, &d), &released, &mut gradient).unwrap();
    system.gradient(x, Functional::Second(&w, &d), &released, &mut second_gradient).unwrap();
    let mut monitors = vec![vec![0.0; x.len()]; monitor_count];
    (0..monitor_count).for_each(|k| {
        system.gradient(x, Functional::Monitor(k), &released, &mut monitors[k]).unwrap()
    });
    let mut column = vec![0.0; n];
    for i in 0..x.len() {
        let unit: Vec<f64> = (0..x.len()).map(|j| f64::from(u8::from(i == j))).collect();
        let differences = difference(x, &unit, H, |x| {
            let mut values = vec![0.0; monitor_count];
            system.monitors(x, 0, &mut values).unwrap();
            values.push(dot(&w, &along(system, x)));
            let mut r = vec![0.0; n];
            system.derivative(x, &[&d, &d], &mut r).unwrap();
            values.push(dot(&w, &r));
            values
        });
        let mut found: Vec<f64> = monitors.iter().map(|gradient| gradient[i]).collect();
        found.extend([gradient[i], second_gradient[i]]);
        agree(&found, &differences, 1e-7);
        // The residual as a whole in nested dual numbers; gradients by shooting may err a little.
        let collocation = system.names().monitor("mesh_error").is_some();
        let tolerance = if collocation { 1e-12 } else { 1e-7 };
        system.derivative(x, &[&d, &unit], &mut column).unwrap();
        agree(&[gradient[i]], &[dot(&w, &column)], tolerance);
        system.derivative(x, &[&d, &d, &unit], &mut column).unwrap();
        agree(&[second_gradient[i]], &[dot(&w, &column)], tolerance);
        system.derivative(x, &[&unit], &mut column).unwrap();
        agree(&column, &difference(x, &unit, H, |x| residual(system, x)), 1e-7);
    }
}

/// The factored matrix against multiplication with derivatives in dual numbers, both ways, within a
/// border.
fn factors_agree(system: &mut BoundarySystem, x: &[f64], width: usize) {
    let n = system.names().dimension();
    let size = n + width;
    let mut jacobian = vec![0.0; n * n];
    for (j, column) in jacobian.chunks_exact_mut(n).enumerate() {
        let unit: Vec<f64> = (0..x.len()).map(|i| f64::from(u8::from(i == j))).collect();
        system.derivative(x, &[&unit], column).unwrap();
    }
    system.assemble(x).unwrap();
    let wave = |k: usize, length: usize| -> Vec<f64> {
        (0..length).map(|i| (k as f64 + 1.3 * i as f64 * (k + 1) as f64).cos()).collect()
    };
    let (columns, rows, corner) = (wave(1, n * width), wave(2, n * width), wave(3, width * width));
    let border = Border { width, columns: &columns, rows: &rows, corner: &corner, units: &[] };
    let entry = |i: usize, j: usize| match (i < n, j < n) {
        (true, true) => jacobian[j * n + i],
        (true, false) => columns[(j - n) * n + i],
        (false, true) => rows[(i - n) * n + j],
        (false, false) => corner[(i - n) * width + j - n],
    };
    let solution = wave(5, size);
    let mut right: Vec<f64> =
        (0..size).map(|i| (0..size).map(|j| entry(i, j) * solution[j]).sum()).collect();
    let mut left: Vec<f64> =
        (0..size).map(|j| (0..size).map(|i| entry(i, j) * solution[i]).sum()).collect();
    let mut factors = Factors::default();
    system.factor(Form::Jacobian, border, &mut factors).unwrap();
    factors.solve(&mut right);
    factors.solve_transposed(&mut left);
    agree(&right, &solution, 1e-9);
    agree(&left, &solution, 1e-9);
}

/// A ring of as many states as wanted: `x_i' = a sin x_{i+1} − x_i² + cos t`.
#[derive(Clone)]
struct Ring(usize);

impl BoundaryProblem for Ring {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![(0..self.0).map(|i| format!("x{i}")).collect()]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["a", "length"])
    }
    fn field<T: Scalar>(&self, _s: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        for i in 0..x.len() {
            f[i] = q[0] * x[(i + 1) % x.len()].sin() - x[i] * x[i] + t.cos();
        }
    }
    fn duration<T: Scalar>(&self, _s: usize, q: &[T]) -> T {
        q[1]
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        (0..b.len()).for_each(|i| b[i] = ends.start[i] + ends.end[(i + 1) % b.len()].powi(2));
    }
}

/// Any number of states, in one pass of directions or in several.
#[test]
fn derivatives_of_any_number_of_states() {
    for n in [1, 3, 4, 6, 10] {
        let mut system = collocated(Ring(n), 2, 2);
        let wave = |_, tau: f64, x: &mut [f64]| {
            (0..n).for_each(|i| x[i] = (3.0 * tau + i as f64).sin());
        };
        let mut x = system.sampled(&[], wave);
        x.extend([0.7, 1.3]);
        derivatives_agree(&mut system, &x, 5);
        factors_agree(&mut system, &x, 1);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn derivatives_of_glued_segments(seed in 0_u64..1000, points in 2..5_usize) {
        let meshes = vec![Mesh::uniform(2), Mesh::new(vec![0.0, 0.2, 0.5, 1.0]).unwrap()];
        let mut system = BoundarySystem::new(Glued, Collocation::new(points).unwrap(), meshes).unwrap();
        let guess = |s: usize, tau: f64, x: &mut [f64]| match s {
            0 => x[0] = 1.0 + tau * tau,
            _ => x.copy_from_slice(&[2.0 - 3.0 * tau, (4.0 * tau + 1.0).sin()]),
        };
        let mut x = system.sampled(&[0.8, 1.0], guess);
        x.extend([1.2, 0.3, 1.5]);
        derivatives_agree(&mut system, &x, seed);
        for width in 0..3 {
            factors_agree(&mut system, &x, width);
        }
    }

    #[test]
    fn derivatives_of_a_periodic_problem(seed in 0_u64..1000, points in 2..5_usize) {
        let mut system = collocated(VanDerPol, points, 3);
        let guess = |_, tau: f64, x: &mut [f64]| {
            x.copy_from_slice(&[2.0 * (6.0 * tau).cos(), -1.8 * (6.0 * tau).sin()]);
        };
        let mut x = system.sampled(&[6.5], guess);
        x.push(0.7);
        derivatives_agree(&mut system, &x, seed);
        for width in 0..3 {
            factors_agree(&mut system, &x, width);
        }
    }
}
