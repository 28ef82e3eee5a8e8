//! Orbits of many legs: what condenses legs one to the next against dense matrices of all unknowns.

use super::systems::dry_impact::DryImpact;
use super::systems::reference::Reference;
use crate::common::agree;
use tangency::core::bvp::{BoundarySystem, Collocation, Mesh, Method, Shooting};
use tangency::core::linalg::{Border, BorderedLu, Factors, Form};
use tangency::core::ode::Scheme;
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::{Functional, System};

/// Waves stand for numbers without any order.
fn wave(seed: usize, length: usize) -> Vec<f64> {
    (0..length).map(|i| (seed as f64 + 1.3 * i as f64 * (seed + 1) as f64).cos()).collect()
}

/// An orbit's legs several times over, at a point that solves nothing.
fn at(
    (system, words, p): (Reference, &str, &[f64]),
    times: usize,
    method: impl Into<Method>,
    seed: usize,
) -> (BoundarySystem, Vec<f64>) {
    let itinerary = Itinerary::read(&[words].repeat(times).join(" "), &system).unwrap();
    let meshes = vec![Mesh::uniform(2); itinerary.legs.len()];
    let orbit = HybridOrbit::of(system, itinerary).unwrap();
    let orbits = BoundarySystem::new(orbit, method, meshes).unwrap();
    let mut x = wave(seed, orbits.names().dimension());
    x.iter_mut().for_each(|x| *x = 1.1 + 0.5 * *x);
    x.extend_from_slice(p);
    (orbits, x)
}

