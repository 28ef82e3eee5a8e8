//! Promise: branches of cycles end where they repeat themselves, and their special points are
//! consistent with theory.

use super::traced;
use crate::common::{close, first, values};
use tangency::core::continuation::{Branch, End, Number};
use tangency::output::{Summary, example_branch};
use tangency::prelude::*;

/// The cycles from the second Hopf point of the model of J. L. Hindmarsh and R. M. Rose, with
/// settings of the run.
fn bursting(settings: &str) -> Branch {
    let text = format!(
        r#"Scene(title: "bursting", problem: Equations(
        states: [("x", "y - x^3 + 3*x^2 - z + I"), ("y", "1 - 5*x^2 - y"), ("z", "0.005*(4*(x + 1.6) - z)")],
        initial: [("x", 0)], solution: equilibrium), parameters: [("I", 5.4)],
        runs: [(name: "rest", along: [(name: "I", low: 5.3, high: 5.4)]),
            (name: "cycles", start: From(run: "rest", kind: HB, switch: true),
                along: [(name: "I", low: 5.3, high: 5.4)], {settings})])"#
    );
    traced(&text).remove(1)
}

/// Each revolution about another cycle adds two folds at the same values. The end has the values of
/// the last folds that are located on their own equations.
#[test]
fn a_snaking_branch_of_cycles_ends() {
    let branch = bursting("");
    let [_, End::Snaking { values, from, to, .. }] = &branch.ends else {
        panic!("{:?}", branch.ends)
    };
    assert!(from < to && branch.points.len() < 500, "{from} to {to}, {}", branch.points.len());
    let folds: Vec<f64> = branch.of_kind(Kind::LP).map(|fold| fold.parameters[0]).collect();
    let width = values[1] - values[0];
    for value in &folds[folds.len() - 4..] {
        let near = values.iter().any(|own| (own - value).abs() < 0.03 * width);
        assert!(near, "{folds:?}, {values:?}");
    }
}

/// A bound of the period is reached instead.
#[test]
fn a_bound_of_the_period_follows_a_snaking_branch() {
    let branch = bursting(r#"bounds: [(name: "period", low: 0, high: 250)]"#);
    assert!(matches!(&branch.ends[1], End::MonitorBound { name, .. } if name == "period"));
}

/// At a fold of cycles a multiplier is 1; on the default mesh its error was 0.1.
#[test]
fn folds_of_bursts_have_the_multiplier_one() {
    for fold in bursting("").of_kind(Kind::LP).filter(|fold| fold.converged) {
        let distances = fold.eigenvalues.iter().map(|(re, im)| (re - 1.0).hypot(*im));
        let nearest = distances.fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-2 || fold.undetermined.is_some(), "{:?}", fold.eigenvalues);
    }
}

/// A window of O. E. Rössler's equations: on the default mesh the second doubled branch did not
/// begin. The values agree with a mesh error of 1e-6.
#[test]
fn doubled_orbits_of_doubled_orbits_begin_on_the_default_mesh() {
    let run = |name: &str, from: &str| {
        format!(
            r#"(name: "{name}", start: From(run: "{from}", kind: PD, switch: true), along: [(name: "c", low: 5, high: 6)])"#
        )
    };
    let [second, third] = [run("second", "first"), run("third", "second")];
    let text = format!(
        r#"Scene(title: "window", problem: Equations(
        states: [("x", "-y - z"), ("y", "x + a*y"), ("z", "b + z*(x - c)")], initial: [("x", 1)],
        solution: orbit), parameters: [("a", 0.2), ("b", 0.2), ("c", 5.3)],
        runs: [(name: "first", start: Simulated(transient: 2000), along: [(name: "c", low: 5, high: 6)]),
            {second}, {third}])"#
    );
    let branches = traced(&text);
    for (branch, doubling) in branches.iter().zip([5.379_419_82, 5.471_228_17, 5.491_719_52]) {
        close(values(branch, Kind::PD, "c")[0], doubling, 1e-7);
    }
    // The start has the refined value of the doubling, too.
    close(values(&branches[2], Kind::EP, "c")[0], 5.471_228_17, 1e-7);
}

