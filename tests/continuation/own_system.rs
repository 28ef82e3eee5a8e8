//! Promise: a `System` with a matrix of its own structure is one file, written from outside of the
//! library: a boundary-value problem whose matrix is tridiagonal, at a cost and a memory of O(n).

use crate::common::{Bratu, close, first};
use nalgebra::{DMatrix, DVector};
use num_dual::{Dual64, HyperDual64};
use tangency::core::continuation::Continuation;
use tangency::core::failure::Failure;
use tangency::core::linalg::{Border, Factorisation, Factors, Form, Spectrum, SpectrumRequest};
use tangency::core::problem::{Dynamics, Names};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Functional, Kind, System};

/// LU factors of a tridiagonal matrix within a border of width `m`. Rows are exchanged with the
/// next one only; the last row joins the border, so that the matrix itself may be singular.
#[derive(Default)]
struct BorderedBand {
    /// The rows of U: three entries, and `m` of the border's columns.
    rows: Vec<([f64; 3], Vec<f64>)>,
    /// The multiplier of the next row, those of the border's rows, and whether rows are exchanged.
    steps: Vec<(f64, Vec<f64>, bool)>,
    /// The last row and the border.
    last: DMatrix<f64>,
}

impl BorderedBand {
    /// Factors the matrix with these diagonal entries and 1 beside them.
    fn factor(&mut self, diagonal: &[f64], border: Border) -> Result<(), Failure> {
        let (n, m) = (diagonal.len(), border.width);
        let column = |i: usize| (0..m).map(|k| border.columns[k * n + i]).collect::<Vec<_>>();
        let mut below: Vec<Vec<f64>> = border.rows.chunks(n).map(<[f64]>::to_vec).collect();
        let mut corner = DMatrix::from_row_slice(m, m, border.corner);
        let mut row = ([diagonal[0], 1.0, 0.0], column(0));
        self.rows.clear();
        self.steps.clear();
        for j in 0..n - 1 {
            let above = if j + 2 < n { 1.0 } else { 0.0 };
            let mut next = ([1.0, diagonal[j + 1], above], column(j + 1));
            let exchange = row.0[0].abs() < 1.0;
            if exchange {
                std::mem::swap(&mut row, &mut next);
            }
            let (pivot, border) = (row.0, &row.1);
            let factor = next.0[0] / pivot[0];
            let reduced = [next.0[1] - factor * pivot[1], next.0[2] - factor * pivot[2], 0.0];
            next.1.iter_mut().zip(border).for_each(|(b, p)| *b -= factor * p);
            let mut factors = Vec::new();
            for (k, below) in below.iter_mut().enumerate() {
                let factor = below[j] / pivot[0];
                below[j + 1] -= factor * pivot[1];
                if let Some(entry) = below.get_mut(j + 2) {
                    *entry -= factor * pivot[2];
                }
                (0..m).for_each(|i| corner[(k, i)] -= factor * border[i]);
                factors.push(factor);
            }
            self.steps.push((factor, factors, exchange));
            self.rows.push(std::mem::replace(&mut row, (reduced, next.1)));
        }
        self.last = DMatrix::from_fn(m + 1, m + 1, |i, k| match (i, k) {
            (0, 0) => row.0[0],
            (0, k) => row.1[k - 1],
            (i, 0) => below[i - 1][n - 1],
            (i, k) => corner[(i - 1, k - 1)],
        });
        Ok(())
    }

    fn solve_last(matrix: &DMatrix<f64>, right: &mut [f64]) {
        let solved = matrix.clone().lu().solve(&DVector::from_row_slice(right));
        right.copy_from_slice(
            solved.unwrap_or_else(|| DVector::repeat(right.len(), f64::NAN)).as_slice(),
        );
    }
}

impl Factorisation for BorderedBand {
    fn solve(&mut self, r: &mut [f64]) {
        let n = self.rows.len() + 1;
        for (j, (factor, below, exchange)) in self.steps.iter().enumerate() {
            if *exchange {
                r.swap(j, j + 1);
            }
            r[j + 1] -= factor * r[j];
            below.iter().enumerate().for_each(|(k, factor)| r[n + k] -= factor * r[j]);
        }
        Self::solve_last(&self.last, &mut r[n - 1..]);
        for (j, (row, border)) in self.rows.iter().enumerate().rev() {
            let beyond = if j + 2 < n { row[2] * r[j + 2] } else { 0.0 };
            let beside: f64 = border.iter().zip(&r[n..]).map(|(b, x)| b * x).sum();
            r[j] = (r[j] - row[1] * r[j + 1] - beyond - beside) / row[0];
        }
    }
    fn solve_transposed(&mut self, r: &mut [f64]) {
        let n = self.rows.len() + 1;
        for (j, (row, border)) in self.rows.iter().enumerate() {
            r[j] /= row[0];
            r[j + 1] -= row[1] * r[j];
            if j + 2 < n {
                r[j + 2] -= row[2] * r[j];
            }
            border.iter().enumerate().for_each(|(k, b)| r[n + k] -= b * r[j]);
        }
        Self::solve_last(&self.last.transpose(), &mut r[n - 1..]);
        for (j, (factor, below, exchange)) in self.steps.iter().enumerate().rev() {
            r[j] -= factor * r[j + 1];
            r[j] -= below.iter().zip(&r[n..]).map(|(factor, x)| factor * x).sum::<f64>();
            if *exchange {
                r.swap(j, j + 1);
            }
        }
    }
    fn determinant_sign(&self) -> f64 {
        let exchanges = self.steps.iter().map(|step| if step.2 { -1.0 } else { 1.0 });
        let pivots = self.rows.iter().map(|(row, _)| row[0].signum());
        exchanges.chain(pivots).product::<f64>() * self.last.determinant().signum()
    }
}

