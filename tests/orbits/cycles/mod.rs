//! Vector fields with known periodic orbits, and ways to get to them, shared by tests.

use tangency::core::attractor::{CycleSearch, CycleSearchError};
use tangency::core::bvp::{BoundarySystem, Collocation, Shooting};
use tangency::core::continuation::{Branch, Continuation};
use tangency::core::hybrid::{Cycle, HybridFlow, HybridSettings, HybridState};
use tangency::core::ode::Scheme;
use tangency::core::orbit::{Smooth, periodic_orbits};
use tangency::core::problem::{Equilibria, VectorField};
use tangency::core::system::{Dense, Kind};
use tangency::vector_field;

pub fn collocated(field: impl VectorField + 'static, intervals: usize) -> BoundarySystem {
    periodic_orbits(field, intervals, collocation(4)).unwrap()
}

pub fn collocation(degree: usize) -> Collocation {
    Collocation::new(degree).unwrap()
}

/// The cycle on which the motion of a field from a state settles.
pub fn cycle_of(
    field: impl VectorField,
    search: CycleSearch,
    start: &[f64],
    p: &[f64],
) -> Result<Cycle, CycleSearchError> {
    let system = Smooth(field);
    let mut flow = HybridFlow::new(&system, HybridSettings::default())?;
    search.find(&mut flow, HybridState { mode: 0, time: 0.0, x: start.to_vec() }, p)
}

pub fn shot(field: impl VectorField + 'static, segments: usize) -> BoundarySystem {
    periodic_orbits(field, segments, Shooting::default()).unwrap()
}

pub fn precisely_shot(field: impl VectorField + 'static, segments: usize) -> BoundarySystem {
    let method = Shooting::new(Scheme::DormandPrince8, 1e-13).unwrap();
    periodic_orbits(field, segments, method).unwrap()
}

/// The equilibria of a field in its first parameter, from a guess.
pub fn equilibria<F: VectorField + 'static>(
    field: F,
    guess: &[f64],
    p: &[f64],
    ends: [f64; 2],
) -> Branch {
    let names = field.names().parameters;
    let mut system = Dense::new(Equilibria::new(field));
    let mut continuation = Continuation::new(&mut system)
        .named("rest")
        .from(guess)
        .along(&names[0], ends[0]..=ends[1]);
    for (name, value) in names.iter().zip(p) {
        continuation = continuation.at(name, *value);
    }
    continuation.trace().unwrap()
}

/// The first label of a kind.
#[track_caller]
pub fn label(branch: &Branch, kind: Kind) -> usize {
    let found = branch.of_kind(kind).next();
    found.unwrap_or_else(|| panic!("no {kind} on {}: {:?}", branch.name, branch.ends)).label
}

vector_field! {
    /// AUTO's demo pp2.
    pub struct PredatorPrey [x, y; p] {
        d/dt x = x * 3.0 * (T::one() - x) - x * y - p * (T::one() - (x * -5.0).exp());
        d/dt y = x * y * 3.0 - y;
    }
}

vector_field! {
    /// Bautin's normal form: `r' = r(μ + 2κr² − r⁴), θ' = 1`. Cycles `μ = r⁴ − 2κr²` of period 2π fold
    /// at `μ = −κ²`, `r² = κ`; the multiplier is `exp(2π(4κr² − 4r⁴))`.
    pub struct Bautin [x, y; mu, kappa] {
        let square = x * x + y * y;
        let growth = mu + kappa * square * 2.0 - square * square;
        d/dt x = x * growth - y;
        d/dt y = y * growth + x;
    }
}

vector_field! {
    /// The circle of radius 1, and a pitchfork across it: `z' = (μ − 1 − κ² + x) z − z³ + δ`. On the
    /// circle the mean of `x` is zero: for `δ = 0`, the branch point is at `μ = 1 + κ²`.
    pub struct PitchforkOfCycles [x, y, z; mu, kappa, delta] {
        let growth = T::one() - x * x - y * y;
        d/dt x = x * growth - y;
        d/dt y = y * growth + x;
        d/dt z = (mu - kappa * kappa - 1.0 + x) * z - z.powi(3) + delta;
    }
}

vector_field! {
    /// A spiral about a forced motion `a(t) = (cos νt, sin νt)`: with `w = x + iy − e^{iνt}`,
    /// `w' = (μ − κ² + iΩ) w − |w|² w`. The motion `w = 0` has the multipliers
    /// `exp((μ − κ² ± iΩ) 2π/ν)`, and a torus point at `μ = κ²`.
    pub struct ForcedSpiral [x, y; mu, kappa; t] {
        let (nu, omega) = (Self::NU, Self::OMEGA);
        let (sine, cosine) = (t * nu).sin_cos();
        let (u, v) = (x - cosine, y - sine);
        let growth = mu - kappa * kappa - u * u - v * v;
        d/dt x = growth * u - v * omega - sine * nu;
        d/dt y = growth * v + u * omega + cosine * nu;
        period = T::constant(std::f64::consts::TAU / Self::NU);
    }
}

impl ForcedSpiral {
    pub const NU: f64 = 1.3;
    pub const OMEGA: f64 = 0.4;
}

vector_field! {
    /// `x' = λ(x − A cos t) − A sin t`, `y' = −λ(y − A sin t) + A cos t`: whatever the rate λ, the
    /// periodic solution is `(A cos t, A sin t)`, with the multipliers `exp(±2πλ)`.
    pub struct Saddle [x, y; amplitude, rate; t] {
        let (sine, cosine) = t.sin_cos();
        d/dt x = rate * (x - amplitude * cosine) - amplitude * sine;
        d/dt y = -rate * (y - amplitude * sine) + amplitude * cosine;
        period = T::constant(std::f64::consts::TAU);
    }
}
