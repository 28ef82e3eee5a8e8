//! The strip: a plate that is infinitely long in one direction, and whose edges are immovable.
//!
//! ```text
//!     w'''' = λ/(1−w)² + 6α₁² (∫₀¹ w'² dx) w''
//! ```
//!
//! The boundary conditions are `w = w'' = 0` (supported) or `w = w' = 0` (clamped) at both ends;
//! the strip is the limit of a long plate. Galerkin's method is applied with functions that are
//! even about the middle: the residual is the gradient of `½∫w''² + (3/2)α₁²(∫w'²)² − λ∫1/(1−w)`.

use super::basis::Basis;
use super::edges::Support;
use super::error::PlateError;
use super::modes::{Eigenproblem, signed_root};
use super::monitors::{self, MONITORS};
use super::parameters::Units;
use super::tensor::{Rule, dot};
use super::vibration::{Lowest, Vibrates, reals};
use super::{domain, profile};
use crate::core::failure::OutOfDomain;
use crate::core::problem::{Dynamics, Names, Profile, ZeroProblem};
use crate::core::scalar::Scalar;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The maximum number of shape functions of a strip.
const MOST: usize = 512;

/// The supports of both ends of a strip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// Simply supported ends: `w = w'' = 0`. The shape functions are `sin kπx` with odd `k`.
    /// Convergence is algebraic because `w''''` does not vanish at the ends: the error of the load
    /// at pull-in falls with the seventh power of the number of functions, and is 6e-9 for 5
    /// functions and 4e-11 for 10 functions.
    #[default]
    Supported,
    /// Clamped ends: `w = w' = 0`. The shape functions are twice integrated Legendre polynomials,
    /// orthogonal in bending; convergence is exponential.
    Clamped,
}

/// The settings of a [`Strip`]. The default settings are 40 shape functions and simply supported
/// ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StripSettings {
    /// The number of shape functions, from 1 to 512.
    pub functions: usize,
    /// The support of both ends of the strip.
    pub ends: Ends,
    /// The number of Gauss points on the half interval; by default the number of shape functions
    /// plus 32.
    pub quadrature_points: Option<usize>,
}

impl Default for StripSettings {
    fn default() -> Self {
        StripSettings { functions: 40, ends: Ends::default(), quadrature_points: None }
    }
}

/// An electrically actuated strip whose deflection is expanded in `N` shape functions.
///
/// This [`ZeroProblem`] has the unknowns `w` (`N` coefficients of the deflection over the gap), the
/// parameters `load` (`λ`, eq. 3.17) and `gap_ratio` (`α₁ = d/h`), and the dimensionless monitors
/// of [all plates](super#monitors). The monitor `frequency` is the lowest frequency among the modes
/// of vibration that are even about the middle of the strip.
///
/// ```
/// use tangency::core::problem::ZeroProblem;
/// use tangency::problems::plate::strip::{Ends, Strip, StripSettings};
/// let strip = Strip::new(StripSettings { functions: 10, ends: Ends::Clamped, ..Default::default() })?;
/// let mut monitors = [0.0; 4];
/// strip.monitors(&[0.0; 10], &[0.0, 1.0], &mut monitors);
/// assert!((monitors[2] - 4.730_040_744_862_704_f64.powi(2)).abs() < 1e-10); // cosh k cos k = 1
/// # Ok::<(), tangency::problems::plate::PlateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Strip {
    functions: Functions,
    /// The weights of the Gauss points on (0, ½), whose sum is 1; in addition to the Gauss points,
    /// the table of shape functions contains the middle of the strip.
    weights: Vec<f64>,
    /// The values of the shape functions at the points of the table, one point after another.
    table: Vec<f64>,
    /// The bending stiffnesses of the shape functions: `∫φ_i''φ_j'' = stiffness_i δ_ij`.
    stiffness: Vec<f64>,
    /// The integrals `∫φ_i'φ_j'` of the slopes of the shape functions, row by row.
    slopes: Vec<f64>,
    mass: DMatrix<f64>,
    flat_frequency: f64,
}

impl Strip {
    /// Creates a strip of a plate, and tabulates its shape functions and their products at the
    /// quadrature points.
    ///
    /// # Errors
    /// [`PlateError`] if the number of shape functions is out of range, or the number of quadrature
    /// points is smaller than the number of functions.
    pub fn new(settings: StripSettings) -> Result<Self, PlateError> {
        let n = settings.functions;
        PlateError::check("functions", n, [1, MOST])?;
        let points = settings.quadrature_points.unwrap_or(n + 32);
        if points < n {
            return Err(PlateError::TooFewPoints { points, needed: n });
        }
        let (functions, stiffness): (_, Vec<f64>) = match settings.ends {
            Ends::Supported => {
                (Functions::Sines(n), (0..n).map(|i| 0.5 * odd_wave(i).powi(4)).collect())
            }
            Ends::Clamped => {
                let bubbles = Basis::transverse([Support::Clamped; 2], true, n);
                (Functions::Bubbles(bubbles), vec![1.0; n])
            }
        };
        // The constant integrals need a rule that is exact for products of functions of wave number
        // or degree up to 2N + 2, for any rule of the load.
        let gram = |pick: fn(&[f64; 2]) -> f64| -> DMatrix<f64> {
            let Rule { nodes, weights } = Rule::halves(2 * n + 16, true);
            nodes.iter().zip(weights).fold(DMatrix::zeros(n, n), |sum, (node, weight)| {
                let values = DVector::from_iterator(n, functions.at(0.5 * node).iter().map(pick));
                sum + &values * values.transpose() * weight
            })
        };
        let (mass, slopes) = (gram(|[value, _]| *value), gram(|[_, slope]| *slope));
        let Rule { nodes, weights } = Rule::halves(points, true);
        let abscissae = nodes.iter().map(|node| 0.5 * node).chain([0.5]);
        let flat = DMatrix::from_diagonal(&DVector::from_row_slice(&stiffness));
        let modes = Eigenproblem::new(mass.as_slice().into()).solved(flat.as_slice());
        let flat_frequency = modes.map_or(f64::NAN, |modes| signed_root(modes.square(0)));
        Ok(Strip {
            weights,
            table: abscissae.flat_map(|x| functions.at(x)).map(|[value, _]| value).collect(),
            functions,
            stiffness,
            slopes: slopes.as_slice().to_vec(),
            mass,
            flat_frequency,
        })
    }

