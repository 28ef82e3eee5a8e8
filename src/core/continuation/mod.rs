//! Continuation: stepping along curves of zeros, events on them, and branches as data.

mod branch;
mod settings;

pub use branch::{Branch, End, Kind, Point, SpecialPoint};
pub use settings::{SettingError, Settings};
