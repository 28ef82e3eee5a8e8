//! The parameters of the actuator.

use crate::core::scalar::Scalar;

/// Their names, in their order.
pub(super) const NAMES: [&str; 9] = [
    "voltage",
    "frequency",
    "clearance",
    "restitution",
    "damping",
    "static_friction",
    "dynamic_friction",
    "frame_mass",
    "gravity",
];

/// The parameters by name.
pub(super) struct Parameters<T> {
    /// Voltage, frequency, damping: those of the block.
    pub block: [T; 3],
    pub clearance: T,
    pub restitution: T,
    pub static_friction: T,
    pub dynamic_friction: T,
    pub frame_mass: T,
    pub gravity: T,
}

impl<T: Scalar> Parameters<T> {
    pub fn of(p: &[T]) -> Self {
        Parameters {
            block: [p[0], p[1], p[4]],
            clearance: p[2],
            restitution: p[3],
            static_friction: p[5],
            dynamic_friction: p[6],
            frame_mass: p[7],
            gravity: p[8],
        }
    }

    /// The mass of all.
    pub fn mass(&self) -> T {
        self.frame_mass + 1.0
    }

    /// `μ N`.
    pub fn friction(&self, coefficient: T) -> T {
        coefficient * self.mass() * self.gravity
    }

    /// Friction on a frame that moves forward, or backward.
    pub fn on_the_frame(&self, forward: bool) -> T {
        let friction = self.friction(self.dynamic_friction);
        if forward { -friction } else { friction }
    }
}
