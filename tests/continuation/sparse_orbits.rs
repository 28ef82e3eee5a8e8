//! Promises of sparse matrices for periodic orbits: branches from Hopf points, factors that solve the
//! linearised equations, and patterns that follow the orbit.

use crate::common::close;
use crate::common::diffusive_brusselator::DiffusiveBrusselator;
use std::f64::consts::TAU;
use tangency::core::bvp::{BoundarySystem, Collocation, Mesh, Shooting};
use tangency::core::continuation::{Branch, Continuation};
use tangency::core::linalg::{Border, Factors, Form, SpectrumRequest};
use tangency::core::orbit::periodic_orbits;
use tangency::core::problem::{Equilibria, Group, Names, VectorField};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Kind, Matrices, Solution, Sparse, System};
use tangency::problems::classic::Bratu;

/// The cycles from the first Hopf point of the Brusselator with `2n` states, up to a length.
fn cycles(n: usize, last: f64, matrices: Matrices) -> (BoundarySystem, Branch) {
    let mut start = vec![2.0; n];
    start.extend(vec![5.45 / 2.0; n]);
    let mut rest = Sparse::new(Equilibria::new(DiffusiveBrusselator::new(n)));
    let stated = Continuation::new(&mut rest).at("L", 0.5).at("A", 2.0).at("B", 5.45);
    let rest = stated.from(&start[..]).along("L", 0.5..=last).trace().unwrap();
    let hopf = rest.of_kind(Kind::HB).next().unwrap();
    let collocation = Collocation::new(4).unwrap().with_matrices(matrices);
    let mut orbits = periodic_orbits(DiffusiveBrusselator::new(n), 20, collocation).unwrap();
    let branch = Continuation::new(&mut orbits)
        .restart(&rest, hopf.label)
        .along("L", 0.5..=last)
        .trace()
        .unwrap();
    (orbits, branch)
}

/// A motion near the equilibrium, as unknowns of a discretised orbit.
fn wave(orbits: &BoundarySystem, n: usize, amplitude: f64) -> Vec<f64> {
    let mut x = orbits.sampled(&[3.0], |_, tau, x| {
        for (i, x) in x.iter_mut().enumerate() {
            let mean = if i < n { 2.0 } else { 2.725 };
            *x = mean + amplitude * (TAU * tau + i as f64 / n as f64).sin();
        }
    });
    x.extend([0.55, 2.0, 5.45]);
    x
}

/// Asserts that factors solve the linearised equations: the directional derivative along the solution
/// is the right-hand side.
fn assert_solves(orbits: &mut BoundarySystem, x: &[f64]) {
    orbits.assemble(x).unwrap();
    let mut factors = Factors::default();
    orbits.factor(Form::Jacobian, Border::NONE, &mut factors).unwrap();
    let count = orbits.names().dimension();
    let right: Vec<f64> = (0..count).map(|i| (i as f64).cos()).collect();
    let mut solved = right.clone();
    factors.solve(&mut solved);
    let size = solved.iter().fold(1.0, |most: f64, s| most.max(s.abs()));
    solved.extend(vec![0.0; x.len() - count]);
    let mut product = vec![0.0; count];
    orbits.derivative(x, &[&solved], &mut product).unwrap();
    product.iter().zip(&right).for_each(|(found, right)| close(*found, *right, 1e-9 * size));
}

/// The solution at the end of a branch, on its own mesh.
fn end_of(branch: &Branch) -> Solution {
    let end = branch.special.last().unwrap();
    Solution {
        kind: end.kind,
        condition: None,
        itinerary: String::new(),
        method: branch.method.clone(),
        mesh: end.mesh.clone(),
        state: end.state.clone(),
        parameters: end.parameters.clone(),
        tangent: None,
        mesh_shift: None,
        multiplicity: 0,
        frequency: None,
        error: 0.0,
        switch: None,
        beside: None,
    }
}

/// Solves the equations at fixed parameters by Newton's method, from `x`.
fn solve(orbits: &mut BoundarySystem, x: &mut [f64]) {
    let count = orbits.names().dimension();
    let mut factors = Factors::default();
    for _ in 0..3 {
        let mut step = vec![0.0; count];
        orbits.residual(x, &mut step).unwrap();
        orbits.assemble(x).unwrap();
        orbits.factor(Form::Jacobian, Border::NONE, &mut factors).unwrap();
        factors.solve(&mut step);
        x.iter_mut().zip(&step).for_each(|(x, step)| *x -= step);
    }
}

