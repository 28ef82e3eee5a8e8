//! Promise: the normal forms and resonances of fixed points of `(x, y) → (y, α − β x − y² + R x y)`,
//! `R = ½`, which are known in closed form.

use super::{at, coefficient, model, range, set, traced};
use crate::common::close;
use tangency::core::continuation::SpecialPoint;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Request, Scene, execute};

fn curve(kind: Kind, first: &str, al: [f64; 2], be: [f64; 2], start: (f64, f64, f64)) -> Document {
    let ranges = [range("al", al[0], al[1]), range("be", be[0], be[1])];
    let mut along = ranges.to_vec();
    if first == "be" {
        along.reverse();
    }
    let (value_al, value_be, x) = start;
    let set = vec![("al".into(), value_al.to_string()), ("be".into(), value_be.to_string())];
    let state = vec![("x".into(), x), ("y".into(), x)];
    let request = Request { set, along, state, hold: Some(kind), ..Request::default() };
    traced(model("pulsed-map"), &request)
}

/// The map with multiplier −1: `ξ → −ξ + b ξ³` with `b = −c`.
#[test]
fn period_doublings_and_torus_points_of_a_map() {
    let document = curve(Kind::PD, "al", [-0.4, 5.0], [-3.0, 3.0], (0.2, 0.6, 0.1));
    let doubling = at(&document.branches[0], Kind::PD, "al", 1.6, 1e-12);
    coefficient(doubling, "doubling_c", -0.78125, 1e-9);
    let document = curve(Kind::TR, "be", [-2.0, 5.0], [0.2, 2.0], (0.5625, 0.2, 0.3));
    let torus = at(&document.branches[0], Kind::TR, "be", 1.125, 1e-12);
    coefficient(torus, "torus_d_re", 1.0 / 38.0, 1e-9);
    coefficient(torus, "torus_d_im", 0.163089831352, 1e-9);
    assert_eq!(torus.subkind.as_deref(), Some("subcritical"));
}

/// The same map by pulses at given times, as orbits of a hybrid system.
#[test]
fn period_doublings_and_torus_points_of_pulsed_motion() {
    for method in ["shooting", "collocation"] {
        let branch = |values: &str, low, high| {
            let set = set(&format!("{values} method={method}"));
            let along = vec![range("be", low, high)];
            let request = Request { set, along, settle: Some(1000.0), ..Request::default() };
            traced(model("pulses"), &request).branches.remove(0)
        };
        let fixed = branch("al=1.6 be=0.75", 0.5, 0.8);
        let doubling = at(&fixed, Kind::PD, "be", 0.6, 1e-9);
        coefficient(doubling, "doubling_c", -0.78125 / 4.0, 1e-7);
        let fixed = branch("al=0.5625 be=1.05", 1.0, 1.2);
        let torus = at(&fixed, Kind::TR, "be", 1.125, 1e-9);
        coefficient(torus, "torus_d_re", 1.0 / 152.0, 1e-7);
        coefficient(torus, "torus_d_im", 0.163089831352 / 4.0, 1e-7);
        assert_eq!(torus.subkind.as_deref(), Some("subcritical"));
    }
}

#[test]
fn all_strong_resonances_of_a_map() {
    let document = curve(Kind::TR, "be", [-2.0, 5.0], [0.2, 2.0], (0.5625, 0.2, 0.3));
    let torus = document.branches.last().unwrap();
    for (kind, al, be, angle) in [
        (Kind::R1, -8.0 / 9.0, 1.0 / 3.0, 0.0),
        (Kind::R2, 40.0 / 9.0, 5.0 / 3.0, std::f64::consts::PI),
        (Kind::R3, 16.0 / 9.0, 4.0 / 3.0, 2.0 * std::f64::consts::PI / 3.0),
        (Kind::R4, 0.0, 1.0, 0.5 * std::f64::consts::PI),
    ] {
        let point = at(torus, kind, "al", al, 1e-12);
        close(point.parameters[1], be, 1e-12);
        close(*point.monitors.last().unwrap(), angle, 1e-15);
        assert!(point.error < 1e-13);
        resonance(point);
    }
    // The same from the curves of folds and period doublings, with the fold–flip at (0, −1).
    let doublings = curve(Kind::PD, "al", [-0.4, 5.0], [-3.0, 3.0], (0.2, 0.6, 0.1));
    let doublings = doublings.branches.last().unwrap();
    resonance(at(doublings, Kind::R2, "al", 40.0 / 9.0, 1e-12));
    at(doublings, Kind::LPPD, "al", 0.0, 1e-12);
    assert_eq!(doublings.of_kind(Kind::GPD).count(), 0, "poles are no zeros");
    let folds = curve(Kind::LP, "al", [-2.0, 5.0], [-3.0, 3.0], (0.2, 0.6, 0.1));
    let folds = folds.branches.last().unwrap();
    resonance(at(folds, Kind::R1, "al", -8.0 / 9.0, 1e-12));
    // At (0, −1), with u = (x + y)/√2 and w = (x − y)/√2, u → u − (u² − 4uw + 3w²)/(4√2) and
    // w → −w + (u² − 4uw + 3w²)/(4√2); u may be replaced by −u.
    let both = at(folds, Kind::LPPD, "al", 0.0, 1e-12);
    coefficient(both, "lppd_a20", 1.0 / 32.0_f64.sqrt(), 1e-9);
    coefficient(both, "lppd_a02", 3.0 / 32.0_f64.sqrt(), 1e-9);
    coefficient(both, "lppd_b11", -(0.5_f64.sqrt()), 1e-9);
    coefficient(both, "lppd_theta", -4.0, 1e-9);
}

