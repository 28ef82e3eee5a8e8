//! Promise: curves of equilibria with a special point have all points of codimension two, and no others.

use super::traced;
use crate::common::{close, values};
use std::f64::consts::PI;
use tangency::core::continuation::SpecialPoint;
use tangency::core::system::Kind;

/// The curve of Hopf points of the flat state of the Gray–Scott equations passes two fold–Hopf points
/// in some steps. At the fold–Hopf point of mode `j`, the determinant of the mode's 2 × 2 matrix
/// vanishes.
#[test]
fn pairs_of_fold_hopf_points_are_found_in_one_step() {
    let model = r#"Residual(
        unknowns: [("u[i=1..n]", "Du*(u[i-1]-2*u[i]+u[i+1])*(n/L)^2 - u[i]*v[i]^2 + F*(1-u[i])"),
            ("v[i=1..n]", "Dv*(v[i-1]-2*v[i]+v[i+1])*(n/L)^2 + u[i]*v[i]^2 - (F+k)*v[i]")],
        definitions: [("n", 20), ("u[i=0..n+1]", "u[min(max(i,1),n)]"), ("v[i=0..n+1]", "v[min(max(i,1),n)]")],
        initial: [("u", 0.139), ("v", 0.43)], dynamics: flow)"#;
    let curves = traced(&format!(
        r#"Scene(title: "t", problem: {model},
        parameters: [("k", 0.03), ("F", 0.03), ("Du", 2e-5), ("Dv", 1e-5), ("L", 0.25)], runs: [
            (name: "rest", along: [(name: "k", low: 0.03, high: 0.07)]),
            (name: "hopf", hold: HB, start: From(run: "rest", kind: HB),
                along: [(name: "k", low: 0.03, high: 0.07), (name: "F", low: 0.005, high: 0.08)])])"#
    ));
    let determinant = |point: &SpecialPoint, mode: usize| {
        let (k, feed) = (point.parameters[0], point.parameters[1]);
        let c = 25600.0 * (mode as f64 * PI / 40.0).sin().powi(2);
        (-k - feed - 2e-5 * c) * (feed + k - 1e-5 * c) + 2.0 * (feed + k) * k
    };
    let found: Vec<&SpecialPoint> = curves[1].of_kind(Kind::ZH).collect();
    let mode_of = |point: &&SpecialPoint| {
        let mut modes = (1..20).filter(|mode| determinant(point, *mode).abs() < 1e-10);
        modes.next().unwrap_or_else(|| panic!("no mode is critical at {point:?}"))
    };
    let mut modes: Vec<usize> = found.iter().map(mode_of).collect();
    modes.sort_unstable();
    assert_eq!(modes, [1, 2, 3, 4, 5, 6]);
    for point in found {
        assert!(
            point.subkind.as_ref().is_none_or(|it| it.starts_with("pitchfork–Hopf")),
            "{point:?}"
        );
    }
}

/// Along the curve of Hopf points of a pair of cells, two further pairs become unstable in one step.
#[test]
fn two_double_hopf_points_are_found_in_one_step() {
    let cell = |k: usize, rate: &str, frequency: f64| {
        format!(
            r#"("x{k}", "({rate})*x{k} - {frequency}*y{k} - x{k}*(x{k}^2+y{k}^2)"),
               ("y{k}", "{frequency}*x{k} + ({rate})*y{k} - y{k}*(x{k}^2+y{k}^2)")"#
        )
    };
    let cells = [cell(1, "p", 1.0), cell(2, "q - 0.3", 1.7), cell(3, "q - 0.35", 2.3)].join(", ");
    let curves = traced(&format!(
        r#"Scene(title: "t", problem: Equations(states: [{cells}], solution: equilibrium),
        parameters: [("p", -0.5), ("q", -0.9)], runs: [
            (name: "rest", along: [(name: "p", low: -1, high: 1)]),
            (name: "hopf", hold: HB, start: From(run: "rest", kind: HB),
                along: [(name: "p", low: -1, high: 1), (name: "q", low: -1, high: 1)])])"#
    ));
    let mut places: Vec<f64> =
        curves[1].of_kind(Kind::HH).map(|point| point.parameters[1]).collect();
    places.sort_by(f64::total_cmp);
    assert_eq!(places.len(), 2, "{places:?}");
    places.iter().zip([0.3, 0.35]).for_each(|(place, exact)| close(*place, exact, 1e-9));
}

/// A second eigenvalue with an eigenvector of its own vanishes on a curve of folds: the curve has a warning.
#[test]
fn a_second_eigenvalue_on_a_curve_of_folds_is_a_warning() {
    let curves = traced(
        r#"Scene(title: "t", problem: Equations(
            states: [("u", "p + u^2"), ("v", "q*v - v^3")], initial: [("u", -0.7)], solution: equilibrium),
        parameters: [("p", -0.5), ("q", -0.9)], runs: [
            (name: "rest", along: [(name: "p", low: -1, high: 1)]),
            (name: "folds", hold: LP, start: From(run: "rest", kind: LP),
                along: [(name: "p", low: -1, high: 1), (name: "q", low: -1, high: 1)])])"#,
    );
    let warnings = &curves[1].warnings;
    assert!(
        warnings.iter().any(|it| it.contains("beside the curve changes by +1")),
        "{warnings:?}"
    );
}

