//! Electrically actuated rectangular microplates: von Kármán's theory, several models.

mod parameters;
pub mod sine;
pub mod strip;

pub use parameters::{Parameters, Units};
