//! Promise: the numbers of fold–Hopf and double Hopf points, and the curves of special cycles that begin
//! there and at generalised Hopf points, do not depend on coordinates, nor on time. The systems are
//! normal forms with chosen coefficients, in other coordinates.

use super::{at, coefficient};
use crate::common::close;
use std::error::Error;
use std::f64::consts::TAU;
use tangency::core::continuation::{Branch, End};
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Following, Scene, execute};

/// What is traced of a scene, and the curves that meet its own at points of codimension two.
fn traced(text: &str) -> Document {
    let scene = Scene::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let following = Following { kinds: Following::of_curves(), depth: 1, distinct: false };
    let (_, outcome) = scene.resolve(None).unwrap().explore(&following, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document
}

/// The curves of a kind of special cycles, each of which begins at a point of equilibria: it goes away
/// from there only, with amplitudes that grow.
fn of_cycles(document: &Document, kind: Kind) -> Vec<&Branch> {
    let cycles = |branch: &&Branch| branch.column("period").is_some();
    let curves: Vec<&Branch> = document.branches.iter().filter(cycles).collect();
    for curve in &curves {
        assert_eq!(curve.condition, Some(kind));
        assert_eq!(curve.ends[0], End::Start, "{}", curve.name);
        assert!(curve.warnings.is_empty(), "{:?}", curve.warnings);
        assert!(curve.points.len() > 10, "{} points", curve.points.len());
    }
    curves
}

/// The values of some columns at each point of a curve.
fn columns<const N: usize>(curve: &Branch, names: [&str; N]) -> Vec<[f64; N]> {
    let columns = names.map(|name| curve.column(name).unwrap_or_else(|| panic!("{name}")));
    let values = curve.points.iter().map(|point| columns.map(|k| point.value(k).unwrap()));
    values.collect()
}

/// The coefficients of a fold–Hopf point: `G₂₀₀`, `G₀₁₁`, `G₃₀₀`, `G₁₁₁`; real and imaginary parts of
/// `G₁₁₀`, `G₂₁₀`, `G₀₂₁`; and the frequency.
type FoldHopf = ([f64; 4], [(f64, f64); 3], f64);

const FOLD_HOPF: FoldHopf = ([1.4, -0.8, 0.6, 0.3], [(0.35, 0.2), (-0.4, 0.7), (0.9, -1.1)], 1.3);

/// `v' = β₁ + G₂₀₀/2 v² + G₀₁₁ r² + …`, `z' = (β₂ + iω + …) z` with `z = a + ib` (real and
/// imaginary parts of coefficients are given), in coordinates
/// with `v = V`, `a = A + V²/3 + V B/2`, `b = B + a²/5`.
fn fold_hopf(([g200, g011, g300, g111], [g110, g210, g021], omega): FoldHopf) -> String {
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
    format!(
        "Scene(title: \"planted\", problem: Equations(states: [(\"V\", \"vd\"), (\"A\", \"ad - (2*V/3 + B/2)*vd - \
         V/2*Bd\"), (\"B\", \"Bd\")], definitions: [{}], parameters: [(\"p\", -0.1), (\"q\", -0.3)], initial: \
         [(\"V\", -0.4)], solution: equilibrium), runs: [(name: \"rest\", along: [(name: \"q\", low: -0.4, high: \
         0.6)]), (name: \"curve\", start: From(run: \"rest\", kind: HB), hold: HB, along: [(name: \"q\", low: -1, \
         high: 1), (name: \"p\", low: -0.2, high: 0.1)])])",
        definitions.join(", ")
    )
}

#[test]
fn the_numbers_of_a_fold_hopf_point() {
    let ([g200, g011, g300, g111], [g110, g210, g021], _) = FOLD_HOPF;
    let document = traced(&fold_hopf(FOLD_HOPF));
    let point = at(&document.branches[1], Kind::ZH, "p", 0.0, 1e-10);
    coefficient(point, "zh_s", -1.0, 1e-9);
    coefficient(point, "zh_theta", 2.0 * g110.0 / g200, 1e-9);
    let e = 0.5
        * (g210.0 + g110.0 * (g021.0 / g011 - g300 / g200 + g111 / g011)
            - g021.0 * g200 / (2.0 * g011));
    coefficient(point, "zh_e", e, 1e-9);
    assert_eq!(point.subkind.as_deref(), Some("s = −1, θ > 0"));
    // The curve of folds through the point, which sees the same.
    let folds = document.branches.iter().find(|it| it.condition == Some(Kind::LP)).unwrap();
    let p = folds.column("p").unwrap();
    assert!(folds.points.iter().all(|point| point.value(p).unwrap().abs() < 1e-9));
}

/// With the symmetry `x → −x`, the zero eigenvalue at the point belongs to a pitchfork: `x' = b x −
/// 3 10⁶ x³ − 2 x r²`, `r' = a r − 5 10⁶ x² r − r³`.
#[test]
fn the_numbers_of_a_pitchfork_hopf_point() {
    let document = traced(
        "Scene(title: \"planted\", problem: Equations(states: [(\"x\", \"b*x - 3e6*x^3 - 2*x*(u^2 + v^2)\"), \
         (\"u\", \"c*u - 7*v\"), (\"v\", \"c*v + 7*u\")], definitions: [(\"c\", \"a - 5e6*x^2 - u^2 - v^2\")], \
         parameters: [(\"a\", -1), (\"b\", -1)], solution: equilibrium), runs: [(name: \"rest\", along: [(name: \
         \"a\", low: -1, high: 1)]), (name: \"curve\", start: From(run: \"rest\", kind: HB), hold: HB, along: \
         [(name: \"a\", low: -1, high: 1), (name: \"b\", low: -1, high: 1)])])",
    );
    let point = at(&document.branches[1], Kind::ZH, "b", 0.0, 1e-10);
    coefficient(point, "ph_p11", -3e6, 1e-9);
    coefficient(point, "ph_theta", 2.0, 1e-9);
    coefficient(point, "ph_delta", 5.0 / 3.0, 1e-9);
    assert_eq!(point.subkind.as_deref(), Some("pitchfork–Hopf, simple"));
    assert!(point.number("zh_s").is_none());
}

/// Cycles of constant `v` and `r` are torus points where the trace of the motion of `(v, r)` vanishes:
/// `G₂₀₀ v + G₃₀₀/2 v² + (G₁₁₁ + Re G₀₂₁) r² = 0`.
#[test]
fn torus_points_of_cycles_begin_at_a_fold_hopf_point() {
    let ([g200, g011, g300, g111], [g110, g210, g021], omega) = FOLD_HOPF;
    let document = traced(&fold_hopf(FOLD_HOPF));
    let [curve] = of_cycles(&document, Kind::TR)[..] else { panic!("not one curve") };
    let mut before = 0.0;
    for [p, q, v, angle] in columns(curve, ["p", "q", "max_V", "torus_angle"]) {
        let square = -(g200 * v + g300 / 2.0 * v * v) / (g111 + g021.0);
        assert!(square > before, "the amplitude grows");
        before = square;
        let rest = g200 / 2.0 * v * v + g011 * square + g300 / 6.0 * v.powi(3) + g111 * v * square;
        close(p, -rest, 1e-9);
        close(q, -(g110.0 * v + g210.0 / 2.0 * v * v + g021.0 / 2.0 * square), 1e-9);
        let by_v = g200 * v + g300 / 2.0 * v * v + g111 * square;
        let across = 2.0 * (g011 + g111 * v) * (g110.0 + g210.0 * v) * square;
        let turning = (by_v * g021.0 * square - across).sqrt();
        let rate = omega + g110.1 * v + g210.1 / 2.0 * v * v + g021.1 / 2.0 * square;
        close(angle.cos(), (turning * TAU / rate).cos(), 1e-8);
    }
    assert!(before > 0.01, "r² = {before}");
}

/// With `s θ > 0` the real parts of both multipliers do not vanish, and nothing is followed.
#[test]
fn no_torus_points_begin_at_a_fold_hopf_point_without_tori() {
    let ([g200, _, g300, g111], of_pair, omega) = FOLD_HOPF;
    let text = fold_hopf(([g200, 0.8, g300, g111], of_pair, omega));
    let document = traced(&text);
    assert!(document.branches.iter().any(|branch| branch.of_kind(Kind::ZH).count() == 1));
    let without =
        |branch: &Branch| branch.condition != Some(Kind::TR) && branch.warnings.is_empty();
    assert!(document.branches.iter().all(without));
    let run = "(name: \"tori\", start: From(run: \"curve\", kind: ZH), hold: TR, along: [(name: \"q\", low: -1, \
               high: 1), (name: \"p\", low: -0.2, high: 0.1)])])";
    let asked = format!("{}, {run}", text.strip_suffix("])").unwrap());
    let outcome = execute(&Scene::parse(&asked).unwrap(), None, &mut ());
    let error = outcome.error.unwrap();
    let (mut said, mut cause) = (Vec::new(), Some(&error as &dyn Error));
    while let Some(error) = cause {
        said.push(error.to_string());
        cause = error.source();
    }
    let reason = "no curve of torus points starts at this fold–Hopf point";
    assert!(said.iter().any(|cause| cause.contains(reason)), "{said:?}");
}

const DOUBLE_HOPF: [f64; 4] = [-0.7, 0.4, -1.1, -0.9];

/// Two oscillators with cubic coupling, in coordinates with `a = A + C²/4`, `b = B + C²/5`.
fn double_hopf() -> String {
    let [p11, p12, p21, p22] = DOUBLE_HOPF;
    let states =
        "(\"A\", \"ad - C*Cd/2\"), (\"B\", \"bd - 2*C*Cd/5\"), (\"C\", \"Cd\"), (\"D\", \"dd\")";
    let definitions = format!(
        "(\"a\", \"A + C^2/4\"), (\"b\", \"B + C^2/5\"), (\"c\", \"C\"), (\"r1\", \"a^2 + b^2\"), (\"r2\", \"c^2 + D^2\"), (\"g1\", \"p + \
         {p11}*r1 + {p12}*r2\"), (\"g2\", \"q + {p21}*r1 + {p22}*r2\"), (\"ad\", \"g1*a - 2.3*b\"), (\"bd\", \
         \"2.3*a + g1*b\"), (\"Cd\", \"g2*c - D\"), (\"dd\", \"c + g2*D\")"
    );
    format!(
        "Scene(title: \"planted\", problem: Equations(states: [{states}], definitions: [{definitions}], parameters: \
         [(\"p\", -0.3), (\"q\", -0.2)], solution: equilibrium), runs: [(name: \"rest\", along: [(name: \"p\", low: \
         -0.4, high: 0.6)]), (name: \"curve\", start: From(run: \"rest\", kind: HB), hold: HB, along: [(name: \"p\", \
         low: -1, high: 1), (name: \"q\", low: -0.4, high: 0.3)])])"
    )
}

#[test]
fn the_numbers_of_a_double_hopf_point() {
    let [p11, p12, p21, p22] = DOUBLE_HOPF;
    let document = traced(&double_hopf());
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
    let hopf = document.branches.iter().filter(|branch| branch.condition == Some(Kind::HB));
    let [_, other] = hopf.collect::<Vec<_>>()[..] else { panic!("not two curves") };
    let q = other.column("q").unwrap();
    assert!(other.points.iter().all(|point| point.value(q).unwrap().abs() < 1e-9));
}

/// Cycles with `p + p₁₁ r₁² = 0` lose stability to the other oscillator where `q + p₂₁ r₁² = 0`; their
/// period is `2π/2.3`. Those with `q + p₂₂ r₂² = 0` do where `p + p₁₂ r₂² = 0`; their period is 2π.
#[test]
fn torus_points_of_both_families_of_cycles_begin_at_a_double_hopf_point() {
    let [p11, p12, p21, p22] = DOUBLE_HOPF;
    let document = traced(&double_hopf());
    let [fast, slow] = of_cycles(&document, Kind::TR)[..] else { panic!("not two curves") };
    for [p, q, top, period, angle] in columns(fast, ["p", "q", "max_B", "period", "torus_angle"]) {
        close(p, -p11 * top * top, 1e-8);
        close(q * p11, p * p21, 1e-9);
        close(period, TAU / 2.3, 1e-9);
        close(angle.cos(), period.cos(), 1e-8);
    }
    for [p, q, top, period, angle] in columns(slow, ["p", "q", "max_C", "period", "torus_angle"]) {
        close(q, -p22 * top * top, 1e-8);
        close(p * p22, q * p12, 1e-9);
        close(period, TAU, 1e-9);
        close(angle.cos(), (2.3 * period).cos(), 1e-7);
    }
}

/// `z' = (p + i) z + q z |z|² − z |z|⁴` in coordinates with `a = A + B²/4`: cycles fold at
/// `p = −r⁴`, `q = 2 r²`.
#[test]
fn folds_of_cycles_begin_at_a_generalised_hopf_point() {
    let text = "Scene(title: \"planted\", problem: Equations(states: [(\"A\", \"ad - B*bd/2\"), (\"B\", \"bd\")], \
        definitions: [(\"a\", \"A + B^2/4\"), (\"r2\", \"a^2 + B^2\"), (\"re\", \"p + q*r2 - r2^2\"), (\"ad\", \
        \"re*a - B\"), (\"bd\", \"a + re*B\")], parameters: [(\"p\", -0.3), (\"q\", -0.5)], solution: \
        equilibrium), runs: [(name: \"rest\", along: [(name: \"p\", low: -0.4, high: 0.6)]), (name: \"curve\", \
        start: From(run: \"rest\", kind: HB), hold: HB, along: [(name: \"p\", low: -1, high: 1), (name: \"q\", \
        low: -1, high: 1)])])";
    let document = traced(text);
    let point = at(&document.branches[1], Kind::GH, "q", 0.0, 1e-10);
    // Unit vectors q = (1, −i)/√2 halve each square.
    coefficient(point, "c2_re", -4.0, 1e-8);
    let [curve] = of_cycles(&document, Kind::LP)[..] else { panic!("not one curve") };
    let mut before = 0.0;
    for [p, q, top] in columns(curve, ["p", "q", "max_B"]) {
        assert!(q > before, "away from the point");
        before = q;
        close(p, -q * q / 4.0, 1e-9);
        close(q, 2.0 * top * top, 1e-7);
    }
    close(before, 1.0, 1e-9);
}
