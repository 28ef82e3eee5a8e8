//! Promise: the curves that leave resonances 1:1 and 1:2 and generalised period doublings are the exact
//! ones, by collocation and shooting and of maps: folds, period doublings and torus points of the orbits,
//! and folds and torus points of doubled orbits.

use super::{at, model, range, set};
use crate::common::close;
use std::f64::consts::PI;
use tangency::core::continuation::Branch;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Following, Range, Request, Scene, execute};

const METHODS: [&str; 3] = ["method=collocation", "method=shooting", "method=shooting segments=3"];

/// A scene with what is followed from the points of codimension two on its curve.
fn followed(scene: &Scene) -> Document {
    let kinds = vec![Kind::R1, Kind::R2, Kind::GPD];
    let following = Following { kinds, depth: 1, distinct: false };
    let (_, outcome) = scene.resolve(None).unwrap().explore(&following, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    for branch in &outcome.document.branches {
        assert!(branch.warnings.is_empty(), "{}: {:?}", branch.name, branch.warnings);
    }
    outcome.document
}

/// The curve of special points of a kind of a model, and what is followed from there.
fn explored(name: &str, values: &str, held: Kind, along: [Range; 2]) -> Document {
    let request = Request {
        set: set(values),
        along: along.into(),
        settle: Some(100.0),
        hold: Some(held),
        ..Request::default()
    };
    followed(&Scene::of_model(model(name), name, &request).unwrap())
}

/// The curve with this name, of points of a kind.
#[track_caller]
fn named<'d>(document: &'d Document, name: &str, kind: Kind) -> &'d Branch {
    let known: Vec<&str> = document.branches.iter().map(|branch| branch.name.as_str()).collect();
    let branch = document.branches.iter().find(|branch| branch.name.ends_with(name));
    let branch = branch.unwrap_or_else(|| panic!("no {name} among {known:?}"));
    assert_eq!(branch.condition, Some(kind));
    assert!(branch.points.len() > 5, "{name}: {} points", branch.points.len());
    branch
}

/// The values of some columns at each point of a curve.
fn columns<const N: usize>(curve: &Branch, names: [&str; N]) -> Vec<[f64; N]> {
    let columns = names.map(|name| curve.column(name).unwrap_or_else(|| panic!("{name}")));
    let values = curve.points.iter().map(|point| columns.map(|k| point.value(k).unwrap()));
    values.collect()
}

/// The largest value of a column on a curve.
fn farthest(curve: &Branch, name: &str) -> f64 {
    columns(curve, [name]).iter().fold(0.0, |most: f64, [value]| most.max(value.abs()))
}

/// `s' = Z`, `Z' = e₁ + e₂ Z + a s² + b s Z`, `θ' = 1 − s` with a = 1, b = 0.4: cycles with the constant `s`
/// fold at `e₁ = 0` and are torus points at `e₁ = −a s²`, `e₂ = −b s`, `s < 0`. The angle is less than π up to
/// `s = −0.17`.
#[test]
fn folds_and_torus_points_meet_at_a_resonance_1_1() {
    let [e1, e2] = [range("e1", -0.2, 0.2), range("e2", -0.3, 0.06)];
    let on_tori = |curve: &Branch| {
        for [e1, e2, angle] in columns(curve, ["e1", "e2", "torus_angle"]) {
            close(e1, -(e2 / 0.4).powi(2), 1e-9);
            let s = -e2 / 0.4;
            close(angle.cos(), ((-2.0 * s).max(0.0).sqrt() * 2.0 * PI / (1.0 - s)).cos(), 1e-7);
        }
        assert!(farthest(curve, "e2") > 0.059, "{}", farthest(curve, "e2"));
        at(curve, Kind::R1, "e2", 0.0, 1e-9);
    };
    for method in METHODS {
        let document = explored("resonant-one", method, Kind::LP, [e1.clone(), e2.clone()]);
        on_tori(named(&document, "R1-TR", Kind::TR));
        let values = format!("{method} e1=-0.02");
        let document = explored("resonant-one", &values, Kind::TR, [e2.clone(), e1.clone()]);
        let folds = named(&document, "R1-LP", Kind::LP);
        columns(folds, ["e1"]).iter().for_each(|[e1]| close(*e1, 0.0, 1e-9));
        assert!(farthest(folds, "e2") > 0.29);
    }
}

