//! Promise: branches pass grazings at which an event leaves the motion unchanged from both sides, and
//! curves of such grazings have no degenerate points. An orbit that consists of two equal halves after
//! it has lost an event is traversed once.

use crate::common::close;
use std::f64::consts::TAU;
use std::path::Path;
use tangency::core::continuation::{Branch, End};
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Following, Problem, Range, Request, Run, Scene, Start, execute};

/// A forced mass between two springs with backlash, in dimensionless form.
const BACKLASH: &str = r#"HybridEquations(
    states: [("x", "v")],
    modes: [
        (name: "free", states: [("v", "pull")]),
        (name: "drive", states: [("v", "pull - k*(x - 1)")]),
        (name: "coast", states: [("v", "pull - k*(x + 1)")]),
    ],
    definitions: [("pull", "10 + 6*cos(2*pi*f*t) - c*v")],
    guards: [
        (name: "on", modes: ["free"], function: "1 - x", next: "drive"),
        (name: "off", modes: ["drive"], function: "x - 1", next: "free"),
        (name: "back", modes: ["free"], function: "1 + x", next: "coast"),
        (name: "forth", modes: ["coast"], function: "-1 - x", next: "free"),
    ],
    parameters: [("f", 0.4), ("k", 20), ("c", 1)],
    period: "1/f",
)"#;

/// Two masses that exchange momentum at impacts.
const TWO_MASSES: &str = r#"HybridEquations(
    modes: [(name: "free", states: [
        ("x", "v"), ("v", "cos(w*t) - x - 0.1*v"), ("y", "u"), ("u", "(-1.5*y - 0.12*u)/m"),
    ])],
    definitions: [("m", 0.7), ("e", 0.7)],
    guards: [(name: "hit", modes: ["free"], function: "1.2 + y - x", reset: [
        ("v", "(v + m*u - m*e*(v - u))/(1 + m)"), ("u", "(v + m*u + e*(v - u))/(1 + m)"),
    ])],
    parameters: [("w", 0.7)],
    period: "2*pi/w",
)"#;

/// Returns the branch of a model over a range of its parameter, and the branches that emanate from
/// grazings.
fn traced(text: &str, (name, value): (&str, f64), [low, high]: [f64; 2]) -> Document {
    let problem = Problem::from_text(Path::new("model.ron"), text, &[]).unwrap();
    let along = vec![Range { name: name.into(), low: Some(low), high: Some(high) }];
    let set = vec![(name.into(), value.to_string())];
    let scene = Scene::of_model(problem, "t", &Request { along, set, ..Request::default() });
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    let following = Following { kinds: vec![Kind::G], depth: 2, distinct: false };
    let (_, outcome) = scene.resolve(None).unwrap().explore(&following, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    for branch in &outcome.document.branches {
        let lost = branch.warnings.iter().find(|it| it.contains("not traced"));
        assert!(lost.is_none(), "{lost:?}");
    }
    outcome.document
}

/// The values of the parameter at the grazings of a branch.
fn grazings(branch: &Branch, name: &str) -> Vec<f64> {
    let column = branch.column(name).unwrap();
    branch.of_kind(Kind::G).map(|point| point.value(column).unwrap()).collect()
}

/// The orbits with two contacts lose the second contact where the orbits with one contact gain it.
#[test]
fn a_soft_contact_is_lost_and_gained_at_one_point() {
    let up = traced(BACKLASH, ("f", 0.4), [0.2, 1.2]);
    let down = traced(BACKLASH, ("f", 1.0), [0.6, 1.2]);
    let last = up.branches.last().unwrap();
    assert!(matches!(last.ends[1], End::ParameterBound { .. }), "{:?}", last.ends);
    assert!(last.points.iter().all(|point| point.unstable == Some(0)));
    let lost = grazings(&up.branches[1], "f");
    let gained = grazings(&down.branches[0], "f");
    close(lost[0], 0.881074, 1e-5);
    close(gained[0], lost[0], 1e-7);
}

/// With a continuous force of contact, orbits with and without contact have the same multipliers, of
/// modulus less than 1.
#[test]
fn soft_contacts_have_no_degenerate_grazings() {
    let text = include_str!("../../scenes/library/soft-stop.ron");
    let range =
        |name: &str, low, high| Range { name: name.into(), low: Some(low), high: Some(high) };
    let along = vec![range("A", 0.0, 3.0), range("omega", 0.4, 1.6)];
    let start = Start::From {
        run: "pressed".into(),
        kind: Kind::EP,
        nth: 0,
        switch: false,
        which: 0,
        unconverged: false,
    };
    let curve = Run { hold: Some(Kind::G), start, ..Run::along("from contact", along) };
    let scene = Scene::parse(text).unwrap().with_runs([curve]).unwrap();
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    let curve = outcome.document.branches.iter().find(|it| it.name == "from contact").unwrap();
    assert!(curve.points.len() > 10 && curve.warnings.is_empty(), "{:?}", curve.warnings);
    assert!(curve.special.iter().all(|point| point.kind == Kind::EP), "{:?}", curve.special);
}

/// Where orbits of two forcing periods with three impacts lose one of them, two equal halves remain.
#[test]
fn equal_halves_are_traversed_once() {
    let document = traced(TWO_MASSES, ("w", 0.7), [0.66, 0.71]);
    let once = document.branches.iter().find(|it| it.itinerary == "free:hit").expect("a branch");
    let [w, period] = ["w", "period"].map(|name| once.column(name).unwrap());
    for point in &once.points {
        close(point.value(period).unwrap(), TAU / point.value(w).unwrap(), 1e-12);
        assert_eq!(point.unstable, Some(0));
    }
    assert!(!document.branches.iter().any(|it| it.itinerary == "2* free:hit free:hit"));
}
