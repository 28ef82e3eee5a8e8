//! Homoclinic orbits at which branches of cycles end, and their curves in two parameters.
//!
//! References: `reference/codim2.md` 5 of the project's shared notes (12 digits, by power series about the
//! saddle), exact loops, and other settings.

use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{Scene, execute};

/// Cycles of a model from the Hopf point of its equilibrium on, along a parameter, and further runs.
fn scene(model: &str, parameters: &str, along: &str, further: &str) -> Scene {
    let text = format!(
        "Scene(title: \"test\", problem: Equations({model}), parameters: [{parameters}], runs: [
            (name: \"rest\", set: [(\"solution\", \"equilibrium\")], along: [{along}]),
            (name: \"cycles\", start: From(run: \"rest\", kind: HB), along: [{along}]),
            {further}
        ])"
    );
    Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"))
}

fn traced(mut scene: Scene, settings: &str) -> Document {
    for setting in settings.split_whitespace() {
        let (name, value) = setting.split_once('=').unwrap();
        scene.set(name, value).unwrap_or_else(|error| panic!("{error}"));
    }
    let outcome = execute(&scene, None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    outcome.document
}

fn branch<'d>(document: &'d Document, name: &str) -> &'d Branch {
    document.branch(name).unwrap()
}

/// The homoclinic orbit at the end of the cycles, whose error is honest and at most `most`.
#[track_caller]
fn ending(document: &Document, expected: f64, most: f64) -> &SpecialPoint {
    let cycles = branch(document, "cycles");
    let mut all = cycles.of_kind(Kind::HOM);
    let Some(point) = all.next() else { panic!("{:?}", cycles.warnings) };
    assert!(all.next().is_none() && point.converged);
    near(cycles, point, expected, most);
    point
}

/// The first released parameter of a point is the expected one (with 12 digits) within its error.
#[track_caller]
fn near(branch: &Branch, point: &SpecialPoint, expected: f64, most: f64) {
    let value = point.value(branch.column(&branch.released[0]).unwrap()).unwrap();
    let off = (value - expected).abs();
    assert!(
        off <= point.error + 5e-12 * expected.abs(),
        "{value:.14} ± {:.1e}, not {expected:.14}",
        point.error
    );
    assert!(point.error <= most, "{:.1e}", point.error);
}

fn number(point: &SpecialPoint, name: &str) -> f64 {
    point.number(name).unwrap().value
}

/// `x' = y, y' = x − x² + y (a x − λ)`: the loop of a conservative field, perturbed.
const PERTURBED: &str =
    r#"states: [("x", "y"), ("y", "x - x^2 + y*(a*x - lam)")], initial: [("x", 1)]"#;

const LAMBDA: &str = r#"(name: "lam", low: 0, high: 2)"#;

/// A curve of homoclinic orbits from the end of the cycles, with marks on its second parameter.
const CURVE: &str = r#"(name: "homoclinic", hold: HOM, start: From(run: "cycles", kind: HOM),
    along: [(name: "lam", low: 0, high: 2), (name: "a", low: 0.01, high: 2)], marks: [("a", 0.1), ("a", 1)])"#;

