//! Promise: shooting has the residuals, derivatives, values and extrema of its trajectories.

use num_dual::Dual64;
use tangency::core::bvp::{
    Block, BoundaryProblem, Ends, Interval, IntoEquations, MonitoredFunctions, Shooting, Span,
};
use tangency::core::failure::{Failure, FlowError, OutOfDomain};
use tangency::core::ode::{Flow, Scheme};
use tangency::core::problem::Observable;
use tangency::core::scalar::Scalar;

/// `x'' + c x' + ω² x = a cos t` over a period, as two segments with `k` further parameters of no
/// effect.
struct Oscillator(usize);

impl BoundaryProblem for Oscillator {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![vec!["x".into(), "v".into()]; 2]
    }
    fn parameters(&self) -> Vec<String> {
        (0..4 + self.0).map(|k| format!("p{k}")).collect()
    }
    fn field<T: Scalar>(&self, _segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = q[2] * t.cos() - q[0] * q[0] * x[0] - q[1] * x[1];
    }
    fn duration<T: Scalar>(&self, segment: usize, q: &[T]) -> T {
        q[3] * (1.0 + segment as f64)
    }
    fn boundary<T: Scalar>(&self, _ends: Ends<T>, _q: &[T], _b: &mut [T]) {}
    fn domain(&self, _segment: usize, x: &[f64], _q: &[f64]) -> Result<(), OutOfDomain> {
        if x[0] < 10.0 { Ok(()) } else { Err(OutOfDomain::new("x", x[0], "keep it below 10")) }
    }
}

const SPAN: Span = Span { segment: 1, start: 0.25, end: 0.75 };
const NODES: [f64; 4] = [0.3, -0.2, 0.5, 0.1];

/// Derivatives of the residual by nodes and numbers, in any number of directions, are those of dual
/// residuals, one direction at a time.
#[test]
fn linearisations_of_all_widths_are_derivatives_of_the_residual() {
    for extra in [0, 2, 5, 12] {
        let problem = Oscillator(extra).into_equations();
        let mut q = vec![1.3, 0.1, 0.4, 2.0];
        q.resize(4 + extra, 0.0);
        for count in 0..=q.len() {
            let active: Vec<usize> = (0..count).rev().collect();
            let mut shooting = Shooting::new(Scheme::DormandPrince8, 1e-10).unwrap();
            let (mut residual, mut nodes) = ([0.0; 2], [f64::NAN; 8]);
            let mut numbers = vec![f64::NAN; 2 * count];
            let block = Block { residual: &mut residual, nodes: &mut nodes, numbers: &mut numbers };
            let interval = Interval { problem: &*problem, span: SPAN, nodes: &NODES, q: &q };
            let unwatched = &mut |_, _, _| {};
            shooting
                .linearise(interval, &active, block, MonitoredFunctions::default(), unwatched)
                .unwrap();
            for direction in 0..4 + count {
                let mut dual: Vec<Dual64> = NODES.map(Dual64::from).to_vec();
                dual.extend(q.iter().map(|q| Dual64::from(*q)));
                let place = direction.checked_sub(4).map_or(direction, |k| 4 + active[k]);
                dual[place] = dual[place].derivative();
                let mut r = [Dual64::from(0.0); 2];
                let mut work = Flow::default();
                let (states, q) = dual.split_at(4);
                let interval = Interval { problem: &*problem, span: SPAN, nodes: states, q };
                shooting.residual(interval, &mut work, &mut r).unwrap();
                for (i, r) in r.iter().enumerate() {
                    let part = match direction.checked_sub(4) {
                        None => nodes[i * 4 + direction],
                        Some(k) => numbers[i * count + k],
                    };
                    assert!((r.re - residual[i]).abs() < 1e-14);
                    assert!((r.eps - part).abs() < 1e-12, "{direction}: {} {part}", r.eps);
                }
            }
        }
    }
}

