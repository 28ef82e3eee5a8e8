//! Work-precision diagrams of forward dual numbers and finite differences: for the Jacobian of a
//! period map with an impact, for its multipliers, and for a fold.

use super::differences::{By, IMPACTING};
use super::fold;
use super::period::Period;
use super::plan::{Answer, Method, Plan};
use nalgebra::Matrix2;

/// Returns the moduli of the two Floquet multipliers, the larger one first.
fn multipliers(matrix: &Matrix2<f64>) -> Vec<f64> {
    let mut sizes: Vec<f64> = matrix.complex_eigenvalues().iter().map(|mu| mu.norm()).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    sizes
}

/// Plans three diagrams: for the Jacobian matrix of the period map, for the Floquet multipliers,
/// and for a fold.
pub(super) fn plans() -> Vec<Plan> {
    let x = IMPACTING.settled();
    let plan = |title: &str, numbers: fn(&Matrix2<f64>) -> Vec<f64>| {
        let (x, at) = (x.clone(), x.clone());
        let exact = Method::new("dual numbers", "at a tolerance of 1e-15", move || {
            let matrix = Period { tolerance: 1e-15, ..IMPACTING }.derivative(at.clone()?)?;
            Ok(Answer { numbers: numbers(&matrix), work: 0.0 })
        });
        let find = move |by: By| Ok(numbers(&by.matrix(x.clone()?)?));
        Plan::of(title, exact)
            .counting("evaluations of the field")
            .with(By::all(2..=11).into_iter().map(|by| by.method(find.clone())))
            .recommending("dual numbers", "")
    };
    let entries = |matrix: &Matrix2<f64>| matrix.iter().copied().collect();
    let [voltage, state] = fold::plans();
    let matrix = plan("Derivatives of a period with an impact", entries);
    vec![matrix, plan("Its multipliers", multipliers), voltage, state]
}
