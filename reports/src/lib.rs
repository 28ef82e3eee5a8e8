//! Measurements of tangency's numerical methods: work-precision diagrams plot the error of methods
//! against their CPU time, and robustness maps show where methods succeed, report failures, or are
//! silently wrong. The [`gallery`] consists of interactive pages of all scenes.
//!
//! `docs/evidence/speed-and-accuracy.md` shows all of these diagrams and maps, and tests compare
//! this page with the measurements.

mod diagram;
pub mod gallery;
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