vector_field! {
    /// The model of R. FitzHugh and J. Nagumo.
    struct Neuron [v, w; i, epsilon] {
        d/dt v = v - v * v * v / 3.0 - w + i;
        d/dt w = (v + 0.7 - w * 0.8) * epsilon;
    }
}

/// The multipliers of planar flows are positive: a fold of cycles has no multiplier −1.
#[test]
fn planar_cycles_have_no_fold_flip_points() {
    let mut rest = Dense::new(Equilibria::new(Neuron));
    let rest = Continuation::new(&mut rest).from(&[-1.2, -0.6]).at("epsilon", 0.15);
    let rest = rest.along("i", 0.0..=1.0).trace().unwrap();
    let mut orbits = periodic_orbits(Neuron, 20, Collocation::new(4).unwrap()).unwrap();
    let hopf = first(&rest, Kind::HB).label;
    let cycles = Continuation::new(&mut orbits).restart(&rest, hopf).along("i", 0.0..=1.0);
    let cycles = cycles.trace().unwrap();
    let fold = first(&cycles, Kind::LP).label;
    let folds = Continuation::new(&mut orbits).restart(&cycles, fold).hold(Kind::LP);
    let folds = folds.along("i", 0.0..=2.0).along("epsilon", 0.01..=2.0).trace().unwrap();
    let kinds: Vec<Kind> = folds.special.iter().map(|special| special.kind).collect();
    assert!(kinds.contains(&Kind::GH), "{kinds:?}");
    assert!(!kinds.contains(&Kind::LPPD), "{kinds:?}");
}

/// The cycles of a mass on a belt that always slips shrink to the Hopf point at V = vm, by single
/// shooting.
#[test]
fn cycles_of_single_shooting_end_at_a_hopf_point() {
    let text = r#"Scene(title: "brake", problem: FilippovEquations(surface: "V - v",
        above: [("x", "v"), ("v", "-x + mu")], below: [("x", "v"), ("v", "-x - mu")],
        definitions: [("w", "abs(V - v)/0.5"), ("mu", "0.4 - 0.15*(3*w - w^3)/2")],
        initial: [("x", 0.3), ("v", 0)], solution: orbit), parameters: [("V", 0.2)],
        runs: [(name: "stick", start: Simulated(transient: 100), along: [(name: "V", low: 0.05, high: 0.7)]),
            (name: "slip", start: From(run: "stick", kind: G, switch: true), along: [(name: "V", low: 0.05, high: 0.7)])])"#;
    let slip = &traced(text)[1];
    let hopf = slip.of_kind(Kind::HB).next().expect("a Hopf point");
    close(hopf.parameters[0], 0.5, 1e-6);
    assert!(slip.ends.iter().any(|end| matches!(end, End::Event { .. })), "{:?}", slip.ends);
}

/// The start lies on a bound; on a coarse mesh the first adaptation moved it across the bound.
#[test]
fn a_coarse_start_on_a_bound_goes_on() {
    let text = r#"Scene(title: "valve", problem: Equations(states: [("x", "y"), ("y", "mu*(1 - x^2)*y - x")],
        initial: [("x", 1)], solution: orbit, method: collocation(intervals: 5)), parameters: [("mu", 1)],
        settings: (target_mesh_error: 1),
        runs: [(name: "cycles", start: Simulated(transient: 50), along: [(name: "mu", low: 1, high: 100)])])"#;
    let branch = &traced(text)[0];
    assert!(branch.points.len() > 5, "{:?}", branch.ends);
}

