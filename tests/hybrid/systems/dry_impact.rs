//! A mass on a spring with dry friction, `m x'' + k x = ∓F` for `x' ≷ 0`, at rest while
//! `|k x| ≤ F`, which a stop moving as `q(t) = −b + a sin ωt` hits from below:
//! `v⁺ = −e v⁻ + (1 + e) q'`.
//!
//! On an orbit that rests at `x`, is hit there, moves up, down and rests again, the motions are
//! half circles about `∓f` with `f = F/k`: about `−f` of the radius `R² = (x + f)² + m v²/k`,
//! `v = (1 + e) q'`, up to `R − f`, and about `f` down to `3f − R`. Hence the orbit is a fixed
//! point of `x ↦ 3f − R(x)`, or `v² = (8F/m)(f − x)`, and `v² = (1 + e)² ω² (a² − (x + b)²)` makes
//! it a root of a quadratic.

use super::quadratic;
use std::f64::consts::TAU;
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;

/// Modes `stick`, `up` and `down`; parameters `stiffness` k, `friction` F, `amplitude` a, `offset`
/// b, `frequency` ω, `restitution` e, `mass` m.
#[derive(Clone, Copy, Debug)]
pub struct DryImpact;

impl DryImpact {
    pub const STICK: usize = 0;
    pub const UP: usize = 1;
    pub const DOWN: usize = 2;
    /// The stop hits the mass.
    pub const HIT: usize = 0;
    /// Upward or downward motion ends.
    pub const TURN: usize = 3;
    /// The parameters of the reference, with `k = 5.5`.
    pub const DEFAULTS: [f64; 7] = [5.5, 0.7961, 1.0, 0.8471, 1.0, 0.9, 1.0];
}

impl HybridSystem for DryImpact {
    fn modes(&self) -> Vec<Mode> {
        let states = ["displacement", "velocity"];
        vec![
            Mode::new("stick", ["displacement"]),
            Mode::new("up", states),
            Mode::new("down", states),
        ]
    }
    fn guards(&self) -> Vec<Guard> {
        vec![
            Guard::new("impact", [Self::STICK, Self::UP, Self::DOWN]),
            Guard::new("slip_up", [Self::STICK]),
            Guard::new("slip_down", [Self::STICK]),
            Guard::new("turn", [Self::UP, Self::DOWN]),
        ]
    }
    fn parameters(&self) -> Vec<String> {
        ["stiffness", "friction", "amplitude", "offset", "frequency", "restitution", "mass"]
            .map(String::from)
            .into()
    }
    fn field<T: Scalar>(&self, mode: usize, _t: T, x: &[T], p: &[T], f: &mut [T]) {
        if mode == Self::STICK {
            f[0] = T::zero();
            return;
        }
        let friction = if mode == Self::UP { -p[1] } else { p[1] };
        f[0] = x[1];
        f[1] = (friction - p[0] * x[0]) / p[6];
    }
    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        let (spring, friction) = (p[0] * x[0], p[1]);
        match guard {
            1 => friction + spring,
            2 => friction - spring,
            Self::TURN if mode == Self::UP => x[1],
            Self::TURN => -x[1],
            _ => x[0] - (p[2] * (p[4] * t).sin() - p[3]),
        }
    }
    fn reset<T: Scalar>(
        &self,
        guard: usize,
        (_, next): (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        after[0] = x[0];
        if next != Self::STICK {
            let velocity = x.get(1).copied().unwrap_or_else(T::zero);
            let stop = p[2] * p[4] * (p[4] * t).cos();
            after[1] = if guard == Self::HIT { stop - p[5] * (velocity - stop) } else { T::zero() };
        }
    }
    fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        let sticks = (p[0] * x[0]).abs() <= p[1];
        match guard {
            1 => Self::UP,
            2 => Self::DOWN,
            Self::TURN if sticks => Self::STICK,
            Self::TURN if mode == Self::UP => Self::DOWN,
            Self::TURN => Self::UP,
            _ => {
                let mut after = [0.0; 2];
                self.reset(guard, (mode, Self::UP), t, x, p, &mut after);
                if after[1] > 0.0 { Self::UP } else { Self::DOWN }
            }
        }
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        p[4].recip() * TAU
    }
}

/// The equations of the orbits with parameters in the order of the system's, `k` first.
#[derive(Clone, Copy, Debug)]
pub struct ClosedForm {
    stiffness: f64,
    friction: f64,
    amplitude: f64,
    offset: f64,
    frequency: f64,
    mass: f64,
    /// `(1 + e)² ω²`.
    kick: f64,
    /// `8F/m`.
    brake: f64,
}

impl ClosedForm {
    pub fn new(p: [f64; 7]) -> Self {
        let [stiffness, friction, amplitude, offset, frequency, restitution, mass] = p;
        let kick = ((1.0 + restitution) * frequency).powi(2);
        let brake = 8.0 * friction / mass;
        ClosedForm { stiffness, friction, amplitude, offset, frequency, mass, kick, brake }
    }

    /// Where the mass rests on the two orbits, ascending, by
    /// `kick (a² − (x + b)²) = brake (f − x)`; physical where `|x| ≤ f`.
    pub fn rest(&self) -> [f64; 2] {
        let constant = self.brake * self.friction / self.stiffness
            - self.kick * (self.amplitude.powi(2) - self.offset.powi(2));
        quadratic(self.kick, 2.0 * self.kick * self.offset - self.brake, constant)
    }

    /// The first time at which the rising stop is at `x`.
    pub fn time(&self, x: f64) -> f64 {
        ((x + self.offset) / self.amplitude).asin() / self.frequency
    }

    /// The velocity just after the impact at `x`.
    pub fn velocity(&self, x: f64) -> f64 {
        (self.kick * (self.amplitude.powi(2) - (x + self.offset).powi(2))).sqrt()
    }

    /// `−R'(x)`.
    pub fn multiplier(&self, x: f64) -> f64 {
        let f = self.friction / self.stiffness;
        let radius = (x + f).hypot(self.velocity(x) * (self.mass / self.stiffness).sqrt());
        (self.kick * self.mass / self.stiffness * (x + self.offset) - x - f) / radius
    }

    /// The stiffness at which both orbits are one.
    pub fn fold(&self) -> f64 {
        let middle = (2.0 * self.kick * self.offset - self.brake).powi(2) / (4.0 * self.kick);
        let constant = middle + self.kick * (self.amplitude.powi(2) - self.offset.powi(2));
        self.brake * self.friction / constant
    }

    /// The stiffnesses, ascending, at which an orbit rests at `x = −f`: beyond, the spring moves
    /// the mass before it is hit. There `kick (a² − (b − f)²) = 2 brake f`.
    pub fn switching_sliding(&self) -> Vec<f64> {
        let linear = 2.0 * (self.brake - self.kick * self.offset);
        let constant = -self.kick * (self.amplitude.powi(2) - self.offset.powi(2));
        let lengths = quadratic(self.kick, linear, constant);
        lengths.into_iter().filter(|f| *f > 0.0).map(|f| self.friction / f).collect()
    }
}
