//! Promise: a branch does not depend on units, ends for a reason that is typed, is recognised when
//! it closes, and can be restarted from any of its labels.

use crate::common::{
    Bratu, Circle, CuspForm, CuspSlice, Oxidation, PredatorPrey, close, first, values,
};
use tangency::core::cancel::CancelToken;
use tangency::core::continuation::{
    Branch, Continuation, End, Event, NewtonError, Observer, Point, Settings, TraceError,
};
use tangency::core::failure::{Failure, OutOfDomain, one_line};
use tangency::core::problem::{Dynamics, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind, System};
use tangency::problems::classic::ParallelPlate;
use tangency::zero_problem;

/// The CO problem in other units: unknowns times `unknown`, q₂ times `parameter`, rows times `row`.
/// Where rows are scaled differently it is no longer the same flow, only the same curve.
struct Rescaled {
    unknown: f64,
    parameter: f64,
    row: [f64; 3],
}

impl ZeroProblem for Rescaled {
    fn names(&self) -> Names {
        Oxidation.names()
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let u = [u[0] / self.unknown, u[1] / self.unknown, u[2] / self.unknown];
        Oxidation.residual(&u, &[p[0] / self.parameter, p[1]], r);
        r.iter_mut().zip(self.row).for_each(|(r, scale)| *r *= scale);
    }
    fn dynamics(&self) -> Dynamics {
        if self.row[0] == self.row[1] { Dynamics::Flow } else { Dynamics::None }
    }
}

#[test]
fn units_do_not_matter() {
    let trace = |unknown: f64, parameter: f64, row: [f64; 3]| {
        let mut system = Dense::new(Rescaled { unknown, parameter, row });
        Continuation::new(&mut system)
            .from(&[0.001137, 0.891483, 0.062345].map(|u| u * unknown))
            .at("q2", 2.0 * parameter)
            .at("k", 0.4)
            .along("q2", 0.5 * parameter..=2.0 * parameter)
            .trace()
            .unwrap()
    };
    let plain = trace(1.0, 1.0, [1.0; 3]);
    for (unknown, parameter, row) in
        [(1e6, 1e-3, [1.0; 3]), (1e-6, 1e3, [1e5, 1e-4, 1e2]), (3.0, 7.0, [1e-8; 3])]
    {
        let other = trace(unknown, parameter, row);
        assert_eq!(plain.points.len(), other.points.len());
        for (a, b) in plain.points.iter().zip(&other.points) {
            close(a.parameters[0], b.parameters[0] / parameter, 1e-9);
            assert!(b.unstable.is_none() || a.unstable == b.unstable);
        }
        let flow = other.points[0].unstable.is_some();
        let special: Vec<_> = plain.special.iter().filter(|s| flow || s.kind != Kind::HB).collect();
        assert_eq!(special.len(), other.special.len());
        for (a, b) in special.iter().zip(&other.special) {
            assert_eq!((a.kind, a.after), (b.kind, b.after));
            close(a.parameters[0], b.parameters[0] / parameter, 1e-13);
            close(a.state[1], b.state[1] / unknown, 1e-10);
        }
    }
}

/// From zero states, where only the tangent tells the size of the unknowns.
#[test]
fn units_do_not_matter_at_vanishing_unknowns() {
    struct Plate(f64, f64);
    impl ZeroProblem for Plate {
        fn names(&self) -> Names {
            ParallelPlate.names()
        }
        fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
            ParallelPlate.residual(&[u[0] / self.0], &[p[0] / self.1], r);
        }
    }
    let trace = |u: f64, p: f64| {
        let mut system = Dense::new(Plate(u, p));
        Continuation::new(&mut system).along("load", 0.0..=0.2 * p).trace().unwrap()
    };
    let (plain, other) = (trace(1.0, 1.0), trace(1e-6, 1e3));
    assert_eq!(plain.points.len(), other.points.len());
    for (a, b) in plain.points.iter().zip(&other.points) {
        close(a.parameters[0], b.parameters[0] / 1e3, 1e-9);
    }
}

