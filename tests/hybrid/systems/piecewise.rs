//! A planar field, smooth on either side of `x₁ = 0`, in polar coordinates
//!
//! ```text
//!     r' = r (1 − r),      θ' = 1            on the left,
//!     r' = α r (β − r),    θ' = γ + β − r    on the right.
//! ```
//!
//! On either side `r` is logistic in time, and on the right `∫(β − r) dt = ln(r₁/r₀)/α`. An orbit
//! that leaves the left side at `r₁` and the right side at `r₀` therefore spends the time `π` on
//! the left, and `s` on the right with `γ s + ln(r₀/r₁)/α = π`. Its multiplier is the product over
//! both sides of `g(r_end)/g(r_start)`, where `dr/dθ = g(r)`.

use std::f64::consts::PI;
use tangency::hybrid_system;

hybrid_system! {
    /// Modes `left` and `right`; parameters `alpha`, `beta`, `gamma`.
    pub struct Piecewise [alpha, beta, gamma] {
        mode left [x1, x2] {
            let r = (x1 * x1 + x2 * x2).sqrt();
            let (growth, turn) = (T::one() - r, T::one());
            d/dt x1 = growth * x1 - turn * x2;
            d/dt x2 = growth * x2 + turn * x1;
            event rightwards: -x1 => right;
        }
        mode right [x1, x2] {
            let r = (x1 * x1 + x2 * x2).sqrt();
            let (growth, turn) = (alpha * (beta - r), gamma + beta - r);
            d/dt x1 = growth * x1 - turn * x2;
            d/dt x2 = growth * x2 + turn * x1;
            event leftwards: x1 => left;
        }
    }
}

impl Piecewise {
    pub const LEFT: usize = 0;
    pub const RIGHT: usize = 1;
}

/// The limit cycle: where it leaves the right side (at the top) and the left one (at the bottom),
/// how long it stays on the right, and its multiplier.
#[derive(Clone, Copy, Debug)]
pub struct Cycle {
    pub top: f64,
    pub bottom: f64,
    pub right: f64,
    pub multiplier: f64,
}

/// The limit cycle around the origin, its radius at the top by bisection.
pub fn cycle(alpha: f64, beta: f64, gamma: f64) -> Cycle {
    // From the top over the left side, and on by the time that remains, to the radius at the top
    // again.
    let left = |top: f64| top * PI.exp() / (1.0 + top * PI.exp_m1());
    let over_the_right = |top: f64, bottom: f64| (PI - (top / bottom).ln() / alpha) / gamma;
    let excess = |top: f64| {
        let bottom = left(top);
        let growth = (alpha * beta * over_the_right(top, bottom)).exp();
        beta * bottom * growth / (beta + bottom * (growth - 1.0)) - top
    };
    // Every radius between those of the two sides' circles returns between them.
    let (mut low, mut high) = (beta.min(1.0), beta.max(1.0));
    while 0.5 * (low + high) > low && 0.5 * (low + high) < high {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 { low = middle } else { high = middle }
    }
    let (top, bottom) = (low, left(low));
    let slope = |r: f64| alpha * r * (beta - r) / (gamma + beta - r);
    let on_the_left = bottom * (1.0 - bottom) / (top * (1.0 - top));
    let multiplier = on_the_left * slope(top) / slope(bottom);
    Cycle { top, bottom, right: over_the_right(top, bottom), multiplier }
}
