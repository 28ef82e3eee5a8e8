//! `tangency live` in a browser, and under hostile requests.

mod change;
mod follow;
mod hostile;
mod keep;
mod latency;
mod plane;
mod program;
mod session;

pub use program::Program;
pub use session::Session;
