//! Promise: special points at starts, at other branch points and at multiple eigenvalues are found, and
//! coefficients that do not exist are not stated.

use super::{scene, traced};
use crate::common::{close, values};
use std::f64::consts::PI;
use std::path::Path;
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::system::Kind;
use tangency::scene::{Following, Problem, Range, Request, Scene, SearchBox, execute};

/// The branches of equilibria of a model along a parameter, started at `initial`.
fn rest(states: &str, (parameters, initial): (&str, &str), along: (&str, [f64; 2])) -> Vec<Branch> {
    let (name, [low, high]) = along;
    traced(&format!(
        "Scene(title: \"t\", problem: Equations(states: [{states}], initial: [{initial}], solution: equilibrium),
            parameters: [{parameters}], runs: [
                (name: \"rest\", along: [(name: \"{name}\", low: {low}, high: {high})])])"
    ))
}

/// The special points of a branch besides its ends.
fn inner(branch: &Branch) -> Vec<&SpecialPoint> {
    branch.special.iter().filter(|point| point.kind != Kind::EP).collect()
}

/// `μ = 0` is the start and the Hopf point of the normal form.
#[test]
fn a_hopf_point_at_the_start_is_found() {
    let states = r#"("x", "mu*x - y - x*(x^2 + y^2)"), ("y", "x + mu*y - y*(x^2 + y^2)")"#;
    let branch = &rest(states, (r#"("mu", 0)"#, ""), ("mu", [-1.0, 1.0]))[0];
    let found = inner(branch);
    assert_eq!(found.iter().map(|point| point.kind).collect::<Vec<_>>(), [Kind::HB]);
    assert!(found[0].converged && found[0].parameters[0].abs() < 1e-12);
    close(found[0].number("l1").expect("a Lyapunov coefficient").value, -2.0, 1e-9);
}

/// The parabola `μ = x²` turns at the branch point: an extremum of the parameter, and no fold.
#[test]
fn a_pitchfork_on_its_own_branch_is_one_point() {
    for high in [1.2, 1.5, 2.0, 3.0, 5.0, 7.0] {
        let start = (r#"("mu", 1)"#, r#"("x", 1)"#);
        let branch = &rest(r#"("x", "mu*x - x^3")"#, start, ("mu", [-1.0, high]))[0];
        let kinds: Vec<Kind> = inner(branch).iter().map(|point| point.kind).collect();
        assert_eq!(kinds, [Kind::BP], "to {high}: {:?}", inner(branch));
    }
}

/// On a ring of three Brusselators two eigenvalues with equal eigenvectors vanish together. With
/// `cⱼ = 4 sin²(πj/n) d`, the determinant of mode `j` vanishes at `b = (1 + 3cⱼ)(1 + cⱼ)/(3cⱼ)`, and its
/// trace at `b = 2 + 4cⱼ` with the frequency `√det`.
#[test]
fn two_eigenvalues_of_a_ring_vanish_together() {
    let ring = |n: usize| {
        let text = format!(
            r#"Scene(title: "t", problem: Equations(
            states: [("u[i=1..n]", "u[i]^2*v[i] - (b+1)*u[i] + 1 + d*(u[i-1] + u[i+1] - 2*u[i])"),
                ("v[i=1..n]", "b*u[i] - u[i]^2*v[i] + 3*d*(v[i-1] + v[i+1] - 2*v[i])")],
            definitions: [("n", {n}), ("u[i=0..n+1]", "u[1+mod(i-1,n)]"), ("v[i=0..n+1]", "v[1+mod(i-1,n)]")],
            initial: [("u", 1), ("v", 1)], solution: equilibrium),
            parameters: [("b", 1), ("d", 0.1)],
            runs: [(name: "rest", along: [(name: "b", low: 1, high: 4)])])"#
        );
        traced(&text).remove(0)
    };
    let mode = |j: f64, n: f64| 0.4 * (std::f64::consts::PI * j / n).sin().powi(2);
    for n in [3_usize, 5, 12] {
        let branch = ring(n);
        for point in inner(&branch) {
            assert!(point.converged, "n = {n}: {point:?}");
        }
        for j in 1..n.div_ceil(2) {
            let c = mode(j as f64, n as f64);
            let b = (1.0 + 3.0 * c) * (1.0 + c) / (3.0 * c);
            let at = |kind: Kind, b: f64| {
                let mut points = branch.of_kind(kind);
                points.find(|point| (point.parameters[0] - b).abs() < 1e-9).cloned()
            };
            if b < 4.0 {
                let point = at(Kind::BP, b).unwrap_or_else(|| panic!("n = {n}: no BP at {b}"));
                assert_eq!(point.multiplicity, 2);
            }
            let b = 2.0 + 4.0 * c;
            let square = (1.0 + 3.0 * c) * (1.0 - b + c) + b;
            if b < 4.0 && square > 0.0 {
                let point = at(Kind::HB, b).unwrap_or_else(|| panic!("n = {n}: no HB at {b}"));
                let frequency = point.number("hopf_frequency").expect("a frequency");
                let miss = (frequency.value - square.sqrt()).abs();
                assert!(
                    miss <= frequency.error && frequency.error < 1e-6,
                    "{frequency:?}: {miss:e}"
                );
            }
        }
    }
}

/// The branch `x = r` becomes unstable at `r = d`, within the first step from the branch point at 0.
#[test]
fn a_branch_point_next_to_the_start_of_a_branch_is_found() {
    let states = r#"("x", "r*x - x^2"), ("y", "(x - d)*y - y^3")"#;
    let text = format!(
        "Scene(title: \"t\", problem: Equations(states: [{states}], solution: equilibrium),
            parameters: [(\"r\", -1), (\"d\", 0.01)], runs: [
                (name: \"rest\", along: [(name: \"r\", low: -1, high: 1)]),
                (name: \"other\", start: From(run: \"rest\", kind: BP, switch: true),
                    along: [(name: \"r\", low: -1, high: 1)])])"
    );
    let branch = &traced(&text)[1];
    let found: Vec<f64> = branch.of_kind(Kind::BP).map(|point| point.parameters[0]).collect();
    assert!(found.iter().any(|r| (r - 0.01).abs() < 1e-10), "{found:?}");
}

/// On `x = y = 0`, the second branch point of competing species is transcritical, `y' = (r − 0.3) y −
/// y²`. In the conservative pendulum, `p q = 0`: the rates of the normal form do not exist.
#[test]
fn coefficients_exist_or_are_not_stated() {
    let states = r#"("x", "r*x - x^2 - x*y"), ("y", "(r - 0.3)*y - y^2 - x*y")"#;
    let branch = &rest(states, (r#"("r", -0.5)"#, ""), ("r", [-0.5, 1.0]))[0];
    for (point, r) in inner(branch).into_iter().zip([0.0, 0.3]) {
        close(point.parameters[0], r, 1e-12);
        close(point.number("transcritical_a").expect("a coefficient").value, 1.0, 1e-9);
    }
    let states = r#"("x", "y"), ("y", "-r*x - x^3")"#;
    let branch = &rest(states, (r#"("r", 1)"#, ""), ("r", [-1.0, 1.0]))[0];
    let points: Vec<&SpecialPoint> = branch.of_kind(Kind::BP).collect();
    assert_eq!(points.len(), 1);
    assert!(points[0].number("pitchfork_c").is_none(), "{:?}", points[0].numbers);
}

/// A zero column of the Jacobian at the branch point, with sparse matrices: a zero pivot.
#[test]
fn sparse_matrices_with_an_empty_column_have_branch_points() {
    let text = r#"Scene(title: "t", problem: Equations(
        states: [("u[i=1..n]", "(u[i-1] - 2*u[i] + u[i+1])*n^2 + u[i]*(K - u[i])"), ("p", "p*(u[1] - 1 - p)")],
        definitions: [("n", 100), ("u[0]", "u[1]"), ("u[n+1]", "u[n]")], initial: [("u", 0.5)],
        solution: equilibrium, matrices: sparse), parameters: [("K", 0.5)],
        runs: [(name: "r", along: [(name: "K", low: 0.5, high: 2)])])"#;
    let branch = &traced(text)[0];
    let points: Vec<&SpecialPoint> = branch.of_kind(Kind::BP).collect();
    assert_eq!(points.len(), 1, "{points:?}");
    close(points[0].parameters[0], 1.0, 1e-9);
    close(points[0].number("transcritical_a").expect("a coefficient").value, 1.0, 1e-6);
}

/// `b` unfolds the pitchfork `r x − x³`: no curve of branch points in `(r, b)` exists. `c` does not.
#[test]
fn curves_of_branch_points_start_only_where_they_exist() {
    let run = |other: &str| {
        let text = format!(
            r#"Scene(title: "t", problem: Equations(states: [("x", "(r + c)*x - x^3 + b")], solution: equilibrium),
            parameters: [("r", -1), ("b", 0), ("c", 0)], runs: [
                (name: "rest", along: [(name: "r", low: -1, high: 1)]),
                (name: "curve", hold: BP, start: From(run: "rest", kind: BP),
                    along: [(name: "r", low: -1, high: 1), (name: "{other}", low: -0.5, high: 0.5)])])"#
        );
        execute(&scene(&text), None, &mut ())
    };
    let kept = run("c");
    assert!(kept.error.is_none(), "{:?}", kept.error);
    let curve = &kept.document.branches[1];
    assert!(
        curve.points.iter().all(|point| (point.parameters[0] + point.parameters[2]).abs() < 1e-9)
    );
    let said = run("b").error.expect("an error").to_string();
    assert!(said.contains("breaks up if `b` changes"), "{said}");
}

/// A motion that approaches the equilibrium slowly is no reason to refuse the equilibrium.
#[test]
fn a_short_simulation_leads_to_the_equilibrium() {
    let text = r#"Equations(states: [("x", "10*(y - x)"), ("y", "x*(rho - z) - y"), ("z", "x*y - 8*z/3")],
        parameters: [("rho", 20)], initial: [("x", 1), ("y", 1), ("z", 1)])"#;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lorenz.ron");
    std::fs::write(&path, text).unwrap();
    let along = Range { name: "rho".into(), low: Some(10.0), high: Some(24.0) };
    let request = Request { along: vec![along], settle: Some(10.0), ..Request::default() };
    let problem = Problem::from_file(&path, &[]);
    let scene = problem.and_then(|problem| Scene::of_model(problem, "lorenz", &request));
    let outcome = execute(&scene.unwrap_or_else(|error| panic!("{error}")), None, &mut ());
    assert!(outcome.error.is_none(), "{:?}", outcome.error);
    assert_eq!(outcome.document.branches[0].points[0].unstable, Some(0));
}

/// `cos ωt` does not have the period `2π/(1.01 ω)`, also if the force is small beside other terms; a few
/// digits of π are enough.
#[test]
fn a_wrong_period_is_an_error() {
    let scene = |force: &str, period: &str| {
        Scene::parse(&format!(
            r#"Scene(title: "t", problem: Equations(states: [("x", "v"), ("v", "{force} - 0.4*v - w^2*x")], period: "{period}"),
            parameters: [("w", 6000)], runs: [(name: "r", along: [(name: "w", low: 1, high: 8000)])])"#
        ))
    };
    for (force, period) in
        [("cos(w*t)", "2*pi/w"), ("cos(w*t)", "4*pi/w"), ("cos(w*t)", "6.2831/w"), ("1", "1/w")]
    {
        assert!(scene(force, period).is_ok(), "{force}, {period}");
    }
    let pulse = "if(mod(t, 1/w) < 0.25/w, 1, 0)";
    assert!(scene(pulse, "1/w").is_ok());
    for (force, period) in
        [("cos(w*t)", "2*pi/(1.01*w)"), ("1e-3*cos(w*t)", "1/w"), (pulse, "1.3/w")]
    {
        let said = scene(force, period).expect_err("an error").to_string();
        assert!(said.contains("do not have the stated period"), "{said}");
    }
}

/// The cycle of Van der Pol's oscillator beside a state that rests at a large value.
#[test]
fn cycles_beside_large_states_are_found() {
    let text = r#"Scene(title: "t", problem: Equations(
        states: [("u", "v"), ("v", "(1 - u^2)*v - u"), ("n", "1e7 + a - n")], initial: [("u", 1), ("n", 1e7)]),
        parameters: [("a", 0)], runs: [(name: "r", start: Simulated(), along: [(name: "a", low: 0, high: 1)])])"#;
    let branch = &traced(text)[0];
    let period = branch.column("period").expect("a period");
    close(branch.points[0].value(period).unwrap(), 6.663_286_859_3, 1e-6);
}

/// A motion that ends at a focus after events is at rest, although rounding errors repeat.
#[test]
fn rest_after_events_is_no_cycle() {
    for p in [2.4, 3.9, 4.0] {
        let text = format!(
            r#"Scene(title: "t", problem: HybridEquations(
            modes: [(name: "off", states: [("x", "-x + y"), ("y", "p - y - x")]),
                (name: "on", states: [("x", "-x + y"), ("y", "p - y - x - 3*(x - 1)")])],
            guards: [(name: "up", modes: ["off"], function: "1 - x", next: "on"),
                (name: "down", modes: ["on"], function: "x - 1", next: "off")]),
            parameters: [("p", {p})], runs: [
                (name: "r", start: Simulated(), along: [(name: "p", low: 0, high: 5)])])"#
        );
        let outcome = execute(&scene(&text), None, &mut ());
        let said = outcome.error.expect("an error").to_string();
        assert!(said.contains("comes to rest"), "p = {p}: {said}");
    }
}

/// Folds of cycles emanate from the generalised Hopf point, and a `Residual` has no cycles.
#[test]
fn no_folds_of_equilibria_emanate_from_a_generalised_hopf_point() {
    let text = r#"Scene(title: "t", problem: Residual(dynamics: flow,
        unknowns: [("u", "-u*v^2 + F*(1 - u)"), ("v", "u*v^2 - (F + k)*v")], initial: [("u", 0.25), ("v", 0.28)]),
        parameters: [("F", 0.03), ("k", 0.05)], runs: [
            (name: "rest", along: [(name: "F", low: 0.005, high: 0.1)]),
            (name: "hopf", hold: HB, start: From(run: "rest", kind: HB),
                along: [(name: "F", low: 0.005, high: 0.1), (name: "k", low: 0.01, high: 0.07)]),
            (name: "folds", hold: LP, start: From(run: "hopf", kind: GH),
                along: [(name: "F", low: 0.005, high: 0.1), (name: "k", low: 0.01, high: 0.07)])])"#;
    let outcome = execute(&scene(text), None, &mut ());
    close(values(&outcome.document.branches[1], Kind::GH, "F")[0], 0.01171875, 1e-9);
    let said = outcome.error.expect("an error").to_string();
    assert!(said.contains("this problem has no cycles"), "{said}");
}

/// The one-impact orbit of an oscillator grazes a second time at the restitution `e = 0.003516823030`
/// (closed form), where its distance jumps from another minimum.
#[test]
fn a_limit_behind_a_jump_of_the_distance_is_found() {
    let text = r#"Scene(title: "t", problem: HybridEquations(
        modes: [(name: "free", states: [("x", "v"), ("v", "3e5*cos(2*pi*f*t) - 18*v - 9e4*x")])],
        guards: [(name: "hit", modes: ["free"], function: "gap - x", reset: [("v", "-e*v")])], period: "1/f"),
        parameters: [("f", 60), ("e", 0.7), ("gap", 2)],
        runs: [(name: "r", start: Simulated(), along: [(name: "e", low: 0.001, high: 1)])])"#;
    let branch = &traced(text)[0];
    close(values(branch, Kind::G, "e")[0], 0.003_516_823_030, 1e-8);
}

