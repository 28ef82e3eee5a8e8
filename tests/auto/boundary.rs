//! The boundary-value problems of AUTO's demos.

use std::f64::consts::PI;
use tangency::core::bvp::{BoundaryProblem, Ends, Monitor};
use tangency::core::scalar::Scalar;

fn strings(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| name.to_string()).collect()
}

/// `exp`: Bratu's problem `u'' = −λ eᵘ`, `u(0) = u(1) = 0`.
pub struct Exp;

impl BoundaryProblem for Exp {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["lambda"])
    }
    fn field<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -q[0] * x[0].exp();
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0];
    }
    fn of_ends<T: Scalar>(&self, _: usize, ends: Ends<T>, _: &[T]) -> T {
        ends.start[1]
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("slope".into(), Monitor::Ends(0)), ("max_u".into(), Monitor::maximum(0, 0))]
    }
}

/// `ezp`: Bratu's problem of a complex `u`.
pub struct Ezp;

impl BoundaryProblem for Ezp {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v", "s", "t"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["lambda"])
    }
    fn field<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -q[0] * x[0].exp() * x[2].cos();
        f[2] = x[3];
        f[3] = -q[0] * x[0].exp() * x[2].sin();
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _: &[T], b: &mut [T]) {
        b.copy_from_slice(&[ends.start[0], ends.end[0], ends.start[2], ends.end[2]]);
    }
    fn of_ends<T: Scalar>(&self, k: usize, ends: Ends<T>, _: &[T]) -> T {
        ends.start[1 + 2 * k]
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("real_slope".into(), Monitor::Ends(0)), ("imaginary_slope".into(), Monitor::Ends(1))]
    }
}

/// `int`: `u'' = −p₁ eᵘ`, `u(0) − u(1) = p₂`, `∫u = p₃`.
pub struct Int;

impl BoundaryProblem for Int {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["p1", "p2", "p3"])
    }
    fn field<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -q[0] * x[0].exp();
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        b[0] = ends.start[0] - ends.end[0] - q[1];
    }
    fn integrals(&self) -> usize {
        1
    }
    fn integrand<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], g: &mut [T]) {
        g[0] = x[0] - q[2];
    }
    fn of_ends<T: Scalar>(&self, _: usize, ends: Ends<T>, _: &[T]) -> T {
        ends.start[1]
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("slope".into(), Monitor::Ends(0))]
    }
}

/// `bvp`: `u'' = −(pπ)² u + u²`, `u(0) = u(1) = 0`, `c = ∫u`.
pub struct Bvp;

impl BoundaryProblem for Bvp {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["p"])
    }
    fn extras(&self) -> Vec<String> {
        strings(&["c"])
    }
    fn field<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = x[0] * x[0] - (q[0] * PI).powi(2) * x[0];
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0];
    }
    fn integrals(&self) -> usize {
        1
    }
    fn integrand<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], g: &mut [T]) {
        g[0] = x[0] - q[1];
    }
    fn of_ends<T: Scalar>(&self, _: usize, _: Ends<T>, q: &[T]) -> T {
        q[1]
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("mean".into(), Monitor::Ends(0)), ("max_u".into(), Monitor::maximum(0, 0))]
    }
}

/// `lin`: `u'' = −(pπ)² u`, `u(0) = p₂`, `u(1) = 0`, `∫u² = p₃`: the eigenfunctions.
pub struct Lin;

impl BoundaryProblem for Lin {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["p", "p2"])
    }
    fn extras(&self) -> Vec<String> {
        strings(&["p3"])
    }
    fn field<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -(q[0] * PI).powi(2) * x[0];
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        b[0] = ends.start[0] - q[1];
        b[1] = ends.end[0];
    }
    fn integrals(&self) -> usize {
        1
    }
    fn integrand<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], g: &mut [T]) {
        g[0] = x[0] * x[0] - q[2];
    }
    fn of_ends<T: Scalar>(&self, k: usize, ends: Ends<T>, q: &[T]) -> T {
        if k == 0 { q[2] } else { ends.start[1] }
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("norm".into(), Monitor::Ends(0)), ("slope".into(), Monitor::Ends(1))]
    }
}

/// `obv`: the optimality system of Bratu's problem with further coefficients,
/// `J = ∫(u − 1)² + |l|²/10`.
pub struct Obv;

impl BoundaryProblem for Obv {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![strings(&["u", "v", "a", "b"])]
    }
    fn parameters(&self) -> Vec<String> {
        strings(&["J", "l2", "l3"])
    }
    fn extras(&self) -> Vec<String> {
        strings(&["l1", "a13", "a14", "a15", "a16"])
    }
    fn field<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], f: &mut [T]) {
        let (l2, l3, l1, a15) = (q[1], q[2], q[3], q[6]);
        let u = x[0];
        let e = (u + l2 * u.powi(2) + l3 * u.powi(4)).exp();
        f[0] = x[1];
        f[1] = -l1 * e;
        f[2] = l1 * e * (l2 * u * 2.0 + l3 * u.powi(3) * 4.0 + 1.0) * x[3] + a15 * 2.0 * (u - 1.0);
        f[3] = -x[2];
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0];
        b[2] = ends.start[2] - q[4];
        b[3] = ends.start[3];
        b[4] = ends.end[2] + q[5];
        b[5] = ends.end[3];
    }
    fn integrals(&self) -> usize {
        3
    }
    fn integrand<T: Scalar>(&self, _: usize, _: T, x: &[T], q: &[T], g: &mut [T]) {
        let (l2, l3, l1, a15) = (q[1], q[2], q[3], q[6]);
        let e = (x[0] + l2 * x[0].powi(2) + l3 * x[0].powi(4)).exp();
        g[0] = x[2] * x[2] - q[7];
        g[1] = q[0] - (x[0] - 1.0).powi(2) - (l1 * l1 + l2 * l2 + l3 * l3) * 0.1;
        g[2] = -e * x[3] - a15 * 0.2 * l1;
    }
    fn of_ends<T: Scalar>(&self, k: usize, _: Ends<T>, q: &[T]) -> T {
        q[[3, 6, 7][k]]
    }
    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![
            ("l1".into(), Monitor::Ends(0)),
            ("a15".into(), Monitor::Ends(1)),
            ("a16".into(), Monitor::Ends(2)),
        ]
    }
}