/// In a frame that turns by half in a period `p' = q`, `q' = e₁ p + e₂ q + a p³ + b p² q`: doubled orbits have
/// `p² = −e₁/a`, and are torus points at `e₂ = (b/a) e₁` if `a < 0`, with an angle less than π up to `e₁ = 1/32`.
#[test]
fn curves_of_orbits_and_of_doubled_orbits_leave_a_resonance_1_2() {
    let [e1, e2] = [range("e1", -0.2, 0.03), range("e2", -0.3, 0.3)];
    let doubled = |curve: &Branch| {
        for [e1, e2, angle, period] in columns(curve, ["e1", "e2", "torus_angle", "period"]) {
            close(e2, -0.5 / -0.3 * e1, 1e-9);
            close(period, 4.0 * PI, 1e-9);
            close(angle.cos(), (4.0 * PI * (2.0 * e1).sqrt()).cos(), 1e-7);
        }
        assert!(columns(curve, ["e1"]).windows(2).all(|pair| pair[1][0] > pair[0][0]));
        assert!(farthest(curve, "e1") > 0.029);
    };
    for method in METHODS {
        let values = format!("{method} a=-0.3");
        let document = explored("resonant-two", &values, Kind::PD, [e1.clone(), e2.clone()]);
        let tori = named(&document, "R2-TR", Kind::TR);
        columns(tori, ["e2"]).iter().for_each(|[e2]| close(*e2, 0.0, 1e-9));
        assert!(columns(tori, ["e1"]).iter().all(|[e1]| *e1 < 1e-12) && farthest(tori, "e1") > 0.1);
        at(tori, Kind::R2, "e1", 0.0, 1e-9);
        doubled(named(&document, "R2-TR.2", Kind::TR));
        // The other ways are the same by all methods.
        if method != METHODS[1] {
            continue;
        }
        let document = explored("resonant-two", &values, Kind::TR, [e2.clone(), e1.clone()]);
        let flips = named(&document, "R2-PD", Kind::PD);
        columns(flips, ["e1"]).iter().for_each(|[e1]| close(*e1, 0.0, 1e-9));
        doubled(named(&document, "R2-TR", Kind::TR));
        // With a > 0 no doubled orbit is a torus point.
        let values = format!("{method} a=0.3");
        let document = explored("resonant-two", &values, Kind::PD, [e1.clone(), e2.clone()]);
        let tori = document.branches.iter().filter(|branch| branch.condition == Some(Kind::TR));
        assert_eq!(tori.count(), 1);
    }
}

/// Doubled orbits `μ + c p² + e p⁴ = 0` fold at `μ = c²/(4e)`, `c = −2 e p²`.
#[test]
fn folds_of_doubled_orbits_leave_a_generalised_period_doubling() {
    for (method, e) in METHODS.into_iter().flat_map(|method| [(method, 0.3), (method, -0.5)]) {
        let along = [range("mu", -0.2, 0.2), range("c", -0.3, 0.3)];
        let document = explored("flipped", &format!("{method} e={e}"), Kind::PD, along);
        let folds = named(&document, "GPD-LP", Kind::LP);
        let points = columns(folds, ["mu", "c", "period"]);
        for [mu, c, period] in &points {
            close(*mu, c * c / (4.0 * e), 1e-9);
            close(*period, 4.0 * PI, 1e-9);
            assert!(c * e < 0.0);
        }
        assert!(points.windows(2).all(|pair| pair[1][1].abs() > pair[0][1].abs()));
        assert!(farthest(folds, "c") > 0.29);
    }
}

/// The curve of special points of the pulsed map, and what is followed from there.
fn of_pulsed_map(kind: Kind, first: &str, (al, be, x): (f64, f64, f64)) -> Document {
    let mut along = vec![range("al", -2.0, 5.0), range("be", -3.0, 3.0)];
    if first == "be" {
        along.reverse();
    }
    let set = vec![("al".into(), al.to_string()), ("be".into(), be.to_string())];
    let state = vec![("x".into(), x), ("y".into(), x)];
    let request = Request { set, along, state, hold: Some(kind), ..Request::default() };
    followed(&Scene::of_model(model("pulsed-map"), "test", &request).unwrap())
}

