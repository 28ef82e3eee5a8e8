//! Derivatives by dual numbers, and derivatives by finite differences for comparison.

use super::period::{Period, parameters};
use super::plan::{Answer, Method};
use nalgebra::{Matrix2, SMatrix, SVector};
use std::iter;
use std::ops::RangeInclusive;
use tangency::core::ode::work;

/// A rule of finite differences, with its step size.
#[derive(Clone, Copy)]
pub(super) enum Differences {
    OneSided(f64),
    Central(f64),
}

impl Differences {
    /// Computes the Jacobian matrix of a function with respect to all its arguments.
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

/// The period map of Mita's actuator on the branch of orbits with one impact per period.
pub(super) const IMPACTING: Period = Period { impacts: true, p: parameters(0.4), tolerance: 1e-12 };

/// The method by which derivatives are computed.
#[derive(Clone, Copy)]
pub(super) enum By {
    Duals,
    Differences(Differences),
}

impl By {
    /// Returns all methods of differentiation: dual numbers, and finite differences with several
    /// step sizes.
    pub fn all(exponents: RangeInclusive<i32>) -> Vec<By> {
        let steps = || exponents.clone().map(|k| 10.0_f64.powi(-k));
        let one_sided = steps().map(Differences::OneSided);
        let differences = one_sided.chain(steps().map(Differences::Central));
        iter::once(By::Duals).chain(differences.map(By::Differences)).collect()
    }

    /// Returns a method that passes this way of differentiation to `find`, which computes the
    /// answer, and that counts the evaluations of the vector field.
    pub fn method(self, find: impl Fn(By) -> Result<Vec<f64>, String> + 'static) -> Method {
        let (line, setting) = match self {
            By::Duals => ("dual numbers", String::new()),
            By::Differences(Differences::OneSided(step)) => {
                ("one-sided differences", format!("step {step:.0e}"))
            }
            By::Differences(Differences::Central(step)) => {
                ("central differences", format!("step {step:.0e}"))
            }
        };
        Method::new(line, setting, move || {
            let before = work().evaluations;
            let numbers = find(self)?;
            Ok(Answer { numbers, work: (work().evaluations - before) as f64 })
        })
    }

    /// Computes the Jacobian matrix of the period map with respect to the state.
    pub fn matrix(self, x: [f64; 2]) -> Result<Matrix2<f64>, String> {
        match self {
            By::Duals => IMPACTING.derivative(x),
            By::Differences(rule) => rule.matrix(|x| IMPACTING.image(x.into()), x.into()),
        }
    }
}