/// A circle closes from whichever point one starts, is traced once, and has its two folds once
/// each.
#[test]
fn closed_curves_are_recognised() {
    for angle in [0.0, 0.3, 1.0, 1.5, 2.0, 3.0, 4.5, 5.9] {
        for radius in [0.01, 1.0] {
            let (p, x) = (radius * f64::cos(angle), radius * f64::sin(angle));
            let mut system = Dense::new(Circle { radius });
            let branch = Continuation::new(&mut system)
                .from(&[x])
                .at("p", p)
                .along("p", -2.0 * radius..=2.0 * radius)
                .trace()
                .unwrap();
            let End::Closed { points } = branch.ends[1] else {
                panic!("{angle}: {:?}", branch.ends)
            };
            assert_eq!(branch.ends[0], branch.ends[1]);
            assert_eq!(branch.points.len(), points + 1, "the start is the last point again");
            assert!((15..100).contains(&points), "{points}");
            let [first, last] = [&branch.points[0], &branch.points[points]];
            assert_eq!((&first.parameters, &first.monitors), (&last.parameters, &last.monitors));
            let folds = values(&branch, Kind::LP, "p");
            assert_eq!(folds.len(), 2, "from {angle}");
            close(folds[0], -radius, 1e-14 * radius);
            close(folds[1], radius, 1e-14 * radius);
        }
    }
}

/// An isola of two parameters' worth of structure: `(p² + x² − 1)² = x/2`-like ovals close as well.
#[test]
fn an_isola_closes() {
    zero_problem! {
        struct Oval [x, y; p] {
            0 = (p - 3.0).powi(2) * 25.0 + (x - 2.0).powi(4) - 0.01;
            0 = y - x * p;
        }
    }
    let mut system = Dense::new(Oval);
    let branch = Continuation::new(&mut system)
        .from(&[2.1, 6.3])
        .at("p", 3.015)
        .along("p", 0.0..=10.0)
        .settings(Settings { initial_step: 0.001, ..Settings::default() })
        .trace()
        .unwrap();
    assert!(matches!(branch.ends[1], End::Closed { .. }), "{:?}", branch.ends);
    let folds = values(&branch, Kind::LP, "p");
    assert_eq!(folds.len(), 2);
    close(folds[0], 2.98, 1e-9);
    close(folds[1], 3.02, 1e-9);
}

#[test]
fn ends_lie_on_the_bounds() {
    let mut system = Dense::new(CuspSlice);
    let branch = Continuation::new(&mut system)
        .from(&[-2.0])
        .at("mu", -1.0)
        .along("mu", -1.5..=1.5)
        .bound("square", 0.0..=5.0)
        .bound("mu", -1.2..=f64::INFINITY)
        .trace()
        .unwrap();
    assert_eq!(branch.ends[0], End::ParameterBound { name: "mu".into(), value: -1.2 });
    assert_eq!(branch.ends[1], End::MonitorBound { name: "square".into(), value: 5.0 });
    close(branch.points[0].parameters[0], -1.2, 1e-15);
    close(branch.points.last().unwrap().monitors[0], 5.0, 1e-14);
    let ends: Vec<_> = branch.special.iter().map(|point| point.kind == Kind::EP).collect();
    assert!(ends[0] && ends[ends.len() - 1] && ends.iter().filter(|end| **end).count() == 2);
    // Labels are given in the order in which points are found: forward, then backward.
    let labels: Vec<_> = branch.special.iter().map(|point| point.label).collect();
    assert_eq!(labels[0], labels.len());
}

