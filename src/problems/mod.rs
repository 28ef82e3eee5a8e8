//! Problems: the equations of devices, and classics to try methods on.

pub mod classic;
pub mod mita;
pub mod plate;
