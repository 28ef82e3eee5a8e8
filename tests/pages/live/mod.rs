//! `tangency live` in a browser, and under hostile requests.

mod attractors;
mod change;
mod follow;
mod hostile;
mod keep;
mod latency;
mod plane;
mod program;
mod session;
mod sweep;

pub use program::Program;
pub use session::Session;
