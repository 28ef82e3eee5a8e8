//! Problems with known answers, and what tests do with them.

pub mod counted;
pub mod diffusive_brusselator;
mod orders;
mod problems;
pub mod random;
pub mod settling;

pub use orders::falls_with_order;
pub use problems::*;
use std::f64::consts::TAU;
use tangency::core::continuation::{
    Branch, Extended, Newton, NewtonError, SpecialPoint, Tolerances,
};
use tangency::core::linalg::SpectrumRequest;
use tangency::core::system::{Kind, System};

/// All eigenvalues.
pub const ALL: SpectrumRequest = SpectrumRequest::new(usize::MAX);

/// Asserts that two numbers agree to an absolute tolerance.
#[track_caller]
pub fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "found {found:.17e}, expected {expected:.17e}, {:.1e} apart where {tolerance:.1e} is allowed",
        (found - expected).abs()
    );
}

/// Asserts that two vectors agree, relative to what is expected where that exceeds 1.
#[track_caller]
pub fn agree(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        close(*found, *expected, tolerance * expected.abs().max(1.0));
    }
}

/// The scalar product.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Central differences of order four of a vector function along a direction, with steps of `h`.
pub fn difference(x: &[f64], d: &[f64], h: f64, mut f: impl FnMut(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let mut at = |k: f64| f(&x.iter().zip(d).map(|(x, d)| x + k * h * d).collect::<Vec<_>>());
    let (a, b, c, e) = (at(-2.0), at(-1.0), at(1.0), at(2.0));
    (0..a.len()).map(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - e[i]) / (12.0 * h)).collect()
}

/// Solves with all parameters fixed: `x = (z, p)`.
pub fn solved(system: &mut dyn System, z: &[f64], p: &[f64]) -> Result<Vec<f64>, NewtonError> {
    let x = [z, p].concat();
    let mut equations = Extended::new(system, &x, vec![]);
    let tolerances = Tolerances::new(1e-13, 20);
    let weights = vec![1.0 / z.len() as f64; z.len()];
    let mut unknowns = z.to_vec();
    Newton::default().solve(&mut equations, &mut unknowns, None, &weights, tolerances)?;
    unknowns.extend_from_slice(p);
    Ok(unknowns)
}

/// `(a cos 2πτ, b sin 2πτ, 0, …)`: a guess, or a solution, on the one segment of a periodic orbit.
pub fn ellipse(a: f64, b: f64) -> impl Fn(usize, f64, &mut [f64]) + Copy {
    move |_, tau, x| {
        x.fill(0.0);
        (x[0], x[1]) = (a * (TAU * tau).cos(), b * (TAU * tau).sin());
    }
}

/// The values of a column at all special points of a kind, ascending.
pub fn values(branch: &Branch, kind: Kind, name: &str) -> Vec<f64> {
    let column = branch.column(name).unwrap();
    let mut values: Vec<f64> =
        branch.of_kind(kind).map(|point| point.value(column).unwrap()).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The first special point of a kind.
#[track_caller]
pub fn first(branch: &Branch, kind: Kind) -> &SpecialPoint {
    branch.of_kind(kind).next().unwrap_or_else(|| panic!("no {kind} on {}", branch.name))
}

/// The special point of a kind, of which there is one.
#[track_caller]
pub fn only(branch: &Branch, kind: Kind) -> &SpecialPoint {
    let mut all = branch.of_kind(kind);
    let first = all.next().unwrap_or_else(|| panic!("no {kind} on {}", branch.name));
    assert!(all.next().is_none(), "several {kind} on {}", branch.name);
    first
}

/// A coefficient of a special point, whose error is honest: the difference from the value expected
/// is at most the error, and that is at most `most` of the value.
#[track_caller]
pub fn coefficient(point: &SpecialPoint, name: &str, expected: f64, most: f64) {
    let number = point.number(name).unwrap_or_else(|| panic!("{name}: {:?}", point.numbers));
    let (found, error) = (number.value, number.error);
    // References have 12 digits.
    let allowed = error + 5e-12 * expected.abs();
    assert!(
        (found - expected).abs() <= allowed,
        "{name} = {found:.13e} ± {error:.1e}, expected {expected:.13e}"
    );
    let size = expected.abs();
    assert!(
        error <= most * size,
        "{name} = {found:.13e} ± {error:.1e}: no {most:.0e} of the value"
    );
}