/// An equilibrium of the mode `off` at `x = 2`, where the mode is `on`, is no equilibrium of the system.
#[test]
fn equilibria_outside_the_region_of_their_mode_are_not_listed() {
    let text = r#"Scene(title: "t", problem: HybridEquations(
        modes: [(name: "off", states: [("x", "p - x")]), (name: "on", states: [("x", "p - x - 3*(x - 1)")])],
        guards: [(name: "up", modes: ["off"], function: "1 - x", next: "on"),
            (name: "down", modes: ["on"], function: "x - 1", next: "off")]),
        parameters: [("p", 2)], runs: [(name: "r", along: [(name: "p", low: 0, high: 5)])])"#;
    let range = Range { name: "x".into(), low: Some(-3.0), high: Some(3.0) };
    let found = |p: &str| {
        let within = Some(SearchBox { ranges: vec![range.clone()], starts: 20 });
        let set = vec![("p".to_string(), p.to_string())];
        scene(text).find(&Request { set, within, ..Request::default() }).unwrap().roots
    };
    let beyond = found("2");
    assert_eq!((beyond.roots.len(), beyond.inadmissible), (0, 1), "{beyond:?}");
    let inside = found("0.5");
    assert_eq!((inside.roots.len(), inside.inadmissible), (1, 0), "{inside:?}");
}

