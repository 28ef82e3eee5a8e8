//! Measurements of tangency's methods: work-precision diagrams, the error of methods against the CPU time that they
//! take, and robustness maps, where methods succeed, report failures, or are silently wrong.
//!
//! `docs/evidence/speed-and-accuracy.md` shows all of them, and its tests compare the page with the
//! measurements.

mod diagram;
mod map;
pub mod prose;
mod report;
pub mod robustness;
pub mod work_precision;

pub use diagram::{
    Circumstances, Clock, Drawn, Line, Measured, Measurement, WORK_PRECISION, WorkPrecision,
};
pub use map::{Cell, Class, Outcome, ROBUSTNESS, Region, RobustnessMap, Tried};
pub use report::{Entry, Report};
