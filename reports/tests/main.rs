//! Work-precision diagrams, robustness maps, and the project's text.

mod english;
#[path = "../../tests/common/orders.rs"]
mod orders;
mod robustness;
mod work_precision;
