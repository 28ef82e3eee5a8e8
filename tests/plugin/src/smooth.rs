//! A smooth field and a zero problem.

use tangency::prelude::*;

vector_field! {
    /// The Brusselator: `x' = a − (b + 1) x + x² y`, `y' = b x − x² y`, with a Hopf point at
    /// `b = 1 + a²`.
    pub struct Brusselator [x, y; a = 1.0, b = 1.5] {
        let made = x * x * y;
        d/dt x = a - (b + 1.0) * x + made;
        d/dt y = b * x - made;
    }
}

zero_problem! {
    /// A rigid rod under a load, held upright by a spring: `load · sin u = u`, which buckles at
    /// `load = 1`. It has no default values, so that scenes must give them.
    pub struct Rod [angle; load] {
        0 = load * angle.sin() - angle;
        monitor tilt = angle;
    }
}
