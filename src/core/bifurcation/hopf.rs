//! Hopf points of equilibria.

use super::generic_vector;
use crate::core::condition::{At, Condition, EvaluationError};
use crate::core::kind::Kind;
use crate::core::linear::BorderedLu;
use crate::core::zero::{Border, Dynamics};

/// A Hopf point: `F_z` has the eigenvalue `iω`, `ω > 0` an unknown of the condition's own.
///
/// The complex matrix `F_z − iω` is bordered as at a fold; the multiplier `g = −w*(F_z − iω)v` is
/// complex, so there are two equations, `Re g = Im g = 0`, with `δg = −w* δF_z v + i w*v δω`.
/// In real arithmetic the pair `(Re v, Im v)` solves a system of `2n + 2` equations.
#[derive(Default)]
pub struct Hopf {
    jacobian: Vec<f64>,
    matrix: Vec<f64>,
    lu: BorderedLu,
    /// `b` and `c` as (real, imaginary) vectors one after the other.
    column: Vec<f64>,
    row: Vec<f64>,
    border_columns: Vec<f64>,
    border_rows: Vec<f64>,
    right: Vec<f64>,
    left: Vec<f64>,
    form: Vec<f64>,
    extended: [Vec<f64>; 2],
    g: [f64; 2],
}

impl Hopf {
    fn solve(&mut self, at: &mut At, omega: f64) -> Result<(), EvaluationError> {
        let n = at.system.names().dimension();
        at.system.assemble(at.x)?;
        at.system.jacobian(&mut self.jacobian);
        let size = 2 * n;
        self.matrix.fill(0.0);
        for j in 0..n {
            for i in 0..n {
                let entry = self.jacobian[j * n + i];
                self.matrix[j * size + i] = entry;
                self.matrix[(n + j) * size + n + i] = entry;
            }
            self.matrix[(n + j) * size + j] = omega;
            self.matrix[j * size + n + j] = -omega;
        }
        // Columns b·1 and b·i; rows of c*·v, real and imaginary part.
        let (b, c) = (&self.column, &self.row);
        for i in 0..n {
            self.border_columns[i] = b[i];
            self.border_columns[n + i] = b[n + i];
            self.border_columns[size + i] = -b[n + i];
            self.border_columns[size + n + i] = b[i];
            self.border_rows[i] = c[i];
            self.border_rows[n + i] = c[n + i];
            self.border_rows[size + i] = -c[n + i];
            self.border_rows[size + n + i] = c[i];
        }
        self.lu.factor(
            &self.matrix,
            Border {
                width: 2,
                columns: &self.border_columns,
                rows: &self.border_rows,
                corner: &[0.0; 4],
            },
        )?;
        for vector in [&mut self.right, &mut self.left] {
            vector.fill(0.0);
            vector[size] = 1.0;
        }
        self.lu.solve(&mut self.right);
        self.lu.solve_transposed(&mut self.left);
        self.g = [self.right[size], self.right[size + 1]];
        Ok(())
    }
}

impl Condition for Hopf {
    fn kind(&self) -> Kind {
        Kind::HB
    }

    fn unknowns(&self) -> usize {
        1
    }

    fn start(&mut self, mut at: At, y: &mut [f64]) -> Result<(), EvaluationError> {
        let n = at.system.names().dimension();
        at.system.assemble(at.x)?;
        y[0] = crossing_frequency(&mut at)?;
        self.jacobian.resize(n * n, 0.0);
        self.matrix.resize(4 * n * n, 0.0);
        self.column = generic_vector(2 * n, 1);
        self.row = generic_vector(2 * n, 2);
        self.border_columns.resize(4 * n, 0.0);
        self.border_rows.resize(4 * n, 0.0);
        self.right.resize(2 * n + 2, 0.0);
        self.left.resize(2 * n + 2, 0.0);
        self.form.resize(at.x.len(), 0.0);
        self.extended = [vec![0.0; at.x.len()], vec![0.0; at.x.len()]];
        for _ in 0..3 {
            self.solve(&mut at, y[0])?;
            self.adapt();
        }
        Ok(())
    }

    fn values(&mut self, mut at: At, y: &[f64], values: &mut [f64]) -> Result<(), EvaluationError> {
        self.solve(&mut at, y[0])?;
        values.copy_from_slice(&self.g);
        Ok(())
    }

    fn gradients(
        &mut self,
        at: At,
        _y: &[f64],
        rows: &mut [f64],
        own: &mut [f64],
    ) -> Result<(), EvaluationError> {
        let (n, length) = (at.system.names().dimension(), at.x.len());
        self.extended[0][..n].copy_from_slice(&self.right[..n]);
        self.extended[1][..n].copy_from_slice(&self.right[n..2 * n]);
        let (left_real, left_imaginary) = self.left[..2 * n].split_at(n);
        rows.fill(0.0);
        // w* δF v = (wᵣ − i wᵢ)ᵀ δF (vᵣ + i vᵢ); the gradient of g is its negative.
        for (w, v, row, sign) in [
            (left_real, 0, 0, -1.0),
            (left_imaginary, 1, 0, -1.0),
            (left_real, 1, length, -1.0),
            (left_imaginary, 0, length, 1.0),
        ] {
            at.system.gradient(at.x, w, &self.extended[v], at.released, &mut self.form);
            rows[row..row + length].iter_mut().zip(&self.form).for_each(|(r, f)| *r += sign * f);
        }
        let (v, w) = (&self.right, &self.left);
        let product_real: f64 = (0..2 * n).map(|i| w[i] * v[i]).sum();
        let product_imaginary: f64 = (0..n).map(|i| w[i] * v[n + i] - w[n + i] * v[i]).sum();
        own[0] = -product_imaginary;
        own[1] = product_real;
        Ok(())
    }

    fn adapt(&mut self) {
        let n = self.column.len();
        self.column.copy_from_slice(&self.left[..n]);
        self.row.copy_from_slice(&self.right[..n]);
        super::normalise(&mut self.column);
        super::normalise(&mut self.row);
    }
}

/// The imaginary part of the complex pair nearest to the imaginary axis.
fn crossing_frequency(at: &mut At) -> Result<f64, EvaluationError> {
    let spectrum = at.system.spectrum(at.x).unwrap_or_default();
    let pairs = spectrum.into_iter().filter(|(_, imaginary)| *imaginary > 0.0);
    match pairs.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())) {
        Some((_, omega)) => Ok(omega),
        None => Err(EvaluationError::NotApplicable(
            "no complex pair of eigenvalues is near the imaginary axis: not a Hopf point (a neutral \
             saddle, perhaps)"
                .into(),
        )),
    }
}

/// The sign of `Π_{i<j} (λᵢ + λⱼ)`, which changes where two eigenvalues `±iω` (or `±λ`, a neutral
/// saddle) cross; 0 where no motion is meant or a potential forbids oscillation.
pub fn hopf_test(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> f64 {
    if dynamics != Dynamics::Flow {
        return 0.0;
    }
    let mut sign = 1.0_f64;
    let real = || spectrum.iter().filter(|l| l.1 == 0.0).map(|l| l.0);
    for (i, a) in real().enumerate() {
        for b in real().skip(i + 1) {
            sign *= (a + b).signum();
        }
    }
    spectrum.iter().filter(|l| l.1 > 0.0).fold(sign, |sign, l| sign * l.0.signum())
}
