//! Promises of the core: Newton, arclength, special points, linear algebra, flows.

mod algebraic;
mod arclength;
mod cancellation;
mod chain;
mod chunks;
mod closures;
mod clusters;
mod exact_models;
mod flow;
mod flow_failures;
mod gradients;
mod linear;
mod mixed;
mod multiple_branch_points;
mod newton;
mod normal_forms;
mod order_conditions;
mod own_kinds;
mod own_system;
mod own_values;
mod prediction;
mod root_search;
mod rounding;
mod sides;
mod special_points;
mod strangers;
