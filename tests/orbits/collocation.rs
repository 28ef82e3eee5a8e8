//! Promise: collocation converges with the orders of theory, its meshes follow the solution, and a
//! mesh that is too coarse says so.

use crate::common::{close, ellipse, falls_with_order, solved};
use crate::orbits::boundary::{FOLD, Glued, Layer, VanDerPol, collocated, strings};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use tangency::core::bvp::{
    BoundaryProblem, BoundarySystem, Collocation, Ends, Interval, IntoEquations, Mesh,
    MonitoredFunctions, Span, reduced_pencil,
};
use tangency::core::continuation::{Continuation, End, Settings};
use tangency::core::failure::one_line;
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::problem::Observable;
use tangency::core::scalar::Scalar;
use tangency::core::system::{Functional, Kind, System};
use tangency::problems::classic::Bratu;

type Collocated = BoundarySystem;

/// The exact lower solution of Bratu's problem: `u = 2 ln(cosh(θ/4) / cosh((t − ½)θ/2))` with
/// `θ = √(2λ) cosh(θ/4)`.
fn bratu(lambda: f64, t: f64) -> f64 {
    let mut theta = 0.0;
    for _ in 0..200 {
        theta = (2.0 * lambda).sqrt() * (theta / 4.0_f64).cosh();
    }
    2.0 * ((theta / 4.0).cosh() / (0.5 * (t - 0.5) * theta).cosh()).ln()
}

/// The largest errors of the first state at breakpoints, at nodes, and anywhere.
fn errors(system: &mut Collocated, x: &[f64], exact: impl Fn(f64) -> f64) -> [f64; 3] {
    let mesh = system.meshes()[0].points().to_vec();
    let m = (system.sampled(&[], |_, _, _| {}).len() / 2 - 1) / (mesh.len() - 1);
    let places = Collocation::new(m).unwrap().places().to_vec();
    let mut largest = [0.0_f64; 3];
    for pair in mesh.windows(2) {
        for k in 0..=20 {
            let spread = (0..=20).contains(&k).then_some(k as f64 / 20.0);
            let node = places.get(k).copied();
            for (place, is_node) in
                spread.map(|s| (s, false)).into_iter().chain(node.map(|s| (s, true)))
            {
                let t = pair[0] + (pair[1] - pair[0]) * place;
                let error = (system.states(x, 0, t).unwrap()[0] - exact(t)).abs();
                largest[2] = largest[2].max(error);
                if is_node {
                    largest[1] = largest[1].max(error);
                }
                if place == 0.0 {
                    largest[0] = largest[0].max(error);
                }
            }
        }
    }
    largest
}

/// The errors of Bratu's problem at `m` points in so many equal intervals; the estimate is that of
/// the largest one, and not below it.
fn estimated(m: usize, intervals: usize) -> [f64; 3] {
    let mut system = collocated(Bratu, m, intervals);
    let z = system.sampled(&[], |_, _, _| {});
    let x = solved(&mut system, &z, &[2.0]).unwrap();
    let estimate = system.mesh_error(&x);
    let errors = errors(&mut system, &x, |t| bratu(2.0, t));
    let relative = errors[2] / bratu(2.0, 0.5);
    assert!(estimate > relative && estimate < 100.0 * relative, "{estimate:e} {relative:e}");
    errors
}

/// Orders `2m` at breakpoints, `m + 2` at nodes and `m + 1` in between, within 10 %.
#[test]
fn superconvergence() {
    for (m, counts) in [(2, [16, 32, 64, 128]), (3, [12, 16, 24, 32]), (4, [6, 8, 10, 12])] {
        let measured = counts.map(|count| (1.0 / count as f64, estimated(m, count)));
        for (k, order) in [(0, 2 * m), (1, m + 2), (2, m + 1)] {
            let of_one = measured.map(|(h, errors)| (h, errors[k]));
            falls_with_order(&format!("{m} points, {k}"), &of_one, order as f64);
        }
    }
    // Five points leave rounding on seven intervals: one refinement.
    let [coarse, fine] = [3, 6].map(|intervals| estimated(5, intervals));
    for (k, order) in [(0, 10.0), (1, 7.0), (2, 6.0)] {
        let found = (coarse[k] / fine[k]).log2();
        assert!((found / order - 1.0_f64).abs() < 0.1, "{k}: {found}, not {order}");
    }
}

