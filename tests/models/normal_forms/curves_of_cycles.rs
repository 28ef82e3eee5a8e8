//! Promise: the curve of folds of cycles that begins at a generalised Hopf point of a model is tangent to
//! the curve of Hopf points as the normal forms say, and its points are the folds found in one parameter.

use super::{model, range, set};
use crate::common::close;
use tangency::core::continuation::Branch;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Following, Request, Scene, StartPoint, execute};

/// The highest value of `k` in two parameters.
const MOST: f64 = 0.312;

/// Values of `k`, with `Re c₂` and the value of `k` at the generalised Hopf point nearby.
const NEAR: [(f64, f64, f64); 4] = [
    (0.2335, -776.900344344, 0.232487354203),
    (0.2345, -776.900344344, 0.232487354203),
    (0.3064, -240.123387708, 0.305879267478),
    (0.3069, -240.123387708, 0.305879267478),
];

/// The value of `k` at which folds are compared with the ones on a branch of cycles.
const FARTHER: f64 = 0.25;

fn following(kind: Kind) -> Following {
    Following { kinds: vec![kind], depth: 1, distinct: false }
}

/// The scene of a curve of special points in `q2` and `k`, with marks.
fn in_two_parameters(held: Kind) -> Scene {
    let marks = NEAR.iter().map(|near| near.0).chain([FARTHER]);
    let request = Request {
        along: vec![range("q2", 0.5, 2.0), range("k", 0.1, MOST)],
        hold: Some(held),
        marks: marks.map(|k| ("k".into(), k)).collect(),
        ..Request::default()
    };
    Scene::of_model(model("co-oxidation"), "test", &request).unwrap()
}

/// Equilibria at a value of `k`, and the cycles from Hopf points.
fn in_one_parameter(k: f64) -> Document {
    let along = vec![range("q2", 0.5, 1.2)];
    let request = Request { along, set: set(&format!("k={k}")), ..Request::default() };
    let scene = Scene::of_model(model("co-oxidation"), "test", &request).unwrap();
    let (_, outcome) = scene.resolve(None).unwrap().explore(&following(Kind::HB), &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document
}

fn curves_of_cycles(document: &Document) -> Vec<&Branch> {
    let curves = document.branches.iter();
    curves.filter(|branch| branch.column("period").is_some()).collect()
}

/// The value of `q2` at the mark of a value of `k`.
fn marked(curve: &Branch, k: f64) -> Option<f64> {
    let [of_q2, of_k] = ["q2", "k"].map(|name| curve.column(name).unwrap());
    let mut marks = curve.of_kind(Kind::UZ);
    let mark = marks.find(|mark| (mark.value(of_k).unwrap() - k).abs() < 1e-12);
    mark.map(|mark| mark.value(of_q2).unwrap())
}

/// Near a generalised Hopf point `Re c₁ + 2 Re c₂ ρ² = 0` and the growth rate is `Re c₂ ρ⁴`, so that
/// folds have the growth rate `(Re c₁)²/(4 Re c₂)`, up to a part that is proportional to the distance
/// from the point.
#[test]
fn folds_of_cycles_are_tangent_to_the_curve_of_hopf_points() {
    let scene = in_two_parameters(Kind::HB);
    let (_, outcome) = scene.resolve(None).unwrap().explore(&following(Kind::GH), &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let document = outcome.document;
    let [first, second] = curves_of_cycles(&document)[..] else { panic!("not two curves") };
    let excess = NEAR.map(|(k, c2, _)| {
        let branches = in_one_parameter(k);
        let rest = &branches.branches[0];
        let q2 = rest.column("q2").unwrap();
        let folds = [first, second].into_iter().filter_map(|curve| marked(curve, k));
        let distances = folds.flat_map(|fold| {
            rest.of_kind(Kind::HB).map(move |hopf| (fold - hopf.value(q2).unwrap(), hopf))
        });
        let (distance, hopf) = distances.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap();
        let [c1, slope] = ["c1_re", "growth_slope"].map(|name| hopf.number(name).unwrap().value);
        distance * slope / (c1 * c1 / (4.0 * c2)) - 1.0
    });
    for pair in [0, 2] {
        let [near, far] = [pair, pair + 1].map(|i| NEAR[i].0 - NEAR[i].2);
        assert!(excess[pair].abs() < 0.01, "{excess:?}");
        close(excess[pair] / excess[pair + 1], near / far, 0.03);
    }
    // A fold of cycles in one parameter.
    let cycles = in_one_parameter(FARTHER);
    let folds = curves_of_cycles(&cycles).into_iter().flat_map(|branch| {
        let column = branch.column("q2").unwrap();
        branch.of_kind(Kind::LP).map(move |fold| fold.value(column).unwrap())
    });
    let on_curve = marked(first, FARTHER).or(marked(second, FARTHER)).unwrap();
    let nearest = folds.map(|fold| (fold - on_curve).abs()).fold(f64::INFINITY, f64::min);
    assert!(nearest < 1e-10, "the folds are {nearest:e} apart");
}

/// The curve begins at a saved point, too.
#[test]
fn a_curve_of_folds_of_cycles_begins_at_a_saved_generalised_hopf_point() {
    let hopf = execute(&in_two_parameters(Kind::HB), None, &mut ()).document;
    let curve = hopf.branches.last().unwrap();
    let point = curve.of_kind(Kind::GH).next().unwrap();
    let start = StartPoint::of(&hopf, curve.clone(), point.label);
    let outcome = execute(&in_two_parameters(Kind::LP), Some(&start), &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let [folds] = &outcome.document.branches[..] else { panic!("not one curve") };
    assert_eq!(folds.condition, Some(Kind::LP));
    let k = folds.column("k").unwrap();
    let begins =
        folds.points[0].value(k).unwrap() - point.value(curve.column("k").unwrap()).unwrap();
    assert!(folds.column("period").is_some() && (0.0..2e-3).contains(&begins), "{begins}");
}

/// The first cycle is small where the field is nonlinear, however far from the origin the equilibrium is.
#[test]
fn the_first_cycle_beside_a_point_is_as_small_as_the_field_demands() {
    let request = Request {
        along: vec![range("p", -0.3, 0.3), range("q", -0.6, 0.6)],
        hold: Some(Kind::HB),
        marks: vec![("q".into(), 0.2), ("q".into(), 0.4)],
        ..Request::default()
    };
    let scene = Scene::of_model(model("far"), "test", &request).unwrap();
    let (_, outcome) = scene.resolve(None).unwrap().explore(&following(Kind::GH), &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let document = outcome.document;
    let [curve] = curves_of_cycles(&document)[..] else { panic!("not one curve") };
    let [p, q] = ["p", "q"].map(|name| curve.column(name).unwrap());
    let folds: Vec<_> = curve.of_kind(Kind::UZ).collect();
    assert_eq!(folds.len(), 2);
    for fold in folds {
        let q = fold.value(q).unwrap();
        close(fold.value(p).unwrap(), -q * q / 4.0, 1e-9);
    }
}
