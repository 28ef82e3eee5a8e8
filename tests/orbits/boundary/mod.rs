//! Boundary-value problems with known answers, shared by tests.

use tangency::core::bvp::{
    BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, Monitor, Shape,
};
use tangency::core::scalar::Scalar;

pub fn strings(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}

/// A system by collocation at `points` on uniform meshes.
pub fn collocated(
    problem: impl BoundaryProblem + 'static,
    points: usize,
    intervals: usize,
) -> BoundarySystem {
    let meshes = problem.segments().iter().map(|_| Mesh::uniform(intervals)).collect();
    BoundarySystem::new(problem, Collocation::new(points).unwrap(), meshes).unwrap()
}

/// The fold of Bratu's problem: `λ* = 8θ²/cosh²θ` with `θ tanh θ = 1`.
pub const FOLD: f64 = 3.51383071912516;

/// `ε u'' + u' = 0`, `u(0) = 0`, `u(1) = 1`: a layer of width `ε` at the left end, as
/// `(u, v) = (u, ε u')`.
#[derive(Clone)]
pub struct Layer;

impl BoundaryProblem for Layer {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["epsilon"])
    }
    fn field<T: Scalar>(&self, _s: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1] / q[0];
        f[1] = -x[1] / q[0];
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0] - 1.0;
    }
}

/// `u'' + 10 a (eᵘ − 1 − b u²/2) = 0`, `u(0) = u(1) = 0`: branch points on `u = 0` at
/// `a = (kπ)²/10`.
#[derive(Clone)]
pub struct TrivialBranch;

impl BoundaryProblem for TrivialBranch {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["a", "b"])
    }
    fn field<T: Scalar>(&self, _s: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -q[0] * 10.0 * (x[0].exp() - 1.0 - q[1] * x[0] * x[0] * 0.5);
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0];
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("max".into(), Monitor::maximum(0, 0)), ("min".into(), Monitor::minimum(0, 0))]
    }
}

/// `u'' + λu = 0`, `u(0) = u(1) = 0`, `∫u² = 1`: `λ = (kπ)²` is an unknown.
#[derive(Clone)]
pub struct Eigenvalue;

impl BoundaryProblem for Eigenvalue {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["norm"])
    }
    fn extras(&self) -> Vec<String> {
        strings(&["lambda"])
    }
    fn field<T: Scalar>(&self, _s: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -q[1] * x[0];
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0];
    }
    fn integrals(&self) -> usize {
        1
    }
    fn integrand<T: Scalar>(&self, _s: usize, _t: T, x: &[T], q: &[T], g: &mut [T]) {
        g[0] = x[0] * x[0] - q[0];
    }
}

/// Everything at once: two segments of different fields, sizes and durations, one of them unknown,
/// forcing, nonlinear boundary conditions and an integral one. The first segment, `x' = a x cos t`,
/// lasts `d` with `x(d) = 2`; the second, `y' = w − b y²`, `w' = −y`, lasts `c`, starts at
/// `y = x(d)` with `∫y = e₂`.
#[derive(Clone)]
pub struct Glued;

impl BoundaryProblem for Glued {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["x"]), strings(&["x", "w"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["a", "b", "c"])
    }
    fn extras(&self) -> Vec<String> {
        strings(&["d", "area"])
    }
    fn field<T: Scalar>(&self, s: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        if s == 0 {
            f[0] = q[0] * x[0] * t.cos();
        } else {
            f[0] = x[1] - q[1] * x[0] * x[0];
            f[1] = -x[0];
        }
    }
    fn duration<T: Scalar>(&self, s: usize, q: &[T]) -> T {
        if s == 0 { q[3] } else { q[2] }
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        b[0] = ends.start[0] - 1.0;
        b[1] = ends.end[0] - 2.0;
        b[2] = ends.start[1] - ends.end[0];
        b[3] = ends.start[2] * ends.start[1] - q[0];
    }
    fn integrals(&self) -> usize {
        1
    }
    fn integrand<T: Scalar>(&self, s: usize, _t: T, x: &[T], q: &[T], g: &mut [T]) {
        g[0] = if s == 0 { T::zero() } else { x[0] - q[4] / q[2] };
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![
            ("duration".into(), Monitor::Duration),
            ("highest".into(), Monitor::maximum(1, 1)),
            ("lowest".into(), Monitor::minimum(1, 0)),
        ]
    }
}

/// Van der Pol's oscillator: periodic solutions of unknown period.
#[derive(Clone)]
pub struct VanDerPol;

impl BoundaryProblem for VanDerPol {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["x", "y"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["mu"])
    }
    fn extras(&self) -> Vec<String> {
        strings(&["period"])
    }
    fn field<T: Scalar>(&self, _s: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = q[0] * (T::one() - x[0] * x[0]) * x[1] - x[0];
    }
    fn duration<T: Scalar>(&self, _s: usize, q: &[T]) -> T {
        q[1]
    }
    fn shape(&self) -> Shape {
        Shape::Periodic { phase: true }
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("duration".into(), Monitor::Duration), ("max".into(), Monitor::maximum(0, 0))]
    }
}
