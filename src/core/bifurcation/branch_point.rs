//! Branch points: where two branches cross, as a condition.

use crate::core::condition::{At, Condition, Failure};
use crate::core::kind::Kind;
use crate::core::linear::Factors;
use crate::core::vector::{dot, generic, normalise};
use crate::core::zero::{Border, Form};

impl Kind {
    /// `BP`: a branch point.
    pub const BP: Kind = Kind::new("BP", "branch point");
}

/// A branch point: `J = [F_z  F_p]` has rank `n − 1`.
///
/// With an unknown `β` of its own that unfolds the problem, `F + β b = 0`, and the bordered matrix
///
/// ```text
///     M = ⎡ J  b ⎤        M ⎡ ζᵢ ⎤ = eₙ₊ᵢ,       Mᵀ (w, g₁, g₂) = e_last
///         ⎣ C  0 ⎦          ⎣ hᵢ ⎦
/// ```
///
/// with two rows `C`, the branch point is `F + β b = 0, g₁ = g₂ = 0`, and `∇gᵢ = −∇ₓ(wᵀ F_x ζᵢ)`:
/// two equations and one unknown of its own, so it can be held along a curve like any other condition
/// (where the branch point persists, as pitchforks of symmetric problems do, `β` stays zero).
#[derive(Default)]
pub struct BranchPoint {
    /// The parameter `p` of the branch, as a position among all parameters.
    parameter: usize,
    /// The unfolding vector `b`.
    unfolding: Vec<f64>,
    /// The two rows of `C`, each `(z, p)`.
    rows: [Vec<f64>; 2],
    /// Null vectors `ζ₁`, `ζ₂` as directions of `x`.
    right: [Vec<f64>; 2],
    left: Vec<f64>,
    g: [f64; 2],
    columns: Vec<f64>,
    border_rows: Vec<f64>,
    /// The unit direction of the parameter.
    direction: Vec<f64>,
    work: Vec<f64>,
    factors: Factors,
}

impl BranchPoint {
    /// A branch point of a branch along which this parameter varies.
    pub fn new(parameter: usize) -> Self {
        BranchPoint { parameter, ..BranchPoint::default() }
    }

    fn solve(&mut self, at: &mut At) -> Result<(), Failure> {
        let n = self.left.len();
        at.system.assemble(at.x)?;
        at.system.derivative(at.x, &[&self.direction], &mut self.columns[..n])?;
        self.columns[n..].copy_from_slice(&self.unfolding);
        for (target, row) in self.border_rows.chunks_exact_mut(n).zip(&self.rows) {
            target.copy_from_slice(&row[..n]);
        }
        let corner = [self.rows[0][n], 0.0, self.rows[1][n], 0.0];
        let (columns, rows) = (&self.columns, &self.border_rows);
        let border = Border { width: 2, columns, rows, corner: &corner };
        at.system.factor(Form::Jacobian, border, &mut self.factors)?;
        for i in 0..2 {
            self.work.fill(0.0);
            self.work[n + i] = 1.0;
            self.factors.solve(&mut self.work);
            self.right[i][..n].copy_from_slice(&self.work[..n]);
            self.right[i][n + self.parameter] = self.work[n];
        }
        self.work.fill(0.0);
        self.work[n + 1] = 1.0;
        self.factors.solve_transposed(&mut self.work);
        self.left.copy_from_slice(&self.work[..n]);
        self.g = [self.work[n], self.work[n + 1]];
        Ok(())
    }
}

impl Condition for BranchPoint {
    fn kind(&self) -> Kind {
        Kind::BP
    }

    fn assembles(&self) -> bool {
        true
    }

    fn unknowns(&self) -> usize {
        1
    }

    fn start(&mut self, mut at: At, y: &mut [f64]) -> Result<(), Failure> {
        let n = at.system.names().dimension();
        if n + self.parameter >= at.x.len() {
            return Err(Failure::Mismatch(format!(
                "the branch point asks for parameter {}, counted from 0, of {}",
                self.parameter,
                at.x.len() - n
            )));
        }
        self.unfolding = generic(n, 1);
        self.rows = [generic(n + 1, 2), generic(n + 1, 3)];
        self.right = [vec![0.0; at.x.len()], vec![0.0; at.x.len()]];
        self.left.resize(n, 0.0);
        self.direction = vec![0.0; at.x.len()];
        self.direction[n + self.parameter] = 1.0;
        self.columns.resize(2 * n, 0.0);
        self.border_rows.resize(2 * n, 0.0);
        self.work.resize(n + 2, 0.0);
        y[0] = 0.0;
        for _ in 0..3 {
            self.solve(&mut at)?;
            self.adapt();
        }
        Ok(())
    }

    fn values(&mut self, mut at: At, _y: &[f64], values: &mut [f64]) -> Result<(), Failure> {
        self.solve(&mut at)?;
        values.copy_from_slice(&self.g);
        Ok(())
    }

    fn gradients(&mut self, at: At, rows: &mut [f64], own: &mut [f64]) -> Result<(), Failure> {
        own.fill(0.0);
        for (row, right) in rows.chunks_exact_mut(at.x.len()).zip(&self.right) {
            at.system.gradient(at.x, (&self.left, right, 1), at.released, row)?;
            row.iter_mut().for_each(|entry| *entry = -*entry);
        }
        Ok(())
    }

    fn unfolding(&self, _j: usize) -> Option<&[f64]> {
        Some(&self.unfolding)
    }

    fn adapt(&mut self) {
        let n = self.left.len();
        self.unfolding.copy_from_slice(&self.left);
        normalise(&mut self.unfolding);
        for (row, right) in self.rows.iter_mut().zip(&self.right) {
            row[..n].copy_from_slice(&right[..n]);
            row[n] = right[n + self.parameter];
            normalise(row);
        }
        // The second row is made orthogonal to the first, lest the border become singular.
        let [first, second] = &mut self.rows;
        let overlap = dot(first, second);
        second.iter_mut().zip(first.iter()).for_each(|(s, f)| *s -= overlap * f);
        normalise(second);
    }
}