#[test]
fn orbits_of_many_states_have_the_period_and_the_multipliers_of_shooting() {
    let n = 60;
    let (mut collocated, branch) = cycles(n, 0.6, Matrices::Cheaper);
    let end = branch.special.last().unwrap();
    close(end.parameters[0], 0.6, 1e-15);
    assert_eq!(end.unstable, Some(0));
    assert!(branch.warnings.is_empty(), "{:?}", branch.warnings);
    let solution = end_of(&branch);
    let start = collocated.resume_from(&solution).unwrap();
    let mut x = [&start.z[..], &end.parameters].concat();
    solve(&mut collocated, &mut x);
    let found = collocated.spectrum(&x, SpectrumRequest::new(3)).unwrap().unwrap();
    assert!(found.len() < 2 * n - 1, "a Krylov space yields only the largest multipliers");
    // The same orbit by multiple shooting.
    let mut shot = periodic_orbits(DiffusiveBrusselator::new(n), 20, Shooting::default()).unwrap();
    let start = shot.resume_from(&solution).unwrap();
    let mut y = [&start.z[..], &end.parameters].concat();
    solve(&mut shot, &mut y);
    let expected = shot.spectrum(&y, SpectrumRequest::new(3)).unwrap().unwrap();
    let [period, exact] = [&x, &y].map(|x| x[x.len() - 4]);
    close(period, exact, 1e-7);
    for (found, expected) in found.iter().zip(&expected).take(3) {
        close(found.0, expected.0, 1e-6);
        close(found.1.abs(), expected.1.abs(), 1e-6);
    }
}

#[test]
fn dense_and_sparse_matrices_yield_the_same_orbits() {
    // Fewer states than the smallest number for which sparse matrices are chosen.
    let n = 11;
    let orbit = |matrices| cycles(n, 0.6, matrices).1;
    let [dense, sparse, cheaper] =
        [Matrices::Dense, Matrices::Sparse, Matrices::Cheaper].map(orbit);
    assert_eq!(dense.method, "collocation(4)");
    assert_eq!(sparse.method, "collocation(4), sparse matrices");
    assert_eq!(cheaper.method, dense.method);
    // Enough states, and few enough multiplications.
    assert_eq!(cycles(20, 0.52, Matrices::Cheaper).1.method, sparse.method);
    let [dense, sparse] = [&dense, &sparse].map(|branch| branch.special.last().unwrap());
    let [period, other] = [dense, sparse].map(|end| end.state[end.state.len() - 1]);
    close(period, other, 1e-10);
    for (own, other) in dense.eigenvalues.iter().zip(&sparse.eigenvalues).take(3) {
        close(own.0, other.0, 1e-7);
        close(own.1.abs(), other.1.abs(), 1e-7);
    }
}

#[test]
fn sparse_matrices_are_refused_for_other_boundary_value_problems() {
    let collocation = Collocation::new(4).unwrap().with_matrices(Matrices::Sparse);
    let mut bratu = BoundarySystem::new(Bratu, collocation, vec![Mesh::uniform(5)]).unwrap();
    let mut x = bratu.sampled(&[], |_, _, x| x.fill(0.1));
    x.push(1.0);
    let refused = bratu.assemble(&x).unwrap_err().to_string();
    assert!(refused.contains("only for periodic orbits"), "{refused}");
}

#[test]
fn factors_solve_the_linearised_equations() {
    let n = 80;
    let field = DiffusiveBrusselator::new(n);
    let mut orbits = periodic_orbits(field, 10, Collocation::new(4).unwrap()).unwrap();
    let x = wave(&orbits, n, 0.5);
    assert_solves(&mut orbits, &x);
    // The same number by the transposed system, with one column in the border, for both real forms.
    let count = orbits.names().dimension();
    let vector = |seed: f64| -> Vec<f64> { (0..count).map(|i| (seed + i as f64).sin()).collect() };
    let (column, row) = (vector(5.0), vector(6.0));
    let border = Border { width: 1, columns: &column, rows: &row, corner: &[0.5], units: &[] };
    let mut factors = Factors::default();
    for form in [Form::Jacobian, Form::Antiperiodic] {
        orbits.factor(form, border, &mut factors).unwrap();
        let (mut forward, mut backward) = (vector(2.0), vector(3.0));
        forward.push(0.7);
        backward.push(-0.4);
        let (right, weights) = (forward.clone(), backward.clone());
        factors.solve(&mut forward);
        factors.solve_transposed(&mut backward);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (one, other) = (dot(&weights, &forward), dot(&backward, &right));
        close(one, other, 1e-9 * one.abs().max(1.0));
    }
}

