//! Jets: truncated Taylor series in several variables, as scalars.
//!
//! A jet of order `N` in the variables `ε = (ε₁, …, ε_V)` is a polynomial `a(ε) = Σ a_α ε^α`,
//! `|α| ≤ N`, with `a_α = ∂^α a(0)/α!`. Jets are added and multiplied like polynomials, and terms of
//! higher degree are dropped. With `a = a₀ + h`, where `h` has no constant term, a function `f` of a
//! jet is the finite sum
//!
//! ```text
//!     f(a) = Σ_{k ≤ N} f⁽ᵏ⁾(a₀)/k! hᵏ,
//! ```
//!
//! whose coefficients come from the recurrences of univariate series (R. E. Moore, *Interval
//! Analysis*, 1966; A. Griewank and A. Walther, *Evaluating Derivatives*, 2nd ed. 2008, chapter 13).
//! A [`Jet`] is a [`Scalar`](super::Scalar): fields, guards, resets and flows, written once, are
//! evaluated on jets and return their Taylor polynomials. The size of a jet is a binomial coefficient
//! in the order, whereas nested dual numbers grow exponentially. Scalars are `Copy`, so a jet's
//! capacity is a compile-time constant: hybrid systems are compiled for two capacities, since a
//! single one would make each small jet 8 kB.

mod dual;
mod number;
mod polynomial;
pub(crate) mod powers;
pub(crate) mod series;
mod space;
pub(crate) mod taylor;

pub use number::Jet;
pub(crate) use number::jet_of;
pub use polynomial::{Monomials, Polynomial};
pub use space::{JetError, Space};
