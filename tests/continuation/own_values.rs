//! Promise: an event that cannot be evaluated ends the branch or is said, and special points have
//! the values of their own matrix.

use crate::common::close;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use tangency::core::continuation::{Continuation, End, Event, Settings};
use tangency::core::problem::{Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind};
use tangency::zero_problem;

zero_problem! {
    /// `x = p`, with the monitor `1/p`: finite on both sides of `p = 0`, and not on it.
    struct Pole [x; p] {
        0 = x - p;
        monitor reciprocal = p.recip();
    }
}

#[test]
fn a_bound_at_a_pole_of_a_monitor_ends_the_branch() {
    let mut pole = Dense::new(Pole);
    let run = Continuation::new(&mut pole).from(&[-1.0]).at("p", -1.0);
    let settings = Settings { max_points: 50, ..Settings::default() };
    let branch = run.along("p", -1.0..=0.0).settings(settings).trace().unwrap();
    assert!(matches!(&branch.ends[1], End::ParameterBound { name, value: 0.0 } if name == "p"));
    assert!(branch.points.iter().all(|point| point.parameters[0] <= 0.0), "beyond the bound");
    let end = branch.special.last().unwrap();
    assert!(!end.converged && end.parameters[0] < 0.0 && end.parameters[0] > -1e-6, "{end:?}");
    assert!(end.error >= -end.parameters[0], "{} at {}", end.error, end.parameters[0]);
}

/// An event that is not a bound is passed with a warning.
#[test]
fn an_event_at_a_pole_is_said() {
    let mut pole = Dense::new(Pole);
    let run = Continuation::new(&mut pole).from(&[-1.0]).at("p", -1.0).mark("p", 0.0);
    let branch = run.along("p", -1.0..=1.0).trace().unwrap();
    assert!(branch.of_kind(Kind::UZ).next().is_none());
    let [warning] = &branch.warnings[..] else { panic!("{:?}", branch.warnings) };
    assert!(warning.contains("p = 0") && warning.contains("reciprocal"), "{warning}");
}

zero_problem! {
    /// `x' = p + x² − x⁴/4` along its folds: the eigenvalue is `2x − x³`.
    struct Quartic [x; p] {
        0 = p + x.powi(2) - x.powi(4) * 0.25;
    }
}

#[test]
fn saved_points_have_the_eigenvalues_of_their_own_matrix() {
    let mut quartic = Dense::new(Quartic);
    let settings = Settings { save_every: 1, ..Settings::default() };
    let run = Continuation::new(&mut quartic).from(&[-3.0]).at("p", 11.25).settings(settings);
    let branch = run.along("p", -3.0..=12.0).trace().unwrap();
    assert!(branch.of_kind(Kind::RG).count() > 10);
    for point in &branch.special {
        if ![Kind::RG, Kind::EP].contains(&point.kind) {
            continue;
        }
        let x = point.state[0];
        close(point.eigenvalues[0].0, 2.0 * x - x.powi(3), 1e-12);
    }
}

/// `x_i = p` for 64 unknowns.
struct Copies;

impl ZeroProblem for Copies {
    fn names(&self) -> Names {
        Names::new([("x", 64)], ["p"])
    }
    fn residual<T: Scalar>(&self, x: &[T], p: &[T], r: &mut [T]) {
        r.iter_mut().zip(x).for_each(|(r, x)| *r = *x - p[0]);
    }
}

/// Eight components of a gradient cost one call.
#[test]
fn gradients_of_functions_take_eight_components_at_once() {
    let calls = Arc::new(AtomicUsize::new(0));
    let counted = calls.clone();
    let mut copies = Dense::new(Copies);
    let squares = Event::zero_of("Σ x² = 1", move |x, _| {
        counted.fetch_add(1, Relaxed);
        x.iter().map(|x| *x * *x).sum::<tangency::core::scalar::Chunk>() - 1.0
    });
    let run = Continuation::new(&mut copies).from(&[0.0; 64]).along("p", 0.0..=1.0);
    let branch = run.event(squares).trace().unwrap();
    let found = branch.of_kind(Kind::UZ).next().unwrap();
    close(found.parameters[0], 0.125, 1e-13);
    // One gradient from single components takes 65 calls.
    let calls = calls.load(Relaxed);
    assert!(calls < 9 * 6 + 2 * branch.points.len() + 20, "{calls} calls");
}