/// `u'' = 6t`, `u(0) = 0`, `u(1) = 1`: a cubic, for which three points are exact on a single
/// interval.
#[derive(Clone)]
struct Cubic;

impl BoundaryProblem for Cubic {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        Vec::new()
    }
    fn field<T: Scalar>(&self, _s: usize, t: T, x: &[T], _q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = t * 6.0;
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0] - 1.0;
    }
}

#[test]
fn polynomials_are_exact() {
    for (m, mesh) in [(3, vec![0.0, 1.0]), (4, vec![0.0, 0.1, 0.7, 1.0])] {
        let mesh = Mesh::new(mesh).unwrap();
        let mut system =
            BoundarySystem::new(Cubic, Collocation::new(m).unwrap(), vec![mesh]).unwrap();
        let z = system.sampled(&[], |_, _, _| {});
        let x = solved(&mut system, &z, &[]).unwrap();
        assert!(errors(&mut system, &x, |t| t.powi(3))[2] < 4e-15);
    }
}

/// A uniform mesh misses the layer and says so; an adapted one of as many intervals resolves it.
#[test]
fn adaptation_resolves_a_layer() {
    let epsilon = 1e-3;
    let exact = |t: f64| (-t / epsilon).exp_m1() / (-1.0 / epsilon).exp_m1();
    let mut system = collocated(Layer, 4, 20);
    let z = system.sampled(&[], |_, tau, x| x[0] = tau);
    let mut x = solved(&mut system, &z, &[epsilon]).unwrap();
    let n = x.len() - 1;
    let coarse = errors(&mut system, &x, exact)[2];
    let estimate = system.mesh_error(&x);
    assert!(coarse > 0.1 && estimate > 0.1);
    for _ in 0..8 {
        system.adapt(&mut x, &mut []).unwrap();
        x = solved(&mut system, &x[..n], &[epsilon]).unwrap();
    }
    let (fine, estimate) = (errors(&mut system, &x, exact)[2], system.mesh_error(&x));
    assert!(fine < 1e-5 && estimate < 1e-4 && estimate > 0.5 * fine, "{fine:e} {estimate:e}");
    assert_eq!(system.meshes()[0].intervals(), 20);
}

/// The estimate chooses the number of intervals.
#[test]
fn a_tolerance_chooses_the_mesh() {
    for tolerance in [1e-4, 1e-7, 1e-10] {
        let epsilon = 0.05;
        let exact = |t: f64| (-t / epsilon).exp_m1() / (-1.0 / epsilon).exp_m1();
        let mut system = collocated(Layer, 4, 10);
        let z = system.sampled(&[], |_, tau, x| x[0] = tau);
        let mut x = solved(&mut system, &z, &[epsilon]).unwrap();
        for _ in 0..3 {
            (system, x) = system.with_error(&x, tolerance).unwrap();
            let n = x.len() - 1;
            x = solved(&mut system, &x[..n], &[epsilon]).unwrap();
        }
        let (error, estimate) = (errors(&mut system, &x, exact)[2], system.mesh_error(&x));
        assert!(error < tolerance && estimate < 1.2 * tolerance && estimate > 0.05 * tolerance);
    }
    let mut system = collocated(Layer, 2, 10);
    let z = system.sampled(&[], |_, tau, x| x[0] = tau);
    let x = solved(&mut system, &z, &[0.05]).unwrap();
    let refused = system.with_error(&x, 1e-14).err().unwrap().to_string();
    assert!(
        refused.contains("intervals on segment 0, but at most 4096 intervals are allowed"),
        "{refused}"
    );
}

