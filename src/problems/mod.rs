//! Problems: the equations of devices, classics to try methods on, and what users give as text.

pub mod classic;
#[cfg(feature = "scene")]
pub mod mita;
#[cfg(feature = "scene")]
pub mod plate;
#[cfg(feature = "scene")]
pub mod text;
