//! Promise: the numbers of fold–Hopf and double Hopf points do not depend on coordinates, nor on
//! time. The systems are normal forms with chosen coefficients, in other coordinates.

use super::{at, coefficient};
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Following, Scene};

/// What is traced of a scene, and the curves that meet its own at points of codimension two.
fn traced(text: &str) -> Document {
    let scene = Scene::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let following = Following { kinds: Following::of_curves(), depth: 1, distinct: false };
    let (_, outcome) = scene.resolve(None).unwrap().explore(&following, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document
}

/// `v' = β₁ + G₂₀₀/2 v² + G₀₁₁ r² + …`, `z' = (β₂ + iω + …) z` with `z = a + ib` (real and
/// imaginary parts of coefficients are given), in coordinates
/// with `v = V`, `a = A + V²/3 + V B/2`, `b = B + a²/5`.
#[test]
fn the_numbers_of_a_fold_hopf_point() {
    let [g200, g011, g300, g111] = [1.4, -0.8, 0.6, 0.3];
    let [g110, g210, g021] = [(0.35, 0.2), (-0.4, 0.7), (0.9, -1.1)];
    let omega = 1.3;
    let definitions = [
        ("v", "V".to_string()),
        ("a", "A + V^2/3 + V*B/2".to_string()),
        ("b", "B + a^2/5".to_string()),
        ("r2", "a^2 + b^2".to_string()),
        ("vd", format!("p + {g200}/2*v^2 + {g011}*r2 + {g300}/6*v^3 + {g111}*v*r2")),
        ("re", format!("q + {}*v + {}/2*v^2 + {}/2*r2", g110.0, g210.0, g021.0)),
        ("im", format!("{omega} + {}*v + {}/2*v^2 + {}/2*r2", g110.1, g210.1, g021.1)),
        ("ad", "re*a - im*b".to_string()),
        ("bd", "im*a + re*b".to_string()),
        // V' = v', a' = A' + 2V/3 V' + V' B/2 + V B'/2, b' = B' + 2a/5 a'.
        ("Bd", "bd - 2*a/5*ad".to_string()),
    ];
    let definitions: Vec<String> =
        definitions.iter().map(|(name, formula)| format!("(\"{name}\", \"{formula}\")")).collect();
    let text = format!(
        "Scene(title: \"planted\", problem: Equations(states: [(\"V\", \"vd\"), (\"A\", \"ad - (2*V/3 + B/2)*vd - \
         V/2*Bd\"), (\"B\", \"Bd\")], definitions: [{}], parameters: [(\"p\", -0.1), (\"q\", -0.3)], initial: \
         [(\"V\", -0.4)], solution: equilibrium), runs: [(name: \"rest\", along: [(name: \"q\", low: -0.4, high: \
         0.6)]), (name: \"curve\", start: From(run: \"rest\", kind: HB), hold: HB, along: [(name: \"q\", low: -1, \
         high: 1), (name: \"p\", low: -0.2, high: 0.1)])])",
        definitions.join(", ")
    );
    let document = traced(&text);
    let point = at(&document.branches[1], Kind::ZH, "p", 0.0, 1e-10);
    coefficient(point, "zh_s", -1.0, 1e-9);
    coefficient(point, "zh_theta", 2.0 * g110.0 / g200, 1e-9);
    let e = 0.5
        * (g210.0 + g110.0 * (g021.0 / g011 - g300 / g200 + g111 / g011)
            - g021.0 * g200 / (2.0 * g011));
    coefficient(point, "zh_e", e, 1e-9);
    assert_eq!(point.subkind.as_deref(), Some("s = −1, θ > 0"));
    // The curve of folds through the point, which sees the same.
    let folds = document.branches.last().unwrap();
    assert_eq!(folds.condition, Some(Kind::LP));
    let p = folds.column("p").unwrap();
    assert!(folds.points.iter().all(|point| point.value(p).unwrap().abs() < 1e-9));
}

/// Two oscillators with cubic coupling, in coordinates with `a = A + C²/4`.
#[test]
fn the_numbers_of_a_double_hopf_point() {
    let [p11, p12, p21, p22] = [-0.7, 0.4, -1.1, -0.9];
    let states = "(\"A\", \"ad - C*Cd/2\"), (\"B\", \"bd\"), (\"C\", \"Cd\"), (\"D\", \"dd\")";
    let definitions = format!(
        "(\"a\", \"A + C^2/4\"), (\"c\", \"C\"), (\"r1\", \"a^2 + B^2\"), (\"r2\", \"c^2 + D^2\"), (\"g1\", \"p + \
         {p11}*r1 + {p12}*r2\"), (\"g2\", \"q + {p21}*r1 + {p22}*r2\"), (\"ad\", \"g1*a - 2.3*B\"), (\"bd\", \
         \"2.3*a + g1*B\"), (\"Cd\", \"g2*c - D\"), (\"dd\", \"c + g2*D\")"
    );
    let text = format!(
        "Scene(title: \"planted\", problem: Equations(states: [{states}], definitions: [{definitions}], parameters: \
         [(\"p\", -0.3), (\"q\", -0.2)], solution: equilibrium), runs: [(name: \"rest\", along: [(name: \"p\", low: \
         -0.4, high: 0.6)]), (name: \"curve\", start: From(run: \"rest\", kind: HB), hold: HB, along: [(name: \"p\", \
         low: -1, high: 1), (name: \"q\", low: -0.4, high: 0.3)])])"
    );
    let document = traced(&text);
    let point = at(&document.branches[1], Kind::HH, "q", 0.0, 1e-10);
    // Unit vectors q = (1, −i)/√2 halve each square.
    for (name, value) in [("hh_p11", p11), ("hh_p12", p12), ("hh_p21", p21), ("hh_p22", p22)] {
        coefficient(point, name, 2.0 * value, 1e-9);
    }
    coefficient(point, "hh_theta", p12 / p22, 1e-9);
    coefficient(point, "hh_delta", p21 / p11, 1e-9);
    coefficient(point, "second_frequency", 1.0, 1e-9);
    assert_eq!(point.subkind.as_deref(), Some("simple"));
    // The other curve of Hopf points is q = 0, not p = 0 again.
    let other = document.branches.last().unwrap();
    let q = other.column("q").unwrap();
    assert_eq!((document.branches.len(), other.condition), (3, Some(Kind::HB)));
    assert!(other.points.iter().all(|point| point.value(q).unwrap().abs() < 1e-9));
}
