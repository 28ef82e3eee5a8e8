//! Mita's impact microactuator: a block on a spring within a frame, pulled by a voltage
//! `V(t) = V sin ωt` (X. Zhao, *Modeling and Simulation of MEMS Devices*, 2004, chapters 2.2
//! and 4).
//!
//! All quantities are nondimensional: the block's mass, the spring's stiffness and the electrode
//! gap are 1.

mod actuator;
mod block;
mod parameters;
mod switch_on;

pub use actuator::Actuator;
pub use block::Block;
pub use switch_on::{SwitchOn, SwitchOnError};
