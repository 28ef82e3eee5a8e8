//! Continuation: stepping along curves of zeros, events on them, and branches as data.

mod arnoldi;
mod between;
mod bracket;
mod branch;
mod checks;
mod closing;
mod crossing;
mod describe;
mod error;
mod event;
mod gather;
mod hermite;
mod homoclinic;
mod limit;
mod locate;
mod metric;
mod observer;
mod predictor;
mod prepare;
mod refine;
mod run;
mod settings;
mod start;
mod stepper;
mod trace;
mod unexplained;

pub use crate::core::kind::Kind;
pub use branch::{Branch, End, Point, SpecialPoint};
pub use error::TraceError;
pub use event::{Direction, Event, MakeCondition, Test, TestFunction, TestPoint};
pub use metric::Metric;
pub use observer::Observer;
pub use settings::{SettingError, Settings};
pub use trace::Continuation;
