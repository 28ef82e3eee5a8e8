//! The normal velocities of the vector fields at the switching surface, and the sliding field.

use super::{FilippovSystem, Side};
use crate::core::problem::gradient;
use crate::core::scalar::Scalar;
use num_dual::Dual;

/// Computes the rate of change `h_t + h_x f` of the surface's function `h` along a vector field
/// `f`.
fn lie_derivative<S: FilippovSystem + ?Sized, T: Scalar>(
    system: &S,
    (t, x, p): (T, &[T], &[T]),
    f: &[T],
) -> T {
    let x: Vec<_> = x.iter().zip(f).map(|(x, f)| Dual::new(*x, *f)).collect();
    let p: Vec<_> = p.iter().map(|p| Dual::new(*p, T::zero())).collect();
    system.surface(Dual::new(t, T::one()), &x, &p).eps
}

/// Computes the speed at which the field of a side approaches the surface, from its normal velocity
/// `L_f h = h_t + h_x f`; the speed is negative if the field leaves the surface.
pub fn held_by_field<S: FilippovSystem + ?Sized, T: Scalar>(
    system: &S,
    side: Side,
    t: T,
    x: &[T],
    p: &[T],
) -> T {
    let mut f = vec![T::zero(); x.len()];
    system.field(side, t, x, p, &mut f);
    let velocity = lie_derivative(system, (t, x, p), &f);
    match side {
        Side::Above => -velocity,
        Side::Below => velocity,
    }
}

/// Computes Filippov's sliding field and writes it into `f`. The sliding field is the convex
/// combination `(L⁻ f⁺ − L⁺ f⁻)/(L⁻ − L⁺)` of the fields `f⁺` above and `f⁻` below that is tangent
/// to the surface, where `L±` are their normal velocities. The sliding field is not finite where
/// both normal velocities vanish.
pub fn convex_combination<S: FilippovSystem + ?Sized, T: Scalar>(
    system: &S,
    t: T,
    x: &[T],
    p: &[T],
    f: &mut [T],
) {
    let mut below = vec![T::zero(); x.len()];
    system.field(Side::Above, t, x, p, f);
    system.field(Side::Below, t, x, p, &mut below);
    let [up, down] = [&*f, &below].map(|f| lie_derivative(system, (t, x, p), f));
    let share = down / (down - up);
    for (f, below) in f.iter_mut().zip(&below) {
        *f = *below + (*f - *below) * share;
    }
}

/// Returns the normal velocity of sliding motion, and the size of the terms in its sum.
pub(super) fn sliding_velocity<S: FilippovSystem + ?Sized>(
    system: &S,
    (t, x, p): (f64, &[f64], &[f64]),
) -> [f64; 2] {
    let mut f = vec![0.0; x.len()];
    system.sliding(t, x, p, &mut f);
    let (by_states, by_time) = gradient((t, x), p, |t, x, p| system.surface(t, x, p));
    let terms = by_states.iter().zip(&f).map(|(slope, f)| slope * f).chain([by_time]);
    terms.fold([0.0, 0.0], |[sum, size], term| [sum + term, size + term.abs()])
}

/// Projects a state near the surface onto the surface by one Newton step, the shortest one in units
/// of the states' sizes. For a state on the surface, the projection leaves derivatives along the
/// surface unchanged.
pub(super) fn project<S: FilippovSystem + ?Sized, T: Scalar>(
    system: &S,
    (t, x, p): (T, &mut [T], &[T]),
    sizes: &[f64],
) {
    // The function and its slope along one state, in units of the state's size.
    let place: Vec<T> = x.to_vec();
    let along = |i: usize| {
        let seed = |k: usize| if k == i { T::from(sizes[i]) } else { T::zero() };
        let x: Vec<_> = place.iter().enumerate().map(|(k, x)| Dual::new(*x, seed(k))).collect();
        let p: Vec<_> = p.iter().map(|p| Dual::new(*p, T::zero())).collect();
        system.surface(Dual::new(t, T::zero()), &x, &p)
    };
    let along: Vec<Dual<T>> = (0..x.len()).map(along).collect();
    let square = along.iter().fold(T::zero(), |sum, h| sum + h.eps * h.eps);
    if square.real() > 0.0 {
        for ((x, h), size) in x.iter_mut().zip(&along).zip(sizes) {
            *x -= h.re * h.eps * *size / square;
        }
    }
}
