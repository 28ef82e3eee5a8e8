//! Promise: special points of hybrid models do not depend on the method, the steps, or the units.

use crate::common::close;
use tangency::core::continuation::Branch;
use tangency::core::system::Kind;
use tangency::scene::{Scene, execute};

/// The special points besides ends at bounds: kinds with values of the parameter, by both methods and
/// with several steps.
fn points(problem: &str, (along, transient): (&str, f64), runs: &str) -> Vec<(Kind, f64)> {
    let mut all: Vec<Vec<(Kind, f64)>> = Vec::new();
    for (method, max_step) in
        [("shooting", 0.1), ("collocation", 0.1), ("shooting", 0.02), ("collocation", 0.5)]
    {
        let text = format!(
            "Scene(title: \"t\", problem: {problem}, settings: (max_step: {max_step}), runs: [
                (name: \"r\", set: [(\"method\", \"{method}\")], start: Simulated(transient: {transient}), {along}),
                {runs}])"
        )
        .replace("{along}", along)
        .replace("{method}", method);
        let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        let outcome = execute(&scene, None, &mut ());
        assert!(outcome.error.is_none(), "{method}, {max_step}: {:?}", outcome.error);
        let of_branch = |branch: &Branch| {
            let special = branch.special.iter().filter(|point| point.kind != Kind::EP);
            special.map(|point| (point.kind, point.parameters[0])).collect::<Vec<_>>()
        };
        let mut found: Vec<_> = outcome.document.branches.iter().flat_map(of_branch).collect();
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        all.push(found);
    }
    for other in &all[1..] {
        assert_eq!(other.len(), all[0].len(), "{other:?}, {:?}", all[0]);
        for (a, b) in other.iter().zip(&all[0]) {
            assert_eq!(a.0, b.0);
            assert!((a.1 - b.1).abs() <= 1e-8 * b.1.abs(), "{a:?}, {b:?}");
        }
    }
    all.swap_remove(0)
}

