//! Forward dual numbers against finite differences: the derivative of a period with an impact, and its multipliers.

use super::period::Period;
use super::plan::{Answer, ChartError, Method, Plan};
use crate::core::flow::work;
use nalgebra::{Matrix2, Vector2};

/// On the branch with an impact a period.
const PERIOD: Period = Period { impacts: true, voltage: 0.4, tolerance: 1e-12 };

/// How a derivative is found.
#[derive(Clone, Copy)]
enum By {
    Duals,
    OneSided(f64),
    Central(f64),
}

impl By {
    fn matrix(self, x: [f64; 2]) -> Result<Matrix2<f64>, String> {
        let of = |x: Vector2<f64>| PERIOD.image::<f64>(x.into());
        let (x, unit) = (Vector2::from(x), [Vector2::x(), Vector2::y()]);
        let columns = match self {
            By::Duals => return PERIOD.derivative(x.into()),
            By::OneSided(step) => {
                let here = of(x)?;
                let column = |e: Vector2<f64>| Ok((of(x + e * step)? - here) / step);
                unit.map(column).into_iter().collect::<Result<Vec<_>, String>>()?
            }
            By::Central(step) => {
                let column =
                    |e: Vector2<f64>| Ok((of(x + e * step)? - of(x - e * step)?) / (2.0 * step));
                unit.map(column).into_iter().collect::<Result<Vec<_>, String>>()?
            }
        };
        Ok(Matrix2::from_columns(&columns))
    }

    fn method(self, x: [f64; 2], numbers: fn(&Matrix2<f64>) -> Vec<f64>) -> Method {
        let (line, setting) = match self {
            By::Duals => ("dual numbers", String::new()),
            By::OneSided(step) => ("one-sided differences", format!("step {step:.0e}")),
            By::Central(step) => ("central differences", format!("step {step:.0e}")),
        };
        Method::new(line, setting, move || {
            let before = work().evaluations;
            let numbers = numbers(&self.matrix(x)?);
            Ok(Answer { numbers, work: (work().evaluations - before) as f64 })
        })
    }
}

/// The sizes of both multipliers, the larger one first.
fn multipliers(matrix: &Matrix2<f64>) -> Vec<f64> {
    let mut sizes: Vec<f64> = matrix.complex_eigenvalues().iter().map(|mu| mu.norm()).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    sizes
}

/// The matrix, and its multipliers.
pub(super) fn plans() -> Result<Vec<Plan>, ChartError> {
    let x = PERIOD.settled().map_err(ChartError::Statement)?;
    let steps: Vec<f64> = (2..=11).map(|k| 10.0_f64.powi(-k)).collect();
    let plan = |title: &str, numbers: fn(&Matrix2<f64>) -> Vec<f64>| {
        let exact = Method::new("dual numbers", "at a tolerance of 1e-15", move || {
            Ok(Answer {
                numbers: numbers(&Period { tolerance: 1e-15, ..PERIOD }.derivative(x)?),
                work: 0.0,
            })
        });
        Plan::of(title, exact)
            .counting("evaluations of the field")
            .with([By::Duals.method(x, numbers)])
            .with(steps.iter().map(|step| By::OneSided(*step).method(x, numbers)))
            .with(steps.iter().map(|step| By::Central(*step).method(x, numbers)))
            .recommending("dual numbers", "")
    };
    let entries = |matrix: &Matrix2<f64>| matrix.iter().copied().collect();
    Ok(vec![
        plan("Derivatives of a period with an impact", entries),
        plan("Its multipliers", multipliers),
    ])
}