/// A forced orbit of legs of different numbers of states, one of equal ones, and one without
/// forcing.
fn problems() -> [(Reference, &'static str, Vec<f64>); 3] {
    [
        (Reference::DryImpact, "stick:impact up:turn down:turn", DryImpact::DEFAULTS.to_vec()),
        (Reference::ImpactOscillator, "flight:impact", vec![0.3, 1.7, 0.8, 0.1, 0.9]),
        (Reference::Belt, "stick:slower slower:belt", vec![1.0, 0.6, 0.3]),
    ]
}

fn collocation() -> Collocation {
    Collocation::new(3).unwrap()
}

/// A bordered matrix, one column after the other, whose `F_z` is given so.
fn bordered(matrix: &[f64], border: Border) -> Vec<f64> {
    let (n, width) = (matrix.len().isqrt(), border.width);
    let size = n + width;
    let mut all = vec![0.0; size * size];
    for j in 0..n {
        all[j * size..j * size + n].copy_from_slice(&matrix[j * n..(j + 1) * n]);
        (0..width).for_each(|i| all[j * size + n + i] = border.rows[i * n + j]);
    }
    for j in 0..width {
        all[(n + j) * size..][..n].copy_from_slice(&border.columns[j * n..(j + 1) * n]);
        (0..width).for_each(|i| all[(n + j) * size + n + i] = border.corner[i * width + j]);
    }
    all
}

/// `F_z` at a point in dual numbers, `μ y − Y` in place of returns.
fn dense(system: &mut BoundarySystem, x: &[f64], mu: f64) -> Vec<f64> {
    let n = system.names().dimension();
    let mut matrix = vec![0.0; n * n];
    for (j, column) in matrix.chunks_exact_mut(n).enumerate() {
        let unit: Vec<f64> = (0..x.len()).map(|i| f64::from(u8::from(i == j))).collect();
        system.derivative(x, &[&unit], column).unwrap();
    }
    system.assemble(x).unwrap();
    for r in returns(system) {
        matrix[r[1] * n + r[0]] += mu - 1.0;
    }
    matrix
}

/// Equation and unknown of each return.
fn returns(system: &BoundarySystem) -> Vec<[usize; 2]> {
    let groups = system.names().unknowns.clone();
    let begin = |k: usize| groups[..k].iter().map(|group| group.length).sum::<usize>();
    let states = system.problem().segments().concat().len();
    let n = system.names().dimension();
    let conditions = n - states - system.problem().extras().len();
    // The first leg's states, and under forcing the time of the start.
    let segments = system.problem().segments();
    let first = (0..segments[0].len()).map(|i| [conditions + i, begin(i)]);
    let start = [conditions + states + segments.len(), begin(states)];
    let forced = system.problem().extras()[0] == "start";
    first.chain(forced.then_some(start)).collect()
}

/// Derivatives are those of the residual in dual numbers, gradients those of nested ones.
#[test]
fn derivatives_are_those_of_all_equations() {
    for (system, words, p) in problems() {
        let (mut orbits, x) = at((system, words, &p), 3, collocation(), 2);
        let n = x.len() - p.len();
        let released: Vec<usize> = (0..p.len()).collect();
        let (w, v) = (wave(4, n), wave(5, x.len()));
        let (mut gradient, mut second) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        orbits.gradient(&x, Functional::First(&w, &v), &released, &mut gradient).unwrap();
        orbits.gradient(&x, Functional::Second(&w, &v), &released, &mut second).unwrap();
        let mut column = vec![0.0; n];
        let dot = |a: &[f64]| a.iter().zip(&w).map(|(a, w)| a * w).sum::<f64>();
        for i in 0..x.len() {
            let unit: Vec<f64> = (0..x.len()).map(|j| f64::from(u8::from(i == j))).collect();
            if i >= n {
                // That of the assembly, and the same in dual numbers.
                orbits.derivative(&x, &[&unit], &mut column).unwrap();
                let assembled = column.clone();
                let twice: Vec<f64> = unit.iter().map(|u| 2.0 * u).collect();
                orbits.derivative(&x, &[&twice], &mut column).unwrap();
                let half: Vec<f64> = column.iter().map(|c| 0.5 * c).collect();
                agree(&assembled, &half, 1e-12);
            }
            orbits.derivative(&x, &[&v, &unit], &mut column).unwrap();
            agree(&[gradient[i]], &[dot(&column)], 1e-12);
            orbits.derivative(&x, &[&v, &v, &unit], &mut column).unwrap();
            agree(&[second[i]], &[dot(&column)], 1e-12);
        }
    }
}

/// Solutions with matrix and transposed, for the multipliers 1 and −1, within borders; and the sign
/// of the determinant.
#[test]
fn solutions_are_those_of_dense_matrices() {
    for (system, words, p) in problems() {
        for (times, width) in [(1, 0), (1, 1), (2, 2), (5, 1)] {
            let (mut signs, mut factors) = (Vec::new(), Factors::default());
            for seed in 1..8 {
                let (mut orbits, x) = at((system, words, &p), times, collocation(), seed);
                let n = x.len() - p.len();
                let (columns, rows) = (wave(seed + 1, n * width), wave(seed + 2, n * width));
                let corner = wave(seed + 3, width * width);
                let border =
                    Border { width, columns: &columns, rows: &rows, corner: &corner, units: &[] };
                for mu in [1.0, -1.0] {
                    let matrix = dense(&mut orbits, &x, mu);
                    let all = bordered(&matrix, border);
                    let form = if mu == 1.0 { Form::Jacobian } else { Form::Antiperiodic };
                    orbits.factor(form, border, &mut factors).unwrap();
                    let solution = wave(seed + 4, n + width);
                    let [mut right, mut left] = products(&all, &solution);
                    factors.solve(&mut right);
                    factors.solve_transposed(&mut left);
                    agree(&right, &solution, 1e-8);
                    agree(&left, &solution, 1e-8);
                    let mut lu = BorderedLu::<f64>::default();
                    lu.factor(&all, Border::NONE).unwrap();
                    signs.push(lu.determinant_sign() * factors.determinant_sign());
                }
            }
            assert!(signs.iter().all(|sign| *sign == signs[0]), "{words}: {signs:?}");
        }
    }
}

/// `A x` and `Aᵀ x`.
fn products(matrix: &[f64], x: &[f64]) -> [Vec<f64>; 2] {
    let size = x.len();
    let entry = |i: usize, j: usize| matrix[j * size + i];
    let sum = |of: &dyn Fn(usize, usize) -> f64, i| (0..size).map(|j| of(i, j) * x[j]).sum();
    let transposed = |i, j| entry(j, i);
    [(0..size).map(|i| sum(&entry, i)).collect(), (0..size).map(|i| sum(&transposed, i)).collect()]
}

/// Solutions for a complex multiplier within a complex border.
#[test]
fn oscillations_are_those_of_dense_matrices() {
    for (system, words, p) in problems() {
        let (mut orbits, x) = at((system, words, &p), 3, collocation(), 3);
        let (n, omega) = (x.len() - p.len(), 0.7_f64);
        let matrix = dense(&mut orbits, &x, 1.0);
        let places = returns(&orbits);
        let (column, row, solution) = (wave(1, 2 * n), wave(2, 2 * n), wave(5, 2 * n + 2));
        // The complex matrix as a real one of twice the size: unknowns and equations, then the
        // border, real parts first.
        let half = n + 1;
        let mut all = vec![0.0; 4 * half * half];
        let mut add = |i: usize, j: usize, (re, im): (f64, f64)| {
            all[j * 2 * half + i] += re;
            all[(half + j) * 2 * half + half + i] += re;
            all[j * 2 * half + half + i] += im;
            all[(half + j) * 2 * half + i] -= im;
        };
        for j in 0..n {
            (0..n).for_each(|i| add(i, j, (matrix[j * n + i], 0.0)));
            add(j, n, (column[j], column[n + j]));
            add(n, j, (row[j], -row[n + j]));
        }
        for [i, j] in places {
            add(i, j, (omega.cos() - 1.0, omega.sin()));
        }
        let [mut right, mut left] = products(&all, &solution);
        let border = Border { width: 1, columns: &column, rows: &row, corner: &[0.0], units: &[] };
        let mut factors = Factors::default();
        orbits.factor(Form::Oscillation(omega), border, &mut factors).unwrap();
        factors.solve(&mut right);
        factors.solve_transposed(&mut left);
        agree(&right, &solution, 1e-8);
        agree(&left, &solution, 1e-8);
    }
}

/// Multiple shooting and collocation have the same multipliers on an orbit of several legs, each
/// equal to the eigenvalue of the dense pencil.
#[test]
fn multipliers_make_the_dense_matrix_singular() {
    let problems = problems();
    let (system, words, p) = &problems[1];
    let shooting = Shooting::new(Scheme::DormandPrince8, 1e-12).unwrap();
    let (mut orbits, x) = at((*system, words, p), 3, shooting, 3);
    orbits.assemble(&x).unwrap();
    let multipliers = orbits.multipliers().unwrap();
    for (mu, _) in
        multipliers.into_iter().filter(|mu| mu.1 == 0.0 && (1e-9..1e3).contains(&mu.0.abs()))
    {
        let [below, above] = [0.999, 1.001].map(|part| {
            let mut lu = BorderedLu::<f64>::default();
            lu.factor(&dense(&mut orbits, &x, mu * part), Border::NONE).unwrap();
            lu.determinant_sign()
        });
        assert_eq!(below, -above, "the determinant changes sign at {mu}");
    }
}
