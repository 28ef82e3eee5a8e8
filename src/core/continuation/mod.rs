//! Continuation: stepping along curves of zeros, events on them, and branches as data.

mod branch;
mod event;
mod locate;
mod metric;
mod run;
mod settings;
mod start;
mod stepper;
mod trace;

pub use branch::{Branch, End, Kind, Point, SpecialPoint};
pub use event::{Direction, Event, MakeCondition, Test};
pub use metric::Metric;
pub use settings::{SettingError, Settings};
pub use trace::{Continuation, Observer, TraceError};
