//! Promise: curves of folds and of torus points of cycles end where the cycles shrink onto an equilibrium.

use super::traced;
use crate::common::close;
use tangency::core::continuation::Branch;
use tangency::core::system::Kind;

const METHODS: [&str; 2] = ["collocation", "shooting"];

/// Returns the curve of special cycles that begins at the first point of a kind on a curve of Hopf points.
fn curve(
    [states, initial]: [&str; 2],
    parameters: &str,
    [held, from]: [&str; 2],
    method: &str,
) -> Branch {
    let both = r#"along: [(name: "la", low: -1, high: 2), (name: "mu", low: -2, high: 2)]"#;
    traced(&format!(
        r#"Scene(title: "t", problem: Equations(states: [{states}], initial: [{initial}], solution: equilibrium, method: {method}()),
        parameters: {parameters}, runs: [
            (name: "rest", along: [(name: "la", low: -2, high: 2)]),
            (name: "hopf", hold: HB, start: From(run: "rest", kind: HB), {both}),
            (name: "cycles", hold: {held}, start: From(run: "hopf", kind: {from}), {both})])"#
    ))
    .remove(2)
}

/// Asserts that a curve has no special point but its end, where its cycles shrink.
fn assert_ends(curve: &Branch, kind: Kind, parameters: [f64; 2], tolerance: f64) {
    let kinds: Vec<Kind> = curve.special.iter().map(|point| point.kind).collect();
    assert_eq!(kinds, [Kind::EP, kind], "{:?}", curve.ends);
    let end = &curve.special[1];
    assert!(
        end.converged && end.event.ends_with("the cycles shrink onto an equilibrium"),
        "{end:?}"
    );
    parameters
        .iter()
        .zip(&end.parameters)
        .for_each(|(exact, found)| close(*found, *exact, tolerance));
}

/// The cycle of the first oscillator has the squared amplitude `la (1 − la)`. Its torus points are at
/// `mu = la (1 − la)/2`, and end at both double Hopf points, where `mu` vanishes.
#[test]
fn torus_points_end_at_a_double_hopf_point() {
    let states = r#"
        ("x", "la*(1-la)*x - y - x*(x^2+y^2) - 0.5*x*(u^2+v^2) + 0.3*x*u"),
        ("y", "x + la*(1-la)*y - y*(x^2+y^2) - 0.5*y*(u^2+v^2)"),
        ("u", "mu*u - 2.2*v - u*(u^2+v^2) - 0.5*u*(x^2+y^2)"),
        ("v", "2.2*u + mu*v - v*(u^2+v^2) - 0.5*v*(x^2+y^2)")"#;
    for method in METHODS {
        let parameters = r#"[("la", -0.5), ("mu", -0.3)]"#;
        let curve = curve([states, ""], parameters, ["TR", "HH"], method);
        assert_ends(&curve, Kind::HH, [1.0, 0.0], 1e-9);
    }
}

