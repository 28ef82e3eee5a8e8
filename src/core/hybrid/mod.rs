//! Hybrid systems: smooth motion in modes, interrupted by events.
//!
//! In each **mode** a state of the mode's own dimension follows a vector field, `x' = f_m(t, x, p)`. The mode
//! lasts while its **guards** are positive and ends where the first of them vanishes,
//!
//! ```text
//!     h_g(t, x, p) = 0,    falling,
//! ```
//!
//! at an **event**: a **reset** `x⁺ = r_g(t, x, p)` takes the state to that of the next mode. An impact is a
//! reset of velocity, sticking is a mode, and the end of sticking is a guard.

mod measure;
mod system;

pub use measure::{Measure, Passage};
pub use system::{Guard, HybridSystem, Mode};
