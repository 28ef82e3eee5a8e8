//! Promises of the core: Newton, arclength, special points, linear algebra, flows.

#[path = "../common/mod.rs"]
mod common;

mod algebraic;
mod arclength;
mod chain;
mod flow;
mod flow_failures;
mod gradients;
mod newton;
mod special_points;
