//! A ball on a table that moves as `Γ sin t`, in units of time `1/ω` and of length `g/ω²`.

use std::f64::consts::TAU;
use tangency::prelude::*;

hybrid_system! {
    /// Modes `flight` and `contact`, in which the ball moves with the table.
    pub struct Ball [acceleration = 1.2, restitution = 0.5; t] {
        let (table, rate) = (acceleration * t.sin(), acceleration * t.cos());
        period = T::constant(TAU);
        mode flight [height, velocity] {
            d/dt height = velocity;
            d/dt velocity = -T::one();
            event impact: height - table
                => flight { height, velocity: rate - restitution * (velocity - rate) };
            accumulates to contact { height };
        }
        mode contact [height] {
            d/dt height = rate;
            // The table pushes by its acceleration −Γ sin t and the weight.
            event leave: T::one() - table => flight { height, velocity: rate };
        }
    }
}