#[test]
fn starts_on_a_bound() {
    let mut system = Dense::new(CuspSlice);
    // On the upper bound of μ; backward it goes in.
    let branch = Continuation::new(&mut system)
        .from(&[2.4])
        .at("mu", 1.0)
        .along("mu", -3.0..=1.0)
        .bound("square", 0.0..=9.0)
        .trace()
        .unwrap();
    assert_eq!(branch.ends[1], End::ParameterBound { name: "mu".into(), value: 1.0 });
    assert!(branch.points.len() > 5);
    // On the bound of a monitor: x = −1.5, x² = 2.25 is the least allowed, and x² falls with μ.
    let mu = -1.5_f64.powi(3) / 3.0 + 1.5;
    let branch = Continuation::new(&mut system)
        .from(&[-1.5])
        .at("mu", mu)
        .along("mu", -3.0..=3.0)
        .bound("square", 2.25..=9.0)
        .trace()
        .unwrap();
    assert_eq!(
        branch.ends[1 - usize::from(branch.points[0].monitors[0] < 3.0)].to_string(),
        "square reached its bound 2.25"
    );
    assert!(branch.points.iter().all(|p| p.monitors[0] >= 2.25 - 1e-9));
    // Beyond a bound there is no start.
    let error = Continuation::new(&mut system)
        .from(&[-2.0])
        .at("mu", -2.0 / 3.0)
        .along("mu", -1.0..=1.0)
        .bound("square", 0.0..=1.0)
        .trace()
        .unwrap_err();
    let TraceError::OutOfRange { name, low, high, .. } = &error else { panic!("{error}") };
    assert_eq!((name.as_str(), *low, *high), ("square", 0.0, 1.0));
}

/// A start on a fold is sound: both directions leave it. A start on a branch point is refused.
#[test]
fn singular_starts() {
    let mut system = Dense::new(ParallelPlate);
    let branch = Continuation::new(&mut system)
        .from(&[1.0 / 3.0])
        .at("load", 4.0 / 27.0)
        .along("load", 0.0..=1.0)
        .bound("load", 0.01..=1.0)
        .trace()
        .unwrap();
    for end in &branch.ends {
        assert_eq!(*end, End::ParameterBound { name: "load".into(), value: 0.01 });
    }
    zero_problem! {
        /// `x (x − p)`.
        struct Transcritical [x; p] {
            0 = x * (p - x);
        }
    }
    let mut system = Dense::new(Transcritical);
    let start = || Continuation::new(&mut Dense::new(Transcritical)).along("p", -1.0..=1.0).trace();
    // Beside a branch point the direction is determined.
    let branch = start().unwrap();
    assert!(branch.warnings[0].contains("moved from p = 0 to 0.00002"), "{:?}", branch.warnings);
    let crossing = branch.of_kind(Kind::BP).next().unwrap();
    assert!(crossing.converged && crossing.parameters[0].abs() < 1e-12, "{crossing:?}");
    // Said to be one, it is left along the other branch.
    let branch = Continuation::new(&mut system).along("p", -1.0..=1.0).switch().trace().unwrap();
    assert_eq!(branch.ends[1], End::ParameterBound { name: "p".into(), value: 1.0 });
}

#[test]
fn max_points_is_kept() {
    let mut system = Dense::new(CuspSlice);
    let settings = Settings { max_points: 3, ..Settings::default() };
    let branch = Continuation::new(&mut system)
        .from(&[-2.0])
        .at("mu", -1.0)
        .along("mu", -5.0..=5.0)
        .settings(settings)
        .trace()
        .unwrap();
    assert_eq!(branch.ends, [End::PointLimit { points: 3 }, End::PointLimit { points: 3 }]);
    assert_eq!(branch.points.len(), 7);
}

/// `x = √(1 − p)` written so that it is undefined beyond p = 1: the branch up to there is kept.
#[test]
fn a_failed_branch_is_kept() {
    zero_problem! {
        struct Edge [x; p] {
            0 = p * 0.5 - x;
            fn domain(&self, _x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
                if p[0] < 0.7 {
                    Ok(())
                } else {
                    Err(OutOfDomain::new("p", p[0], "p must be below 0.7"))
                }
            }
        }
    }
    let mut system = Dense::new(Edge);
    let branch = Continuation::new(&mut system).along("p", 0.0..=1.0).trace().unwrap();
    let End::StepTooSmall { step, cause, failure } = &branch.ends[1] else { panic!() };
    assert!(*step < 2e-7 && cause.contains("p must be below 0.7"), "{step} {cause}");
    let Some(NewtonError::Evaluation { cause: Failure::OutOfDomain(outside), .. }) =
        failure.as_deref()
    else {
        panic!("{failure:?}")
    };
    assert!(outside.value >= 0.7 && outside.quantity == "p");
    let last = branch.special.last().unwrap();
    assert_eq!(last.kind, Kind::MX);
    close(last.parameters[0], 0.7, 1e-6);
    assert!(branch.points.len() > 5);
}

