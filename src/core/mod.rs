//! The continuation core, independent of applications: problems, flows, hybrid systems,
//! boundary-value problems and branches.

pub mod attractor;
pub mod bifurcation;
pub mod bvp;
pub mod cancel;
pub mod continuation;
pub mod equilibrium;
pub mod failure;
pub mod hybrid;
pub mod linalg;
pub mod local_map;
pub mod manifold;
pub mod numerics;
pub mod ode;
pub mod orbit;
pub mod problem;
pub mod scalar;
#[cfg(feature = "scene")]
pub mod sweep;
pub mod system;
