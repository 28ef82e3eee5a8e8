//! Work-precision diagrams and robustness maps, which the feature `reports` adds.

#[path = "../common/orders.rs"]
mod orders;
mod robustness;
mod work_precision;