/// The normal forms of all branch points of a row of points, whose null vectors are orthogonal to
/// each other: with `q = sin kπx` on `n` inner points, `⟨q, q⟩ = 1`, the cubic coefficient is
/// `−λ Σ q⁴ = −3λ/(2(n + 1))`.
#[test]
fn each_branch_point_of_a_row_has_its_normal_form() {
    let text = r#"Scene(title: "row", problem: Residual(
        unknowns: [("u[i=1..19]", "(u[i-1] - 2*u[i] + u[i+1])*400 + lambda*(u[i] - u[i]^3)")],
        definitions: [("u[0]", 0), ("u[20]", 0)], dynamics: flow), parameters: [("lambda", 0)],
        runs: [(name: "rest", along: [(name: "lambda", low: 0, high: 100)])])"#;
    let points: Vec<_> = traced(text)[0].of_kind(Kind::BP).cloned().collect();
    assert_eq!(points.len(), 3);
    for point in points {
        let c = point.number("pitchfork_c").expect("a coefficient");
        close(c.value, -1.5 * point.parameters[0] / 20.0, 1e-9 * point.parameters[0]);
    }
}

/// Tables leave a number empty whose error exceeds its value.
#[test]
fn numbers_without_a_certain_digit_are_not_in_tables() {
    let cell = |error: f64| {
        let mut branch = example_branch();
        branch.special[2].numbers = vec![Number { name: "fold_b".into(), value: 6.7e10, error }];
        let table = csv(&[branch]);
        let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
        let column = rows[0].iter().position(|title| *title == "fold_b").expect("the column");
        rows[3][column].to_string()
    };
    assert_eq!((cell(1e9), cell(3e11)), ("67000000000".into(), String::new()));
}

/// Near homoclinic orbits, the periods at folds of cycles of a Morris–Lecar neuron depend on the
/// mesh far more than the cycles: on meshes with a mesh error of 1e-6, the period at I = 31.58 was
/// wrong by 5 %, and the curve turned back. The fold along `gCa` at fixed `I`, on 150 intervals, has
/// the period 207.507.
#[test]
fn folds_of_cycles_near_homoclinic_orbits_have_fine_meshes() {
    let folds = traced(
        r#"Scene(title: "folds of cycles", problem: Equations(
            states: [("V", "(I - 2*(V + 60) - 8*w*(V + 84) - gCa*m*(V - 120))/20"),
                ("w", "(w_rest - w)*cosh((V - 12)/34.8)/15")],
            parameters: [("gCa", 4)],
            definitions: [("m", "(1 + tanh((V + 1.2)/18))/2"), ("w_rest", "(1 + tanh((V - 12)/17.4))/2")],
            initial: [("V", -60), ("w", 0)], scales: [("V", 50)], solution: equilibrium), parameters: [("I", 0)],
            runs: [(name: "rest", along: [(name: "I", low: -20, high: 300)]),
                (name: "cycles", start: From(run: "rest", kind: HB, switch: true), along: [(name: "I", low: 0, high: 300)]),
                (name: "folds", hold: LP, start: From(run: "cycles", kind: LP), set: [("solution","orbit")],
                    along: [(name: "I", low: 31.3, high: 200), (name: "gCa", low: 0, high: 8)], marks: [("I", 31.5777)])])"#,
    )
    .remove(2);
    let mark = folds.of_kind(Kind::UZ).next().unwrap();
    let of = |column: &str| mark.value(folds.column(column).unwrap()).unwrap();
    assert!(mark.converged);
    close(of("period"), 207.507, 1e-3);
    close(of("gCa"), 5.6261799, 1e-7);
    let column = |name: &str| {
        let column = folds.column(name).unwrap();
        folds.points.iter().filter_map(move |point| point.value(column)).collect::<Vec<f64>>()
    };
    assert!(column("I").windows(2).all(|pair| pair[1] < pair[0]));
    assert!(column("period").windows(2).all(|pair| pair[1] > pair[0]));
}

