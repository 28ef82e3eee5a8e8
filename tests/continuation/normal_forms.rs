//! Promise: special points of equilibria carry the coefficients of their normal forms. References:
//! Yu. A. Kuznetsov's formulas evaluated with 50 digits, and by power series without those formulas.

use crate::common::counted::Counted;
use crate::common::{BogdanovTakens, Brusselator, Oxidation, close, first};
use tangency::core::continuation::{Branch, Continuation, Settings, SpecialPoint};
use tangency::core::problem::Equilibria;
use tangency::core::system::{Dense, Kind};
use tangency::zero_problem;

fn number(point: &SpecialPoint, name: &str) -> f64 {
    point.number(name).unwrap().value
}

/// `l₁ = −(A² + 2)/(2A(2A² + 1))` at `B = 1 + A²`.
#[test]
fn the_lyapunov_coefficient_of_the_brusselator() {
    for a in [0.3, 1.0, 2.0, 5.0_f64] {
        let mut system = Dense::new(Equilibria::new(Brusselator));
        let curve = Continuation::new(&mut system).from(&[a, 0.5 / a]).at("a", a).at("b", 0.5);
        let branch = curve.along("b", 0.5..=30.0).trace().unwrap();
        let hopf = first(&branch, Kind::HB);
        let exact = -(a * a + 2.0) / (2.0 * a * (2.0 * a * a + 1.0));
        close(number(hopf, "l1"), exact, 1e-11 * exact.abs());
    }
}

zero_problem! {
    struct Lorenz [x, y, z; rho] {
        0 = (y - x) * 10.0;
        0 = (rho - z) * x - y;
        0 = x * y - z * (8.0 / 3.0);
    }
}

#[test]
fn the_subcritical_hopf_point_of_lorenz() {
    let mut system = Dense::new(Lorenz);
    let x = (8.0 / 3.0 * 9.0_f64).sqrt();
    let curve = Continuation::new(&mut system).from(&[x, x, 9.0]).at("rho", 10.0);
    let branch = curve.along("rho", 10.0..=30.0).trace().unwrap();
    close(number(first(&branch, Kind::HB), "l1"), 2.65518972584e-4, 1e-15);
}

/// Two folds and two Hopf points of CO oxidation. The sign of a fold's coefficient is that for the
/// null vector whose largest component, here `y`, is positive.
#[test]
fn the_normal_forms_of_co_oxidation() {
    let mut system = Dense::new(Oxidation);
    let curve = Continuation::new(&mut system).from(&[0.001137, 0.891483, 0.062345]);
    let branch: Branch = curve.at("q2", 2.0).at("k", 0.4).along("q2", 0.5..=2.0).trace().unwrap();
    let of = |kind: Kind, name: &str| -> Vec<(f64, f64)> {
        let all = branch.of_kind(kind).map(|point| (point.parameters[0], number(point, name)));
        let mut all: Vec<(f64, f64)> = all.collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    };
    let expected = [(1.04204850538, 0.116659346881), (1.05220028787, -0.134650516124)];
    for (found, expected) in of(Kind::LP, "fold_a").iter().zip(expected) {
        close(found.0, expected.0, 1e-11);
        close(found.1, expected.1, 2e-12);
    }
    // l₁ = Re c₁/ω.
    let expected = [
        (1.04099156953, 4.33137897821 / 0.0591061479358),
        (1.05155746246, 10.7010196344 / 0.0507403448968),
    ];
    for (found, expected) in of(Kind::HB, "l1").iter().zip(expected) {
        close(found.0, expected.0, 1e-11);
        close(found.1, expected.1, 1e-10 * expected.1);
    }
    assert_eq!((branch.of_kind(Kind::LP).count(), branch.of_kind(Kind::HB).count()), (2, 2));
}

/// The unstable pair that appears at the Hopf point `a = −b²` becomes real just before the fold at
/// `a = 0`. The fold also solves the equations of a Hopf point, with frequency 0. Short steps
/// separate all three places; one long step contains them.
#[test]
fn a_fold_beside_a_bogdanov_takens_point_is_no_hopf_point() {
    for b in [0.05, 0.1, 0.2, 0.3] {
        for max_step in [0.01, 0.03, 0.1, 0.3] {
            let mut system = Dense::new(BogdanovTakens);
            let start = Continuation::new(&mut system).from(&[-1.0, 0.0]).at("a", -1.0).at("b", b);
            let settings = Settings { max_step, ..Settings::default() };
            let branch = start.along("a", -1.0..=1.0).settings(settings).trace().unwrap();
            let of = |kind| branch.of_kind(kind).collect::<Vec<_>>();
            let (hopf, folds) = (of(Kind::HB), of(Kind::LP));
            assert_eq!((hopf.len(), folds.len()), (1, 1), "b = {b}, steps of {max_step}");
            assert!(hopf[0].converged && folds[0].converged, "b = {b}, steps of {max_step}");
            close(hopf[0].parameters[0], -b * b, 1e-12);
            close(folds[0].parameters[0], 0.0, 1e-12);
        }
    }
}

/// Along a curve of folds the fold, the cusp and the Bogdanov–Takens point share the null vectors of
/// a point. The two conditions that are test functions only cost none of their own: before, a point
/// cost two more.
#[test]
fn conditions_at_a_point_share_its_null_vectors() {
    let (mut system, counts) = Counted::new(Box::new(Dense::new(BogdanovTakens)));
    let start = Continuation::new(&mut system).from(&[-1.0, 0.0]).at("a", -1.0).at("b", 0.5);
    let branch = start.along("a", -1.0..=1.0).trace().unwrap();
    *counts.lock().unwrap() = Default::default();
    let curve = Continuation::new(&mut system)
        .restart(&branch, first(&branch, Kind::LP).label)
        .hold(Kind::LP)
        .along("a", -2.0..=2.0)
        .along("b", -3.0..=3.0)
        .settings(Settings { max_step: 0.01, ..Settings::default() })
        .trace()
        .unwrap();
    let takens = first(&curve, Kind::BT);
    close(takens.parameters[1], 0.0, 1e-12);
    let counts = *counts.lock().unwrap();
    let (points, factorisations) = (curve.points.len(), counts.factorisations);
    println!("{points} points: {counts:?}");
    assert!(points > 100 && factorisations <= 6 * points, "{points} points: {counts:?}");
}
