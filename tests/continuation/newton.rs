//! Promise: Newton's iteration converges quadratically, and where it fails it says why, with the
//! numbers that decide.

use crate::common::{Circle, close, falls_with_order, first};
use tangency::core::continuation::{
    Continuation, Convergence, End, Extended, Newton, NewtonError, Settings, Tolerances, TraceError,
};
use tangency::core::failure::{Failure, OutOfDomain, one_line};
use tangency::core::problem::{Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind};
use tangency::problems::classic::ParallelPlate;

const TOLERANCES: Tolerances = Tolerances::new(1e-12, 12);

/// A scalar equation in `x` with the parameter `p`, stated by name.
enum Equation {
    /// `eˣ − p`.
    Exponential,
    /// `atan x − p`.
    Arctangent,
    /// `x² + p`.
    Square,
    /// `√x − p`.
    Root,
    /// `x − p`, NaN for `p > 1` and infinite for `p < 0`.
    Broken,
}

impl ZeroProblem for Equation {
    fn names(&self) -> Names {
        Names::new(["x"], ["p"])
    }
    fn residual<T: Scalar>(&self, x: &[T], p: &[T], r: &mut [T]) {
        r[0] = match self {
            Equation::Exponential => x[0].exp() - p[0],
            Equation::Arctangent => x[0].atan() - p[0],
            Equation::Square => x[0] * x[0] + p[0],
            Equation::Root => x[0].sqrt() - p[0],
            Equation::Broken if p[0].real() > 1.0 => T::constant(f64::NAN),
            Equation::Broken if p[0].real() < 0.0 => T::constant(f64::INFINITY),
            Equation::Broken => x[0] - p[0],
        };
    }
    fn domain(&self, x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        match self {
            Equation::Root if x[0] <= 0.0 => {
                Err(OutOfDomain::new("x", x[0], "the root needs x > 0"))
            }
            _ => Ok(()),
        }
    }
}

fn solve(
    problem: impl ZeroProblem + 'static,
    x: f64,
    p: f64,
    tolerances: Tolerances,
) -> Result<(f64, Convergence), NewtonError> {
    let mut system = Dense::new(problem);
    let mut equations = Extended::new(&mut system, &[x, p], vec![]);
    let mut unknowns = [x];
    let report =
        Newton::default().solve(&mut equations, &mut unknowns, None, &[1.0], tolerances)?;
    Ok((unknowns[0], report))
}

#[test]
fn converges_to_its_tolerance() {
    let (x, report) = solve(Equation::Exponential, 1.0, 2.0, TOLERANCES).unwrap();
    // What the next correction would be is below a hundredth of the tolerance.
    close(x, 2.0_f64.ln(), 1e-14);
    assert!(report.iterations <= 5 && report.correction <= 1e-6, "{report:?}");
}

/// An error is the square of the one before, times a constant: `log eₖ₊₁` against `log eₖ` has the
/// slope 2.
#[test]
fn convergence_is_quadratic() {
    let error = |iterations: usize| {
        let mut system = Dense::new(Equation::Exponential);
        let mut unknowns = [1.0];
        let mut equations = Extended::new(&mut system, &[1.0, 2.0], vec![]);
        // Nothing is below this tolerance: so many full steps are taken.
        let tolerances = Tolerances { tolerance: 0.0, max_iterations: iterations, ..TOLERANCES };
        let stopped =
            Newton::default().solve(&mut equations, &mut unknowns, None, &[1.0], tolerances);
        assert!(matches!(stopped, Err(NewtonError::IterationLimit { .. })), "{stopped:?}");
        (unknowns[0] - 2.0_f64.ln()).abs()
    };
    let start = 1.0 - 2.0_f64.ln();
    let errors = [start, error(1), error(2), error(3), error(4)];
    let pairs: Vec<(f64, f64)> = errors.windows(2).map(|pair| (pair[0], pair[1])).collect();
    falls_with_order("Newton's method", &pairs, 2.0);
}