/// Two multipliers of a ring of maps pass −1 together, close to a torus point whose multipliers are
/// nearer to the unit circle on most of the step. The value is from Newton's method for the cycle and
/// bisection for its multiplier (SciPy).
#[test]
fn a_double_period_doubling_beside_a_torus_point_is_accurate() {
    let text = r#"Map(states: [("x[i=1..n]", "(1-eps)*f(x[i]) + eps/2*(f(x[1+mod(i,n)]) + f(x[1+mod(i-2,n)]))")],
        functions: [("f", ["s"], "r*s*(1-s)")], definitions: [("n", 4)], parameters: [("r", 2.5), ("eps", 0.1)],
        initial: [("x", 0.6)])"#;
    let problem = Problem::from_text(Path::new("ring.ron"), text, &[]).unwrap();
    let along = vec![Range { name: "r".into(), low: Some(2.5), high: Some(3.75) }];
    let request = Request { along, ..Request::default() };
    let scene = Scene::of_model(problem, "ring", &request).unwrap_or_else(|it| panic!("{it}"));
    let following = Following { kinds: vec![Kind::PD], depth: 2, distinct: false };
    let (_, outcome) = scene.resolve(None).unwrap().explore(&following, &mut ());
    let doubled = outcome.document.branches.iter().flat_map(|branch| {
        let r = branch.column("r").unwrap();
        branch.of_kind(Kind::PD).map(move |point| (point, point.value(r).unwrap()))
    });
    let near: Vec<_> = doubled.filter(|(_, r)| (r - 3.7004).abs() < 1e-3).collect();
    let [(point, r)] = near[..] else { panic!("{} points", near.len()) };
    assert!(point.converged && point.multiplicity == 2 && point.error < 1e-8, "{}", point.error);
    assert!((r - 3.70043436976).abs() < 1e-10, "{r}");
}