/// The bordered matrix of the Floquet multiplier `e^{iω}` is built from the derivatives of the orbit's
/// equations, in which the return conditions are `x(0) − x(1)`.
#[test]
fn complex_factors_solve_the_linearised_equations() {
    let (n, nodes, omega) = (80, 41, 0.3);
    let field = DiffusiveBrusselator::new(n);
    let mut orbits = periodic_orbits(field, 10, Collocation::new(4).unwrap()).unwrap();
    let x = wave(&orbits, n, 0.5);
    orbits.assemble(&x).unwrap();
    let (count, values) = (orbits.names().dimension(), 2 * n * nodes);
    let vector = |seed: f64| -> Vec<f64> { (0..count).map(|i| (seed + i as f64).sin()).collect() };
    // A complex vector consists of its real and its imaginary part.
    let [column, row, right] = [5.0, 6.0, 2.0].map(|seed| [vector(seed), vector(seed + 0.5)]);
    let (columns, rows) = (column.concat(), row.concat());
    let border = Border { width: 1, columns: &columns, rows: &rows, corner: &[0.0], units: &[] };
    let mut factors = Factors::default();
    orbits.factor(Form::Oscillation(omega), border, &mut factors).unwrap();
    let last = [0.7, -0.4];
    let bordered = |part: usize| right[part].iter().copied().chain([last[part]]);
    let mut solved: Vec<f64> = bordered(0).chain(bordered(1)).collect();
    factors.solve(&mut solved);
    let parts: Vec<&[f64]> = solved.chunks(count + 1).collect();
    let (v, g) = (parts.clone(), [parts[0][count], parts[1][count]]);
    let mut products = [vec![0.0; count], vec![0.0; count]];
    for part in 0..2 {
        // The period, an extra unknown, is zero in the complex linearisation.
        let mut direction = v[part][..values].to_vec();
        direction.resize(x.len(), 0.0);
        orbits.derivative(&x, &[&direction], &mut products[part]).unwrap();
    }
    let size = solved.iter().fold(1.0, |most: f64, s| most.max(s.abs()));
    let turned = [omega.cos() - 1.0, omega.sin()];
    for i in 0..values {
        let [mut re, mut im] = [products[0][i], products[1][i]];
        if let Some(state) = i.checked_sub(values - 2 * n) {
            let start = [v[0][state * nodes], v[1][state * nodes]];
            re += turned[0] * start[0] - turned[1] * start[1];
            im += turned[0] * start[1] + turned[1] * start[0];
        }
        re += column[0][i] * g[0] - column[1][i] * g[1];
        im += column[0][i] * g[1] + column[1][i] * g[0];
        close(re, right[0][i], 1e-9 * size);
        close(im, right[1][i], 1e-9 * size);
    }
    // The row enters as its complex conjugate, without the period.
    let product = |a: usize, b: usize| -> f64 {
        row[a][..values].iter().zip(&v[b][..values]).map(|(a, b)| a * b).sum()
    };
    close(product(0, 0) + product(1, 1), last[0], 1e-9 * size * count as f64);
    close(product(0, 1) - product(1, 0), last[1], 1e-9 * size * count as f64);
    // The adjoint solution.
    let mut backward: Vec<f64> = solved.iter().map(|x| x.cos()).collect();
    let weights = backward.clone();
    factors.solve_transposed(&mut backward);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let right: Vec<f64> = bordered(0).chain(bordered(1)).collect();
    let (one, other) = (dot(&weights, &solved), dot(&backward, &right));
    close(one, other, 1e-9 * one.abs().max(1.0));
}

#[test]
fn a_dependence_that_begins_on_the_branch_extends_the_pattern() {
    let n = 80;
    let field = DiffusiveBrusselator { n, valve: 2.5 };
    let mut orbits = periodic_orbits(field, 10, Collocation::new(4).unwrap()).unwrap();
    // Before the valve opens, and after: an assembly with the old pattern would miss the entry.
    for amplitude in [0.1, 1.0] {
        let x = wave(&orbits, n, amplitude);
        assert_solves(&mut orbits, &x);
    }
}

