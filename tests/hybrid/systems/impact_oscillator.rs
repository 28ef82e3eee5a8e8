//! Closed forms of `tangency::problems::classic::ImpactOscillator`, of stiffness 1.
//!
//! The motion is the forced one, `p(t)` of amplitude `A/D`, and a free one `z`. An orbit with one
//! impact in a period `T`, with the incoming speed `u`, has `z⁻ = Φ z⁺` and
//! `z⁻ = z⁺ + (1 + e) u (0, 1)ᵀ`, so that `z⁺ = u (a, b)ᵀ` with
//! `(a, b)ᵀ = (1 + e)(Φ − I)⁻¹ (0, 1)ᵀ`. At the impact `p = d − a u` and `p' = −(e + b) u`, and the
//! sum of their squares, weighted, is the amplitude's.

use std::f64::consts::TAU;
use tangency::core::scalar::Scalar;
use tangency::problems::classic::ImpactOscillator;

/// What the closed forms are written in: all parameters but the amplitude.
#[derive(Clone, Copy, Debug)]
pub struct ClosedForm {
    pub frequency: f64,
    pub restitution: f64,
    pub damping: f64,
    pub clearance: f64,
    /// `√((1 − ω²)² + (cω)²)`, the force by which the forced motion has the amplitude 1.
    pub stiffness: f64,
    /// `Φ = exp(T [[0, 1], [−1, −c]])` by rows.
    pub flow: [[f64; 2]; 2],
    pub a: f64,
    pub b: f64,
}

impl ClosedForm {
    pub fn new(frequency: f64, restitution: f64, damping: f64, clearance: f64) -> Self {
        let flow = flow(TAU / frequency, damping);
        let [[p, q], [r, s]] = flow;
        let determinant = (p - 1.0) * (s - 1.0) - q * r;
        let kick = (1.0 + restitution) / determinant;
        let stiffness = (1.0 - frequency * frequency).hypot(damping * frequency);
        let (a, b) = (-q * kick, (p - 1.0) * kick);
        ClosedForm { frequency, restitution, damping, clearance, stiffness, flow, a, b }
    }

    /// With the default values of the parameters but for the frequency.
    pub fn usual(frequency: f64) -> Self {
        let [_, _, restitution, damping, clearance] = ImpactOscillator::DEFAULTS;
        ClosedForm::new(frequency, restitution, damping, clearance)
    }

    /// The amplitude of forcing at which the motion without impacts grazes the stop.
    pub fn grazing(&self) -> f64 {
        self.stiffness * self.clearance
    }

    /// The forced motion at the impact of incoming speed `u`, and its derivative over the
    /// frequency.
    fn forced(&self, u: f64) -> [f64; 2] {
        [self.clearance - self.a * u, -(self.restitution + self.b) * u / self.frequency]
    }

    /// The amplitude of forcing of the orbit with one impact of incoming speed `u` in a period.
    pub fn amplitude(&self, u: f64) -> f64 {
        let [displacement, velocity] = self.forced(u);
        self.stiffness * displacement.hypot(velocity)
    }

    /// By how much the forced motion, `Re A e^{iωt}/(1 − ω² + icω)`, lags the force.
    fn lag(&self) -> f64 {
        (self.damping * self.frequency).atan2(1.0 - self.frequency * self.frequency)
    }

    /// When the impact of incoming speed `u` comes, from 0 to a period.
    pub fn time(&self, u: f64) -> f64 {
        let [displacement, velocity] = self.forced(u);
        let phase = (-velocity).atan2(displacement);
        (phase + self.lag()).rem_euclid(TAU) / self.frequency
    }

    /// The motion without impacts at a time.
    pub fn motion<T: Scalar>(&self, amplitude: f64, t: T) -> [T; 2] {
        let (size, phase) = (amplitude / self.stiffness, t * self.frequency - self.lag());
        [phase.cos() * size, -phase.sin() * size * self.frequency]
    }

    /// The motion so long after it left the stop at a time with a velocity: displacement and
    /// velocity.
    pub fn flight<T: Scalar>(&self, amplitude: f64, start: [T; 2], after: T) -> [T; 2] {
        let [left, velocity] = start;
        let [x, v] = self.motion(amplitude, left);
        let free = [-x + self.clearance, velocity - v];
        let [[p, q], [r, s]] = flow(after, self.damping);
        let [x, v] = self.motion(amplitude, left + after);
        [x + p * free[0] + q * free[1], v + r * free[0] + s * free[1]]
    }

    /// The product of the multipliers, whatever the speed: `e² e^{−cT}`.
    pub fn determinant(&self) -> f64 {
        self.restitution.powi(2) * (-self.damping * TAU / self.frequency).exp()
    }

    /// `Φ₁₂ (1 + e)`, by which the impact's place in time enters the multipliers.
    fn saltation(&self) -> f64 {
        self.flow[0][1] * (1.0 + self.restitution)
    }

    /// The sum of the multipliers without its part in `1/u`.
    fn regular_trace(&self) -> f64 {
        let ClosedForm { frequency, restitution, damping, a, b, flow, .. } = *self;
        let acceleration = (1.0 - frequency * frequency) * a + damping * (restitution + b);
        -restitution * (flow[0][0] + flow[1][1]) - self.saltation() * acceleration
    }

    /// `Φ₁₂ (1 + e) ω² d`: the sum of the multipliers has the part `−1/u` of it.
    fn singular_trace(&self) -> f64 {
        self.saltation() * self.frequency.powi(2) * self.clearance
    }

    /// The sum of the multipliers of the orbit of incoming speed `u`.
    pub fn trace(&self, u: f64) -> f64 {
        self.regular_trace() - self.singular_trace() / u
    }

    /// The incoming speed at the fold, where the sum of the multipliers is 1 and their product;
    /// physical if positive.
    pub fn fold(&self) -> f64 {
        let ratio = (self.restitution + self.b) / self.frequency;
        self.a * self.clearance / (self.a.powi(2) + ratio.powi(2))
    }

    /// The amplitude at the fold.
    pub fn fold_amplitude(&self) -> f64 {
        let ratio = ((self.restitution + self.b) / self.frequency).abs();
        self.stiffness * self.clearance * ratio / self.a.hypot(ratio)
    }

    /// The incoming speed at the period doubling; physical if positive.
    pub fn doubling(&self) -> f64 {
        self.singular_trace() / (1.0 + self.determinant() + self.regular_trace())
    }
}

/// `exp(t [[0, 1], [−1, −c]])` by rows.
pub fn flow<T: Scalar>(t: T, damping: f64) -> [[T; 2]; 2] {
    let (rate, natural) = (0.5 * damping, damped(damping));
    let decay = (t * -rate).exp();
    let (cosine, sine) = ((t * natural).cos() * decay, (t * natural).sin() * decay / natural);
    [[cosine + sine * rate, sine], [-sine, cosine - sine * rate]]
}

/// The frequency of free motion, `ω_d = √(1 − c²/4)`.
pub fn damped(damping: f64) -> f64 {
    (1.0 - 0.25 * damping * damping).sqrt()
}

/// The frequency of the n-th resonant grazing, `2ω_d/n`, where `Φ₁₂ = 0`.
pub fn resonance(n: usize, damping: f64) -> f64 {
    2.0 * damped(damping) / n as f64
}
