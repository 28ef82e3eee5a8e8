//! Problems: the equations of devices, and classics to try methods on.

pub mod classic;
#[cfg(feature = "scene")]
pub mod mita;
#[cfg(feature = "scene")]
pub mod plate;