/// With `la = 0`, the system is reversible, and its cycles with `z = 0` have multipliers on the unit
/// circle. The squared amplitude is `0.4 mu (1 − mu) − 0.09`.
#[test]
fn torus_points_end_at_a_fold_hopf_point() {
    let states = r#"
        ("x", "(la + z)*x - y - x*z^2"),
        ("y", "x + (la + z)*y - y*z^2 + 0.3*x*z"),
        ("z", "-0.09 + 0.4*mu*(1-mu) - z^2 - x^2 - y^2 + 0.2*z^3")"#;
    for method in METHODS {
        let parameters = r#"[("la", -0.2), ("mu", 0.5)]"#;
        let curve = curve([states, r#"("z", 0.1)"#], parameters, ["TR", "ZH"], method);
        assert_ends(&curve, Kind::ZH, [0.0, 0.5 - 0.025_f64.sqrt()], 1e-9);
    }
}

/// The radius of the cycles obeys `la + mu (1 − mu) r² = r⁴` up to the quadratic term, which does not move
/// the points at which the first Lyapunov coefficient vanishes. On a mesh, small cycles are inaccurate.
#[test]
fn folds_end_at_a_generalised_hopf_point() {
    let states = r#"
        ("x", "la*x - y + x*(x^2+y^2)*(mu*(1-mu) - x^2 - y^2) + 0.1*x^2"),
        ("y", "x + la*y + y*(x^2+y^2)*(mu*(1-mu) - x^2 - y^2)")"#;
    for (method, tolerance) in METHODS.into_iter().zip([1e-6, 1e-9]) {
        let parameters = r#"[("la", -0.2), ("mu", 0.5)]"#;
        let curve = curve([states, ""], parameters, ["LP", "GH"], method);
        assert_ends(&curve, Kind::GH, [0.0, 1.0], tolerance);
    }
}

/// Asserts that a curve ends at two points of a kind, where the halves of its doubled orbits coincide.
fn assert_halves_coincide(curve: &Branch, kind: Kind, parameters: [[f64; 2]; 2]) {
    let kinds: Vec<Kind> = curve.special.iter().map(|point| point.kind).collect();
    assert_eq!(kinds, [kind; 2], "{:?}", curve.ends);
    let mut found: Vec<&[f64]> = curve.special.iter().map(|it| &it.parameters[..2]).collect();
    found.sort_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
    for (found, exact) in found.into_iter().zip(parameters) {
        close(found[0], exact[0], 1e-8);
        close(found[1], exact[1], 1e-8);
    }
    assert!(curve.special.iter().all(|point| point.converged));
}

/// The 2-cycles `x, −x` with `m = C x² + x⁴` and `C = p² − 1/4` have folds at `m = −C²/4`, for `|p| < 1/2`.
#[test]
fn folds_of_doubled_orbits_end_at_a_generalised_period_doubling() {
    let both = r#"along: [(name: "m", low: -0.9, high: 0.9), (name: "p", low: -1, high: 1)]"#;
    let curve = traced(&format!(
        r#"Scene(title: "t", problem: Map(states: [("x", "-(1+m)*x + (p^2-0.25)*x^3 + x^5")], initial: [("x", 0)]),
        parameters: [("m", -0.5), ("p", 0.3)], runs: [
            (name: "rest", along: [(name: "m", low: -0.9, high: 0.9)]),
            (name: "doubled", start: From(run: "rest", kind: PD, switch: true), along: [(name: "m", low: -0.9, high: 0.9)]),
            (name: "folds", hold: LP, start: From(run: "doubled", kind: LP), {both})])"#
    ))
    .remove(2);
    assert_halves_coincide(&curve, Kind::GPD, [[0.0, -0.5], [0.0, 0.5]]);
}

/// The 2-cycles have `x² = m (1 − m)`. Their torus points are at `p = m (1 − m)`.
#[test]
fn torus_points_of_doubled_orbits_end_at_a_flip_torus_point() {
    let both = r#"along: [(name: "m", low: -0.9, high: 1.9), (name: "p", low: -1, high: 1)]"#;
    let pair = |u: &str, v: &str| {
        format!(
            "(1 + p - x^2 - u^2 - v^2)*(cos(theta)*{u} {} sin(theta)*{v})",
            if u == "u" { "-" } else { "+" }
        )
    };
    let curve = traced(&format!(
        r#"Scene(title: "t", problem: Map(
            states: [("x", "-(1 + m*(1-m))*x + x^3"), ("u", "{}"), ("v", "{}")],
            initial: [("x", 0), ("u", 0), ("v", 0)]),
        parameters: [("m", -0.5), ("p", 0.1), ("theta", 1)], runs: [
            (name: "rest", along: [(name: "m", low: -0.9, high: 0.5)]),
            (name: "doubled", start: From(run: "rest", kind: PD, switch: true), along: [(name: "m", low: -0.9, high: 0.5)]),
            (name: "tori", hold: TR, start: From(run: "doubled", kind: TR), {both})])"#,
        pair("u", "v"),
        pair("v", "u")
    ))
    .remove(2);
    assert_halves_coincide(&curve, Kind::PDNS, [[0.0, 0.0], [1.0, 0.0]]);
}
