//! Where methods fail on the plate: what fails, when, and what is said then.

use crate::plates::models::{
    assert_within, at, at_rest, folds_from, plate, pull_in, refined_to, system, through_pull_in,
    value,
};
use std::f64::consts::PI;
use tangency::core::continuation::{End, NewtonError, TraceError};
use tangency::core::failure::Failure;
use tangency::core::failure::one_line;
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::numerics::gauss_legendre;
use tangency::core::system::{Kind, System};
use tangency::problems::plate::basis::Basis;
use tangency::problems::plate::{InPlane, Ritz, RitzSettings, Support};

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Newton's iteration without damping at a fixed load, from the flat plate: the number of
/// corrections until one is smaller than 1e-9 of the deflection.
fn corrections(system: &mut dyn System, load: f64) -> Result<usize, String> {
    let n = system.names().dimension();
    let mut x = vec![0.0; n];
    x.extend([load, 1.0, 1.0, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let mut r = vec![0.0; n];
    for count in 1..60 {
        system.residual(&x, &mut r).map_err(|left| left.to_string())?;
        system.assemble(&x).map_err(|left| left.to_string())?;
        let mut factors = Factors::default();
        system
            .factor(Form::Jacobian, Border::NONE, &mut factors)
            .map_err(|singular| singular.to_string())?;
        factors.solve(&mut r);
        x[..n].iter_mut().zip(&r).for_each(|(x, step)| *x -= step);
        if norm(&r) < 1e-9 * norm(&x[..n]) {
            return Ok(count);
        }
    }
    Err("no convergence".into())
}

/// Newton at a fixed load needs ever more corrections on the way to the fold, and none suffice
/// beyond it: it runs through the electrode, or wanders about. The core's own says so by a typed
/// failure, while arclength passes the fold in a few steps.
#[test]
fn newton_at_a_fixed_load_fails_at_the_fold_that_arclength_passes() {
    let mut system = system(&plate("CCCC", InPlane::Immovable), 1.0);
    let branch = through_pull_in(&mut *system, &[]).settings(refined_to(0.0)).trace().unwrap();
    let top = pull_in(&branch).parameters[0];
    let counts = [0.9, 0.99, 0.999, 0.9999, 0.99999, 0.999999]
        .map(|share| corrections(&mut *system, share * top));
    assert_eq!(counts, [5, 7, 8, 10, 12, 13].map(Ok));
    for share in [1.000001, 1.001, 1.1, 2.0] {
        let failure = corrections(&mut *system, share * top).unwrap_err();
        let touched = failure.starts_with("max_deflection");
        assert!(touched || failure == "no convergence", "{failure}");
        let start = at_rest(&mut *system, &[("load", share * top)]).along("load", 0.0..=1000.0);
        let failure = start.trace().unwrap_err();
        let TraceError::Start { cause, .. } = &failure else { panic!("{failure}") };
        let NewtonError::Stagnation { iterations, damping, .. } = &**cause else {
            panic!("{failure}")
        };
        assert!(*iterations <= 12 && *damping < 0.01, "{failure}");
        assert!(
            one_line(&failure).contains("near a fold, use continuation by arclength"),
            "{failure}"
        );
    }
    let bound = End::MonitorBound { name: "max_deflection".into(), value: 0.9 };
    assert_eq!(branch.ends[1], bound);
    assert!(branch.points.len() < 60, "{} points", branch.points.len());
}

/// Appendix B: `f_r = Σ (−1)ⁿ (2r−2n−7)!!/(2ⁿ n! (r−2n−1)!) ξ^{r−2n−1}`, `r > 4`.
fn in_powers(r: usize, xi: f64) -> f64 {
    let double = |k: usize| (1..=k).rev().step_by(2).map(|v| v as f64).product::<f64>();
    let single = |k: usize| (1..=k).map(|v| v as f64).product::<f64>();
    let term = |n: usize| {
        let power = r - 2 * n - 1;
        let below = 2f64.powi(n as i32) * single(n) * single(power);
        (-1f64).powi(n as i32) * double((2 * r - 2 * n).saturating_sub(7)) / below
            * xi.powi(power as i32)
    };
    (0..=(r - 1) / 2).map(term).sum()
}

/// Summed in powers, Bardell's polynomials lose six digits by order 30 and all by order 50, while
/// the recurrence keeps them: at the ends, where they vanish, and in the middle, where a single
/// power is left.
#[test]
fn polynomials_in_powers_lose_their_digits_and_by_recurrence_keep_them() {
    let basis = Basis::transverse([Support::Clamped; 2], false, 56);
    // f_r" = P_{r−3}; the basis scales it by √(r − 5/2).
    let by_recurrence = |r: usize, xi: f64| basis.at(xi)[r - 5][0] / (r as f64 - 2.5).sqrt();
    let grid = || (-100..=100).map(|i| f64::from(i) / 100.0);
    let size = |r| grid().map(|xi| by_recurrence(r, xi).abs()).fold(0.0, f64::max);
    let lost = |r| {
        let differences = grid().map(|xi| (in_powers(r, xi) - by_recurrence(r, xi)).abs());
        differences.fold(0.0, f64::max) / size(r)
    };
    assert!(lost(6) < 1e-14 && lost(10) < 1e-12, "{:e}, {:e}", lost(6), lost(10));
    assert!((1e-7..1e-5).contains(&lost(30)), "{:e}", lost(30));
    assert!(lost(50) > 1.0, "{:e}", lost(50));
    for r in [29, 30, 49, 50, 59, 60] {
        for (end, slope) in [(-1.0, 0), (-1.0, 1), (1.0, 0), (1.0, 1)] {
            let rest = basis.at(end)[r - 5][slope];
            assert!(rest.abs() < 1e-15, "order {r} at {end}: {rest:e}");
        }
        // Only the last power does not vanish at 0, and it loses nothing.
        let middle = by_recurrence(r, 0.0) - in_powers(r, 0.0);
        assert!(middle.abs() < 1e-14 * size(r), "order {r}: {middle:e}");
        if r >= 49 {
            let at_the_end = in_powers(r, 1.0).abs();
            assert!(at_the_end > 10.0 * size(r), "order {r}: {at_the_end:e}");
        }
    }
}

/// Gauss points on each half side that integrate the load `1/(1 − w)²` of a traced plate to 1e-9.
fn points_needed(plate: &Ritz, state: &[f64]) -> usize {
    let load = |points: usize| {
        let (nodes, weights) = gauss_legendre(points);
        let line = || nodes.iter().map(|node| 0.25 * (node + 1.0)).zip(&weights);
        let mut sum = 0.0;
        for (x, along_x) in line() {
            for (y, along_y) in line() {
                sum += along_x * along_y / (1.0 - plate.deflection(state, x, y)).powi(2);
            }
        }
        sum
    };
    let exact = load(90);
    let fine = |points: &usize| (load(*points) / exact - 1.0).abs() < 1e-9;
    (2..90).find(fine).unwrap()
}

/// The load needs more and more points near `w = 1`, and a branch bounded beyond 0.96 ends there
/// with a reason, before the numbers lie: up to then they agree with those of a finer plate to the
/// error given.
#[test]
fn branches_end_with_a_reason_where_the_load_is_no_longer_integrated() {
    for supports in ["SSSS", "CCCC"] {
        let settings = RitzSettings::new(supports.parse().unwrap());
        let mut coarse = Ritz::new(settings).unwrap();
        let mut finer = settings;
        finer.orders = Some(coarse.orders().finer().finer());
        let mut fine = Ritz::new(finer).unwrap();
        let levels = [0.5, 0.8, 0.9, 0.95];
        let [branch, reference] = [(&mut coarse, 1e-4), (&mut fine, 1e-6)].map(|(plate, asked)| {
            let open = f64::NEG_INFINITY;
            let mut curve = at_rest(plate, &[])
                .settings(refined_to(asked))
                .along("load", 0.0..=f64::INFINITY)
                .bound("max_deflection", open..=0.99);
            for level in levels {
                curve = curve.mark("max_deflection", level);
            }
            curve.trace().unwrap()
        });
        let End::StepTooSmall { cause, .. } = &branch.ends[1] else {
            panic!("{supports}: {:?}", branch.ends)
        };
        for said in ["max_deflection = 9.6", "clear of the electrode", "end the branch earlier"] {
            assert!(cause.contains(said), "{supports}: {cause}");
        }
        let last = branch.special.last().unwrap();
        assert_eq!(last.kind, Kind::MX);
        assert!((0.9599..=0.96).contains(&value(&branch, last, "max_deflection")));
        let mut needed = Vec::new();
        for level in levels {
            let point = at(&branch, "max_deflection", level);
            let better = at(&reference, "max_deflection", level);
            let loads = [value(&branch, point, "load"), value(&reference, better, "load")];
            assert_within(supports, loads[0], loads[1], point.error + better.error);
            needed.push(points_needed(&fine, &better.state));
        }
        assert!(needed.windows(2).all(|pair| pair[0] < pair[1]), "{supports}: {needed:?}");
        // The numbers of points said to be needed are on the safe side.
        let enough = needed.iter().zip([12, 20, 32, 48]).all(|(needed, given)| *needed <= given);
        assert!(enough, "{supports}: {needed:?}");
    }
}

/// Where `ω² = 4π⁴ − π²N − 2λ` of a flat supported plate vanishes, a flat plate is a singular
/// start: the correction is useless, and the trace refuses to begin, by a typed failure. From rest,
/// where it is regular, the same plate is traced to the pull-in that a curve of folds leads to from
/// one without edge forces.
#[test]
fn a_singular_start_is_refused() {
    let critical = 4.0 * PI * PI - 2.0 / (PI * PI);
    let mut system = system(&plate("SSSS", InPlane::Slide), 1.0);
    let n = system.names().dimension();
    let mut x = vec![0.0; n];
    x.extend([1.0, 1.0, 1.0, 0.3, 0.0, critical, 0.0, 0.0, 0.0]);
    system.assemble(&x).unwrap();
    let mut factors = Factors::default();
    let refused = system.factor(Form::Jacobian, Border::NONE, &mut factors).is_err();
    let mut r = vec![0.0; n];
    system.residual(&x, &mut r).unwrap();
    factors.solve(&mut r);
    assert!(refused || norm(&r) > 1e9, "a correction of {:e}", norm(&r));
    let force = ("edge_force_x", critical);
    let failure = through_pull_in(&mut *system, &[("load", 1.0), force]).trace().unwrap_err();
    let TraceError::Start { cause, place, .. } = &failure else { panic!("{failure}") };
    let expected = matches!(
        **cause,
        NewtonError::Stagnation { .. }
            | NewtonError::Evaluation { cause: Failure::Singular { .. }, .. }
    );
    assert!(expected, "{failure}");
    assert_eq!(place, "load = 1");
    let branch = through_pull_in(&mut *system, &[force]).trace().unwrap();
    let flat = through_pull_in(&mut *system, &[]).trace().unwrap();
    let folds = folds_from(&mut *system, &flat, "edge_force_x", 0.0..=critical).trace().unwrap();
    let other = folds.special.last().unwrap();
    assert_eq!(value(&folds, other, "edge_force_x"), critical);
    let [one, other] = [pull_in(&branch).parameters[0], value(&folds, other, "load")];
    assert_within("pull-in of the compressed plate", one, other, 1e-8 * one);
}

/// Free edges and their corners are beyond polynomials of the orders provided for: the ladder ends
/// before the accuracy asked for is met, and `error` says what is met instead.
#[test]
fn functions_that_cannot_meet_the_accuracy_say_so() {
    let mut plate = Ritz::new(RitzSettings::new("CFFF".parse().unwrap())).unwrap();
    let branch = through_pull_in(&mut plate, &[]).trace().unwrap();
    let fold = pull_in(&branch);
    assert!(fold.converged);
    let asked = branch.settings.refinement * fold.parameters[0];
    assert!(fold.error > 10.0 * asked, "{:e} where {asked:e} was asked for", fold.error);
    assert!(fold.error < 1e-4 * fold.parameters[0], "{:e}", fold.error);
}
