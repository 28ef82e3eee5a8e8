//! Numerical continuation: curves of zeros, the special points on them, and curves of those.

pub mod core;
pub mod output;
pub mod problems;
pub mod scene;
