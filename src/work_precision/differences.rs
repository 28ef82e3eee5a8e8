//! Finite differences, for comparison only.

use nalgebra::{SMatrix, SVector};

/// A rule with its step.
#[derive(Clone, Copy)]
pub(super) enum Differences {
    OneSided(f64),
    Central(f64),
}

impl Differences {
    /// The derivative of a function by all its arguments.
    pub fn matrix<const N: usize, const M: usize>(
        self,
        of: impl Fn(SVector<f64, N>) -> Result<SVector<f64, M>, String>,
        x: SVector<f64, N>,
    ) -> Result<SMatrix<f64, M, N>, String> {
        let mut matrix = SMatrix::<f64, M, N>::zeros();
        let here = match self {
            Differences::OneSided(_) => of(x)?,
            Differences::Central(_) => SVector::zeros(),
        };
        for (k, mut column) in matrix.column_iter_mut().enumerate() {
            let mut unit = SVector::zeros();
            unit[k] = 1.0;
            column.copy_from(&match self {
                Differences::OneSided(step) => (of(x + unit * step)? - here) / step,
                Differences::Central(step) => {
                    (of(x + unit * step)? - of(x - unit * step)?) / (2.0 * step)
                }
            });
        }
        Ok(matrix)
    }
}
