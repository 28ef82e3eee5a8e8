//! Electrically actuated rectangular microplates: von Kármán's theory, several models.

mod parameters;

pub use parameters::{Parameters, Units};