/// The multipliers of `x → (1 + a − |x|²) R(θ) x` are `(1 + a) exp(±iθ)`: a torus point, also if the
/// angle is nearly π.
#[test]
fn a_torus_point_with_an_angle_near_pi_is_no_period_doubling() {
    for gap in [0.14, 1.6e-3, 9e-5, 1.3e-5] {
        let angle = PI - gap;
        let branches = traced(&format!(
            "Scene(title: \"t\", problem: Map(states: [(\"x\", \"g*(c*x - s*y)\"), (\"y\", \"g*(s*x + c*y)\")],
                definitions: [(\"g\", \"1 + a - x^2 - y^2\"), (\"c\", \"cos({angle})\"), (\"s\", \"sin({angle})\")],
                initial: [(\"x\", 0), (\"y\", 0)]), parameters: [(\"a\", -0.3)],
                runs: [(name: \"rest\", along: [(name: \"a\", low: -0.31, high: 0.77)])])"
        ));
        let special = inner(&branches[0]);
        let [point] = special[..] else { panic!("{angle}: {special:?}") };
        assert!(point.kind == Kind::TR && point.converged && point.multiplicity == 1, "{point:?}");
        assert!(
            point.parameters[0].abs() <= point.error && point.error < 1e-5,
            "{angle}: {point:?}"
        );
    }
}

/// `x' = a x − w y − x³`, `y' = a y + w x − y³` has a Hopf point at `a = 0` with the frequency `w` and
/// `l1 = −1.5/w`, also if `w` is small. Near a double eigenvalue 0, the frequency has few digits.
#[test]
fn slow_hopf_points_have_positive_frequencies() {
    let states = r#"("x", "a*x - w*y - x^3"), ("y", "a*y + w*x - y^3")"#;
    for w in [1.0, 1e-2, 1e-3, 1e-4, 1e-5] {
        let parameters = format!(r#"("a", -1), ("w", {w})"#);
        let branch = &rest(states, (&parameters, ""), ("a", [-1.0, 1.3]))[0];
        let found = inner(branch);
        assert_eq!(found.iter().map(|it| it.kind).collect::<Vec<_>>(), [Kind::HB], "w = {w}");
        let number = |name: &str| found[0].number(name).expect("a number of a Hopf point");
        let frequency = number("hopf_frequency");
        assert!(frequency.value > 0.0, "w = {w}: {frequency:?}");
        let error = (frequency.value - w).abs();
        assert!(error <= frequency.error, "w = {w}: {error} exceeds {}", frequency.error);
        if w >= 1e-4 {
            assert!(error < 1e-6 * w, "w = {w}: {error}");
            close(number("l1").value * w, -1.5, 1e-6);
        }
    }
}

/// On rings of reaction–diffusion cells, whose eigenvalues are real, double eigenvalues pass zero at `a
/// = m + 1/(4 + 2 m)` with `m = 4 sin²(πk/n)`. Rounding turns double eigenvalues into complex pairs,
/// which are no Hopf points.
#[test]
fn double_real_eigenvalues_are_no_hopf_points() {
    for n in [14_usize, 16] {
        let text = format!(
            r#"Scene(title: "t", problem: Residual(
            unknowns: [("u[i=1..n]", "u[i-1] - 2*u[i] + u[i+1] + a*u[i] - u[i]^3 - v[i]"),
                ("v[i=1..n]", "0.5*u[i] - 2*v[i] + v[i-1] - 2*v[i] + v[i+1]")],
            definitions: [("n", {n}), ("u[i=0..n+1]", "u[1 + mod(i-1, n)]"), ("v[i=0..n+1]", "v[1 + mod(i-1, n)]")],
            dynamics: flow),
            parameters: [("a", -1)],
            runs: [(name: "rest", along: [(name: "a", low: -1, high: 1)])])"#
        );
        let branch = &traced(&text)[0];
        let found = inner(branch);
        let expected: Vec<f64> = (0..n / 2)
            .map(|k| 4.0 * (PI * k as f64 / n as f64).sin().powi(2))
            .map(|m| m + 1.0 / (4.0 + 2.0 * m))
            .filter(|a| *a < 1.0)
            .collect();
        assert_eq!(found.len(), expected.len(), "n = {n}: {found:?}");
        for (k, (point, a)) in found.iter().zip(expected).enumerate() {
            assert!(point.converged && point.kind == Kind::BP, "n = {n}: {point:?}");
            assert_eq!(point.multiplicity, if k == 0 { 1 } else { 2 }, "n = {n}: {point:?}");
            // One eigenvalue at the first point, two at each of the others.
            assert_eq!(point.unstable, Some((2 * k).saturating_sub(1)), "n = {n}: {point:?}");
            close(point.parameters[0], a, 1e-8);
        }
    }
}

/// Of the pitchfork of `x' = a (x − x³)`, whose branch is vertical, no coefficient exists.
#[test]
fn a_vertical_pitchfork_has_no_type() {
    let states = r#"("x", "a*(x - x^3) + b*y"), ("y", "-y + b*x*a")"#;
    let branch = &rest(states, (r#"("a", -1), ("b", 0)"#, ""), ("a", [-1.0, 1.0]))[0];
    let found = inner(branch);
    assert_eq!(found.iter().map(|it| it.kind).collect::<Vec<_>>(), [Kind::BP]);
    let coefficient = found[0].number("pitchfork_c");
    assert!(coefficient.is_none_or(|it| it.value.abs() <= it.error), "{coefficient:?}");
    let subkind = found[0].subkind.as_deref().unwrap_or_default();
    assert!(!subkind.contains("critical"), "{subkind}");
}

/// On a periodic square of `n × n` cells, eigenvalues of a symmetric matrix pass zero in groups of four
/// and eight, and the points state how many are unstable already.
#[test]
fn points_of_high_multiplicity_count_the_unstable_eigenvalues() {
    let branch = &traced(
        r#"Scene(title: "t", problem: Residual(
        unknowns: [("u[i=1..n, j=1..n]", "u[i-1,j] + u[i+1,j] + u[i,j-1] + u[i,j+1] - 4*u[i,j] + a*u[i,j] - u[i,j]^3")],
        definitions: [("n", 12), ("u[i=0..n+1, j=0..n+1]", "u[1 + mod(i-1, n), 1 + mod(j-1, n)]")],
        dynamics: flow),
        parameters: [("a", -0.1)],
        runs: [(name: "rest", along: [(name: "a", low: -0.1, high: 1.5)])])"#,
    )[0];
    let counts: Vec<_> = inner(branch).iter().map(|it| (it.multiplicity, it.unstable)).collect();
    let expected = [(1, 0), (4, 1), (4, 5), (4, 9), (8, 13)];
    assert_eq!(counts, expected.map(|(multiplicity, count)| (multiplicity, Some(count))));
}

/// Units of 1e-12 A beside units of 0.1 V: the eigenvalues of a sparse matrix do not depend on units.
/// With `φ(V) = g V (1 − V/Vs) (V/Vs − α)`, the trace `φ'(V)/C − ε` vanishes at both Hopf points.
#[test]
fn sparse_eigenvalues_do_not_depend_on_units() {
    let branch = &traced(
        r#"Scene(title: "t", problem: Residual(
        unknowns: [("V[i=1..n]", "(D*(V[i-1]-2*V[i]+V[i+1])*(n/L)^2 + g*V[i]*(1-V[i]/Vs)*(V[i]/Vs-al) - W[i] + I)/C"),
            ("W[i=1..n]", "eps*(g*be*V[i] - W[i]) + Dw*(W[i-1]-2*W[i]+W[i+1])*(n/L)^2")],
        definitions: [("n", 110), ("V[i=0..n+1]", "V[min(max(i,1),n)]"), ("W[i=0..n+1]", "W[min(max(i,1),n)]")],
        dynamics: flow, matrices: sparse),
        parameters: [("I", 0), ("eps", 5e5), ("g", 1e-9), ("Vs", 0.1), ("al", 0.1), ("be", 0.5), ("C", 1e-16),
            ("D", 1e-16), ("Dw", 0.5), ("L", 1e-3)],
        runs: [(name: "rest", along: [(name: "I", low: 0, high: 1e-10)])])"#,
    )[0];
    let found = inner(branch);
    assert_eq!(found.iter().map(|it| it.kind).collect::<Vec<_>>(), [Kind::HB, Kind::HB]);
    // V/Vs = v with −3 v² + 2 (1 + α) v − α = ε C/g.
    let (al, be, ratio): (f64, f64, f64) = (0.1, 0.5, 5e5 * 1e-16 / 1e-9);
    let root = ((1.0 + al).powi(2) - 3.0 * (al + ratio)).sqrt();
    for (point, sign) in found.iter().zip([-1.0, 1.0]) {
        let v = (1.0 + al + sign * root) / 3.0;
        let current = 1e-10 * (be * v - v * (1.0 - v) * (v - al));
        close(point.parameters[0] / current, 1.0, 1e-9);
        close(point.number("hopf_frequency").expect("a frequency").value, 1.5e6, 1e-3);
        assert!(point.converged && point.unstable == Some(0), "{point:?}");
    }
}

/// The flat state of the Cahn–Hilliard equation, split into two equations of second order, with a
/// singular mass matrix. Mode `k` becomes stable at `e = 1/(4n² sin²(kπ/2n))`.
#[test]
fn a_singular_mass_matrix_leaves_the_eigenvalues_right() {
    let branch = &traced(
        r#"Scene(title: "t", problem: Residual(
        unknowns: [
            ("u[i=1..n]", "u[i]' = (w[i-1] - 2*w[i] + w[i+1])*n^2 + if(i == 1, m - sum(j,1,n,u[j])/n, 0)"),
            ("w[i=1..n]", "0 = w[i] + e*(u[i-1] - 2*u[i] + u[i+1])*n^2 + u[i] - u[i]^3")],
        definitions: [("n", 101), ("u[i=0..n+1]", "u[min(max(i,1),n)]"), ("w[i=0..n+1]", "w[min(max(i,1),n)]")],
        dynamics: flow, matrices: sparse),
        parameters: [("m", 0), ("e", 0.01)],
        runs: [(name: "flat", along: [(name: "e", low: 0.01, high: 0.2)])])"#,
    )[0];
    let found = inner(branch);
    assert_eq!(found.iter().map(|it| it.kind).collect::<Vec<_>>(), [Kind::BP; 3], "{found:?}");
    for (point, k) in found.iter().zip([3, 2, 1]) {
        let e = (202.0 * (f64::from(k) * PI / 202.0).sin()).powi(-2);
        close(point.parameters[1] / e, 1.0, 1e-10);
        assert!(point.converged && point.unstable == Some(k as usize - 1), "{point:?}");
    }
}

/// Diffusion on a ring conserves the sum of all values, unless a term determines this sum.
#[test]
fn a_conserved_sum_is_named() {
    let outcome = |term: &str| {
        let text = format!(
            r#"Scene(title: "t", problem: Residual(
            unknowns: [("u[i=1..n]",
                "((k + (u[i]+u[i+1])/2)*(u[i+1]-u[i]) - (k + (u[i-1]+u[i])/2)*(u[i]-u[i-1]))*n^2 {term}")],
            definitions: [("n", 20), ("u[i=0..n+1]", "u[1 + mod(i-1,n)]")], dynamics: flow),
            parameters: [("k", 1), ("m", 0)],
            runs: [(name: "rest", along: [(name: "k", low: 1, high: 2)])])"#
        );
        execute(&scene(&text), None, &mut ())
    };
    let error = outcome("").error.expect("an error");
    assert!(error.to_string().contains("the quantity Σ u is conserved"), "{error}");
    let known = outcome("+ m - sum(j,1,n,u[j])/n");
    assert_eq!(known.error, None);
    assert_eq!(known.document.branches[0].points.last().and_then(|point| point.unstable), Some(0));
}