/// Directions and the phase reference are carried over with the solution: a tangent remains one.
#[test]
fn adaptation_carries_directions() {
    let mut system = collocated(VanDerPol, 7, 40);
    let z = system.sampled(&[6.5], ellipse(2.0, -2.0));
    let mut x = solved(&mut system, &z, &[1.0]).unwrap();
    system.set_reference(&x).unwrap();
    let n = x.len() - 1;
    let tangent = |system: &mut Collocated, x: &[f64]| {
        let mut unit = vec![0.0; n + 1];
        unit[n] = 1.0;
        let mut t = vec![0.0; n];
        system.derivative(x, &[&unit], &mut t).unwrap();
        system.assemble(x).unwrap();
        let mut factors = Factors::default();
        system.factor(Form::Jacobian, Border::NONE, &mut factors).unwrap();
        factors.solve(&mut t);
        t.push(-1.0);
        t
    };
    let mut carried = tangent(&mut system, &x);
    system.adapt(&mut x, &mut [&mut carried[..]]).unwrap();
    x = solved(&mut system, &x[..n], &[1.0]).unwrap();
    let fresh = tangent(&mut system, &x);
    let size = fresh.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
    for (carried, fresh) in carried.iter().zip(&fresh) {
        close(*carried, *fresh, 1e-7 * size);
    }
}

/// Far too few intervals: the branch ends before the fold and says why. Told to go on, the monitor
/// still says so, and the fold's error covers the truth.
#[test]
fn a_coarse_mesh_says_so() {
    let mut system = collocated(Bratu, 2, 2);
    let limit = Settings::default().max_mesh_error;
    // Nothing adds intervals.
    let stays = || Settings { target_mesh_error: f64::MAX, ..Settings::default() };
    let told_to = Settings { refinement: 0.0, max_mesh_error: 1.0, ..stays() };
    let trace = |system: &mut Collocated, settings: Settings| {
        Continuation::new(system)
            .settings(settings)
            .at("lambda", 0.5)
            .along("lambda", 0.0..=10.0)
            .bound("max_u", 0.0..=5.0)
            .trace()
            .unwrap()
    };
    let branch = trace(&mut system, stays());
    assert!(branch.of_kind(Kind::LP).next().is_none());
    let End::MeshTooCoarse { error, .. } = branch.ends[1] else { panic!("{:?}", branch.ends) };
    let end = branch.special.last().unwrap();
    assert!(error > limit && end.kind == Kind::MX && end.error > limit * end.parameters[0]);
    let branch = trace(&mut system, told_to.clone());
    let fold = branch.of_kind(Kind::LP).next().unwrap();
    let rough = (fold.parameters[0] - FOLD).abs();
    assert!(rough > 1e-3 && fold.monitors[1] > 1e-2);
    for refinement in [0.1, 1e-3, 1e-6, 1e-9] {
        let branch = trace(&mut system, Settings { refinement, ..told_to.clone() });
        let fold = branch.of_kind(Kind::LP).next().unwrap();
        assert!(fold.converged && (fold.parameters[0] - FOLD).abs() <= fold.error);
    }
    // The branch can be bounded where the mesh no longer resolves it.
    let branch = Continuation::new(&mut system)
        .settings(told_to)
        .at("lambda", 0.5)
        .along("lambda", 0.0..=10.0)
        .bound("mesh_error", 0.0..=0.05)
        .trace()
        .unwrap();
    let end = branch.special.last().unwrap();
    close(end.monitors[1], 0.05, 1e-9);
}

/// A state that leaves the domain is named with segment and time.
#[derive(Clone)]
struct Forbidden;

impl BoundaryProblem for Forbidden {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["p"])
    }
    fn field<T: Scalar>(&self, _s: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = (x[0] - q[0]).sqrt();
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0] - 1.0;
    }
}

