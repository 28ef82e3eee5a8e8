//! Work-precision diagrams of the fold of orbits with one impact per period. The state and the
//! voltage at the fold satisfy `f(x, V) − x = 0` and `det(∂f/∂x − I) = 0`; Newton's method solves
//! these equations, with derivatives of first and second order from dual numbers or from finite
//! differences.
//!
//! At the fold, the voltage is stationary along the curve of orbits. Therefore the error of the
//! voltage at the fold is of the order of the square of the error of the state, and the digits of
//! the determinant that finite differences lose affect mainly the state.

use super::differences::{By, Differences, IMPACTING};
use super::orbit;
use super::period::{Period, parameters};
use super::plan::{Answer, Method, Plan};
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use std::ops::Range;
use tangency::core::scalar::{DualChunk, Scalar};

/// The displacement, the velocity and the voltage at the beginning of a period, close enough to the
/// fold for Newton's method to converge.
const NEAR: [f64; 3] = [0.033, -0.476, 0.1765];

/// Returns the period map at a voltage, in the scalar type of the voltage.
fn period<T: Scalar>(voltage: T, tolerance: f64) -> Period<T> {
    let mut p = parameters(0.0).map(T::constant);
    p[0] = voltage;
    Period { tolerance, ..IMPACTING }.at(p)
}

/// Evaluates the defining system of the fold from a state, its image under the period map, and the
/// Jacobian matrix of the map.
fn defining<T: Scalar>([x, u]: [T; 2], image: Vector2<T>, by_state: Matrix2<T>) -> [T; 3] {
    let [[a, b], [c, d]] = by_state.transpose().data.0;
    [image[0] - x, image[1] - u, (a - 1.0) * (d - 1.0) - b * c]
}

/// Evaluates the defining system of the fold and its derivative with respect to state and voltage,
/// by nested dual numbers.
fn by_duals(z: Vector3<f64>, tolerance: f64) -> Result<(Vector3<f64>, Matrix3<f64>), String> {
    let [x, u, voltage] = [0, 1, 2].map(|k| DualChunk::<f64, 8>::seeded(z[k], k));
    let (x, period) = ([x, u], period(voltage, tolerance));
    let equations = Vector3::from(defining(x, period.image(x)?, period.derivative(x)?));
    let derivatives = Matrix3::from_fn(|i, k| equations[i].eps[k]);
    Ok((equations.map(|equation| equation.re), derivatives))
}

/// Evaluates the defining system of the fold and its derivative by nested finite differences.
fn by_differences(
    rule: Differences,
    z: Vector3<f64>,
    tolerance: f64,
) -> Result<(Vector3<f64>, Matrix3<f64>), String> {
    let equations = |z: Vector3<f64>| {
        let (x, period) = ([z[0], z[1]], period(z[2], tolerance));
        let by_state = rule.matrix(|x| period.image(x.into()), x.into())?;
        Ok(Vector3::from(defining(x, period.image(x)?, by_state)))
    };
    Ok((equations(z)?, rule.matrix(equations, z)?))
}

/// Computes the state and the voltage at the fold by Newton's method.
fn fold(by: By, tolerance: f64) -> Result<[f64; 3], String> {
    let (mut z, mut before) = (Vector3::from(NEAR), f64::INFINITY);
    for _ in 0..30 {
        let (miss, matrix) = match by {
            By::Duals => by_duals(z, tolerance)?,
            By::Differences(rule) => by_differences(rule, z, tolerance)?,
        };
        let step = matrix.lu().solve(&miss).ok_or("the fold is degenerate")?;
        z -= step;
        // Small steps that no longer shrink are due to errors of the equations.
        let size = step.norm();
        if size < 1e-4 && size > 0.5 * before || size == 0.0 {
            return Ok(z.into());
        }
        before = size;
    }
    Err("Newton's method does not converge".into())
}

/// Plans two diagrams: for the voltage at the fold, and for the state at the fold.
pub(super) fn plans() -> [Plan; 2] {
    let plan = |title: &str, part: Range<usize>| {
        let of = part.clone();
        let exact = Method::new("dual numbers", "at a tolerance of 1e-15", move || {
            Ok(Answer { numbers: fold(By::Duals, 1e-15)?[of.clone()].to_vec(), work: 0.0 })
        });
        let method = |by: By| {
            let of = part.clone();
            by.method(move |by| Ok(fold(by, IMPACTING.tolerance)?[of.clone()].to_vec()))
        };
        Plan::of(title, exact)
            .counting("evaluations of the field")
            .with(By::all(2..=7).into_iter().map(method))
            .recommending("dual numbers", "")
    };
    let voltage = plan("Voltage at a fold", 2..3).with([orbit::fold_on_a_branch()]);
    [voltage, plan("State at a fold", 0..2)]
}