/// Smooth branches take few points, at the default settings.
#[test]
fn steps_are_long_on_smooth_branches() {
    let mut system = Dense::new(Bratu(20));
    let branch = Continuation::new(&mut system)
        .along("lambda", 0.0..=10.0)
        .bound("middle", 0.0..=5.0)
        .trace()
        .unwrap();
    assert!((8..30).contains(&branch.points.len()), "{}", branch.points.len());
    let mut system = Dense::new(CuspSlice);
    let branch = Continuation::new(&mut system)
        .from(&[-2.0])
        .at("mu", -2.0 / 3.0)
        .along("mu", -2.0..=2.0)
        .trace()
        .unwrap();
    assert!((8..40).contains(&branch.points.len()), "{}", branch.points.len());
}

#[test]
fn an_observer_interrupts() {
    struct Patience(usize, CancelToken);
    impl Observer for Patience {
        fn point(&mut self, _point: &Point) {
            self.0 -= 1;
            if self.0 == 0 {
                self.1.cancel();
            }
        }
    }
    let mut system = Dense::new(CuspSlice);
    for patience in [1, 5] {
        let cancel = CancelToken::default();
        let settings = Settings { cancel: cancel.clone(), ..Settings::default() };
        let branch = Continuation::new(&mut system)
            .from(&[-2.0])
            .at("mu", -2.0 / 3.0)
            .along("mu", -2.0..=2.0)
            .settings(settings)
            .steps()
            .unwrap()
            .run(&mut Patience(patience, cancel));
        assert_eq!(branch.ends, [End::Interrupted, End::Interrupted]);
        assert_eq!(branch.points.len(), patience);
    }
}

/// Values of all columns at special points of these kinds, sorted.
fn landmarks(branch: &Branch, kinds: &[Kind]) -> Vec<(Kind, f64)> {
    let mut found: Vec<_> =
        kinds.iter().flat_map(|k| branch.of_kind(*k).map(|s| (*k, s.parameters[0]))).collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    found
}

/// A branch restarted from any of its labels has the same ends and, but for a branch point that it
/// starts from, the same special points.
#[test]
fn restarts_reproduce_the_branch() {
    let mut system = Dense::new(PredatorPrey);
    let trivial = Continuation::new(&mut system).at("p", 0.01).along("p", 0.01..=1.0);
    let trivial = trivial.trace().unwrap();
    let kinds = [Kind::LP, Kind::BP, Kind::UZ];
    let prey = Continuation::new(&mut system)
        .restart(&trivial, first(&trivial, Kind::BP).label)
        .switch()
        .along("p", 0.01..=1.0)
        .mark("p", 0.7)
        .trace()
        .unwrap();
    let reference = landmarks(&prey, &kinds);
    assert_eq!(reference.len(), 4, "LP, BP and two marks: {reference:?}");
    for special in &prey.special {
        let again = Continuation::new(&mut system)
            .restart(&prey, special.label)
            .along("p", 0.01..=1.0)
            .mark("p", 0.7)
            .trace()
            .unwrap();
        let mut found = landmarks(&again, &kinds);
        // The branch point that the reference itself started from is on the way as well.
        found.retain(|(kind, p)| !(*kind == Kind::BP && (p - 0.6).abs() < 1e-9));
        let expected: Vec<_> = reference
            .iter()
            .filter(|(kind, p)| {
                special.kind != Kind::BP
                    || *kind != Kind::BP
                    || (p - special.parameters[0]).abs() >= 1e-9
            })
            .collect();
        assert_eq!(
            found.len(),
            expected.len(),
            "from {} {}: {found:?}",
            special.label,
            special.kind
        );
        for end in 0..2 {
            assert!(matches!(again.ends[end], End::ParameterBound { .. }), "{:?}", again.ends);
        }
    }
}

