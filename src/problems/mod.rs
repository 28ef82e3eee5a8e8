//! Predefined problems: the equations of devices, and classic test problems.
//!
//! | module | problems |
//! |---|---|
//! | [`classic`] | test problems from the literature: folds, Hopf points, boundary-value problems, impacts |
//! | `mita` (feature `scene`) | Mita's impact microactuator, a hybrid system with dry friction |
//! | `plate` (feature `scene`) | electrically actuated microplates, as in the command `tangency trace plate-device` |
//!
//! ```
//! use tangency::core::problem::ZeroProblem;
//! use tangency::problems::classic::ParallelPlate;
//! // The parallel-plate actuator `load/(1 − u)² = u` pulls in at `u = 1/3`, `load = 4/27`.
//! let mut r = [1.0_f64];
//! ParallelPlate.residual(&[1.0 / 3.0], &[4.0 / 27.0], &mut r);
//! assert!(r[0].abs() < 1e-15);
//! ```

pub mod classic;
#[cfg(feature = "scene")]
pub mod mita;
#[cfg(feature = "scene")]
pub mod plate;