#[test]
fn refusals_name_segment_state_and_time() {
    let mut system = collocated(Forbidden, 2, 4);
    let mut x = system.sampled(&[], |_, tau, x| x[0] = 1.0 - tau);
    x.push(0.6);
    let mut r = vec![0.0; x.len() - 1];
    let refused = one_line(&system.residual(&x, &mut r).unwrap_err());
    assert!(refused.contains("the equation of u at t = 2.5"), "{refused}");
    assert!(refused.contains("on segment 0"), "{refused}");
    assert_eq!(one_line(&system.assemble(&x).unwrap_err()), refused);
}

/// After a warm-up nothing that a step of the continuation asks for allocates.
#[test]
fn steps_allocate_nothing() {
    let mut system = collocated(Glued, 4, 10);
    let guess = |s: usize, tau: f64, x: &mut [f64]| match s {
        0 => x[0] = 1.0 + tau * tau,
        _ => x.copy_from_slice(&[2.0 - 3.0 * tau, (4.0 * tau + 1.0).sin()]),
    };
    let mut x = system.sampled(&[0.8, 1.0], guess);
    let n = x.len();
    x.extend([1.2, 0.3, 1.5]);
    let mut unit = vec![0.0; n + 3];
    unit[n] = 1.0;
    let (mut r, mut column, mut long) = (vec![0.0; n], vec![0.0; n], vec![0.0; n + 3]);
    let mut monitors = vec![0.0; 4];
    let rows = vec![1.0; n];
    let mut factors = Factors::default();
    let mut step = |shift: f64| {
        x[n] = 1.2 + shift;
        system.residual(&x, &mut r).unwrap();
        system.derivative(&x, &[&unit], &mut column).unwrap();
        system.assemble(&x).unwrap();
        let border = Border { width: 1, columns: &column, rows: &rows, corner: &[0.3], units: &[] };
        system.factor(Form::Jacobian, border, &mut factors).unwrap();
        factors.solve(&mut long[..n + 1]);
        factors.solve_transposed(&mut long[..n + 1]);
        system.derivative(&x, &[&unit, &unit], &mut r).unwrap();
        system.derivative(&x, &[&unit, &unit, &unit], &mut r).unwrap();
        system.gradient(&x, Functional::First(&rows, &unit), &[0], &mut long).unwrap();
        system.gradient(&x, Functional::Second(&rows, &unit), &[0], &mut long).unwrap();
        system.monitors(&x, 0, &mut monitors).unwrap();
        (0..4).for_each(|k| system.gradient(&x, Functional::Monitor(k), &[0], &mut long).unwrap());
        reduced_pencil(&mut system).unwrap();
    };
    step(0.0);
    let counted = allocation_counter::measure(|| step(0.01));
    assert_eq!(counted.count_total, 0);
}

/// A problem with its evaluations counted.
#[derive(Clone)]
struct Counted(Bratu, Arc<AtomicUsize>);

impl BoundaryProblem for Counted {
    fn segments(&self) -> Vec<Vec<String>> {
        self.0.segments()
    }
    fn parameters(&self) -> Vec<String> {
        self.0.parameters()
    }
    fn field<T: Scalar>(&self, segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        self.1.fetch_add(1, Relaxed);
        self.0.field(segment, t, x, q, f);
    }
    fn duration<T: Scalar>(&self, segment: usize, q: &[T]) -> T {
        self.0.duration(segment, q)
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        self.0.boundary(ends, q, b);
    }
}

/// Eight times the intervals are eight times the evaluations and the memory.
#[test]
fn cost_is_linear_in_the_intervals() {
    let [few, many] = [100, 800].map(|intervals| {
        let evaluations = Arc::new(AtomicUsize::new(0));
        let memory = allocation_counter::measure(|| {
            let mut system = collocated(Counted(Bratu, Arc::clone(&evaluations)), 4, intervals);
            let mut x = system.sampled(&[], |_, tau, x| x[0] = tau * (1.0 - tau));
            let n = x.len();
            x.push(1.0);
            evaluations.store(0, Relaxed);
            system.assemble(&x).unwrap();
            let mut factors = Factors::default();
            system.factor(Form::Jacobian, Border::NONE, &mut factors).unwrap();
            factors.solve(&mut vec![1.0; n]);
        });
        [evaluations.load(Relaxed) as f64, memory.bytes_max as f64]
    });
    for (few, many) in few.into_iter().zip(many) {
        assert!((7.0..8.5).contains(&(many / few)), "{few} {many}");
    }
}

