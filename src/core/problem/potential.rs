//! Gradients of the directional derivatives of a residual `F`, if `F` is the gradient of a
//! potential.

use super::names::Names;
use crate::core::failure::Failure;

/// Scratch space for [`gradient`](Self::gradient).
#[derive(Default)]
pub(crate) struct PotentialGradient {
    direction: Vec<f64>,
    derivative: Vec<f64>,
}

impl PotentialGradient {
    pub fn new(names: &Names) -> Self {
        PotentialGradient {
            direction: vec![0.0; names.length()],
            derivative: vec![0.0; names.dimension()],
        }
    }

    /// Computes `∇(wᵀD)` with respect to the unknowns and the `released` parameters, where `D` is a
    /// derivative of `F = ∂Π/∂z`, such as `F_x v`. The closure `along(d, out)` computes the
    /// derivative of `D` along `d`. Since mixed derivatives of the potential `Π` commute, the
    /// derivative of `D` along `w` equals the gradient of `wᵀD` with respect to the unknowns.
    ///
    /// # Errors
    /// Any error of the closure `along` is returned unchanged.
    pub fn gradient(
        &mut self,
        w: &[f64],
        released: &[usize],
        mut along: impl FnMut(&[f64], &mut [f64]) -> Result<(), Failure>,
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let n = w.len();
        self.direction.fill(0.0);
        self.direction[..n].copy_from_slice(w);
        along(&self.direction, &mut out[..n])?;
        self.direction[..n].fill(0.0);
        for parameter in released {
            self.direction[n + parameter] = 1.0;
            along(&self.direction, &mut self.derivative)?;
            self.direction[n + parameter] = 0.0;
            out[n + parameter] = self.derivative.iter().zip(w).map(|(d, w)| d * w).sum();
        }
        Ok(())
    }
}
