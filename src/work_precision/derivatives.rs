//! Forward dual numbers against finite differences: the derivative of a period with an impact, its multipliers, and a
//! fold.

use super::differences::Differences;
use super::fold;
use super::period::{Period, parameters};
use super::plan::{Answer, Method, Plan, WorkPrecisionError};
use crate::core::flow::work;
use nalgebra::Matrix2;
use std::iter;
use std::ops::RangeInclusive;

/// On the branch with an impact a period.
pub(super) const IMPACTING: Period = Period { impacts: true, p: parameters(0.4), tolerance: 1e-12 };

/// How a derivative is found.
#[derive(Clone, Copy)]
pub(super) enum By {
    Duals,
    Differences(Differences),
}

impl By {
    /// Dual numbers, and differences of several steps.
    pub fn all(exponents: RangeInclusive<i32>) -> Vec<By> {
        let steps = || exponents.clone().map(|k| 10.0_f64.powi(-k));
        let one_sided = steps().map(Differences::OneSided);
        let differences = one_sided.chain(steps().map(Differences::Central));
        iter::once(By::Duals).chain(differences.map(By::Differences)).collect()
    }

    /// The method that finds numbers in this way; what it counts are evaluations of the field.
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

    /// The derivative of the image by the state.
    fn matrix(self, x: [f64; 2]) -> Result<Matrix2<f64>, String> {
        match self {
            By::Duals => IMPACTING.derivative(x),
            By::Differences(rule) => rule.matrix(|x| IMPACTING.image(x.into()), x.into()),
        }
    }
}

/// The sizes of both multipliers, the larger one first.
fn multipliers(matrix: &Matrix2<f64>) -> Vec<f64> {
    let mut sizes: Vec<f64> = matrix.complex_eigenvalues().iter().map(|mu| mu.norm()).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    sizes
}

/// The matrix, its multipliers, and a fold.
pub(super) fn plans() -> Result<Vec<Plan>, WorkPrecisionError> {
    let x = IMPACTING.settled().map_err(WorkPrecisionError::Statement)?;
    let plan = |title: &str, numbers: fn(&Matrix2<f64>) -> Vec<f64>| {
        let exact = Method::new("dual numbers", "at a tolerance of 1e-15", move || {
            let matrix = Period { tolerance: 1e-15, ..IMPACTING }.derivative(x)?;
            Ok(Answer { numbers: numbers(&matrix), work: 0.0 })
        });
        let find = move |by: By| Ok(numbers(&by.matrix(x)?));
        Plan::of(title, exact)
            .counting("evaluations of the field")
            .with(By::all(2..=11).into_iter().map(|by| by.method(find)))
            .recommending("dual numbers", "")
    };
    let entries = |matrix: &Matrix2<f64>| matrix.iter().copied().collect();
    let [voltage, state] = fold::plans()?;
    Ok(vec![
        plan("Derivatives of a period with an impact", entries),
        plan("Its multipliers", multipliers),
        voltage,
        state,
    ])
}
