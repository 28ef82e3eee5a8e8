//! Problems with known answers, shared by the tests of the core.

pub mod counted;
mod measured;
mod orders;
mod planar;
pub mod random;
pub mod settling;

pub use measured::{Bratu, Oxidation};
pub use orders::falls_with_order;
pub use planar::{BogdanovTakens, Brusselator};
use std::f64::consts::TAU;
use tangency::core::continuation::{
    Branch, Extended, Newton, NewtonError, SpecialPoint, Tolerances,
};
use tangency::core::linalg::SpectrumRequest;
use tangency::core::problem::{Dynamics, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Kind, System};
use tangency::zero_problem;

/// All eigenvalues.
pub const ALL: SpectrumRequest = SpectrumRequest { count: usize::MAX };

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
    let tolerances = Tolerances { tolerance: 1e-13, max_iterations: 20 };
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

zero_problem! {
    /// `μ + x − x³/3 = 0`: folds `μ = ±2/3` at `x = ∓1`.
    pub struct CuspSlice [x; mu] {
        0 = mu + x - x.powi(3) / 3.0;
        monitor square = x * x;
    }
}

zero_problem! {
    /// The cusp's normal form `x³ − a x − b = 0`: folds `4a³ = 27b²`, a cusp at 0.
    pub struct CuspForm [x; b, a] {
        0 = a * x + b - x.powi(3);
    }
}

zero_problem! {
    /// `p² + x² = radius²`: closed.
    pub struct Circle { pub radius: f64 } [x; p] {
        0 = x * x + p * p - radius * radius;
        fn dynamics(&self) -> Dynamics {
            Dynamics::None
        }
    }
}

zero_problem! {
    /// AUTO's demo pp2.
    pub struct PredatorPrey [x, y; p] {
        0 = x * 3.0 * (T::one() - x) - x * y - p * (T::one() - (x * -5.0).exp());
        0 = x * y * 3.0 - y;
    }
}

/// `u'' + 10 a (eᵘ − 1 − b u²/2) = 0`: branch points on `u = 0` at `a = (kπ)²/10` (continuum).
pub struct TrivialBranch(pub usize);

impl ZeroProblem for TrivialBranch {
    fn names(&self) -> Names {
        Names::new([("u", self.0)], ["a", "b"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let n = self.0;
        let inverse = ((n + 1) * (n + 1)) as f64;
        let at = |i: usize| if i == 0 || i > n { T::zero() } else { u[i - 1] };
        for i in 1..=n {
            let source = at(i).exp() - 1.0 - p[1] * at(i) * at(i) * 0.5;
            r[i - 1] = (at(i - 1) - at(i) * 2.0 + at(i + 1)) * inverse + p[0] * source * 10.0;
        }
    }
}

zero_problem! {
    /// Two coupled columns under one load: a pitchfork from `x = y = 0`, at `p = 1 − c` and `1 + c`.
    pub struct Columns [x, y; p, c] {
        0 = (p - 1.0) * x + c * y - x.powi(3);
        0 = (p - 1.0) * y + c * x - y.powi(3);
    }
}
