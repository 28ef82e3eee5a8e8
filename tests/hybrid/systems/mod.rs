//! Hybrid systems with known answers, shared by tests: one file a system, its closed forms beside
//! its equations.

/// The methods of a hybrid system that are those of another one: the macro `of` gives an answer of
/// that one.
macro_rules! as_another {
    ($self:ident, $of:ident) => { as_another! { $self, $of,
        fn modes() -> Vec<Mode>;
        fn guards() -> Vec<Guard>;
        fn parameters() -> Vec<String>;
        fn field<T>(mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) -> ();
        fn guard<T>(guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T;
        fn reset<T>(g: usize, modes: (usize, usize), t: T, x: &[T], p: &[T], after: &mut [T]) -> ();
        fn next_mode(guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize;
        fn forcing() -> Forcing;
        fn period<T>(p: &[T]) -> T;
    } };
    ($self:ident, $of:ident, $(
        fn $name:ident $(<$scalar:ident>)? ($($argument:ident: $type:ty),*) -> $result:ty;
    )*) => {$(
        fn $name $(<$scalar: Scalar>)? (&$self $(, $argument: $type)*) -> $result {
            $of!($self, system => system.$name($($argument),*))
        }
    )*};
}
pub(in crate::hybrid) use as_another;

pub mod belt;
pub mod bouncing_ball;
pub mod coulomb;
pub mod dry_impact;
pub mod impact_map;
pub mod impact_oscillator;
pub mod orbits;
pub mod piecewise;
pub mod rebound;
pub mod reference;
pub mod sliding;

use num_dual::Dual64;
use tangency::core::hybrid::{HybridSettings, HybridSystem};
use tangency::core::ode::{Scheme, Settings};
use tangency::core::scalar::Scalar;

/// The event that ends an exact flight, given as its state so long after its start at `t`, near an
/// expected duration: the duration and the state after the reset, with their derivatives.
pub fn event<S: HybridSystem, T: Scalar, const N: usize>(
    system: &S,
    (guard, mode): (usize, usize),
    t: T,
    expected: f64,
    flight: impl Fn(T) -> [T; N],
    p: &[T],
) -> (T, Vec<T>) {
    let value = |after: T| system.guard(guard, mode, t + after, &flight(after), p);
    let mut after = T::constant(expected);
    for _ in 0..20 {
        let h = 1e-4;
        let slope = (value(after + h) - value(after + -h)).real() / (2.0 * h);
        after -= value(after) / slope;
    }
    let before = flight(after);
    let (end, reals) = ((t + after).real(), before.map(|x| x.real()));
    let values: Vec<f64> = p.iter().map(T::real).collect();
    let next = system.next_mode(guard, mode, end, &reals, &values);
    let mut state = vec![T::zero(); system.modes()[next].states.len()];
    system.reset(guard, (mode, next), t + after, &before, p, &mut state);
    (after, state)
}

/// How far the velocity of an exact flight is from the system's field, a time after its start at
/// `t`.
pub fn defect<S: HybridSystem, const N: usize>(
    system: &S,
    mode: usize,
    t: f64,
    after: f64,
    flight: impl Fn(Dual64) -> [Dual64; N],
    p: &[f64],
) -> f64 {
    let exact = flight(Dual64::from(after).derivative());
    let mut f = [0.0; N];
    system.field(mode, t + after, &exact.map(|x| x.re), p, &mut f);
    exact.iter().zip(f).map(|(x, f)| (x.eps - f).abs()).fold(0.0, f64::max)
}

/// The roots of `a x² + b x + c`, ascending.
pub fn quadratic(a: f64, b: f64, c: f64) -> [f64; 2] {
    // The half that does not cancel first.
    let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    let (one, other) = (q / a, c / q);
    [one.min(other), one.max(other)]
}

/// The multipliers of a map of the plane, from the trace and the determinant of its derivative:
/// real and imaginary parts, the largest modulus first.
pub fn multipliers(trace: f64, determinant: f64) -> [(f64, f64); 2] {
    let discriminant = 0.25 * trace * trace - determinant;
    if discriminant < 0.0 {
        let imaginary = (-discriminant).sqrt();
        return [(0.5 * trace, imaginary), (0.5 * trace, -imaginary)];
    }
    let large = 0.5 * trace + discriminant.sqrt().copysign(trace);
    [(large, 0.0), (determinant / large, 0.0)]
}

/// The method of order 8 at a tolerance.
pub fn settings(tolerance: f64) -> HybridSettings {
    let flow = Settings::new(Scheme::DormandPrince8, tolerance);
    HybridSettings { flow, ..HybridSettings::default() }
}
