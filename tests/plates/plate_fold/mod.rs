//! Equilibria and folds of plates and strips, found by the plainest of methods: independent of the
//! solvers under test elsewhere.

use crate::plates::models::LOAD;
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::problem::ZeroProblem;
use tangency::core::system::{Dense, Functional, System};

/// Newton's iteration from `z = start` at fixed parameters; `x = (z, p)`.
pub fn equilibrium(system: &mut dyn System, start: &[f64], p: &[f64]) -> Vec<f64> {
    let mut x = [start, p].concat();
    settle(system, &mut x);
    x
}

/// Newton's iteration from `x = (z, p)` at fixed parameters.
pub fn settle(system: &mut dyn System, x: &mut [f64]) {
    let mut step = vec![0.0; system.names().dimension()];
    for _ in 0..50 {
        system.residual(x, &mut step).expect("inside the domain");
        system.assemble(x).expect("inside the domain");
        let mut factors = Factors::default();
        system.factor(Form::Jacobian, Border::NONE, &mut factors).expect("regular");
        factors.solve(&mut step);
        x.iter_mut().zip(&step).for_each(|(x, step)| *x -= step);
        if step.iter().all(|step| step.abs() < 1e-12) {
            return;
        }
    }
    panic!("no convergence: last step {:e}", step[0]);
}

/// The fold of the load next to `x`: Newton's iteration on `F = 0` and `g = 0`, where
/// `[F_z b; cᵀ 0][v; g] = [0; 1]`, and `g` has the gradient `−wᵀ F_zx v`.
pub fn fold(system: &mut dyn System, mut x: Vec<f64>) -> Vec<f64> {
    let n = system.names().dimension();
    let mut v: Vec<f64> = (0..=n).map(|i| if i == 0 { 1.0 } else { 0.0 }).collect();
    let mut w = v.clone();
    let (mut gradient, mut load_column) = (vec![0.0; x.len()], vec![0.0; n]);
    let load: Vec<f64> = (0..x.len()).map(|i| if i == n + LOAD { 1.0 } else { 0.0 }).collect();
    for _ in 0..40 {
        let mut step = vec![0.0; n + 1];
        system.residual(&x, &mut step[..n]).expect("inside the domain");
        system.assemble(&x).expect("inside the domain");
        let border =
            Border { width: 1, columns: &w[..n], rows: &v[..n], corner: &[0.0], units: &[] };
        let mut factors = Factors::default();
        system.factor(Form::Jacobian, border, &mut factors).expect("regular");
        (v, w) = (vec![0.0; n + 1], vec![0.0; n + 1]);
        (v[n], w[n]) = (1.0, 1.0);
        factors.solve(&mut v);
        factors.solve_transposed(&mut w);
        step[n] = v[n];
        let direction = [&v[..n], &vec![0.0; x.len() - n]].concat();
        system
            .gradient(&x, Functional::First(&w[..n], &direction), &[LOAD], &mut gradient)
            .unwrap();
        gradient.iter_mut().for_each(|g| *g = -*g);
        system.derivative(&x, &[&load], &mut load_column).unwrap();
        let border = Border {
            width: 1,
            columns: &load_column,
            rows: &gradient[..n],
            corner: &gradient[n + LOAD..=n + LOAD],
            units: &[],
        };
        let mut factors = Factors::default();
        system.factor(Form::Jacobian, border, &mut factors).expect("regular");
        factors.solve(&mut step);
        x[..n].iter_mut().zip(&step).for_each(|(x, step)| *x -= step);
        x[n + LOAD] -= step[n];
        for null in [&mut v, &mut w] {
            let norm = null[..n].iter().map(|value| value * value).sum::<f64>().sqrt();
            null.iter_mut().for_each(|value| *value /= norm);
        }
        if step[..n].iter().all(|step| step.abs() < 1e-12)
            && step[n].abs() < 1e-12 * (100.0 + x[n + LOAD].abs())
        {
            return x;
        }
    }
    panic!("no fold found");
}

/// Where the load has its maximum if the deflection is the first function alone: the residual's
/// first component is linear in the load.
pub fn one_mode_start<P: ZeroProblem + 'static>(system: &mut Dense<P>, p: &[f64]) -> Vec<f64> {
    let n = system.names().dimension();
    let mut best = vec![0.0; n + p.len()];
    let mut monitors = vec![0.0; system.names().monitors.len()];
    let unit: Vec<f64> = (0..n).map(|i| if i == 0 { 1.0 } else { 0.0 }).collect();
    system.problem().monitors(&unit, p, &mut monitors);
    for step in 1..85 {
        let mut x = [vec![0.0; n], p.to_vec()].concat();
        x[0] = step as f64 * 0.01 / monitors[0];
        let mut first = |load| {
            let mut r = vec![0.0; n];
            x[n + LOAD] = load;
            system.residual(&x, &mut r).expect("inside the domain");
            r[0]
        };
        let (without, with) = (first(0.0), first(1.0));
        x[n + LOAD] = without / (without - with);
        if x[n + LOAD] > best[n + LOAD] {
            best = x;
        }
    }
    best
}
