//! Problems: the equations of devices, without any solver.

pub mod plate;