/// Converters of four states under current control, in SI units, with a clock by the time.
fn converter(rates: &str) -> String {
    format!(
        "HybridEquations(
            states: [{rates}],
            modes: [
                (name: \"on\", definitions: [(\"on\", 1), (\"off\", 0)]),
                (name: \"off\", definitions: [(\"on\", 0), (\"off\", 1)]),
            ],
            guards: [
                (name: \"peak\", modes: [\"on\"], function: \"Iref - i1 - i2\", next: \"off\"),
                (name: \"clock\", modes: [\"off\", \"on\"], at: \"n*T\", next: \"on\"),
            ],
            parameters: [(\"Iref\", 1), (\"E\", 12), (\"L\", 1e-3), (\"C\", 10e-6), (\"R\", 20), (\"T\", 5e-5)],
            period: \"T\", scales: [(\"t\", 5e-5)],
            initial: [(\"i1\", 0.3), (\"i2\", 0.3), (\"v1\", 12), (\"v2\", 8)])"
    )
}

const SWITCHED: &str = "(name: \"s\", set: [(\"method\", \"{method}\")],
    start: From(run: \"r\", kind: PD, switch: true), {along}),
    (name: \"t\", set: [(\"method\", \"{method}\")],
    start: From(run: \"s\", kind: G, switch: true), {along})";

/// Ćuk's converter doubles its period; the doubled orbit collides with the clock, and loses its
/// stability to a torus beyond.
#[test]
fn cuk_converter() {
    let rates = "(\"i1\", \"(E - off*v1)/L\"), (\"i2\", \"(on*v1 - v2)/L\"),
        (\"v1\", \"(off*i1 - on*i2)/C\"), (\"v2\", \"(i2 - v2/R)/C\")";
    let along = "along: [(name: \"Iref\", low: 0.5, high: 4)]";
    let found = points(&converter(rates), (along, 0.05), SWITCHED);
    let kinds: Vec<Kind> = found.iter().map(|point| point.0).collect();
    assert_eq!(kinds, [Kind::PD, Kind::G, Kind::TR, Kind::PD, Kind::TR]);
}

/// A capsule of micrometres and milliseconds, with contact and friction: the special points are those
/// of the capsule without units.
#[test]
fn capsule_in_si_units() {
    let capsule = |[length, time, force]: [f64; 3]| {
        let (speed, stiffness) = (length / time, force / length);
        let mass = force * time * time / length;
        format!(
            "HybridEquations(
                states: [(\"y\", \"u - w\"), (\"u\", \"(A*cos(om*t) - F)/m\")],
                product: [
                    [
                        (name: \"stick\", definitions: [(\"w\", 0)]),
                        (name: \"forward\", states: [(\"w\", \"(F - mu)/(2*m)\")]),
                        (name: \"back\", states: [(\"w\", \"(F + mu)/(2*m)\")]),
                    ],
                    [
                        (name: \"free\", definitions: [(\"wall\", 0)]),
                        (name: \"contact\", definitions: [(\"wall\", \"15*k*(y - gap)\")]),
                    ],
                ],
                definitions: [(\"F\", \"k*y + c*(u - w) + wall\")],
                guards: [
                    (name: \"touch\", modes: [\"free\"], function: \"gap - y\", next: \"contact\"),
                    (name: \"part\", modes: [\"contact\"], function: \"y - gap\", next: \"free\"),
                    (name: \"go\", modes: [\"stick\"], function: \"mu - F\", next: \"forward\", reset: [(\"w\", 0)]),
                    (name: \"go_back\", modes: [\"stick\"], function: \"mu + F\", next: \"back\", reset: [(\"w\", 0)]),
                    (name: \"stop\", modes: [\"forward\"], function: \"w\", reset: [(\"w\", 0)],
                     next: [(\"stick\", \"mu - abs(F)\"), (\"back\", \"-F\"), \"forward\"]),
                    (name: \"stop\", modes: [\"back\"], function: \"-w\", reset: [(\"w\", 0)],
                     next: [(\"stick\", \"mu - abs(F)\"), (\"forward\", \"F\"), \"back\"]),
                ],
                parameters: [
                    (\"A\", {}), (\"om\", {}), (\"k\", {stiffness}), (\"c\", {}), (\"m\", {mass}),
                    (\"gap\", {}), (\"mu\", {}),
                ],
                period: \"2*pi/om\",
                scales: [(\"t\", {time}), (\"y\", {length}), (\"u\", {speed}), (\"w\", {speed})])",
            0.6 * force,
            0.9 / time,
            0.1 * stiffness * time,
            0.02 * length,
            0.3 * force
        )
    };
    let found = |units: [f64; 3]| {
        let [_, time, force] = units;
        let along = format!("along: [(name: \"A\", low: {}, high: {})]", 0.4 * force, force);
        let found = points(&capsule(units), (&along, 300.0 * time), "");
        found.into_iter().map(|(kind, a)| (kind, a / force)).collect::<Vec<_>>()
    };
    let (plain, si) = (found([1.0, 1.0, 1.0]), found([2e-6, 1e-2, 2e-3]));
    assert_eq!(plain.len(), si.len());
    for (a, b) in plain.iter().zip(&si) {
        assert_eq!(a.0, b.0);
        close(a.1, b.1, 1e-9);
    }
    close(plain.last().unwrap().1, 0.623328464528, 1e-9);
}

/// Fish grow by `N' = N (1 − N)`, and the fraction `E` is caught once in a unit of time: after a
/// catch there are `((1 − E) e − 1)/(e − 1)`, and none from `E = 1 − e⁻¹` on.
#[test]
fn fish_that_are_caught_by_the_calendar() {
    let fish = "HybridEquations(
        modes: [(name: \"m\", states: [(\"N\", \"N*(1 - N)\")])],
        guards: [(name: \"catch\", modes: [\"m\"], at: \"n\", reset: [(\"N\", \"(1 - E)*N\")])],
        parameters: [(\"E\", 0.3)], period: \"1\", initial: [(\"N\", 0.5)])";
    let along = "along: [(name: \"E\", low: 0.1, high: 0.64)]";
    let found = points(fish, (along, 200.0), "");
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].0, Kind::BP);
    close(found[0].1, 1.0 - (-1.0_f64).exp(), 1e-10);
}

/// A force that switches, in units of time up to 1e6 times shorter and 1e9 times longer: the symmetric
/// orbit loses its symmetry at the same frequency.
#[test]
fn bang_bang_in_other_units_of_time() {
    let found = |unit: f64| {
        let model = format!(
            "HybridEquations(
                modes: [
                    (name: \"plus\", states: [(\"x\", \"s*v\"), (\"v\", \"s*(A - 0.2*v - x - x^3)\")]),
                    (name: \"minus\", states: [(\"x\", \"s*v\"), (\"v\", \"s*(-A - 0.2*v - x - x^3)\")]),
                ],
                guards: [
                    (name: \"down\", modes: [\"plus\"], function: \"sin(omega*t*s)\", next: \"minus\"),
                    (name: \"up\", modes: [\"minus\"], function: \"-sin(omega*t*s)\", next: \"plus\"),
                ],
                definitions: [(\"s\", \"1/{unit}\")],
                parameters: [(\"omega\", 1.2), (\"A\", 26)],
                period: \"2*pi/omega*{unit}\")"
        );
        points(&model, ("along: [(name: \"omega\", low: 1, high: 1.3)]", 50.0), "")
    };
    for unit in [1e6, 1.0, 1e-9] {
        let found = found(unit);
        assert_eq!(found.len(), 1, "{unit}: {found:?}");
        assert_eq!(found[0].0, Kind::BP);
        close(found[0].1, 1.07596790660122, 1e-9);
    }
}