/// With the conditions `q[i] + q[i+1] = 0` and `u[2i] = u[2i−1]`, the equations have index 2. Each pair moves
/// as one cell with the mean of their rates; mode `j` of the ten pairs has a Hopf point at `a = 0.5 + 0.05 (2
/// sin(πj/20))²`.
#[test]
fn infinite_eigenvalues_of_index_two_are_not_counted() {
    let branch = &traced(
        r#"Scene(title: "t", problem: Residual(dynamics: flow, matrices: sparse, unknowns: [
            ("u[i=1..n]", "u[i]' = 0.1*(u[i-1]-2*u[i]+u[i+1]) + a*u[i] - w[i] - u[i]^3 + q[i]"),
            ("w[i=1..n]", "w[i]' = u[i] - 0.5*w[i]"),
            ("q[i=1..n]", "0 = if(mod(i,2) == 0, u[i]-u[i-1], q[i]+q[i+1])")],
        definitions: [("n", 20), ("u[i=0..n+1]", "u[min(max(i,1),n)]"), ("q[n+1]", "0")]),
        parameters: [("a", 0)], runs: [(name: "rest", along: [(name: "a", low: 0, high: 1)])])"#,
    )[0];
    let found = inner(branch);
    assert_eq!(found.iter().map(|it| it.kind).collect::<Vec<_>>(), [Kind::HB; 10], "{found:?}");
    for (j, point) in found.iter().enumerate() {
        let a = 0.5 + 0.2 * (j as f64 * PI / 20.0).sin().powi(2);
        close(point.parameters[0], a, 1e-10);
        assert_eq!(point.unstable, Some(2 * j));
    }
    assert_eq!(branch.points.first().and_then(|point| point.unstable), Some(0));
}