    /// Evaluates the deflection relative to the gap, `Σ z_i φ_i(x)`, at `0 ≤ x ≤ 1`.
    pub fn deflection<T: Scalar>(&self, z: &[T], x: f64) -> T {
        let functions = self.functions.at(x);
        z.iter().zip(functions).fold(T::zero(), |sum, (&z, [value, _])| sum + z * value)
    }

    /// Returns the deflection at a point of the table of shape functions; the last point is the
    /// middle of the strip.
    fn tabulated<T: Scalar>(&self, z: &[T], point: usize) -> T {
        dot(z, self.row(point))
    }

    /// Returns the values of all shape functions at a point of the table.
    fn row(&self, point: usize) -> &[f64] {
        &self.table[point * self.stiffness.len()..][..self.stiffness.len()]
    }

    /// Returns the point of the table with the largest deflection, and the deflection at this
    /// point.
    fn largest(&self, z: &[f64]) -> (usize, f64) {
        let middle = (self.weights.len(), self.tabulated(z, self.weights.len()));
        (0..self.weights.len())
            .map(|point| (point, self.tabulated(z, point)))
            .fold(middle, |best, next| if next.1 > best.1 { next } else { best })
    }
}

impl Vibrates for Strip {
    fn mass(&self, _z: &[f64]) -> Vec<f64> {
        self.mass.as_slice().into()
    }

    fn inertia<T: Scalar>(&self, _z: &[T], Lowest { left, right }: &Lowest) -> T {
        let [left, right] = [left, right].map(|vector| DVector::from_column_slice(vector));
        T::constant(left.dot(&(&self.mass * right)))
    }
}

impl ZeroProblem for Strip {
    fn names(&self) -> Names {
        Names::new([("w", self.stiffness.len())], ["load", "gap_ratio"]).with_monitors(MONITORS)
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        let n = self.stiffness.len();
        let (load, gap_ratio) = (p[0], p[1]);
        let mut stretch = T::zero();
        for ((r, &z_i), row) in r.iter_mut().zip(z).zip(self.slopes.chunks_exact(n)) {
            *r = row.iter().zip(z).fold(T::zero(), |sum, (&slope, &z)| sum + z * slope);
            stretch += *r * z_i;
        }
        let tension = gap_ratio * gap_ratio * stretch * 6.0;
        for ((r, &z), &stiffness) in r.iter_mut().zip(z).zip(&self.stiffness) {
            *r = *r * tension + z * stiffness;
        }
        for (point, &weight) in self.weights.iter().enumerate() {
            let gap = T::one() - self.tabulated(z, point);
            let force = load * weight / (gap * gap);
            for (r, &function) in r.iter_mut().zip(self.row(point)) {
                *r -= force * function;
            }
        }
    }

    fn monitors<T: Scalar>(&self, z: &[T], p: &[T], values: &mut [T]) {
        let places = [self.weights.len(), self.largest(&reals(z)).0];
        let frequencies = [self.frequency(z, p), T::constant(self.flat_frequency)];
        let deflections = places.map(|point| self.tabulated(z, point));
        monitors::fill(Units::Dimensionless, p, deflections, frequencies, values);
    }

    fn domain(&self, z: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        domain::not_negative("gap_ratio", p[1])?;
        domain::clear(self.largest(z).1, 1.0)
    }

    fn dynamics(&self) -> Dynamics {
        Dynamics::Potential
    }

    /// Returns profiles of the deflection and of the first mode shape along the strip.
    fn profiles(&self, z: &[f64], p: &[f64]) -> Vec<Profile> {
        profile::with_lowest_mode(self, z, p, |z, x| self.deflection(z, x))
    }
}

/// The shape functions of a strip, which are even about the middle.
#[derive(Clone, Debug)]
enum Functions {
    /// The functions `sin (2i+1)πx`; the value of the variant is the number of functions.
    Sines(usize),
    /// Twice integrated Legendre polynomials, scaled such that `∫₀¹ φ_i''² dx = 1`.
    Bubbles(Basis),
}

impl Functions {
    /// Returns the values and slopes of all shape functions at `0 ≤ x ≤ 1`.
    fn at(&self, x: f64) -> Vec<[f64; 2]> {
        match self {
            Functions::Sines(count) => {
                let sine = |i| (odd_wave(i) * x).sin_cos();
                (0..*count).map(|i| [sine(i).0, odd_wave(i) * sine(i).1]).collect()
            }
            Functions::Bubbles(basis) => {
                // ∫₋₁¹ b"² dξ = 1 with ξ = 2x − 1: ∫₀¹ (d²b/dx²)² dx = 8.
                let scale = 1.0 / 8.0_f64.sqrt();
                let scaled = |[value, slope, _]: [f64; 3]| [scale * value, 2.0 * scale * slope];
                basis.at(2.0 * x - 1.0).into_iter().map(scaled).collect()
            }
        }
    }
}

/// Returns the odd multiple `(2i + 1)π` of π.
fn odd_wave(i: usize) -> f64 {
    (2 * i + 1) as f64 * PI
}