/// So has a curve of folds, restarted at its ends and at its cusp.
#[test]
fn restarts_reproduce_a_fold_curve() {
    let mut system = Dense::new(CuspForm);
    let trace = |c: Continuation| {
        c.hold(Kind::LP)
            .along("b", -1.0..=1.0)
            .along("a", -1.0..=1.0)
            .mark("a", 0.5)
            .trace()
            .unwrap()
    };
    let x = (0.25_f64 / 3.0).sqrt();
    let curve =
        trace(Continuation::new(&mut system).from(&[x]).at("a", 0.25).at("b", 2.0 * x.powi(3)));
    assert_eq!(curve.of_kind(Kind::CP).count(), 1);
    close(first(&curve, Kind::CP).parameters[0], 0.0, 1e-13);
    close(first(&curve, Kind::CP).parameters[1], 0.0, 1e-13);
    for point in curve.of_kind(Kind::UZ) {
        close(27.0 * point.parameters[0].powi(2), 4.0 * 0.125, 1e-13);
    }
    let marks = values(&curve, Kind::UZ, "b");
    assert_eq!(marks.len(), 2);
    for special in curve.special.iter().filter(|s| s.kind != Kind::UZ) {
        let again = trace(Continuation::new(&mut system).restart(&curve, special.label));
        for (a, b) in values(&again, Kind::UZ, "b").iter().zip(&marks) {
            close(*a, *b, 1e-13);
        }
        assert_eq!(values(&again, Kind::UZ, "b").len(), 2);
    }
}

#[test]
fn every_setting_has_its_range() {
    let d = Settings::default;
    let wrong = [
        (
            Settings { initial_step: 0.0, ..d() },
            "the setting `initial_step` is 0, but must be at least `min_step`",
        ),
        (
            Settings { initial_step: 0.01, min_step: 0.02, ..d() },
            "the setting `initial_step` is 0.01, but must be at least `min_step`",
        ),
        (
            Settings { min_step: f64::NAN, ..d() },
            "the setting `min_step` is NaN, but must be more than 0",
        ),
        (
            Settings { max_step: 1e-9, ..d() },
            "the setting `max_step` is 0.000000001, but must be at least `min_step`",
        ),
        (
            Settings { max_points: 0, ..d() },
            "the setting `max_points` is 0, but must be at least 1",
        ),
        (
            Settings { curve_error: 0.0, ..d() },
            "the setting `curve_error` is 0, but must be more than 0",
        ),
        (
            Settings { tolerance: 0.1, ..d() },
            "the setting `tolerance` is 0.1, but must be between 1e-15 and 1e-3",
        ),
        (
            Settings { event_tolerance: -1.0, ..d() },
            "the setting `event_tolerance` is -1, but must be between 1e-15 and 1e-3",
        ),
        (
            Settings { max_iterations: 1, ..d() },
            "the setting `max_iterations` is 1, but must be at least 2",
        ),
        (
            Settings { refinement: 1.5, ..d() },
            "the setting `refinement` is 1.5, but must be between 0 and 1",
        ),
    ];
    for (settings, message) in wrong {
        let mut system = Dense::new(CuspSlice);
        let error =
            Continuation::new(&mut system).along("mu", -1.0..=1.0).settings(settings).trace();
        assert_eq!(error.unwrap_err().to_string(), message);
    }
    assert!(d().check().is_ok());
}

