//! Problems whose equations are given as text, in scenes or in separate files, as in `tangency
//! trace model.ron`.
//!
//! A **statement** of equations is written in RON and consists of names with formulas, as in
//!
//! ```ron
//! Equations(
//!     states: [("x", "sigma*(y - x)"), ("y", "x*(rho - z) - y"), ("z", "x*y - beta*z")],
//!     parameters: [("sigma", 10), ("rho", 28), ("beta", "8/3")],
//! )
//! ```
//!
//! `docs/reference/language.md` describes the language. A formula is parsed into nodes in postfix
//! order, and its names are then resolved in the scope of the mode in which the formula is used.
//! All formulas that are evaluated together become one tape, a list of operations in which common
//! subexpressions are computed only once. A tape is evaluated over any
//! [`Scalar`](crate::core::scalar::Scalar) type without allocation, so that a [`Model`] supports
//! all computations, such as derivatives of every order, orbits and local maps.

mod affine;
mod assembling;
mod assembly;
mod basis;
mod boundary;
mod calls;
mod duration;
mod elementary;
mod elements;
mod events;
mod filippov;
mod hybrid;
mod implicit;
mod kinds;
mod layout;
mod map;
mod observed;
mod operation;
mod product;
mod residual;
mod scope;
mod smooth;
mod source;
pub mod statement;
mod syntax;
mod tape;
mod text;
mod times;
mod values;
pub mod xpp;

pub use crate::misread::Place;
pub use basis::number;
pub use boundary::Conditions;
pub use filippov::TwoFields;
pub use hybrid::Hybrid;
pub use kinds::{KINDS, Model, Statement};
pub use map::Iteration;
pub use residual::Zero;
pub use smooth::Field;
pub use source::{Fault, ModelError, Phrase, Source};
pub(crate) use source::{misread, without_mark};
pub(crate) use text::{Parts, fields_of, options, statement_in};