/// Central differences of `u'' + λ eᵘ = 0`, `u(0) = u(1) = 0`, in units of `1/h²`.
struct Tridiagonal {
    names: Names,
    diagonal: Vec<f64>,
}

impl Tridiagonal {
    fn new(n: usize) -> Self {
        Tridiagonal { names: Names::new([("u", n)], ["lambda"]), diagonal: vec![0.0; n] }
    }
    /// The nonlinear part at a point of the grid.
    fn reaction<T: Scalar>(&self, u: T, lambda: T) -> T {
        lambda * u.exp() * (1.0 / (self.diagonal.len() as f64 + 1.0).powi(2))
    }
    /// The linear part, into `r`.
    fn diffusion(&self, u: &[f64], r: &mut [f64]) {
        let n = self.diagonal.len();
        let at = |i: usize| if (1..=n).contains(&i) { u[i - 1] } else { 0.0 };
        r.iter_mut().enumerate().for_each(|(i, r)| *r = at(i) - 2.0 * at(i + 1) + at(i + 2));
    }
}

impl System for Tridiagonal {
    fn names(&self) -> &Names {
        &self.names
    }
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        let n = r.len();
        self.diffusion(x, r);
        r.iter_mut().zip(x).for_each(|(r, u)| *r += self.reaction(*u, x[n]));
        Ok(())
    }
    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        let n = self.diagonal.len();
        for i in 0..n {
            self.diagonal[i] = self.reaction(Dual64::new(x[i], 1.0), x[n].into()).eps - 2.0;
        }
        Ok(())
    }
    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        if form != Form::Jacobian {
            return Err(Failure::Unsupported("a form that this system does not have".into()));
        }
        let factors = into.reuse(|_: &BorderedBand| true, BorderedBand::default);
        factors.factor(&self.diagonal, border)
    }
    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let n = out.len();
        match *directions {
            [d] => {
                self.diffusion(d, out);
                for i in 0..n {
                    let [u, lambda] = [i, n].map(|k| Dual64::new(x[k], d[k]));
                    out[i] += self.reaction(u, lambda).eps;
                }
            }
            [d, e] => {
                for i in 0..n {
                    let [u, lambda] = [i, n].map(|k| HyperDual64::new(x[k], d[k], e[k], 0.0));
                    out[i] = self.reaction(u, lambda).eps1eps2;
                }
            }
            _ => return Err(Failure::Unsupported("derivatives of this order".into())),
        }
        Ok(())
    }
    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        _released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let Functional::First(w, v) = of else {
            return Err(Failure::Unsupported("gradients of this functional".into()));
        };
        let n = self.diagonal.len();
        out[n] = 0.0;
        for i in 0..n {
            let mixed = |du: f64, dl: f64| {
                let u = HyperDual64::new(x[i], v[i], du, 0.0);
                self.reaction(u, HyperDual64::new(x[n], v[n], dl, 0.0)).eps1eps2
            };
            out[i] = w[i] * mixed(1.0, 0.0);
            out[n] += w[i] * mixed(0.0, 1.0);
        }
        Ok(())
    }
    fn dynamics(&self) -> Dynamics {
        Dynamics::None
    }
    fn spectrum(&mut self, _: &[f64], _: SpectrumRequest) -> Result<Option<Spectrum>, Failure> {
        Ok(None)
    }
    fn monitors(&mut self, _: &[f64], _: usize, _: &mut [f64]) -> Result<(), Failure> {
        Ok(())
    }
}

fn fold(system: &mut dyn System) -> f64 {
    let branch = Continuation::new(system).along("lambda", 0.0..=10.0).trace().unwrap();
    first(&branch, Kind::LP).parameters[0]
}

/// The same fold as by dense matrices, and at n = 1600 that of the differential equation,
/// `8θ²/cosh²θ` with `θ tanh θ = 1`, to the differences' error of `O(h²)`.
#[test]
fn a_tridiagonal_system_finds_the_fold_of_bratus_problem() {
    close(fold(&mut Tridiagonal::new(60)), fold(&mut Dense::new(Bratu(60))), 1e-12);
    let [coarse, fine] = [799, 1599].map(|n| fold(&mut Tridiagonal::new(n)));
    let exact = 3.513_830_719_125_16;
    close((4.0 * fine - coarse) / 3.0, exact, 1e-9);
    assert!((fine - exact).abs() < 0.26 * (coarse - exact).abs());
}
