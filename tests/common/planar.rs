//! Flows in the plane whose bifurcations are known exactly.

use tangency::{vector_field, zero_problem};

vector_field! {
    /// `x' = a − (b + 1) x + x² y`, `y' = b x − x² y`: a Hopf point at `b = 1 + a²`, of frequency `a`.
    pub struct Brusselator [x, y; a, b] {
        let reaction = x * x * y;
        d/dt x = a - (b + 1.0) * x + reaction;
        d/dt y = b * x - reaction;
    }
}

zero_problem! {
    /// `x' = y, y' = a + b y + x² + x y`: equilibria `x = ±√−a`, of which those with `x > 0` are
    /// saddles. The trace of `F_z` is `b + x`.
    pub struct BogdanovTakens [x, y; a, b] {
        0 = y;
        0 = a + b * y + x * x + x * y;
    }
}
