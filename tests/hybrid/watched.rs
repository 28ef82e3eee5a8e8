//! Promise: a watched function's extrema and its falls through zero are found inside steps, to the
//! accuracy of the flow, however short the dip, and with their derivatives.

use crate::common::close;
use num_dual::{Dual64, DualNum, HyperDual64};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::ControlFlow;
use tangency::core::ode::{Extrema, Extremum, Flow, Root, Roots, Scheme, Settings};
use tangency::core::problem::Watch;
use tangency::core::scalar::Scalar;
use tangency::vector_field;

const ALL: [Scheme; 3] = [Scheme::DormandPrince8, Scheme::DormandPrince5, Scheme::Rodas5P];

vector_field! {
    /// `x = sin t`, `v = cos t`.
    struct Oscillator [x, v; level] {
        d/dt x = v;
        d/dt v = -x;
    }
}

/// `1 + level − x`: dips below zero about `t = π/2` if the level is negative.
struct Ceiling;
impl Watch for Ceiling {
    fn value<T: Scalar>(&self, _t: T, x: &[T], p: &[T]) -> T {
        -x[0] + p[0] + 1.0
    }
}

/// `level + sin 2t − x`, a function of time as well.
struct Moving;
impl Watch for Moving {
    fn value<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T {
        (t * 2.0).sin() - x[0] + p[0]
    }
}

/// Times and rates at which a function falls through zero.
fn falls<T: Scalar>(
    scheme: Scheme,
    watch: impl Watch,
    start: [f64; 2],
    length: f64,
    p: T,
) -> Vec<(T, f64)> {
    let (mut roots, mut found) = (Roots::default(), Vec::new());
    let mut x = start.map(T::constant);
    Flow::new(Settings::new(scheme, 1e-13))
        .unwrap()
        .observe(&Oscillator, T::zero(), T::constant(length), &mut x, &[p], |step| {
            roots.search(&watch, step, |step, Root { fraction, rate }| {
                found.push((step.time(fraction), rate.real()));
                ControlFlow::Continue(())
            })
        })
        .unwrap();
    found
}

/// `sin t = 1 − ε` at `t = arccos(−ε + 1)` from the top: the dip of depth ε is `2√(2ε)` long. Where
/// the value has an error η, that of the place is `η/√(2ε)`.
#[test]
fn dips_are_seen_down_to_the_last_digits() {
    for scheme in ALL {
        for depth in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
            let found = falls(scheme, Ceiling, [0.0, 1.0], 6.0, -depth);
            assert_eq!(found.len(), 1, "{scheme:?} {depth}");
            let aside = 2.0 * (0.5_f64 * depth).sqrt().asin();
            close(found[0].0, FRAC_PI_2 - aside, 1e-12 + 2e-13 / aside);
            close(found[0].1, -aside.sin(), 1e-12 + 2e-13 / aside);
            let found = falls(scheme, Ceiling, [0.0, 1.0], 6.0, depth);
            assert!(found.is_empty(), "{scheme:?} {depth}: {found:?}");
        }
    }
}

/// The root of `1 + p − sin t` is `arcsin(1 + p)`.
#[test]
fn roots_carry_their_derivatives() {
    for scheme in ALL {
        let p = HyperDual64::new(-0.02, 1.0, 1.0, 0.0);
        let found = falls(scheme, Ceiling, [0.0, 1.0], 6.0, p);
        let exact = (p + 1.0).asin();
        close(found[0].0.re, exact.re, 1e-12);
        close(found[0].0.eps1, exact.eps1, 1e-9);
        close(found[0].0.eps1eps2, exact.eps1eps2, 1e-6);
    }
}

