//! Promise: modes that are combinations of alternatives are those that all combinations written out are.

use crate::common::close;
use tangency::core::continuation::Branch;
use tangency::core::failure::one_line;
use tangency::scene::{Scene, execute};

fn traced(model: &str) -> Vec<Branch> {
    let along = "along: [(name: \"A\", low: 0.4, high: 1)]";
    let text = format!(
        "Scene(title: \"t\", problem: {model}, runs: [
            (name: \"r\", start: Simulated(transient: 300), {along}),
            (name: \"s\", start: From(run: \"r\", kind: G, nth: 1, switch: true), {along}),
            (name: \"t\", start: From(run: \"s\", kind: G, switch: true), {along})])"
    );
    let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document.branches
}

/// A capsule that a mass inside drives, which may touch a wall with a spring: stick, slip forward,
/// slip back, each with and without contact.
const CAPSULE: &str = r#"HybridEquations(
    states: [("y", "u - w"), ("u", "A*cos(om*t) - F")],
    product: [
        [
            (name: "stick", definitions: [("w", "0")]),
            (name: "forward", states: [("w", "(F - mu)/gam")]),
            (name: "back", states: [("w", "(F + mu)/gam")]),
        ],
        [
            (name: "free", definitions: [("wall", "0")]),
            (name: "contact", definitions: [("wall", "K*(y - gap)")]),
        ],
    ],
    definitions: [("F", "y + 0.1*(u - w) + wall")],
    guards: [
        (name: "touch", modes: ["free"], function: "gap - y", next: "contact"),
        (name: "part", modes: ["contact"], function: "y - gap", next: "free"),
        (name: "go", modes: ["stick"], function: "mu - F", next: "forward", reset: [("w", 0)]),
        (name: "go_back", modes: ["stick"], function: "mu + F", next: "back", reset: [("w", 0)]),
        (name: "stop", modes: ["forward"], function: "w", reset: [("w", 0)],
         next: [("stick", "mu - abs(F)"), ("back", "-F"), "forward"]),
        (name: "stop", modes: ["back"], function: "-w", reset: [("w", 0)],
         next: [("stick", "mu - abs(F)"), ("forward", "F"), "back"]),
    ],
    parameters: [("A", 0.6), ("om", 0.9), ("K", 15), ("gap", 0.02), ("mu", 0.3), ("gam", 2)],
    period: "2*pi/om",
)"#;

/// The same with each mode and each guard written out.
fn written_out() -> String {
    let (mut modes, mut guards) = (String::new(), String::new());
    let mut guard = |name: &str, mode: &str, rest: String| {
        guards += &format!("(name: \"{name}\", modes: [\"{mode}\"], {rest}),\n");
    };
    for (wall, force) in [("N", ""), ("C", " + K*(y - gap)")] {
        let still = format!("(y + 0.1*u{force})");
        let moving = format!("(y + 0.1*(u - w){force})");
        modes += &format!(
            "(name: \"s{wall}\", states: [(\"y\", \"u\"), (\"u\", \"A*cos(om*t) - {still}\")]),
             (name: \"f{wall}\", states: [(\"y\", \"u - w\"), (\"u\", \"A*cos(om*t) - {moving}\"),
                                        (\"w\", \"({moving} - mu)/gam\")]),
             (name: \"b{wall}\", states: [(\"y\", \"u - w\"), (\"u\", \"A*cos(om*t) - {moving}\"),
                                        (\"w\", \"({moving} + mu)/gam\")]),"
        );
        for slip in ["s", "f", "b"] {
            match wall {
                "N" => guard(
                    "touch",
                    &format!("{slip}N"),
                    format!("function: \"gap - y\", next: \"{slip}C\""),
                ),
                _ => guard(
                    "part",
                    &format!("{slip}C"),
                    format!("function: \"y - gap\", next: \"{slip}N\""),
                ),
            }
        }
        let reset = "reset: [(\"w\", 0)]";
        guard(
            "go",
            &format!("s{wall}"),
            format!("function: \"mu - {still}\", next: \"f{wall}\", {reset}"),
        );
        guard(
            "go_back",
            &format!("s{wall}"),
            format!("function: \"mu + {still}\", next: \"b{wall}\", {reset}"),
        );
        for (slip, sign, other, force) in [("f", "", "b", "-"), ("b", "-", "f", "")] {
            guard(
                "stop",
                &format!("{slip}{wall}"),
                format!(
                    "function: \"{sign}w\", {reset}, next: [(\"s{wall}\", \"mu - abs{moving}\"),
                 (\"{other}{wall}\", \"{force}{moving}\"), \"{slip}{wall}\"]"
                ),
            );
        }
    }
    format!(
        "HybridEquations(modes: [{modes}], guards: [{guards}],
            parameters: [(\"A\", 0.6), (\"om\", 0.9), (\"K\", 15), (\"gap\", 0.02), (\"mu\", 0.3), (\"gam\", 2)],
            period: \"2*pi/om\")"
    )
}

#[test]
fn combinations_are_those_that_are_written_out() {
    let [product, written] = [CAPSULE, &written_out()].map(traced);
    assert_eq!(product.len(), 3);
    for (a, b) in product.iter().zip(&written) {
        let long = |words: &str| {
            [("f", "forward"), ("b", "back"), ("s", "stick")]
                .into_iter()
                .flat_map(|(short, slip)| {
                    [("N", "free"), ("C", "contact")].map(|(wall, contact)| {
                        (format!("{short}{wall}:"), format!("{slip}.{contact}:"))
                    })
                })
                .fold(words.to_string(), |words, (short, long)| words.replace(&short, &long))
        };
        assert_eq!(a.itinerary, long(&b.itinerary));
        assert_eq!(a.special.len(), b.special.len());
        for (a, b) in a.special.iter().zip(&b.special) {
            assert_eq!((a.kind, a.unstable), (b.kind, b.unstable));
            close(a.parameters[0], b.parameters[0], 1e-10);
        }
    }
}

fn refusal(model: &str) -> String {
    let run = "runs: [(name: \"r\", start: Simulated(transient: 1), along: [(name: \"A\", low: 0, high: 1)])]";
    one_line(&Scene::parse(&format!("Scene(title: \"t\", problem: {model}, {run})")).unwrap_err())
}

#[test]
fn combinations_that_have_no_meaning_are_refused() {
    let with = |from: &str, to: &str| refusal(&CAPSULE.replace(from, to));
    let unknown = with("next: \"contact\"", "next: \"contract\"");
    assert!(unknown.contains("`contract`") && unknown.contains("stick"), "{unknown}");
    let twice = with("(name: \"free\"", "(name: \"stick\"");
    assert!(twice.contains("`stick` is already an alternative"), "{twice}");
    let beside = with("product: [", "modes: [(name: \"m\")], product: [");
    assert!(beside.contains("`modes` together with `product`"), "{beside}");
    let none = with("product: [", "product: [[],");
    assert!(none.contains("between 1 and 256"), "{none}");
    // In one guard a combination stands once.
    let overlap = with("modes: [\"free\"]", "modes: [\"free\", \"stick.free\"]");
    assert!(overlap.contains("`stick.free` is already a mode of this guard"), "{overlap}");
    let both = with("modes: [\"free\"]", "modes: [\"free.contact\"]");
    assert!(both.contains("`free.contact`"), "{both}");
}