/// The coefficients of maps in closed form. Normal forms of maps are those of flows after a unit of
/// time:
///
/// ```text
///     1:1   ξ₂ → ξ₂ + a ξ₁² + (b + 2a) ξ₁ ξ₂           a = −√2/4, b + 2a = −3√2/4, or both of the other sign
///     1:2   ξ₂ → −ξ₂ + a ξ₁³ − (b + 3a) ξ₁² ξ₂         a = −3/8, −(b + 3a) = 35/32
///     1:3   ξ → e^{iθ} (ξ + b ξ̄² + (c + |b|²) ξ |ξ|²)   |b| = √(7/24), Re c + |b|² = 5/16
///     1:4   ξ → i (ξ + c ξ |ξ|² + d ξ̄³)                c = (1 − i)/32, |d| = √(65/512)
/// ```
fn resonance(point: &SpecialPoint) {
    let (d, root) = ((65.0_f64 / 512.0).sqrt(), 0.125_f64.sqrt());
    let (expected, case): (&[(&str, f64)], _) = match point.kind {
        Kind::R1 => (&[("r1_a", root), ("r1_b", root)], "s = 1"),
        Kind::R2 => (&[("r2_a", -0.375), ("r2_b", 1.0 / 32.0)], "s = −1, b > 0"),
        Kind::R3 => (&[("r3_b", (7.0_f64 / 24.0).sqrt()), ("r3_c_re", 1.0 / 48.0)], "c > 0"),
        _ => {
            let a0 = 1.0 / 32.0 / d;
            (&[("r4_a0_re", a0), ("r4_a0_im", -a0), ("r4_d", d)], "Re A₀ > 0")
        }
    };
    for (name, value) in expected {
        coefficient(point, name, *value, 1e-7);
    }
    assert_eq!(point.subkind.as_deref(), Some(case));
}

/// A scene of a map, and the curve of special points of a kind.
fn planted(map: &str, along: &str, kind: Kind, curve: &str) -> Document {
    let text = format!(
        "Scene(title: \"planted\", problem: Map({map}), runs: [(name: \"points\", along: [{along}]), (name: \
         \"curve\", start: From(run: \"points\", kind: {kind}), hold: {kind}, along: [{curve}])])"
    );
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document
}

/// `x → x + p + q x − 3x³ + x z` with the center manifold `z = 2x² + …`: `c = −3 + 2`.
#[test]
fn the_cusp_of_a_map() {
    let map = "states: [(\"x\", \"x + p + q*x - 3*x^3 + x*z\"), (\"z\", \"z/2 + x^2\")], parameters: [(\"p\", -0.3), \
               (\"q\", 0.4)], initial: [(\"x\", -0.8), (\"z\", 1.2)]";
    let [p, q] = ["(name: \"p\", low: -0.5, high: 0.5)", "(name: \"q\", low: -0.5, high: 0.6)"];
    let document = planted(map, p, Kind::LP, &format!("{p}, {q}"));
    let cusp = at(&document.branches[1], Kind::CP, "q", 0.0, 1e-10);
    coefficient(cusp, "cusp_c", -1.0, 1e-9);
}

/// `x → −(1 + p) x + q x³ + 0.7 x⁵ + x z` with the center manifold `z = 2x² − 0.6 x⁴ + …`, so that
/// `x → −x + (q + 2) x³ + 0.1 x⁵` at p = 0.
#[test]
fn the_generalised_period_doubling_of_a_map() {
    let map = "states: [(\"x\", \"-(1 + p)*x + q*x^3 + 0.7*x^5 + x*z\"), (\"z\", \"z/2 + x^2 - 0.3*x^4\")], parameters: \
               [(\"p\", -0.2), (\"q\", -1)]";
    let [p, q] = ["(name: \"p\", low: -0.5, high: 0.5)", "(name: \"q\", low: -3, high: 0)"];
    let document = planted(map, p, Kind::PD, &format!("{q}, {p}"));
    let point = at(&document.branches[1], Kind::GPD, "q", -2.0, 1e-9);
    coefficient(point, "gpd_e", -0.1, 1e-6);
    assert_eq!(point.subkind.as_deref(), Some("e < 0"));
}

/// `w → e^{iθ} w (1 + p + (q + 0.4i) |w|² + (0.2 − 0.1i) |w|⁴) + w z` with the center manifold
/// `z = 2|w|²` where `q = −2 cos θ`. The modulus of `w` is multiplied by
/// `1 + (0.2 + ½ (0.4 − 2 sin θ)²) |w|⁴`, and `⟨q, q⟩ = 1` gives another factor 4.
#[test]
fn the_chenciner_point_of_a_map() {
    let angle = 1.1_f64;
    let map = format!(
        "states: [(\"x\", \"cos({angle})*u - sin({angle})*v + x*z\"), (\"y\", \"sin({angle})*u + cos({angle})*v + \
         y*z\"), (\"z\", \"z/2 + r\")], definitions: [(\"r\", \"x^2 + y^2\"), (\"m\", \"1 + p + q*r + 0.2*r^2\"), \
         (\"n\", \"0.4*r - 0.1*r^2\"), (\"u\", \"m*x - n*y\"), (\"v\", \"n*x + m*y\")], parameters: [(\"p\", -0.2), \
         (\"q\", -0.5)]"
    );
    let [p, q] = ["(name: \"p\", low: -0.5, high: 0.5)", "(name: \"q\", low: -2, high: 0)"];
    let document = planted(&map, p, Kind::TR, &format!("{q}, {p}"));
    let point = at(&document.branches[1], Kind::CH, "q", -2.0 * angle.cos(), 1e-9);
    let e = 4.0 * (0.2 + 0.5 * (0.4 - 2.0 * angle.sin()).powi(2));
    coefficient(point, "ch_e_re", e, 1e-6);
    assert_eq!(point.subkind.as_deref(), Some("e > 0"));
}