/// Homoclinic orbits are boundary-value problems with dense matrices, also if the cycles have sparse ones.
#[test]
fn cycles_with_sparse_matrices_end_at_homoclinic_orbits() {
    let scene = scene(PERTURBED, r#"("lam", 1.2), ("a", 0.5)"#, LAMBDA, CURVE);
    let document = traced(scene, "matrices=sparse");
    assert_eq!(branch(&document, "cycles").method, "collocation(4), sparse matrices");
    ending(&document, 0.429505848877, 1e-11);
    assert!(branch(&document, "homoclinic").of_kind(Kind::UZ).count() == 2);
}

#[test]
fn perturbed_loops_break_where_the_reference_says() {
    let scene = scene(PERTURBED, r#"("lam", 1.2), ("a", 0.5)"#, LAMBDA, CURVE);
    let document = traced(scene, "");
    let end = ending(&document, 0.429505848877, 1e-11);
    let (unstable, stable) = (number(end, "leading_unstable"), number(end, "leading_stable"));
    // At x = 0: μ² + λ μ − 1 = 0.
    assert!((unstable * stable + 1.0).abs() < 1e-10);
    assert!((number(end, "saddle_quantity") + 0.429505848877).abs() < 1e-10);
    let curve = branch(&document, "homoclinic");
    assert_eq!(curve.condition, Some(Kind::HOM));
    for (a, expected) in [(0.1, 0.0857217817607), (1.0, 0.864545247422)] {
        let at = curve.of_kind(Kind::UZ).find(|point| (point.parameters[1] - a).abs() < 1e-9);
        near(curve, at.unwrap(), expected, 1e-8);
    }
    // λ = 6a/7 + O(a³), and the loop of a = 0 goes to x = 3/2.
    let end = curve.special.iter().find(|point| (point.parameters[1] - 0.01).abs() < 1e-9).unwrap();
    assert!((end.parameters[0] - 0.06 / 7.0).abs() < 1e-6);
    let highest = end.value(curve.column("max_x").unwrap()).unwrap();
    assert!((highest - 1.5).abs() < 1e-4, "{highest}");
}

/// The unfolding of a Bogdanov–Takens point: `u'' = −4 + u² + ε u' (τ + u)`.
#[test]
fn loops_beside_a_takens_point_have_the_reference_s_tau() {
    let model =
        r#"states: [("u", "v"), ("v", "-4 + u^2 + eps*v*(tau + u)")], initial: [("u", -2)]"#;
    let tau = r#"(name: "tau", low: 1, high: 3)"#;
    for (epsilon, expected) in [(0.1, 1.42977039512), (0.2, 1.43336073267)] {
        let parameters = format!(r#"("tau", 2.2), ("eps", {epsilon})"#);
        ending(&traced(scene(model, &parameters, tau, ""), ""), expected, 1e-10);
    }
}

/// B. Sandstede's field has the loop `x² (1 − x) = y²` at `m = μ = 0`, where the saddle has the
/// eigenvalues `a ± b` and `c`. Its third state is zero along the loop.
#[test]
fn an_exact_loop_in_space_is_found() {
    let document = sandstede(["0", "-2"], "");
    let end = ending(&document, 0.0, 1e-11);
    assert!((number(end, "leading_unstable") - 1.3).abs() < 1e-10);
    assert!((number(end, "leading_stable") + 0.7).abs() < 1e-10);
}

fn sandstede([m, c]: [&str; 2], further: &str) -> Document {
    let model = r#"states: [
            ("x", "a*x + b*y - a*x^2 + (mu - al*z)*x*(2 - 3*x)"),
            ("y", "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - 2*(mu - al*z)*y"),
            ("z", "c*z + m*x + g*x*z + al*be*(x^2*(1 - x) - y^2)"),
        ], initial: [("x", 0.66)]"#;
    let parameters = format!(
        r#"("mu", 0.1), ("m", {m}), ("a", 0.3), ("b", 1), ("c", {c}), ("al", 0.5), ("be", 1), ("g", 0)"#
    );
    traced(scene(model, &parameters, r#"(name: "mu", low: -1, high: 1)"#, further), "")
}

/// The perturbed loop has λ = 0 at a = 0, where both eigenvalues are ±1. Beside the loop, driven states
/// with the eigenvalues `−0.3 ± √(−w)` lead. In Sandstede's field with
/// `c = −0.5` the state `z` leads: there is an orbit flip at the exact loop `m = μ = 0`.
#[test]
fn points_of_codimension_two_of_loops() {
    let curve = |along: [(&str, f64, f64); 2]| {
        let along =
            along.map(|(name, low, high)| format!(r#"(name: "{name}", low: {low}, high: {high})"#));
        let along = along.join(", ");
        format!(
            r#"(name: "curve", hold: HOM, start: From(run: "cycles", kind: HOM), along: [{along}])"#
        )
    };
    let only = |document: &Document, kind: Kind, expected: [f64; 2]| {
        let curve = branch(document, "curve");
        let known = [Kind::NSS, Kind::DRS, Kind::DRU, Kind::OFS, Kind::OFU];
        let found: Vec<_> = curve.special.iter().filter(|it| known.contains(&it.kind)).collect();
        let [point] = found[..] else { panic!("{found:?} {:?}", curve.warnings) };
        assert!(point.kind == kind && point.converged);
        for (name, expected) in curve.released.iter().zip(expected) {
            let value = point.value(curve.column(name).unwrap()).unwrap();
            assert!((value - expected).abs() < 1e-9, "{name}: {value}");
        }
    };
    let neutral = curve([("a", -0.4, 0.6), ("lam", -1.0, 2.0)]);
    let document = traced(scene(PERTURBED, r#"("lam", 1.2), ("a", 0.5)"#, LAMBDA, &neutral), "");
    only(&document, Kind::NSS, [0.0, 0.0]);
    let driven = r#"states: [("x", "y"), ("y", "x - x^2 + y*(a*x - lam)"), ("u", "-0.3*u + v"),
        ("v", "-0.3*v - w*u + x*y + x^2/5")], initial: [("x", 1)]"#;
    let double = curve([("w", -0.005, 0.21), ("lam", 0.0, 2.0)]);
    let parameters = r#"("lam", 1.2), ("a", 0.5), ("w", 0.2)"#;
    let document = traced(scene(driven, parameters, LAMBDA, &double), "");
    only(&document, Kind::DRS, [0.0, 0.429505848877]);
    let flip = curve([("m", -0.02, 0.06), ("mu", -1.0, 1.0)]);
    only(&sandstede(["0.05", "-0.5"], &flip), Kind::OFS, [0.0, 0.0]);
}

const LORENZ: &str = r#"states: [("x", "sigma*(y - x)"), ("y", "x*(rho - z) - y"), ("z", "x*y - beta*z")],
    initial: [("x", 7), ("y", 7), ("z", 20)]"#;

fn lorenz(sigma: f64, settings: &str) -> Document {
    let parameters = format!(r#"("sigma", {sigma}), ("rho", 21), ("beta", "8/3")"#);
    traced(scene(LORENZ, &parameters, r#"(name: "rho", low: 5, high: 30)"#, ""), settings)
}

/// Lorenz' loop by both discretisations and several meshes, and its sensitivity.
#[test]
fn settings_agree_on_lorenz() {
    for settings in ["", "intervals=40", "degree=5", "method=shooting segments=20"] {
        let document = lorenz(10.0, settings);
        let end = ending(&document, 13.926557407513, 1e-10);
        assert!((number(end, "leading_stable") + 8.0 / 3.0).abs() < 1e-9);
    }
    let place = |sigma: f64| ending_of(&lorenz(sigma, ""));
    let document = lorenz(10.0, "");
    let by_sigma = &ending(&document, 13.926557407513, 1e-10).sensitivities;
    let by_sigma = by_sigma.iter().find(|it| it.by == "sigma").unwrap().slopes[0];
    let slope = (place(10.001) - place(9.999)) / 0.002;
    assert!((by_sigma - slope).abs() < 1e-6 * slope.abs(), "{by_sigma} {slope}");
}

/// AUTO's demo `ab`: the orbit has a front that is 10⁴ times shorter than the whole time.
const REACTOR: &str = r#"states: [("x", "-x + D*(1 - x)*exp(y)"), ("y", "-y + 14*D*(1 - x)*exp(y) - beta*y")],
    initial: [("x", 0), ("y", 0)]"#;

/// The references are bisections on the unstable manifold by a Runge–Kutta method of order 8 with the
/// tolerance 1e-13.
#[test]
fn orbits_with_steep_fronts_take_few_points() {
    let curve = r#"(name: "homoclinic", hold: HOM, start: From(run: "cycles", kind: HOM), along: [
        (name: "D", low: 0.05, high: 0.25), (name: "beta", low: 1.9, high: 2.2)],
        marks: [("beta", 1.95), ("beta", 2.1)])"#;
    let along = r#"(name: "D", low: 0, high: 0.25)"#;
    let document = traced(scene(REACTOR, r#"("D", 0), ("beta", 2)"#, along, curve), "");
    ending(&document, 0.1055070700399, 1e-10);
    let curve = branch(&document, "homoclinic");
    assert!(curve.points.len() < 100, "{} points", curve.points.len());
    assert!(curve.warnings.is_empty(), "{:?}", curve.warnings);
    let references = [
        (1.9, 0.1006502601102),
        (1.95, 0.1030641169307),
        (2.1, 0.1104816106201),
        (2.2, 0.1155787200086),
    ];
    for (beta, expected) in references {
        let at = curve.special.iter().find(|it| (it.parameters[1] - beta).abs() < 1e-9);
        let at = at.unwrap_or_else(|| panic!("{beta}: {:?}", curve.ends));
        // Points of the curve have the error of the mesh, which is not in their own.
        assert!(
            (at.parameters[0] - expected).abs() < 4e-12,
            "{}, not {expected}",
            at.parameters[0]
        );
    }
}

/// On fine meshes and by short steps, the last cycles come very near to the saddle.
#[test]
fn orbits_with_steep_fronts_are_located_on_all_meshes() {
    let along = r#"(name: "D", low: 0, high: 0.25)"#;
    for settings in ["intervals=60 degree=5", "max_step=0.05", "intervals=100"] {
        let scene = scene(REACTOR, r#"("D", 0), ("beta", 2)"#, along, "");
        ending(&traced(scene, settings), 0.1055070700399, 1e-10);
    }
}

fn ending_of(document: &Document) -> f64 {
    branch(document, "cycles").of_kind(Kind::HOM).next().unwrap().parameters[1]
}

/// In other units, the same.
#[test]
fn units_change_nothing() {
    // With x = 10⁻⁶ X, y = 10⁻⁶ Y and time in milliseconds: X' = Y, Y' = X − X² + Y (a X − λ).
    let model = r#"states: [("x", "1e3*y"), ("y", "1e3*(x - 1e6*x^2 + y*(1e6*a*x - lam))")],
        initial: [("x", 1e-6)], scales: [("x", 1e-6), ("y", 1e-6)]"#;
    let document = traced(scene(model, r#"("lam", 1.2), ("a", 0.5)"#, LAMBDA, ""), "");
    let end = ending(&document, 0.429505848877, 1e-10);
    assert!((number(end, "leading_unstable") - 808.046576224).abs() < 1e-6);
}

/// A curve of homoclinic orbits starts where cycles come near one, and nowhere else.
#[test]
fn other_starts_are_refused() {
    let refused = |kind: &str, run: &str| {
        let curve =
            CURVE.replace("run: \"cycles\", kind: HOM", &format!("run: \"{run}\", kind: {kind}"));
        let outcome = execute(
            &scene(PERTURBED, r#"("lam", 1.2), ("a", 0.5)"#, LAMBDA, &curve),
            None,
            &mut (),
        );
        one_line(&outcome.error.unwrap())
    };
    let at_rest = refused("HB", "rest");
    assert!(
        at_rest.contains("a branch of homoclinic orbits starts from a nearby cycle"),
        "{at_rest}"
    );
    let small = refused("EP", "cycles");
    assert!(
        small.contains("a branch of homoclinic orbits cannot start at this solution"),
        "{small}"
    );
}

/// Tolerances of parameters spread the place.
#[test]
fn tolerances_spread_the_loop() {
    let mut scene = scene(PERTURBED, r#"("lam", 1.2), ("a", 0.5)"#, LAMBDA, "");
    scene.settings.tolerances = vec![("a".into(), 1e-3)];
    let document = traced(scene, "");
    let end = ending(&document, 0.429505848877, 1e-11);
    let by_a = end.sensitivities.iter().find(|it| it.by == "a").unwrap().slopes[0];
    assert!((number(end, "spread_lam") - 1e-3 * by_a).abs() < 1e-15);
    // Between the references at a = 0.1 and a = 1: about 6/7.
    assert!((by_a - 0.86).abs() < 0.01, "{by_a}");
}

/// Where eigenvalues of the saddle coincide, the subspaces have no frames of eigenvectors: the end
/// stays one, and says so.
#[test]
fn a_defective_saddle_is_not_followed() {
    let model = r#"states: [("x", "y"), ("y", "x - x^2 + y*(a*x - lam)"), ("z", "-z + x*y"), ("w", "-z - w + x^2")],
        initial: [("x", 1), ("y", 0)]"#;
    let document = traced(scene(model, r#"("lam", 1.2), ("a", 0.5)"#, LAMBDA, ""), "");
    let cycles = branch(&document, "cycles");
    assert_eq!(cycles.of_kind(Kind::HOM).count(), 0);
    let warned = |warning: &String| warning.contains("eigenvalues coincide");
    assert!(cycles.warnings.iter().any(warned), "{:?}", cycles.warnings);
}

/// States may be named like the unknowns of the orbit, and lie far from zero.
#[test]
fn names_and_places_of_states_are_free() {
    let model = r#"states: [("gap", "time"), ("time", "(gap - 100) - (gap - 100)^2 + time*(a*(gap - 100) - lam)")],
        initial: [("gap", 101)]"#;
    let document = traced(scene(model, r#"("lam", 1.2), ("a", 0.5)"#, LAMBDA, CURVE), "");
    ending(&document, 0.429505848877, 1e-10);
    assert!(branch(&document, "homoclinic").of_kind(Kind::UZ).count() == 2);
}

/// A driven spiral beside the perturbed loop: the saddle is a saddle-focus, of which the linear flow
/// turns many times between the loop and the ends of the orbit.
#[test]
fn loops_at_saddle_foci_are_followed() {
    for (decay, turn) in [(0.5, 1), (0.2, 3)] {
        let model = format!(
            r#"states: [("x", "y"), ("y", "x - x^2 + y*(a*x - lam)"), ("z", "-{decay}*z + {turn}*w + 0.3*x*y"),
                ("w", "-{turn}*z - {decay}*w + x^2")], initial: [("x", 1)]"#
        );
        let document = traced(scene(&model, r#"("lam", 0.6), ("a", 0.5)"#, LAMBDA, CURVE), "");
        let end = ending(&document, 0.429505848877, 1e-10);
        assert!((number(end, "leading_stable") + decay).abs() < 1e-9);
        let curve = branch(&document, "homoclinic");
        for (a, expected) in [(0.1, 0.0857217817607), (1.0, 0.864545247422)] {
            let at = curve.of_kind(Kind::UZ).find(|it| (it.parameters[1] - a).abs() < 1e-9);
            near(curve, at.unwrap_or_else(|| panic!("{turn}: {:?}", curve.ends)), expected, 1e-8);
        }
    }
}

/// A curve of homoclinic orbits, in `b1` and `b2`, from a Bogdanov–Takens point on a curve of folds.
fn from_takens_point(model: &str, [first, second]: [&str; 2], marks: &str) -> Document {
    let along =
        format!("(name: \"{first}\", low: -2, high: 1), (name: \"{second}\", low: -1, high: 1)");
    let near = along.replace("-2", "-0.05");
    let at_rest = "set: [(\"solution\", \"equilibrium\")]";
    let text = format!(
        "Scene(title: \"test\", problem: Equations({model}), parameters: [(\"{first}\", -1), (\"{second}\", 0.3)], runs: [
            (name: \"rest\", {at_rest}, along: [(name: \"{first}\", low: -2, high: 1)]),
            (name: \"folds\", {at_rest}, hold: LP, start: From(run: \"rest\", kind: LP), along: [{along}]),
            (name: \"homoclinic\", hold: HOM, start: From(run: \"folds\", kind: BT), along: [{near}], marks: [{marks}]),
        ])"
    );
    traced(Scene::parse(&text).unwrap_or_else(|error| panic!("{error}")), "")
}

/// `b1 = −4 ε⁴`, `b2 = τ ε²`: the curve begins at the Bogdanov–Takens point, and leads away.
#[test]
fn curves_of_loops_leave_takens_points() {
    let model = r#"states: [("x", "y"), ("y", "b1 + b2*y + x^2 + x*y")], initial: [("x", 1)]"#;
    let document = from_takens_point(model, ["b1", "b2"], r#"("b1", -0.0004), ("b1", -0.0064)"#);
    let curve = branch(&document, "homoclinic");
    for (epsilon, tau) in [(0.1_f64, 1.42977039512), (0.2, 1.43336073267)] {
        let b1 = -4.0 * epsilon.powi(4);
        let mut at = curve.of_kind(Kind::UZ).filter(|it| (it.parameters[0] - b1).abs() < 1e-12);
        let found = at.next().unwrap().parameters[1] / (epsilon * epsilon);
        assert!((found - tau).abs() < 1e-9, "{found:.12}");
    }
    let first = &curve.points[0].parameters;
    assert!(curve.points.iter().all(|point| point.parameters[0] <= first[0]), "{first:?}");
}

/// In other coordinates, with parameters that mix: the unfolding is computed.
#[test]
fn curves_of_loops_leave_takens_points_in_other_coordinates() {
    let model = r#"definitions: [("x", "X - 3 - 0.2*y"), ("b1", "p + 0.3*q + 0.5*q^2"), ("b2", "2*q - p"),
            ("g", "b1 + b2*y + x^2 + x*y")],
        states: [("X", "y + 0.2*g"), ("y", "g")], initial: [("X", 4)]"#;
    let document = from_takens_point(model, ["p", "q"], r#"("q", 0.01)"#);
    let curve = branch(&document, "homoclinic");
    let [p, q] = curve.of_kind(Kind::UZ).next().unwrap().parameters[..] else { unreachable!() };
    let (b1, b2) = (p + 0.3 * q + 0.5 * q * q, 2.0 * q - p);
    let square = (-b1 / 4.0).sqrt();
    // τ(ε) = 10/7 + (288/2401) ε² + O(ε⁴)
    let tau = 10.0 / 7.0 + 288.0 / 2401.0 * square;
    assert!((b2 / square - tau).abs() < 0.1 * square * square, "{} {tau}", b2 / square);
}

/// Rates that are far apart.
#[test]
fn fast_stable_directions_do_no_harm() {
    for rate in [50, 500, 5000] {
        let model = format!(
            r#"states: [("x", "y"), ("y", "x - x^2 + y*(a*x - lam)"), ("z", "{rate}*(x*y - z)")], initial: [("x", 1)]"#
        );
        let document = traced(scene(&model, r#"("lam", 1.2), ("a", 0.5)"#, LAMBDA, ""), "");
        ending(&document, 0.429505848877, 1e-10);
    }
}