/// From `ln 2 + 0.01` the matrix `eˣ` changes by 1 % up to the solution: with its factors kept, one
/// factorisation suffices, and the reported error is the change of the matrix.
#[test]
fn factors_are_kept_while_the_matrix_changes_little() {
    let mut system = Dense::new(Equation::Exponential);
    let mut equations = Extended::new(&mut system, &[1.0, 2.0], vec![]);
    let mut newton = Newton::default();
    let mut solve = |start: f64, matrix_change: f64| {
        let (mut x, tolerances) =
            ([start], Tolerances { matrix_change, ..Tolerances::new(1e-8, 12) });
        let report = newton.solve(&mut equations, &mut x, None, &[1.0], tolerances).unwrap();
        close(x[0], 2.0_f64.ln(), 1e-11);
        report
    };
    // The first solution measures the curvature.
    solve(1.0, 0.05);
    let kept = solve(2.0_f64.ln() + 0.01, 0.05);
    assert_eq!(kept.iterations, 1);
    close(kept.matrix_error, 0.01_f64.exp_m1(), 1e-3);
    close(kept.contraction, 0.005, 1e-4);
    let fresh = solve(2.0_f64.ln() + 0.01, 1e-4);
    assert!(fresh.iterations > 1 && fresh.matrix_error < 1e-4, "{fresh:?}");
    // A matrix that changes by more than 5 % is factored again.
    assert!(solve(2.0_f64.ln() + 0.2, 0.05).iterations > 1);
}

/// Where neither stability nor branch points are computed, points and folds are as accurate as with
/// new matrices; in a wide range, in which every tangent is nearly vertical, they are so, too.
#[test]
fn branches_with_kept_factors_are_the_same_branches() {
    let settings = Settings {
        stability: false,
        detect: vec![Kind::LP],
        keep_solutions: true,
        ..Settings::default()
    };
    for range in [-2.0..=2.0, -500.0..=500.0] {
        let mut system = Dense::new(Circle { radius: 1.0 });
        let branch = Continuation::new(&mut system)
            .settings(settings.clone())
            .from(&[1.0])
            .at("p", 0.0)
            .along("p", range)
            .trace()
            .unwrap();
        assert!(matches!(branch.ends[1], End::Closed { .. }), "{:?}", branch.ends);
        for point in &branch.points {
            let [x, p] = [point.solution.as_ref().unwrap().state[0], point.parameters[0]];
            close(x * x + p * p, 1.0, 1e-9);
        }
        let folds: Vec<f64> = branch.of_kind(Kind::LP).map(|it| it.parameters[0]).collect();
        assert_eq!(folds.len(), 2, "{folds:?}");
        folds.iter().for_each(|p| close(p.abs(), 1.0, 1e-14));
    }
}

/// From x = 3 undamped Newton on atan x diverges: the first corrections have to be damped.
#[test]
fn damping_reaches_what_plain_newton_does_not() {
    let step = |x: f64| x - (x.atan()) * (1.0 + x * x);
    assert!(step(step(3.0)).abs() > 100.0);
    let (x, report) = solve(Equation::Arctangent, 3.0, 0.0, TOLERANCES).unwrap();
    close(x, 0.0, 1e-13);
    assert!(report.iterations <= 8, "{report:?}");
}

/// In a bracket, a bisection costs less than an iteration that needs strong damping.
#[test]
fn damping_has_a_limit() {
    let tolerances = Tolerances { least_damping: 1.0, ..TOLERANCES };
    let error = solve(Equation::Arctangent, 3.0, 0.0, tolerances).unwrap_err();
    let NewtonError::Stagnation { iterations: 1, damping: 0.5, .. } = &error else {
        panic!("{error}")
    };
}

/// Each correction halves the distance from the double root of x² = 0, at which the matrix is
/// singular: after 19 corrections, the distance is 2⁻¹⁹.
#[test]
fn double_roots_are_approached() {
    let tolerances = Tolerances { max_iterations: 30, ..TOLERANCES };
    let (x, report) = solve(Equation::Square, 1.0, 0.0, tolerances).unwrap();
    assert_eq!((x, report.iterations), (2.0_f64.powi(-19), 19));
}

/// x² + 1 has no root: the iteration stagnates, or runs into the singular point x = 0.
#[test]
fn stagnation() {
    let error = solve(Equation::Square, 1.5, 1.0, TOLERANCES).unwrap_err();
    let NewtonError::Stagnation { iterations, correction, damping } = &error else {
        panic!("{error}")
    };
    assert!((1..=12).contains(iterations) && *correction > 0.1 && *damping < 0.01);
    assert!(one_line(&error).contains("stagnated"), "{error}");
}

