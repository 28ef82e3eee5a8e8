//! Defines the numbers on which equations are evaluated: reals, dual numbers and jets.
//!
//! Equations are written once, generic over [`Scalar`]: evaluation on `f64` yields values,
//! evaluation on dual numbers yields derivatives, and evaluation on a [`Jet`] yields Taylor
//! polynomials (A. Griewank and A. Walther, *Evaluating Derivatives*, 2nd ed. 2008).
//!
//! ```
//! use tangency::core::scalar::Scalar;
//! use tangency::num_dual::{first_derivative, third_derivative};
//! /// The load `u (1 − u)²` of the parallel-plate actuator.
//! fn load<T: Scalar>(u: T) -> T {
//!     u * (T::one() - u).powi(2)
//! }
//! assert_eq!(load(0.5), 0.125);
//! assert_eq!(first_derivative(load, 0.5).1, -0.25);
//! assert_eq!(third_derivative(load, 0.5), (0.125, -0.25, -1.0, 6.0));
//! ```

mod chunk;
pub(crate) mod jet;
mod lanes;
mod number;
mod traced;

pub(in crate::core) use chunk::Narrow;
pub use chunk::{CHUNK, Chunk, DualChunk};
pub(crate) use chunk::{Directional, seeded};
pub use jet::{Jet, JetError, Monomials, Polynomial, Space};
pub use lanes::LaneWidth;
pub(in crate::core) use lanes::in_registers;
pub(in crate::core) use lanes::{
    Avx2, Avx512, Baseline, DualLanes, InLanes, Lanes, MOST_LANES, Register, Registered,
};
#[cfg(feature = "scene")]
pub(crate) use lanes::{in_registers_of, with_avx2};
pub(in crate::core) use number::operations;
pub use traced::Traced;

use num_dual::DualNum;

/// A real number or a dual number of any depth: residuals, monitors and fields are generic over
/// this trait.
///
/// The trait is implemented for every `Copy` type of [`num_dual`] over `f64`, and for `f64` itself.
/// Comparisons use only real parts; `%` panics; the derivative of `√x` at 0 is not finite.
///
/// ```
/// use tangency::core::scalar::Scalar;
/// fn load<T: Scalar>(u: T) -> T {
///     u * (T::one() - u).powi(2)
/// }
/// let slope = num_dual::first_derivative(load, 1.0_f64 / 3.0).1;
/// assert!(slope.abs() < 1e-15, "the parallel-plate actuator folds at u = 1/3");
/// ```
pub trait Scalar: DualNum<Primitive = f64> + Copy + Send + Sync {
    /// The real part of a number: its value without derivatives.
    fn real(&self) -> f64;
    /// A constant: a number whose derivatives are all zero.
    fn constant(value: f64) -> Self {
        Self::from(value)
    }
}

impl<T: DualNum<Primitive = f64> + Copy + Send + Sync> Scalar for T {
    fn real(&self) -> f64 {
        self.re()
    }
}
