//! Jets: truncated Taylor series in several variables, as a scalar type.
//!
//! A jet of order `N` in the variables `ε = (ε₁, …, ε_V)` is a polynomial `a(ε) = Σ a_α ε^α`, `|α| ≤
//! N`, with `a_α = ∂^α a(0)/α!`. Jets are added and multiplied in the same way as polynomials, and
//! terms of degree higher than `N` are dropped. With `a = a₀ + h`, where `h` has no constant term, a
//! function `f` of the jet `a` is the following finite sum:
//!
//! ```text
//!     f(a) = Σ_{k ≤ N} f⁽ᵏ⁾(a₀)/k! hᵏ.
//! ```
//!
//! The coefficients of the sum are computed by the recurrences of univariate Taylor series (R. E.
//! Moore, *Interval Analysis*, 1966; A. Griewank and A. Walther, *Evaluating Derivatives*, 2nd ed.
//! 2008, chapter 13). A [`Jet`] is a [`Scalar`](super::Scalar): fields, guards, resets and flows,
//! written once for all scalar types, can be evaluated with jets, and the results are their Taylor
//! polynomials. The number of a jet's coefficients is a binomial coefficient of the order and the
//! number of variables, whereas the size of nested dual numbers grows exponentially with the order.
//! Since scalars are `Copy`, the capacity of a jet is a compile-time constant. Hybrid systems are
//! compiled for two capacities, because with a single capacity even a small jet would occupy 8 kB.

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
