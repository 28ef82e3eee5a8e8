//! Vector fields with known periodic orbits, and ways to get to them, shared by tests.

use tangency::core::attractor::{CycleSearch, CycleSearchError};
use tangency::core::bvp::{BoundarySystem, Collocation, Shooting};
use tangency::core::continuation::{Branch, Continuation};
use tangency::core::hybrid::{Cycle, HybridFlow, HybridSettings, HybridState};
use tangency::core::ode::Scheme;
use tangency::core::orbit::{Smooth, periodic_orbits};
use tangency::core::problem::{Equilibria, Forcing, Names, VectorField};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind};

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
    let mut system = Dense::new(Equilibria(field));
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

/// AUTO's demo pp2.
#[derive(Clone, Copy, Debug)]
pub struct PredatorPrey;

impl VectorField for PredatorPrey {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["p"])
    }
    fn field<T: Scalar>(&self, _t: T, z: &[T], p: &[T], f: &mut [T]) {
        let (x, y) = (z[0], z[1]);
        f[0] = x * 3.0 * (T::one() - x) - x * y - p[0] * (T::one() - (x * -5.0).exp());
        f[1] = x * y * 3.0 - y;
    }
}

/// Bautin's normal form: `r' = r(μ + 2κr² − r⁴), θ' = 1`. Cycles `μ = r⁴ − 2κr²` of period 2π fold
/// at `μ = −κ²`, `r² = κ`; the multiplier is `exp(2π(4κr² − 4r⁴))`.
#[derive(Clone, Copy, Debug)]
pub struct Bautin;

impl VectorField for Bautin {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["mu", "kappa"])
    }
    fn field<T: Scalar>(&self, _t: T, z: &[T], p: &[T], f: &mut [T]) {
        let square = z[0] * z[0] + z[1] * z[1];
        let growth = p[0] + p[1] * square * 2.0 - square * square;
        f[0] = z[0] * growth - z[1];
        f[1] = z[1] * growth + z[0];
    }
}

/// The circle of radius 1, and a pitchfork across it: `z' = (μ − 1 − κ² + x) z − z³`. On the circle
/// the mean of `x` is zero: the branch point is at `μ = 1 + κ²`.
#[derive(Clone, Copy, Debug)]
pub struct PitchforkOfCycles;

impl VectorField for PitchforkOfCycles {
    fn names(&self) -> Names {
        Names::new(["x", "y", "z"], ["mu", "kappa"])
    }
    fn field<T: Scalar>(&self, _t: T, z: &[T], p: &[T], f: &mut [T]) {
        let growth = T::one() - z[0] * z[0] - z[1] * z[1];
        f[0] = z[0] * growth - z[1];
        f[1] = z[1] * growth + z[0];
        f[2] = (p[0] - p[1] * p[1] - 1.0 + z[0]) * z[2] - z[2].powi(3);
    }
}

/// A spiral about a forced motion `a(t) = (cos νt, sin νt)`: with `w = x + iy − e^{iνt}`,
/// `w' = (μ − κ² + iΩ) w − |w|² w`. The motion `w = 0` has the multipliers
/// `exp((μ − κ² ± iΩ) 2π/ν)`, and a torus point at `μ = κ²`.
#[derive(Clone, Copy, Debug)]
pub struct ForcedSpiral;

impl ForcedSpiral {
    pub const NU: f64 = 1.3;
    pub const OMEGA: f64 = 0.4;
}

impl VectorField for ForcedSpiral {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["mu", "kappa"])
    }
    fn field<T: Scalar>(&self, t: T, z: &[T], p: &[T], f: &mut [T]) {
        let (nu, omega) = (Self::NU, Self::OMEGA);
        let (sine, cosine) = (t * nu).sin_cos();
        let (x, y) = (z[0] - cosine, z[1] - sine);
        let growth = p[0] - p[1] * p[1] - x * x - y * y;
        f[0] = growth * x - y * omega - sine * nu;
        f[1] = growth * y + x * omega + cosine * nu;
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: std::f64::consts::TAU }
    }
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::constant(std::f64::consts::TAU / Self::NU)
    }
}

/// `x' = λ(x − A cos t) − A sin t`, `y' = −λ(y − A sin t) + A cos t`: whatever the rate λ, the
/// periodic solution is `(A cos t, A sin t)`, with the multipliers `exp(±2πλ)`.
#[derive(Clone, Copy, Debug)]
pub struct Saddle;

impl VectorField for Saddle {
    fn names(&self) -> Names {
        Names::new(["x", "y"], ["amplitude", "rate"])
    }
    fn field<T: Scalar>(&self, t: T, z: &[T], p: &[T], f: &mut [T]) {
        let (sine, cosine) = t.sin_cos();
        f[0] = p[1] * (z[0] - p[0] * cosine) - p[0] * sine;
        f[1] = -p[1] * (z[1] - p[0] * sine) + p[0] * cosine;
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: std::f64::consts::TAU }
    }
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::constant(std::f64::consts::TAU)
    }
}