/// `sin 2t = sin t` at 0, π/3, π, 5π/3: it falls at π/3 and 5π/3.
#[test]
fn functions_of_time_are_watched_too() {
    for scheme in ALL {
        let p = Dual64::from(0.0).derivative();
        let found = falls(scheme, Moving, [0.0, 1.0], 6.0, p);
        assert_eq!(found.len(), 2, "{scheme:?}");
        for (found, t) in found.iter().zip([PI / 3.0, 5.0 * PI / 3.0]) {
            let rate = 2.0 * (2.0 * t).cos() - t.cos();
            close(found.0.re, t, 1e-12);
            close(found.0.eps, -1.0 / rate, 1e-9);
            close(found.1, rate, 1e-11);
        }
    }
}

/// At a root: a function that rises counts when it falls again, one that falls counts at once, and
/// one that is zero at a minimum does not count.
#[test]
fn zero_at_the_start() {
    for scheme in ALL {
        let (s, c) = (PI / 3.0).sin_cos();
        // From x = sin(2π/3) downwards, the level there: rises, and falls at π/3 + 2π.
        let rising = falls(scheme, Ceiling, [s, -c], 6.0, s - 1.0);
        assert_eq!(rising.len(), 1, "{scheme:?}");
        close(rising[0].0, 2.0 * PI - PI / 3.0, 1e-11);
        let falling = falls(scheme, Ceiling, [s, c], 6.0, s - 1.0);
        assert!(falling.len() == 1 && falling[0].0 == 0.0, "{scheme:?} {falling:?}");
        close(falling[0].1, -c, 1e-12);
        let touching = falls(scheme, Ceiling, [1.0, 0.0], 6.0, 0.0);
        assert!(touching.is_empty(), "{scheme:?} {touching:?}");
    }
}

/// `sin² t cos t` has extrema where `tan² t = 2` and at multiples of π.
#[test]
fn extrema_of_functions_are_found_with_their_derivatives() {
    struct Product;
    impl Watch for Product {
        fn value<T: Scalar>(&self, _t: T, x: &[T], p: &[T]) -> T {
            x[0] * x[0] * (x[1] + p[0])
        }
    }
    for scheme in ALL {
        let (mut extrema, mut found) = (Extrema::default(), Vec::<Extremum<Dual64>>::new());
        let mut x = [0.0, 1.0].map(Dual64::from);
        let p = [Dual64::from(0.0).derivative()];
        Flow::new(Settings::new(scheme, 1e-13))
            .unwrap()
            .observe(&Oscillator, 0.0.into(), 3.0.into(), &mut x, &p, |step| {
                extrema.search(&Product, step, |extremum| found.push(extremum));
                ControlFlow::Continue(())
            })
            .unwrap();
        let first = 2f64.sqrt().atan();
        assert_eq!(found.len(), 2, "{scheme:?}");
        for (found, t) in found.iter().zip([first, PI - first]) {
            close(found.place.re * 3.0, t, 1e-10);
            close(found.value.re, t.sin().powi(2) * t.cos(), 1e-12);
            // The value moves as the function itself does, `∂h/∂p = sin² t`.
            close(found.value.eps, t.sin().powi(2), 1e-10);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    /// Every fall of `p + sin 2t − sin t` is found: between two samples of a fine grid there is one
    /// where the sign changes from positive to negative.
    #[test]
    fn every_fall_is_found(p in -1.0..1.0f64) {
        let h = |t: f64| (2.0 * t).sin() - t.sin() + p;
        let grid = |k: usize| 12.0 * k as f64 / 20_000.0;
        let crossing = |k: &usize| h(grid(*k)) > 0.0 && h(grid(*k + 1)) <= 0.0;
        let expected: Vec<f64> = (0..20_000).filter(crossing).map(grid).collect();
        let found = falls(Scheme::DormandPrince8, Moving, [0.0, 1.0], 12.0, p);
        prop_assert_eq!(found.len(), expected.len());
        for ((t, _), expected) in found.iter().zip(expected) {
            prop_assert!(h(*t).abs() < 1e-11 && (t - expected).abs() < 1e-3);
        }
    }
}
