//! Promise: flows are those of exact solutions, to the tolerance asked for, and so are their
//! derivatives.

use crate::common::falls_with_order;
use num_dual::{Dual64, DualNum, DualSVec64, HyperDual64};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use tangency::core::ode::{Extrema, Extremum, Flow, Scheme, Settings, Statistics};
use tangency::core::problem::State;
use tangency::core::scalar::Scalar;
use tangency::problems::mita::Block;
use tangency::vector_field;

const ALL: [Scheme; 3] = [Scheme::DormandPrince8, Scheme::DormandPrince5, Scheme::Rodas5P];

vector_field! {
    /// `x'' + c x' + x = cos ωt`.
    struct Forced [x, v; omega, c; t] {
        d/dt x = v;
        d/dt v = (omega * t).cos() - x - c * v;
    }
}

vector_field! {
    /// The plane problem of two bodies.
    struct Kepler [x, y, u, v] {
        let cube = (x * x + y * y).powf(1.5);
        d/dt x = u;
        d/dt y = v;
        d/dt u = -x / cube;
        d/dt v = -y / cube;
    }
}

vector_field! {
    /// Nonlinear and forced: `x = exp(sin t²)`, `y = exp(cos t²)`.
    struct Exponential [x, y;; t] {
        d/dt x = t * 2.0 * x * y.ln();
        d/dt y = t * -2.0 * y * x.ln();
    }
}

vector_field! {
    /// `x' = r x (1 − x)`.
    struct Logistic [x; r] {
        d/dt x = r * x * (T::one() - x);
    }
}

/// Voltage, frequency and damping of the block of Mita's actuator.
const MITA: [f64; 3] = [0.2, 0.45, 0.04];

fn flow<T: Scalar>(scheme: Scheme, tolerance: f64) -> Flow<T> {
    Flow::new(Settings::new(scheme, tolerance)).unwrap()
}

/// A flow with steps of `1/n` whatever their error.
fn steps<T: Scalar>(scheme: Scheme, n: usize) -> Flow<T> {
    let step = 1.0 / n as f64;
    let settings = Settings::new(scheme, 1e6);
    Flow::new(Settings { first_step: Some(step), largest_step: step, ..settings }).unwrap()
}