/// Fixed points `x` have `α = x (1 + β) + x²/2`. They fold at `β = −1 − x`, and are torus points at
/// `β = 1 + x/2` and period doublings at `β = 2x − 1`. Cycles of two iterates have the sum `1 + β` and the
/// product `((1 + β)² − α)/(1 + R)`, and the determinant 1 at `α = 4β² − β − 5`.
#[test]
fn curves_leave_the_resonances_of_a_map() {
    let fixed = |curve: &Branch, beta: fn(f64) -> f64| {
        for [al, be, x] in columns(curve, ["al", "be", "x"]) {
            // Beside a resonance 1:1, where the equations are singular, half of the digits are left.
            let beside = (x + 4.0 / 3.0).abs() < 1e-6;
            close(be, beta(x), if beside { 1e-8 } else { 1e-10 });
            close(al, x * (1.0 + be) + 0.5 * x * x, 1e-10);
        }
    };
    let doubled = |curve: &Branch| {
        for [al, be] in columns(curve, ["al", "be"]) {
            close(al, 4.0 * be * be - be - 5.0, 1e-10);
        }
        assert!(farthest(curve, "al") > 4.6, "{}", farthest(curve, "al"));
    };
    let document = of_pulsed_map(Kind::LP, "al", (0.2, 0.6, 0.1));
    fixed(named(&document, "R1-TR", Kind::TR), |x| 1.0 + 0.5 * x);
    let document = of_pulsed_map(Kind::PD, "al", (0.2, 0.6, 0.1));
    fixed(named(&document, "R2-TR", Kind::TR), |x| 1.0 + 0.5 * x);
    doubled(named(&document, "R2-TR.2", Kind::TR));
    let document = of_pulsed_map(Kind::TR, "be", (0.5625, 0.2, 0.3));
    fixed(named(&document, "R1-LP", Kind::LP), |x| -1.0 - x);
    fixed(named(&document, "R2-PD", Kind::PD), |x| 2.0 * x - 1.0);
    doubled(named(&document, "R2-TR", Kind::TR));
}

/// `x → −x (1 + p + q x² + e x⁴)` in the coordinate `X = x + z`, `z → z/2 + x²`: cycles of `x` and `−x` have
/// `p + q x² + e x⁴ = 0`.
#[test]
fn folds_of_doubled_cycles_leave_a_generalised_period_doubling_of_a_map() {
    let scene = |runs: &str| {
        let text = format!(
            "Scene(title: \"planted\", problem: Map(states: [(\"X\", \"-x*(1 + p + q*x^2 - 0.7*x^4) + z/2 + x^2\"), \
             (\"z\", \"z/2 + x^2\")], definitions: [(\"x\", \"X - z\")], parameters: [(\"p\", -0.2), (\"q\", -1)]), \
             runs: [(name: \"points\", along: [(name: \"p\", low: -0.5, high: 0.5)]), (name: \"curve\", start: \
             From(run: \"points\", kind: PD), hold: PD, along: [(name: \"q\", low: -1, high: 1), (name: \"p\", low: \
             -0.5, high: 0.5)]){runs}])"
        );
        Scene::parse(&text).unwrap_or_else(|error| panic!("{text}: {error}"))
    };
    let check = |folds: &Branch| {
        for [p, q] in columns(folds, ["p", "q"]) {
            close(p, q * q / (4.0 * -0.7), 1e-10);
            assert!(q > 0.0);
        }
        assert!(farthest(folds, "q") > 0.9);
    };
    check(named(&followed(&scene("")), "GPD-LP", Kind::LP));
    // In a scene of its own runs.
    let run = ", (name: \"folds\", start: From(run: \"curve\", kind: GPD), hold: LP, along: [(name: \"q\", low: -1, \
               high: 1), (name: \"p\", low: -0.5, high: 0.5)])";
    let outcome = execute(&scene(run), None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    check(named(&outcome.document, "folds", Kind::LP));
}