/// Hindmarsh and Rose's neuron: at i = 1.831356 a fold and a period doubling of the cycles lie 1.7e-7 apart, closer
/// than the errors of the default mesh. A turn of the parameter without a fold is reported; on 100 intervals both
/// points are found.
#[test]
fn turns_without_a_located_fold_are_reported() {
    let text = |intervals: usize| {
        format!(
            "Scene(title: \"t\", problem: Equations(
                states: [(\"x\", \"y - x^3 + 3*x^2 - z + i\"), (\"y\", \"1 - 5*x^2 - y\"), (\"z\", \"0.01*(4*(x + 1.6) - z)\")],
                initial: [(\"x\", -1.6), (\"y\", -11.8)], method: collocation(intervals: {intervals})),
             parameters: [(\"i\", 0)], runs: [
                (name: \"rest\", set: [(\"solution\", \"equilibrium\")], along: [(name: \"i\", low: 0, high: 4)]),
                (name: \"cycles\", start: From(run: \"rest\", kind: HB), along: [(name: \"i\", low: 0, high: 4)]),
             ])"
        )
    };
    for intervals in [20, 100] {
        let cycles = &traced(&text(intervals))[1];
        let column = cycles.column("i").unwrap();
        let near = |kind: Kind, at: f64| {
            let found = cycles.converged_points(kind);
            found.filter(|it| (it.value(column).unwrap() - at).abs() < 1e-8).count()
        };
        let said = cycles.warnings.iter().any(|warning| warning.contains("turns near 1.8313"));
        let found = [near(Kind::LP, 1.831_356_241_3), near(Kind::PD, 1.831_356_408_8)];
        assert!(said == (found[0] == 0), "{intervals}: {found:?} {:?}", cycles.warnings);
        assert!(intervals == 20 || found == [1, 1], "{found:?}");
        // The last cycles are two equal ones of half the period.
        let last = cycles.special.iter().find(|it| it.halves_the_period()).expect("an end");
        let command = format!("`--start FILE:cycles/{} --switch PD`", last.label);
        assert!(Summary(cycles).to_string().ends_with(&command), "{}", Summary(cycles));
    }
}

/// A ring of Stuart–Landau oscillators: small modes of the wave number k vanish together with their mirror
/// images where `K (2 − 2 cos(2πk/n)) = −2 (1 + α β)/(1 + α²)`. The derivative with respect to K vanishes in
/// the uniform state, and neither rounding errors of the state nor of the multipliers may decide the kind.
#[test]
fn double_multipliers_of_rings_are_branch_points() {
    let critical = -2.0 * (1.0 - 1.2 * 1.5) / (1.0 + 1.2 * 1.2);
    for (n, method) in [(8, "collocation"), (12, "collocation"), (4, "shooting")] {
        let wave = (std::f64::consts::TAU / f64::from(n)).cos();
        let expected = critical / (2.0 - 2.0 * wave);
        let text = format!(
            r#"Scene(title: "ring", problem: Equations(states: [
                ("u[i=1..n]", "u[i] - u[i]*(u[i]^2 + v[i]^2) - 2*v[i] + 1.5*v[i]*(u[i]^2 + v[i]^2)
                    + K*(u[i-1] - 2*u[i] + u[i+1]) + 1.2*K*(v[i-1] - 2*v[i] + v[i+1])"),
                ("v[i=1..n]", "v[i] - v[i]*(u[i]^2 + v[i]^2) + 2*u[i] - 1.5*u[i]*(u[i]^2 + v[i]^2)
                    + K*(v[i-1] - 2*v[i] + v[i+1]) - 1.2*K*(u[i-1] - 2*u[i] + u[i+1])")],
            definitions: [("n", {n}), ("u[i=0..n+1]", "u[1+mod(i-1,n)]"), ("v[i=0..n+1]", "v[1+mod(i-1,n)]")],
            parameters: [("K", 3)], initial: [("u", 1)], method: {method}()), parameters: [("K", {})],
            runs: [(name: "uniform", start: Simulated(transient: 100),
                along: [(name: "K", low: {}, high: {})])])"#,
            1.2 * expected,
            0.9 * expected,
            1.5 * expected
        );
        let branch = &traced(&text)[0];
        let kinds: Vec<Kind> = branch.special.iter().map(|point| point.kind).collect();
        let double: Vec<_> = branch.of_kind(Kind::BP).collect();
        assert!(double.len() == 1 && kinds.len() == 3, "{n}: {kinds:?}");
        assert_eq!(double[0].multiplicity, 2);
        close(double[0].parameters[0], expected, 1e-8);
    }
}

/// Two equal oscillators `z_k' = (m + i) z_k − (|z_k|² + 2 |z_j|²) z_k + z_j² z̄_k/2` have the cycles
/// `z₂ = i z₁`, `z₂ = z₁` and `z₂ = 0` with `m = 3.5 |z₁|²`, `m = 2.5 |z₁|²` and `m = |z₁|²`, up to the symmetry.
#[test]
fn cycles_emanate_in_several_directions_from_equal_pairs() {
    let oscillator = |k: usize, j: usize| {
        let (damping, [re, im]) = (
            format!("(m - x{k}^2 - y{k}^2 - 2*x{j}^2 - 2*y{j}^2)"),
            // z_j² z̄_k.
            [
                format!("((x{j}^2 - y{j}^2)*x{k} + 2*x{j}*y{j}*y{k})"),
                format!("(2*x{j}*y{j}*x{k} - (x{j}^2 - y{j}^2)*y{k})"),
            ],
        );
        format!(
            r#"("x{k}", "{damping}*x{k} - y{k} + {re}/2"), ("y{k}", "{damping}*y{k} + x{k} + {im}/2")"#
        )
    };
    let states = [oscillator(1, 2), oscillator(2, 1)].join(", ");
    let along = r#"along: [(name: "m", low: -1, high: 1)]"#;
    let runs: Vec<String> = (0..3)
        .map(|which| {
            format!(
                r#"(name: "cycles {which}", start: From(run: "rest", kind: HB, switch: true, which: {which}), {along})"#
            )
        })
        .collect();
    let text = format!(
        r#"Scene(title: "t", problem: Equations(states: [{states}], solution: equilibrium), parameters: [("m", -0.5)],
        runs: [(name: "rest", {along}), {}])"#,
        runs.join(", ")
    );
    let all = traced(&text);
    assert_eq!(all[0].of_kind(Kind::HB).next().unwrap().multiplicity, 2);
    for (branch, square) in all[1..].iter().zip([1.0 / 3.5, 1.0 / 2.5, 1.0]) {
        let end = branch
            .special
            .iter()
            .max_by(|a, b| a.parameters[0].total_cmp(&b.parameters[0]))
            .unwrap();
        close(end.parameters[0], 1.0, 1e-12);
        let amplitudes =
            ["max_x1", "max_x2"].map(|name| end.value(branch.column(name).unwrap()).unwrap());
        close(amplitudes[0].max(amplitudes[1]), f64::sqrt(square), 1e-8);
        let other = if square == 1.0 { 0.0 } else { f64::sqrt(square) };
        assert!((amplitudes[0].min(amplitudes[1]) - other).abs() < 1e-8, "{amplitudes:?}");
    }
}

/// Terms of third order determine the rotating wave of three van der Pol oscillators, but not their
/// standing waves. Its period and amplitude at m = 1 are from harmonic balance with 96 points.
#[test]
fn the_rotating_wave_of_a_ring_is_followed() {
    let text = r#"Scene(title: "ring", problem: Equations(states: [("x[i=1..3]", "y[i]"),
            ("y[i=1..3]", "(m - x[i]^2)*y[i] - x[i] - 0.2*x[i]^3 + 0.3*(y[i-1] - 2*y[i] + y[i+1])")],
        definitions: [("y[i=0..4]", "y[1+mod(i-1,3)]")], solution: equilibrium), parameters: [("m", 0.5)],
        runs: [(name: "rest", along: [(name: "m", low: 0.5, high: 1)]),
            (name: "wave", start: From(run: "rest", kind: HB, switch: true), along: [(name: "m", low: 0.5, high: 1)])])"#;
    let wave = &traced(text)[1];
    let end = wave.special.iter().find(|point| point.parameters[0] == 1.0).unwrap();
    let value = |name: &str| end.value(wave.column(name).unwrap()).unwrap();
    close(value("period"), 6.106_888_856_108, 1e-9);
    close(value("max_x[1]"), 0.632_342_348_090, 1e-8);
    close(value("max_x[2]"), 0.632_342_348_090, 1e-8);
}
