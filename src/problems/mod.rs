//! Problems: the equations of devices, and classic test problems, such as the problem of `tangency
//! trace plate-device`.

pub mod classic;
#[cfg(feature = "scene")]
pub mod mita;
#[cfg(feature = "scene")]
pub mod plate;