#[test]
fn what_is_asked_for_wrongly_is_refused_with_the_remedy() {
    let mut system = Dense::new(CuspSlice);
    let mut message = |change: &dyn Fn(Continuation<'_>) -> Result<Branch, TraceError>| {
        let continuation = Continuation::new(&mut system as &mut dyn System);
        one_line(&change(continuation).unwrap_err())
    };
    for (found, expected) in [
        (
            message(&|c| c.along("nu", -1.0..=1.0).trace()),
            "unknown parameter `nu`; did you mean `mu`? Known: mu",
        ),
        (
            message(&|c| c.along("mu", -1.0..=1.0).mark("sqare", 1.0).trace()),
            "unknown parameter or monitor `sqare`; did you mean `square`? Known: mu, square",
        ),
        (
            message(&|c| c.along("mu", -1.0..=1.0).mark("square", f64::NAN).trace()),
            "the mark of square is NaN, but must be finite",
        ),
        (
            message(&|c| c.along("mu", -1.0..=1.0).scale("y", 1.0).trace()),
            "unknown group of unknowns or released parameter `y`; known: x, mu",
        ),
        (
            message(&|c| c.along("mu", -1.0..=1.0).scale("x", 0.0).trace()),
            "the scale of x is 0, but must be finite and more than 0",
        ),
        (
            message(&|c| c.along("mu", 1.0..=-1.0).trace()),
            "the range of mu, 1 to -1, is empty: the lower end must come first",
        ),
        (
            message(&|c| c.at("mu", 3.0).along("mu", -1.0..=1.0).trace()),
            "the start mu = 3 is not in the range of mu, -1 to 1; start the branch within the \
             range, or widen the range",
        ),
        (
            message(&|c| c.at("mu", f64::NAN).along("mu", -1.0..=1.0).trace()),
            "the start mu = NaN is not in the range of mu, -1 to 1; start the branch within the \
             range, or widen the range",
        ),
        (
            message(&|c| c.trace()),
            "0 parameters are released, but 1 parameters are needed: one for the curve, and one \
             more for each condition that is held along the curve",
        ),
        (
            message(&|c| c.hold(Kind::LP).along("mu", -1.0..=1.0).along("mu", -1.0..=1.0).trace()),
            "the parameter `mu` is released twice",
        ),
        (
            message(&|c| c.from(&[1.0, 2.0]).along("mu", -1.0..=1.0).trace()),
            "the start has 2 unknowns, but the problem has 1 unknowns: was the start computed with other settings?",
        ),
        (
            message(&|c| c.hold(Kind::EP).along("mu", -1.0..=1.0).along("mu", -1.0..=1.0).trace()),
            "the parameter `mu` is released twice",
        ),
        (
            message(&|c| {
                let hopf = tangency::core::bifurcation::Hopf::of_equilibria;
                c.along("mu", -1.0..=1.0).event(Event::new("Hopf", hopf)).trace()
            }),
            "the defining system of the event `Hopf` has auxiliary unknowns, so it cannot be used as a test function; \
             give the event a test function with `Event::with_test`",
        ),
    ] {
        assert_eq!(found, expected);
    }
}

/// Continuations, systems and branches can be moved to another thread.
#[test]
fn continuations_can_be_sent_to_threads() {
    fn sent<T: Send>() {}
    sent::<Continuation<'static>>();
    sent::<Box<dyn System>>();
    sent::<Branch>();
}

/// `u_j = cos(20000 p + 2πj/3)`: the norm and the sum of `u` are constant.
struct Turning;

impl ZeroProblem for Turning {
    fn names(&self) -> Names {
        Names::new([("u", 3)], ["p"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        for (j, (r, u)) in r.iter_mut().zip(u).enumerate() {
            *r = *u - (p[0] * 2e4 + j as f64 * std::f64::consts::TAU / 3.0).cos();
        }
    }
    fn dynamics(&self) -> Dynamics {
        Dynamics::None
    }
}

/// Where only the direction of the unknowns changes, a warning says so; a tiny largest step is no crawl.
#[test]
fn a_branch_that_crawls_says_so() {
    let warnings = |max_step: f64| {
        let mut system = Dense::new(Turning);
        let settings = Settings { max_points: 400, max_step, ..Settings::default() };
        let branch = Continuation::new(&mut system)
            .settings(settings)
            .from(&[1.0, -0.5, -0.5])
            .along("p", 0.0..=1.0)
            .trace()
            .unwrap();
        assert_eq!(branch.ends[1], End::PointLimit { points: 400 });
        branch.warnings.iter().filter(|it| it.contains("the branch crawls")).count()
    };
    assert_eq!(warnings(0.2), 1);
    let mut plate = Dense::new(ParallelPlate);
    let settings =
        Settings { max_points: 400, max_step: 1e-6, initial_step: 1e-6, ..Settings::default() };
    let slow = Continuation::new(&mut plate).settings(settings).along("load", 0.0..=1.0).trace();
    assert!(slow.unwrap().warnings.is_empty());
}