/// Langford's system, whose cycle is a circle with a torus point (W. F. Langford, *Numerical Studies of
/// Torus Bifurcations*, ISNM 70 (1984) 285; here without the term that breaks the symmetry of the circle).
/// The cycle drives a chain of states with diffusion.
struct DrivenTorus {
    chain: usize,
}

impl DrivenTorus {
    /// The parameters `c`, `d` and `e`.
    const FIXED: [f64; 3] = [0.6, 3.5, 0.25];

    /// The parameter `a` and the angle of the torus point, at the parameter `b`. On the cycle, `z = b` and
    /// `r² (1 + e b) = c + a b − b³/3`. Deviations satisfy `δr' = r δz` and
    /// `δz' = (a − b² − e r²) δz − 2 r (1 + e b) δr`: if `a = b² + e r²`, they neither grow nor decay.
    fn torus_point(b: f64) -> [f64; 2] {
        let [c, d, e] = Self::FIXED;
        let slope = 1.0 + e * b;
        let a = (b * b + e * (c - b.powi(3) / 3.0) / slope) / (1.0 - e * b / slope);
        let squared = (c + a * b - b.powi(3) / 3.0) / slope;
        [a, (2.0 * squared * slope).sqrt() * TAU / d]
    }
}

impl VectorField for DrivenTorus {
    fn names(&self) -> Names {
        let chain = (1..=self.chain).map(|i| format!("w[{i}]"));
        let all: Vec<String> = ["x", "y", "z"].map(String::from).into_iter().chain(chain).collect();
        Names::new(Group::of_states(&all), ["a", "b"])
    }
    fn field<T: Scalar>(&self, _t: T, u: &[T], p: &[T], f: &mut [T]) {
        let ([c, d, e], (x, y, z), squares) =
            (Self::FIXED, (u[0], u[1], u[2]), u[0] * u[0] + u[1] * u[1]);
        f[0] = (z - p[1]) * x - y * d;
        f[1] = x * d + (z - p[1]) * y;
        f[2] = p[0] * z + c - z * z * z / 3.0 - squares * (z * e + 1.0);
        let w = &u[3..];
        for i in 0..self.chain {
            let before = if i == 0 { x } else { w[i - 1] };
            let after = w.get(i + 1).copied().unwrap_or(w[i]);
            f[3 + i] = (before - w[i] * 2.0 + after) * 20.0 - w[i];
        }
    }
}

#[test]
fn torus_points_of_many_states_are_found_and_continued() {
    let collocation = Collocation::new(4).unwrap().with_matrices(Matrices::Sparse);
    let mut orbits = periodic_orbits(DrivenTorus { chain: 21 }, 30, collocation).unwrap();
    let [_, d, e] = DrivenTorus::FIXED;
    let (a, b) = (0.6, 0.7_f64);
    let radius = ((0.6 + a * b - b.powi(3) / 3.0) / (1.0 + e * b)).sqrt();
    let start = orbits.sampled(&[TAU / d], |_, tau, x| {
        let (sine, cosine) = (TAU * tau).sin_cos();
        x.fill(0.0);
        x[..3].copy_from_slice(&[radius * cosine, radius * sine, b]);
    });
    let run = Continuation::new(&mut orbits).from(&start[..]).at("a", a).at("b", b);
    let branch = run.along("a", 0.6..=0.75).trace().unwrap();
    assert_eq!(branch.method, "collocation(4), sparse matrices");
    let exact = DrivenTorus::torus_point(b);
    let torus = branch.of_kind(Kind::TR).next().expect("a torus point");
    close(torus.parameters[0], exact[0], 1e-9);
    assert!(torus.converged && torus.error < 1e-8, "{}", torus.error);
    // The curve of torus points.
    let label = torus.label;
    let curve = Continuation::new(&mut orbits).restart(&branch, label).hold(Kind::TR);
    let curve = curve.along("b", 0.6..=0.8).along("a", 0.0..=2.0).trace().unwrap();
    let [a, b] = ["a", "b"].map(|name| curve.column(name).unwrap());
    assert!(curve.points.len() > 3);
    for point in &curve.points {
        let exact = DrivenTorus::torus_point(point.value(b).unwrap());
        close(point.value(a).unwrap(), exact[0], 1e-7);
    }
    let angle = curve.column("torus_angle").unwrap();
    let wrapped = |angle: f64| angle.sin().abs();
    let last = curve.points.last().unwrap();
    let expected = DrivenTorus::torus_point(last.value(b).unwrap())[1];
    close(wrapped(last.value(angle).unwrap()), wrapped(expected), 1e-6);
}
