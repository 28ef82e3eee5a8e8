//! Points of codimension two on curves of folds: cusps and Bogdanov–Takens points.
//!
//! Both are zeros of a function of the null vectors, `a = wᵀ F_zz[v, v]` and `c = wᵀ v`. The null
//! vectors depend on `x`; differentiating the bordered systems that define them,
//! `M (δv, δg) = −(δF_z v, 0)` and `Mᵀ (δw, δg) = −(δF_zᵀ w, 0)`, and transposing gives
//!
//! ```text
//!     qᵀ δv = −ξᵀ δF_z v   with  Mᵀ (ξ, ·) = (q, 0)
//!     hᵀ δw = −wᵀ δF_z η   with  M (η, ·) = (h, 0)
//! ```
//!
//! so that their gradients, too, are gradients of bilinear forms in `F_z`.

use super::dot;
use super::null::NullVectors;
use crate::core::condition::{At, Condition, EvaluationError};
use crate::core::kind::Kind;

/// A cusp: on a curve of folds, `a = wᵀ F_zz[v, v] = 0`.
#[derive(Default)]
pub struct Cusp {
    sensitivity: Sensitivity,
}

/// A Bogdanov–Takens point: on a curve of folds, `wᵀ v = 0`, a double eigenvalue zero.
#[derive(Default)]
pub struct BogdanovTakens {
    sensitivity: Sensitivity,
}

/// Null vectors, and how functions of them change with `x`.
#[derive(Default)]
struct Sensitivity {
    null: NullVectors,
    second: Vec<f64>,
    form: Vec<f64>,
    adjoint: Vec<f64>,
    direct: Vec<f64>,
    extended: Vec<f64>,
}

impl Sensitivity {
    fn start(&mut self, at: &mut At) -> Result<(), EvaluationError> {
        let n = at.system.names().dimension();
        self.second.resize(n, 0.0);
        self.form = vec![0.0; at.x.len()];
        self.extended = vec![0.0; at.x.len()];
        self.adjoint = vec![0.0; n + 1];
        self.direct = vec![0.0; n + 1];
        self.null.start(at)
    }

    /// Subtracts `∇(ξᵀ F_z v) + ∇(wᵀ F_z η)` from `row`, with `ξ` from `adjoint`, `η` from `direct`.
    fn subtract(&mut self, at: &mut At, row: &mut [f64]) -> Result<(), EvaluationError> {
        let n = self.null.left.len();
        self.null.update(at)?;
        self.null.solve_transposed_with(at.system, &mut self.adjoint);
        self.null.solve_with(at.system, &mut self.direct);
        let (x, released) = (at.x, at.released);
        at.system.gradient(x, &self.adjoint[..n], &self.null.right, released, &mut self.form);
        row.iter_mut().zip(&self.form).for_each(|(row, form)| *row -= form);
        self.extended[..n].copy_from_slice(&self.direct[..n]);
        at.system.gradient(x, &self.null.left, &self.extended, released, &mut self.form);
        row.iter_mut().zip(&self.form).for_each(|(row, form)| *row -= form);
        Ok(())
    }
}

impl Condition for Cusp {
    fn kind(&self) -> Kind {
        Kind::CP
    }

    fn assembles(&self) -> bool {
        true
    }

    fn start(&mut self, mut at: At, _y: &mut [f64]) -> Result<(), EvaluationError> {
        self.sensitivity.start(&mut at)
    }

    fn values(
        &mut self,
        mut at: At,
        _y: &[f64],
        values: &mut [f64],
    ) -> Result<(), EvaluationError> {
        let Sensitivity { null, second, .. } = &mut self.sensitivity;
        null.update(&mut at)?;
        at.system.second_derivative(at.x, &null.right, &null.right, second);
        values[0] = dot(&null.left, second);
        Ok(())
    }

    fn gradients(
        &mut self,
        mut at: At,
        _y: &[f64],
        rows: &mut [f64],
        _own: &mut [f64],
    ) -> Result<(), EvaluationError> {
        let s = &mut self.sensitivity;
        let n = s.null.left.len();
        at.system.second_gradient(at.x, &s.null.left, &s.null.right, at.released, rows);
        at.system.gradient(at.x, &s.null.left, &s.null.right, at.released, &mut s.form);
        s.adjoint[n] = 0.0;
        s.adjoint[..n].iter_mut().zip(&s.form).for_each(|(q, form)| *q = 2.0 * form);
        s.direct[n] = 0.0;
        s.direct[..n].copy_from_slice(&s.second);
        s.subtract(&mut at, rows)
    }

    fn adapt(&mut self) {
        self.sensitivity.null.adapt();
    }
}

impl Condition for BogdanovTakens {
    fn kind(&self) -> Kind {
        Kind::BT
    }

    fn assembles(&self) -> bool {
        true
    }

    fn start(&mut self, mut at: At, _y: &mut [f64]) -> Result<(), EvaluationError> {
        self.sensitivity.start(&mut at)
    }

    fn values(
        &mut self,
        mut at: At,
        _y: &[f64],
        values: &mut [f64],
    ) -> Result<(), EvaluationError> {
        let null = &mut self.sensitivity.null;
        null.update(&mut at)?;
        values[0] = dot(&null.left, &null.right);
        Ok(())
    }

    fn gradients(
        &mut self,
        mut at: At,
        _y: &[f64],
        rows: &mut [f64],
        _own: &mut [f64],
    ) -> Result<(), EvaluationError> {
        let s = &mut self.sensitivity;
        let n = s.null.left.len();
        rows.fill(0.0);
        s.adjoint[n] = 0.0;
        s.adjoint[..n].copy_from_slice(&s.null.left);
        s.direct[n] = 0.0;
        s.direct[..n].copy_from_slice(&s.null.right[..n]);
        s.subtract(&mut at, rows)
    }

    fn adapt(&mut self) {
        self.sensitivity.null.adapt();
    }
}
