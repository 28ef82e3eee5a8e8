//! Work-precision diagrams and robustness maps.

#[path = "../../tests/common/orders.rs"]
mod orders;
mod robustness;
mod work_precision;