/// The guess of `y` is up to a hundred million times larger than the solution.
#[test]
fn a_start_is_accurate_in_units_of_the_solution() {
    for guess in [1e4, 1.1e6, 3e6, 1e8] {
        let branch = &traced(&format!(
            r#"Scene(title: "t", problem: Residual(
            unknowns: [("x", "y*x - 0.5"), ("y", "1e-8*(x*x + z^2 - 1)"), ("z", "-y*z - 1")],
            initial: [("x", 0.45), ("z", -0.89), ("y", {guess})]),
            parameters: [("d", 1)], runs: [(name: "rest", along: [(name: "d", low: -1, high: 1)])])"#
        ))[0];
        let start = &branch.special[0].state;
        let exact = 1.25_f64.sqrt();
        for (value, exact) in start.iter().zip([0.5 / exact, exact, -1.0 / exact]) {
            close(*value, exact, 1e-9);
        }
    }
}

/// Newton's method converges to the fixed point 0, whose size gives no scale.
#[test]
fn a_fixed_point_at_zero_is_a_start() {
    for guess in [0.01, 0.05, 0.11, -0.1] {
        let branch = &traced(&format!(
            r#"Scene(title: "t", problem: Map(states: [("x", "r*x*(1-x)")], initial: [("x", {guess})]),
            parameters: [("r", 0.5)], runs: [(name: "rest", along: [(name: "r", low: 0, high: 4)])])"#
        ))[0];
        let found = branch.of_kind(Kind::BP).next().expect("a branch point");
        close(found.parameters[0], 1.0, 1e-9);
    }
}