#[test]
fn singular() {
    let error = solve(Equation::Square, 0.0, -1.0, TOLERANCES).unwrap_err();
    let NewtonError::Evaluation { iteration: 1, cause } = &error else { panic!("{error}") };
    assert!(matches!(cause, Failure::Singular { pivot: 0.0, .. }), "{cause:?}");
    assert!(one_line(&error).contains("the matrix is singular: one pivot is 0.0e0"), "{error}");
}

#[test]
fn iteration_limit() {
    let tolerances = Tolerances { max_iterations: 2, ..TOLERANCES };
    let error = solve(Equation::Exponential, 8.0, 1e-3, tolerances).unwrap_err();
    let NewtonError::IterationLimit { iterations: 2, correction, .. } = &error else {
        panic!("{error}")
    };
    assert!(*correction > 1e-3);
    assert!(one_line(&error).contains("raise `max_iterations`"), "{error}");
}

/// √x = −1 pulls x below zero, where the equations are undefined.
#[test]
fn domain_left() {
    let error = solve(Equation::Root, 1.0, -1.0, TOLERANCES).unwrap_err();
    let NewtonError::Evaluation { cause: Failure::OutOfDomain(cause), .. } = &error else {
        panic!("{error}")
    };
    assert_eq!(cause.quantity, "x");
    assert!(cause.value <= 0.0);
    assert!(one_line(&error).contains("the root needs x > 0"), "{error}");
}

#[test]
fn not_a_number() {
    for (p, expected) in [(2.0, "NaN"), (-1.0, "inf")] {
        let error = solve(Equation::Broken, 0.5, p, TOLERANCES).unwrap_err();
        let NewtonError::Evaluation { iteration: 0, cause } = &error else { panic!("{error}") };
        let Failure::NotFinite { quantity, .. } = cause else { panic!("{error}") };
        assert_eq!(quantity, "component 0 of the residual");
        assert!(one_line(&error).contains(expected), "{error}");
    }
}

/// A branch that runs into values that are no numbers ends there, and keeps what it has.
#[test]
fn a_branch_into_nan_is_kept() {
    let mut system = Dense::new(Equation::Broken);
    let branch = Continuation::new(&mut system).along("p", 0.0..=3.0).forward().trace().unwrap();
    let End::StepTooSmall { cause, .. } = &branch.ends[1] else { panic!("{:?}", branch.ends) };
    assert!(cause.contains("component 0 of the residual = NaN"), "{cause}");
    assert_eq!(branch.special.last().unwrap().kind, Kind::MX);
    close(branch.points.last().unwrap().parameters[0], 1.0, 1e-5);
}

/// With the load fixed, Newton fails beyond the pull-in load 4/27, does not reach it in good order,
/// and needs ever more iterations on the way; by arclength the same branch passes.
#[test]
fn load_control_fails_at_the_fold_where_arclength_passes() {
    let limit: f64 = 4.0 / 27.0;
    let iterations =
        |load: f64| solve(ParallelPlate, 0.3, load, TOLERANCES).map(|s| s.1.iterations);
    let (safe, close_by) = (iterations(0.9 * limit).unwrap(), iterations(limit - 1e-8).unwrap());
    assert!(close_by > safe, "{safe} {close_by}");
    let beyond = iterations(1.001 * limit).unwrap_err();
    assert!(
        matches!(beyond, NewtonError::Stagnation { .. } | NewtonError::IterationLimit { .. }),
        "{beyond}"
    );
    // Beyond the fold there is nothing to start from.
    let mut system = Dense::new(ParallelPlate);
    let start = Continuation::new(&mut system).at("load", 0.2).along("load", 0.0..=1.0).trace();
    let Err(TraceError::Start { place, .. }) = start else { panic!() };
    assert_eq!(place, "load = 0.2");
    let branch = Continuation::new(&mut system).along("load", 0.0..=1.0).trace().unwrap();
    close(first(&branch, Kind::LP).parameters[0], limit, 1e-14);
    close(first(&branch, Kind::LP).state[0], 1.0 / 3.0, 1e-12);
}
