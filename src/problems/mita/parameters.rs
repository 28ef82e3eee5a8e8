//! The parameters of Mita's actuator.

use crate::core::scalar::Scalar;

/// The names of the actuator's parameters, in the order in which lists contain their values.
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

/// The actuator's parameters, each accessible by its name.
pub(super) struct Parameters<'a, T>(&'a [T]);

/// Declares an accessor method for each parameter.
macro_rules! named {
    ($($name:ident: $position:literal)*) => {
        impl<T: Scalar> Parameters<'_, T> {
            $(#[inline(always)]
            pub fn $name(&self) -> T {
                self.0[$position]
            })*
        }
    };
}

named! { clearance: 2 restitution: 3 static_friction: 5 dynamic_friction: 6 frame_mass: 7 gravity: 8 }

impl<'a, T: Scalar> Parameters<'a, T> {
    /// Wraps a list that contains the values of all parameters, in the order of their names.
    #[inline(always)]
    pub fn of(p: &'a [T]) -> Self {
        Parameters(&p[..NAMES.len()])
    }

    /// Returns voltage, frequency and damping, which are the parameters of the block.
    #[inline(always)]
    pub fn block(&self) -> [&T; 3] {
        [&self.0[0], &self.0[1], &self.0[4]]
    }

    /// Returns the total mass of block and frame.
    #[inline(always)]
    pub fn mass(&self) -> T {
        self.frame_mass() + 1.0
    }

    /// Returns `μ N`.
    #[inline(always)]
    pub fn friction(&self, coefficient: T) -> T {
        coefficient * self.mass() * self.gravity()
    }

    /// Returns the friction force on a frame that moves forward, or backward.
    #[inline(always)]
    pub fn on_the_frame(&self, forward: bool) -> T {
        let friction = self.friction(self.dynamic_friction());
        if forward { -friction } else { friction }
    }
}