/// The nodes are Lobatto points: for `m = 3` the inner ones are `(1 ± 1/√5)/2`.
#[test]
fn nodes_are_lobatto_points() {
    let inner = 0.5 * (1.0 - 0.2_f64.sqrt());
    let exact = [0.0, inner, 1.0 - inner, 1.0];
    for (node, exact) in Collocation::new(3).unwrap().places().iter().zip(exact) {
        assert!((node - exact).abs() < 1e-16);
    }
}

/// The error polynomial of two points is `s(s − ½)(s − 1)/6`, largest at the Gauss points:
/// `√3/216`.
#[test]
fn error_constant_of_two_points() {
    let constant = Collocation::new(2).unwrap().error_constant();
    assert!((constant - 3.0_f64.sqrt() / 216.0).abs() < 1e-17);
}

/// `x' = m tᵐ⁻¹`.
struct Power(usize);

impl BoundaryProblem for Power {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![vec!["x".into()]]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["duration".into()]
    }
    fn field<T: Scalar>(&self, _segment: usize, t: T, _x: &[T], _q: &[T], f: &mut [T]) {
        f[0] = t.powi(self.0 as i32 - 1) * self.0 as f64;
    }
    fn duration<T: Scalar>(&self, _segment: usize, q: &[T]) -> T {
        q[0]
    }
    fn boundary<T: Scalar>(&self, _ends: Ends<T>, _q: &[T], _b: &mut [T]) {}
}

const WHOLE: Span = Span { segment: 0, start: 0.0, end: 1.0 };

/// A polynomial of degree `m` solves its equations at `m` points, and is known between the nodes.
#[test]
fn polynomials_of_the_degree_solve_their_equations() {
    for m in 2..=7 {
        let collocation = Collocation::new(m).unwrap();
        let nodes: Vec<f64> = collocation.places().iter().map(|s| s.powi(m as i32)).collect();
        let problem = Power(m).into_equations();
        let interval = Interval { problem: &*problem, span: WHOLE, nodes: &nodes, q: &[1.0] };
        let (mut residual, mut x) = (vec![f64::NAN; m], [f64::NAN]);
        collocation.residual(interval, &mut Default::default(), &mut residual).unwrap();
        assert!(residual.iter().all(|r| r.abs() < 2e-14), "{residual:?}");
        for place in [0.1, 0.5, 0.8] {
            collocation.value(interval, place, &mut x);
            assert!((x[0] - place.powi(m as i32)).abs() < 1e-14, "{x:?}");
        }
    }
}

/// A Chebyshev polynomial of degree 7: all six inner extrema are found, and both ends.
#[test]
fn every_stationary_place_is_found() {
    let collocation = Collocation::new(7).unwrap();
    let chebyshev = |s: &f64| (7.0 * (2.0 * s - 1.0).acos()).cos();
    let nodes: Vec<f64> = collocation.places().iter().map(chebyshev).collect();
    let problem = Power(7).into_equations();
    let interval = Interval { problem: &*problem, span: WHOLE, nodes: &nodes, q: &[1.0] };
    let watched =
        MonitoredFunctions { extrema: &[Observable::State(0)], scales: &[1.0], rises: &[] };
    let mut found = Vec::new();
    collocation.extrema(interval, watched, &mut |_, place, _| found.push(place));
    found.sort_by(f64::total_cmp);
    let exact = |k: usize| 0.5 * (1.0 - (std::f64::consts::PI * k as f64 / 7.0).cos());
    assert_eq!(found.len(), 8, "{found:?}");
    for (k, s) in found.iter().enumerate() {
        assert!((s - exact(k)).abs() < 1e-13, "{s}");
    }
}