fn exponential(t: f64) -> [f64; 2] {
    [(t * t).sin().exp(), (t * t).cos().exp()]
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// `x'' + c x' + x = cos ωt` from rest: amplitude and phase of the forced part, decay of the free
/// one.
fn forced<T: Scalar>(t: T, omega: T, c: T) -> [T; 2] {
    let (a, b) = (T::one() - omega * omega, c * omega);
    let square = a * a + b * b;
    let particular = |t: T| (a * (omega * t).cos() + b * (omega * t).sin()) / square;
    let slope = |t: T| (b * (omega * t).cos() - a * (omega * t).sin()) * omega / square;
    let (rate, damped) = (c * 0.5, (T::one() - c * c * 0.25).sqrt());
    let (x, v) = (-particular(T::zero()), -slope(T::zero()));
    let (cosine, sine) = ((damped * t).cos(), (damped * t).sin());
    let decay = (-rate * t).exp();
    [
        particular(t) + decay * (x * cosine + (v + rate * x) / damped * sine),
        slope(t) + decay * (v * cosine - (rate * v + x) / damped * sine),
    ]
}

#[test]
fn exact_solutions_are_met() {
    for scheme in ALL {
        for tolerance in [1e-5, 1e-8, 1e-11] {
            let mut flow = flow(scheme, tolerance);
            let mut x = [0.0, 0.0];
            flow.advance(&Forced, 0.0, 20.0, &mut x, &[0.7, 0.1]).unwrap();
            let error = distance(&x, &forced(20.0, 0.7, 0.1));
            assert!(error < 30.0 * tolerance, "{scheme:?} {tolerance:e}: {error:e}");
            let mut x = exponential(0.0);
            flow.advance(&Exponential, 0.0, 2.5, &mut x, &[]).unwrap();
            let error = distance(&x, &exponential(2.5));
            assert!(error < 100.0 * tolerance, "{scheme:?} {tolerance:e}: {error:e}");
        }
    }
}

/// One revolution on an ellipse of eccentricity 1/2, and its energy.
#[test]
fn kepler_returns() {
    for scheme in ALL {
        let start = [0.5, 0.0, 0.0, 3f64.sqrt()];
        let mut x = start;
        flow(scheme, 1e-12).advance(&Kepler, 0.0, TAU, &mut x, &[]).unwrap();
        let energy = 0.5 * (x[2] * x[2] + x[3] * x[3]) - x[0].hypot(x[1]).recip();
        assert!((energy + 0.5).abs() < 2e-11, "{scheme:?}: {:e}", energy + 0.5);
        assert!(distance(&x, &start) < 2e-10, "{scheme:?}: {:e}", distance(&x, &start));
    }
}

/// Dividing all steps by a factor divides the error by its power `order`.
#[test]
fn orders_are_those_of_theory() {
    for (scheme, counts) in [
        (Scheme::DormandPrince8, [30, 40, 50, 60]),
        (Scheme::DormandPrince5, [200, 250, 320, 400]),
        (Scheme::Rodas5P, [200, 250, 320, 400]),
    ] {
        let measured = counts.map(|n| {
            let mut x = exponential(0.0);
            let statistics = steps(scheme, n).advance(&Exponential, 0.0, 2.0, &mut x, &[]).unwrap();
            assert_eq!((statistics.accepted, statistics.rejected), (n, 0));
            (1.0 / n as f64, distance(&x, &exponential(2.0)))
        });
        falls_with_order(&format!("{scheme:?}"), &measured, scheme.order() as f64);
    }
}

/// The error within one step from an exact state: `h^(order + 1)` by a shorter step, and that of
/// the interpolant by dense output.
#[test]
fn orders_within_a_step_are_those_of_theory() {
    for (scheme, dense, h) in [
        (Scheme::DormandPrince8, 7, 0.16),
        (Scheme::DormandPrince5, 4, 0.025),
        (Scheme::Rodas5P, 4, 0.04),
    ] {
        let errors = |h: f64| {
            let mut errors = [0.0; 2];
            steps(scheme, 1)
                .observe(&Exponential, 1.1, h, &mut exponential(1.1), &[], |step| {
                    for fraction in [0.3, 0.45, 0.6, 0.8] {
                        let exact = exponential(1.1 + fraction * h);
                        let mut x = [0.0; 2];
                        step.interpolate(fraction, &mut x);
                        errors[0] = distance(&x, &exact).max(errors[0]);
                        step.state(fraction, &mut x);
                        errors[1] = distance(&x, &exact).max(errors[1]);
                    }
                    ControlFlow::Continue(())
                })
                .unwrap();
            errors
        };
        let measured = [1.0, 0.8, 0.63, 0.5].map(|part| (part * h, errors(part * h)));
        for (k, theory) in [dense + 1, scheme.order() + 1].into_iter().enumerate() {
            let of_one = measured.map(|(h, errors)| (h, errors[k]));
            falls_with_order(&format!("{scheme:?} {k}"), &of_one, theory as f64);
        }
    }
}

/// Dense output and shorter steps agree with the ends of a step.
#[test]
fn a_step_meets_its_ends() {
    for scheme in ALL {
        flow(scheme, 1e-8)
            .observe(&Block, 0.3, 5.0, &mut [0.1, 0.2], &MITA, |step| {
                let (start, end) = (step.start().to_vec(), step.end().to_vec());
                let mut x = [0.0; 2];
                step.interpolate(0.0, &mut x);
                assert!(distance(&x, &start) < 1e-15);
                step.interpolate(1.0, &mut x);
                assert!(distance(&x, &end) < 1e-15);
                step.state(1.0, &mut x);
                assert!(distance(&x, &end) < 1e-13, "{scheme:?}: {:e}", distance(&x, &end));
                step.state(0.0, &mut x);
                assert!(distance(&x, &start) < 1e-15);
                let (from, to) = step.span();
                assert_eq!((step.place(0.0), step.time(0.0)), (from, 0.3 + 5.0 * from));
                assert!((step.place(1.0) - to).abs() < 1e-15);
                ControlFlow::Continue(())
            })
            .unwrap();
    }
}

/// One period of the nonimpacting orbit of Mita's actuator, to 5e-12 in at most 280 evaluations.
#[test]
fn mita_costs_what_is_claimed() {
    let (p, length) = (MITA, PI / 0.45);
    let start = [-0.1193425866519154, -0.03360474279494714];
    let mut exact = start;
    steps(Scheme::DormandPrince8, 400).advance(&Block, 0.0, length, &mut exact, &p).unwrap();
    let mut x = start;
    let mut flow = flow(Scheme::DormandPrince8, 1.5e-11);
    let statistics = flow.advance(&Block, 0.0, length, &mut x, &p).unwrap();
    assert!(distance(&x, &exact) < 5e-12, "{:e}", distance(&x, &exact));
    assert!(distance(&x, &start) < 5e-12, "the orbit is closed");
    assert!(statistics.evaluations <= 280, "{statistics:?}");
}

type Four = DualSVec64<4>;

/// Mita's block with derivatives with respect to both states and both parameters, over a period
/// that depends on one.
fn with_derivatives(flow: &mut Flow<Four>) -> ([Four; 2], Statistics) {
    let mut x = [Four::from(0.1).derivative(0), Four::from(0.2).derivative(1)];
    let p = [Four::from(0.2).derivative(2), Four::from(0.45).derivative(3), Four::from(0.04)];
    let statistics = flow.advance(&Block, Four::from(0.0), p[1].recip() * PI, &mut x, &p).unwrap();
    (x, statistics)
}

#[test]
fn real_parts_of_dual_flows_are_the_real_flow() {
    for scheme in ALL {
        let mut x = [0.1, 0.2];
        let real =
            flow(scheme, 1e-10).advance(&Block, 0.0, 0.45f64.recip() * PI, &mut x, &MITA).unwrap();
        let (dual, statistics) = with_derivatives(&mut flow(scheme, 1e-10));
        assert_eq!(real, statistics, "{scheme:?}: the same steps");
        assert!(distance(&[dual[0].re, dual[1].re], &x) < 1e-14, "{scheme:?}");
    }
}

/// Control of derivatives takes more steps where they need them, and makes them more accurate.
#[test]
fn derivatives_may_control_the_step() {
    let size = |x: &Four| x.eps.0.map_or(0.0, |eps| eps.amax()).max(x.re.abs());
    let exact = with_derivatives(&mut steps(Scheme::DormandPrince8, 400)).0;
    let error = |x: [Four; 2]| {
        let parts = |x: Four| x.eps.0.unwrap();
        (0..2).map(|i| (parts(x[i]) - parts(exact[i])).amax()).fold(0.0, f64::max)
    };
    let (real, _) = with_derivatives(&mut flow(Scheme::DormandPrince8, 1e-8));
    let (all, _) = with_derivatives(&mut flow(Scheme::DormandPrince8, 1e-8).measured_by(size));
    assert!(
        error(all) < 3e-7 && error(all) < 0.5 * error(real),
        "{:e} {:e}",
        error(all),
        error(real)
    );
}

/// First derivatives of a linear forced oscillator by time, frequency and damping: those of the
/// closed form.
#[test]
fn variational_flows_are_derivatives_of_closed_forms() {
    type Three = DualSVec64<3>;
    for scheme in ALL {
        let [t, omega, c] = [9.0, 0.7, 0.1].map(Three::from);
        let (t, omega, c) = (t.derivative(0), omega.derivative(1), c.derivative(2));
        let mut x = [Three::from(0.0); 2];
        flow(scheme, 1e-11).advance(&Forced, Three::from(0.0), t, &mut x, &[omega, c]).unwrap();
        for (x, exact) in x.iter().zip(forced(t, omega, c)) {
            let difference = *x - exact;
            let error = difference.re.abs().max(difference.eps.0.unwrap().amax());
            assert!(error < 2e-9, "{scheme:?}: {error:e}");
        }
    }
}

/// Second derivatives of the logistic flow by its start and its rate.
#[test]
fn nested_duals_carry_second_derivatives() {
    let closed = |x: HyperDual64, r: HyperDual64, t: f64| {
        let growth = (r * t).exp();
        x * growth / (x * (growth - 1.0) + 1.0)
    };
    for scheme in ALL {
        let x0 = HyperDual64::new(0.2, 1.0, 0.0, 0.0);
        let r = HyperDual64::new(1.5, 0.0, 1.0, 0.0);
        let mut x = [x0];
        let (t0, length) = (HyperDual64::from(0.0), HyperDual64::from(2.0));
        flow(scheme, 1e-11).advance(&Logistic, t0, length, &mut x, &[r]).unwrap();
        let difference = x[0] - closed(x0, r, 2.0);
        for part in [difference.re, difference.eps1, difference.eps2, difference.eps1eps2] {
            assert!(part.abs() < 1e-8, "{scheme:?}: {part:e}");
        }
    }
}

vector_field! {
    /// `x = sin t + a sin 3t` as a flow: extrema at the ends of steps, inside them, and two close
    /// together.
    struct TwoTones [x; a; t] {
        d/dt x = t.cos() + a * 3.0 * (t * 3.0).cos();
    }
}

fn extrema<T: Scalar>(scheme: Scheme, tolerance: f64, a: T) -> Vec<Extremum<T>> {
    let (mut search, mut found) = (Extrema::default(), Vec::new());
    flow(scheme, tolerance)
        .observe(&TwoTones, T::zero(), T::constant(TAU), &mut [T::zero()], &[a], |step| {
            search.search(&State(0), step, |extremum| found.push(extremum));
            ControlFlow::Continue(())
        })
        .unwrap();
    found
}

/// For `a > 1/9` two maxima surround a minimum at `π/2`, and likewise at `3π/2`.
#[test]
fn extrema_are_found_with_their_derivatives() {
    for scheme in ALL {
        for a in [0.112, 0.12, 0.2, 0.5] {
            // x' = cos t (1 + 3a (4 cos²t − 3)), so that cos² t = (9a − 1)/(12a) beside t = π/2.
            let aside = |a: Dual64| ((a * 9.0 - 1.0) / (a * 12.0)).sqrt().acos();
            let value = |t: Dual64, a: Dual64| t.sin() + a * (t * 3.0).sin();
            let a = Dual64::from(a).derivative();
            let (first, half) = (aside(a), Dual64::from(PI));
            let exact = [first, half * 0.5, -first + PI, first + PI, half * 1.5, -first + TAU];
            let found = extrema(scheme, 1e-12, a);
            assert_eq!(found.len(), 6, "{scheme:?} {}: {found:?}", a.re);
            for (found, t) in found.iter().zip(exact) {
                let (place, value) = (found.place * TAU - t, found.value - value(t, a));
                assert!(place.re.abs() < 1e-10, "{scheme:?} {}: {place}", a.re);
                assert!(value.re.abs() < 1e-12, "{scheme:?} {}: {value}", a.re);
                // Steps are controlled by real parts; derivatives have fewer digits.
                assert!(place.eps.abs() < 1e-7 && value.eps.abs() < 1e-9, "{place} {value}");
            }
        }
        assert_eq!(extrema(scheme, 1e-12, 0.1).len(), 2, "one maximum and one minimum only");
    }
}

/// Rates 0.04, 3e7 and 1e4 (Robertson 1966); the values at 1e11 are those of the test set of Mazzia
/// and Magherini (2008).
#[test]
fn robertson_is_integrated_to_the_end() {
    vector_field! {
        /// Autocatalysis.
        struct Robertson [a, b, c] {
            let (slow, fast) = (a * 0.04 - b * c * 1e4, b * b * 3e7);
            d/dt a = -slow;
            d/dt b = slow - fast;
            d/dt c = fast;
        }
    }
    let mut x: [f64; 3] = [1.0, 0.0, 0.0];
    let settings = Settings { absolute: 1e-18, ..Settings::new(Scheme::Rodas5P, 1e-9) };
    let statistics =
        Flow::new(settings).unwrap().advance(&Robertson, 0.0, 1e11, &mut x, &[]).unwrap();
    let exact = [0.2083340149701255e-7, 0.8333360770334713e-13, 0.999999979166505];
    for (x, exact) in x.iter().zip(exact) {
        assert!((x / exact - 1.0).abs() < 1e-7, "{x:e} {exact:e} {statistics:?}");
    }
    assert!(statistics.accepted < 1500, "{statistics:?}");
}

/// `x' = λ(x − a cos t) − a sin t`: the flow is `a cos t` for every λ, and so is its derivative
/// with respect to `a`.
#[test]
fn stiff_flows_have_derivatives_too() {
    vector_field! {
        /// Prothero and Robinson's field with an amplitude.
        struct Stiff [x; lambda, a; t] {
            d/dt x = lambda * (x - a * t.cos()) - a * t.sin();
        }
    }
    let (zero, lambda) = (Dual64::from(0.0), Dual64::from(-1e6));
    let a = Dual64::from(2.0).derivative();
    let mut x = [a];
    flow(Scheme::Rodas5P, 1e-9)
        .advance(&Stiff, zero, Dual64::from(3.0), &mut x, &[lambda, a])
        .unwrap();
    assert!((x[0].re - 2.0 * 3f64.cos()).abs() < 1e-8, "{}", x[0]);
    assert!((x[0].eps - 3f64.cos()).abs() < 1e-8, "{}", x[0]);
}

#[test]
fn nothing_is_allocated_after_the_first_call() {
    for scheme in ALL {
        let mut flow = flow(scheme, 1e-9);
        let mut search = Extrema::default();
        let mut run = || {
            search.restart();
            let p = MITA.map(Four::from);
            let mut x = [Four::from(0.1).derivative(0), Four::from(0.2).derivative(1)];
            flow.observe(&Block, Four::from(0.0), Four::from(7.0), &mut x, &p, |step| {
                search.search(&State(0), step, |extremum| {
                    std::hint::black_box(extremum);
                });
                ControlFlow::Continue(())
            })
            .unwrap()
        };
        let first = run();
        let mut second = None;
        let counted = allocation_counter::measure(|| second = Some(run()));
        assert_eq!(counted.count_total, 0, "{scheme:?}");
        assert_eq!(second, Some(first), "nothing is remembered");
    }
}

/// An observer may end the flow at the end of any step.
#[test]
fn observers_end_a_flow() {
    let mut x = [0.2];
    let mut end = 0.0;
    flow(Scheme::DormandPrince8, 1e-10)
        .observe(&Logistic, 0.0, 4.0, &mut x, &[1.0], |step| {
            end = step.time(1.0);
            if step.end()[0] > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap();
    let exact = 0.2 * f64::exp(end) / (0.8 + 0.2 * f64::exp(end));
    assert!(end < 4.0 && x[0] > 0.5 && (x[0] - exact).abs() < 1e-9, "{end} {x:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn backward_undoes_forward(q in -0.3..0.3f64, u in -0.3..0.3f64, t in -5.0..5.0f64, l in 0.1..8.0f64) {
        for scheme in ALL {
            let mut flow = flow(scheme, 1e-10);
            let mut x = [q, u];
            flow.advance(&Block, t, l, &mut x, &MITA).unwrap();
            flow.advance(&Block, t + l, -l, &mut x, &MITA).unwrap();
            prop_assert!(distance(&x, &[q, u]) < 1e-8, "{:?}: {:e}", scheme, distance(&x, &[q, u]));
        }
    }

    #[test]
    fn parts_make_the_whole(q in -0.3..0.3f64, u in -0.3..0.3f64, l in 0.1..8.0f64, part in 0.05..0.95f64) {
        for scheme in ALL {
            let mut flow = flow(scheme, 1e-10);
            let (mut x, mut y) = ([q, u], [q, u]);
            flow.advance(&Block, 0.0, l, &mut x, &MITA).unwrap();
            flow.advance(&Block, 0.0, l * part, &mut y, &MITA).unwrap();
            flow.advance(&Block, l * part, l - l * part, &mut y, &MITA).unwrap();
            prop_assert!(distance(&x, &y) < 1e-8, "{:?}: {:e}", scheme, distance(&x, &y));
        }
    }
}