/// `x = cos t` (ω = 1, no damping, no force) from the middle of a segment of duration 8: its value
/// within an interval, its extrema at π and 2π between `t = 2` and `t = 7`, and its rise at 3π/2.
#[test]
fn values_and_extrema_are_those_of_the_trajectory() {
    let (problem, q) = (Oscillator(0).into_equations(), [1.0, 0.0, 0.0, 4.0]);
    let span = Span { segment: 1, start: 0.25, end: 0.875 };
    let nodes = [2f64.cos(), -2f64.sin(), 7f64.cos(), -7f64.sin()];
    let mut shooting = Shooting::default();
    let (mut x, mut work) = ([0.0; 2], Flow::default());
    let interval = Interval { problem: &*problem, span, nodes: &nodes, q: &q };
    shooting.residual(interval, &mut work, &mut x).unwrap();
    assert!(x[0].abs().max(x[1].abs()) < 2e-12, "{x:?}");
    // The states before the last place come from dense output.
    for (places, tolerance) in [
        (&[0.0][..], 2e-12),
        (&[0.3], 2e-12),
        (&[1.0, 1.0], 2e-12),
        (&[0.0, 0.0, 0.1, 0.3, 0.3, 0.7, 1.0], 1e-9),
    ] {
        let mut seen = 0;
        let mut check = |k: usize, x: &[f64]| {
            assert_eq!(k, seen);
            seen += 1;
            let t: f64 = 2.0 + 5.0 * places[k];
            let error = (x[0] - t.cos()).abs().max((x[1] + t.sin()).abs());
            let tolerance = if k + 1 == places.len() { 2e-12 } else { tolerance };
            assert!(error < tolerance, "{error} at {t}");
        };
        shooting.values(interval, places, &mut work, &mut x, &mut check).unwrap();
        assert_eq!(seen, places.len());
    }
    let mut all = [Vec::new(), Vec::new()];
    let mut visit = |k: usize, place, value| all[k].push((2.0 + 5.0 * place, value));
    let through = [[Observable::State(0), Observable::State(1)]];
    let watched =
        MonitoredFunctions { extrema: &[Observable::State(0)], scales: &[1.0], rises: &through };
    shooting.extrema(interval, watched, None, &mut visit).unwrap();
    let [found, risen] = all;
    let (time, speed) = risen[0];
    assert!((time - 1.5 * std::f64::consts::PI).abs() < 1e-11 && (speed - 1.0).abs() < 2e-12);
    let exact = [2.0, std::f64::consts::PI, std::f64::consts::TAU, 7.0];
    assert_eq!(found.len(), exact.len(), "{found:?}");
    for ((t, x), exact) in found.iter().zip(exact) {
        // An error of the place moves the value by its square.
        assert!((t - exact).abs() < 1e-10 && (x - exact.cos()).abs() < 2e-12, "{t} {x}");
    }
}

#[test]
fn finer_shooting_ends_where_rounding_begins() {
    let mut shooting = Shooting::new(Scheme::DormandPrince8, 1e-9).unwrap();
    let mut tolerances = Vec::new();
    while let Some(finer) = shooting.finer() {
        tolerances.push(finer.settings().relative);
        shooting = finer;
    }
    let expected = [1e-11, 1e-13, 1e-14];
    assert_eq!(tolerances.len(), 3);
    assert!(tolerances.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-12));
}

#[test]
fn leaving_the_domain_is_an_error_of_every_evaluation() {
    let (problem, q, nodes) =
        (Oscillator(0).into_equations(), [1.0, 0.0, 1e3, 2.0], [9.0, 9.0, 0.0, 0.0]);
    let mut shooting = Shooting::default();
    let (mut x, mut work) = ([0.0; 2], Flow::default());
    let interval = Interval { problem: &*problem, span: SPAN, nodes: &nodes, q: &q };
    let error = shooting.residual(interval, &mut work, &mut x).unwrap_err();
    let Failure::Flow(FlowError::OutOfDomain { left, .. }) = &error else { panic!("{error}") };
    assert_eq!(left.quantity, "x");
    let (mut nodes_part, mut r) = ([0.0; 8], [0.0; 2]);
    let block = Block { residual: &mut r, nodes: &mut nodes_part, numbers: &mut [] };
    let linear = shooting
        .linearise(interval, &[], block, MonitoredFunctions::default(), &mut |_, _, _| {})
        .unwrap_err();
    assert_eq!(error, linear);
}