/// On the curve of folds of the flat state, u = 1/2 and √F/2 = F + k, the states of patterns have curves of
/// folds that nearly coincide. With equal diffusion, mode `j` of 8 cells vanishes where √F/2 − 2F = 256 D (2 −
/// 2 cos(πj/8)): a second eigenvector, and no kind of special
/// point exists for this case. The only point of codimension two is the
/// Takens–Bogdanov point F = 1/16.
#[test]
fn points_of_nearby_curves_are_not_points_of_the_curve() {
    let text = r#"Scene(title: "Gray-Scott", problem: Residual(unknowns: [
            ("u[i=1..n]", "D*(u[i-1] - 2*u[i] + u[i+1])*(n/0.5)^2 - u[i]*v[i]^2 + F*(1 - u[i])"),
            ("v[i=1..n]", "D*(v[i-1] - 2*v[i] + v[i+1])*(n/0.5)^2 + u[i]*v[i]^2 - (F + k)*v[i]")],
        definitions: [("n", 8), ("u[i=0..n+1]", "u[min(max(i,1),n)]"), ("v[i=0..n+1]", "v[min(max(i,1),n)]")],
        parameters: [("k", 0.03), ("F", 0.03), ("D", 1e-5)], initial: [("u", 0.139), ("v", 0.43)], dynamics: flow),
        runs: [(name: "flat", along: [(name: "F", low: 0.002, high: 0.2)]),
            (name: "folds", start: From(run: "flat", kind: LP), hold: LP,
                along: [(name: "F", low: 0.002, high: 0.2), (name: "k", low: 0, high: 0.08)])])"#;
    let folds = &traced(text)[1];
    let inner: Vec<_> = folds.special.iter().filter(|point| point.kind != Kind::EP).collect();
    assert!(inner.len() == 1 && inner[0].kind == Kind::BT, "{:?}", values(folds, Kind::ZH, "F"));
    close(values(folds, Kind::BT, "F")[0], 1.0 / 16.0, 1e-9);
    let stated = |warning: &String| warning.split("F = ").nth(1)?.get(..8)?.parse().ok();
    let mut warned: Vec<f64> = folds.warnings.iter().filter_map(stated).collect();
    warned.sort_by(|a, b| b.total_cmp(a));
    assert_eq!(warned.len(), 7, "{:?}", folds.warnings);
    for (warned, j) in warned.into_iter().zip(1..) {
        let size = 2.56e-3 * (2.0 - 2.0 * (f64::from(j) * PI / 8.0).cos());
        // √F = (1 + √(1 − 32 size))/8.
        let f = ((1.0 + (1.0 - 32.0 * size).sqrt()) / 8.0).powi(2);
        close(warned, f, 2e-4);
    }
}

/// The cubic coefficients of Hopf points of the Lotka–Volterra equations without competition, and of
/// torus points of the area-preserving Hénon map, vanish along the whole curves.
#[test]
fn rounding_errors_of_coefficients_are_no_special_points() {
    let curve = |problem: &str, parameters: &str, [first, second]: [&str; 2], held: &str| {
        traced(&format!(
            r#"Scene(title: "t", problem: {problem}, parameters: [{parameters}], runs: [
                (name: "rest", along: [{first}]),
                (name: "curve", hold: {held}, start: From(run: "rest", kind: {held}), along: [{first}, {second}])])"#
        ))
        .remove(1)
    };
    let populations = curve(
        r#"Equations(states: [("x", "x*(a - y) - q*x^2"), ("y", "-c*y + d*x*y")], solution: equilibrium,
            initial: [("x", 1), ("y", 0.9)])"#,
        r#"("q", 0.1), ("a", 1), ("c", 1), ("d", 1)"#,
        [r#"(name: "q", low: -0.5, high: 0.5)"#, r#"(name: "a", low: 0.2, high: 3)"#],
        "HB",
    );
    let henon = curve(
        r#"Map(states: [("x", "1 - a*x^2 + y"), ("y", "b*x")], initial: [("x", 0.5), ("y", 0)])"#,
        r#"("a", 0.5), ("b", -0.7)"#,
        [r#"(name: "b", low: -1.5, high: 0.5)"#, r#"(name: "a", low: -1, high: 6)"#],
        "TR",
    );
    assert!(populations.points.len() > 5 && henon.points.len() > 20);
    for point in populations.special.iter().chain(&henon.special) {
        assert!(![Kind::GH, Kind::CH].contains(&point.kind), "{point:?}");
    }
}