/// Two eigenvalues vanish at K = 1.62600810784 (0 = 5 u − u³ − 1, 5 − 3 u² = 3 K). The derivative with
/// respect to K vanishes in the uniform state, up to rounding errors of the state: whatever the guess, the
/// branches cross.
#[test]
fn a_double_branch_point_is_no_fold_whatever_the_guess() {
    for guess in [0.2, 0.0, 0.4, -0.1, -0.2016, 0.15] {
        let text = format!(
            r#"Scene(title: "ring", problem: Residual(dynamics: flow,
            unknowns: [("u[i=1..3]", "5*u[i] - u[i]^3 - 1 + K*(u[i-1] - 2*u[i] + u[i+1])")],
            definitions: [("u[i=0..4]", "u[1+mod(i-1,3)]")], parameters: [("K", 2)]),
            runs: [(name: "branch", start: Guess([("u", {guess})]), along: [(name: "K", low: 0.1, high: 5)])])"#
        );
        let branch = traced(&text).remove(0);
        assert!(branch.of_kind(Kind::LP).next().is_none(), "{guess}");
        let double = branch.of_kind(Kind::BP).next().unwrap();
        assert_eq!(double.multiplicity, 2, "{guess}");
        close(double.parameters[0], 1.626_008_107_84, 1e-9);
    }
}
