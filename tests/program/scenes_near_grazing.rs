//! Promise: from the command line, local maps near grazing lie beside the flow in one diagram:
//! their fixed points, multipliers, folds and doublings, and the curves of these that begin at
//! points of codimension two.

use crate::common::close;
use crate::program::scenarios::{built_in, column, refusal, traced, with};
use tangency::core::continuation::Branch;
use tangency::core::failure::one_line;
use tangency::core::sweep::Part;
use tangency::core::system::Kind;
use tangency::output::{Document, FigureError, SweepTable, figures};
use tangency::scene::{Scene, SceneError, StartPoint, execute, sweep};

/// The one value of a column at the special points of a kind.
#[track_caller]
fn one(document: &Document, branch: &str, kind: Kind, name: &str) -> f64 {
    let found = column(document, branch, kind, name);
    assert_eq!(found.len(), 1, "{branch}, {kind}: {found:?}");
    found[0]
}

/// Column `y` of a branch where its column `x` has a value, by the cubic polynomial through the
/// points around.
fn between(branch: &Branch, x: &str, y: &str, at: f64) -> f64 {
    let (x, y) = (branch.column(x).unwrap(), branch.column(y).unwrap());
    let points: Vec<(f64, f64)> =
        branch.points.iter().filter_map(|p| Some((p.value(x)?, p.value(y)?))).collect();
    let around = |four: &&[(f64, f64)]| (four[1].0 - at) * (four[2].0 - at) <= 0.0;
    let four = points.windows(4).find(around).unwrap();
    let weight = |k: usize| {
        let others = four.iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, other)| (at - other.0) / (four[k].0 - other.0)).product::<f64>()
    };
    (0..4).map(|k| weight(k) * four[k].1).sum()
}

/// Grazings of the flow are the sheet's, and its fold and doublings by `mita-type-2` and the curve
/// of grazings. Those of the map of second order miss them by so much, and those of the third order
/// by less.
#[test]
fn maps_approach_the_flow() {
    let (flow, map) =
        (["P(0,1)", "P(1,1)"], ["P(0,1) by the local map", "P(1,1) by the local map"]);
    for (scene, grazing, (of, kind), misses) in [
        ("mita-near-grazing-1", 0.171490414984, (1, Kind::LP), [3e-7, 5e-9]),
        ("mita-near-grazing-2", 0.171741423232, (1, Kind::PD), [4e-5, 9e-4]),
        ("mita-near-grazing-3", 0.178194172275, (0, Kind::LP), [1e-6, 5e-6]),
    ] {
        let errors = |order: &str| {
            let document = traced(&with(scene, &[("order", order)]));
            close(one(&document, flow[0], Kind::G, "voltage"), grazing, 1e-11);
            let miss = |k: usize, kind: Kind| {
                let [a, b] =
                    [flow[k], map[k]].map(|branch| one(&document, branch, kind, "voltage"));
                (a - b).abs()
            };
            [miss(0, Kind::G), miss(of, kind)]
        };
        let (second, third) = (errors("2"), errors("3"));
        for k in 0..2 {
            assert!(second[k] < misses[k] && third[k] < 0.4 * second[k], "{second:?} {third:?}");
        }
    }
}

/// At the degenerate point itself, to six digits, the map is as good as the flow (figure 5.10):
/// penetrations agree to a hundredth where the voltage is 1e-4 beyond grazing, and so do both
/// multipliers, a complex pair.
#[test]
fn virtual_points_and_multipliers_agree() {
    let document = traced(&with("mita-near-grazing-1", &[("frequency", "0.487809")]));
    let at = one(&document, "P(0,1)", Kind::G, "voltage") + 1e-4;
    let [flow, map] =
        ["P(1,1)", "P(1,1) by the local map"].map(|name| document.branch(name).unwrap());
    for name in ["penetration", "eigenvalue[0]", "eigenvalue[1]", "eigenvalue[0].imaginary"] {
        let [a, b] = [flow, map].map(|branch| between(branch, "voltage", name, at));
        assert!(a != 0.0 && (a - b).abs() < 1e-2 * a.abs(), "{name}: {a} {b}");
    }
    let pair = |name: &str| between(flow, "voltage", name, at);
    close(pair("eigenvalue[0]"), pair("eigenvalue[1]"), 1e-12);
    close(pair("eigenvalue[0].imaginary"), -pair("eigenvalue[1].imaginary"), 1e-12);
}

/// The curves of both begin at the sheet's points; a small way from there they are apart by as much
/// as the map's second order leaves out.
#[test]
fn curves_of_maps_begin_at_points_of_codimension_two() {
    let document = traced(&built_in("mita-local-curves"));
    let (degenerate, nonhyperbolic) = ([0.487808700, 0.171066689], [0.480271127, 0.176795673]);
    for (branch, kind, [frequency, voltage]) in [
        ("SN of P(1,1)", Kind::G, degenerate),
        ("SN of P(1,1), map at I/II", Kind::G, degenerate),
        ("PD of P(1,1)", Kind::G, degenerate),
        ("PD of P(1,1), map at I/II", Kind::G, degenerate),
        ("G", Kind::GL, nonhyperbolic),
        ("G, map at II/III", Kind::GL, nonhyperbolic),
        ("SN of P(0,1)", Kind::G, nonhyperbolic),
        ("SN of P(0,1), map at II/III", Kind::G, nonhyperbolic),
    ] {
        close(one(&document, branch, kind, "frequency"), frequency, 1e-9);
        close(one(&document, branch, kind, "voltage"), voltage, 1e-9);
    }
    for (flow, map, frequency, apart) in [
        ("G", "G, map at I/II", 0.4883, 2e-7),
        ("SN of P(1,1)", "SN of P(1,1), map at I/II", 0.4883, 1e-7),
        ("PD of P(1,1)", "PD of P(1,1), map at I/II", 0.4875, 1e-5),
        ("G", "G, map at II/III", 0.4799, 2e-6),
        ("SN of P(0,1)", "SN of P(0,1), map at II/III", 0.4799, 2e-6),
    ] {
        let [a, b] = [flow, map]
            .map(|name| between(document.branch(name).unwrap(), "frequency", "voltage", frequency));
        assert!((a - b).abs() < apart, "{map} at {frequency}: {a} {b}");
    }
}

/// Beside the curves of folds and doublings that begin at the degenerate point: their Taylor series
/// with the coefficients that X. Zhao (2004) prints in section 5.3, on the sides where there are
/// such orbits.
#[test]
fn series_lie_beside_their_curves() {
    // Polynomials through four points have the digits compared if steps are short.
    let document = traced(&with("mita-local-curves", &[("max_step", "0.05")]));
    let ([frequency, voltage], slope) = ([0.487808700, 0.171066689], 0.224982);
    for (name, of, second, change) in [
        ("SN of P(1,1), series at I/II", "SN of P(1,1)", 17.7774, 4e-4),
        ("PD of P(1,1), series at I/II", "PD of P(1,1)", 1557.35, -1e-4),
    ] {
        let [series, curve] = [name, of].map(|name| {
            between(document.branch(name).unwrap(), "frequency", "voltage", frequency + change)
        });
        close(series, voltage + slope * change + second * change * change, 2e-9);
        // The next term is of the third power.
        assert!((series - curve).abs() < 0.15 * (curve - voltage - slope * change).abs(), "{name}");
        let depths = column(&document, name, Kind::EP, "depth");
        assert!(depths.iter().any(|depth| depth.abs() < 1e-9) && depths.iter().all(|d| *d > -1e-9));
    }
}

/// What motion settles on, as the penetration of its virtual points: the orbits with an impact of
/// the branch, and those of the map.
#[test]
fn attractors_lie_on_branches() {
    let scene =
        with("mita-near-grazing-1", &[("count", "3"), ("order", "3"), ("max_step", "0.05")]);
    let document = traced(&scene);
    let sweeps = sweep(&scene, "few", Part::WHOLE, None, &mut ()).unwrap();
    for (table, branch) in sweeps.sweeps.iter().zip(["P(1,1)", "P(1,1) by the local map"]) {
        let penetration =
            table.point_columns.iter().position(|name| name == "penetration").unwrap();
        // V = 0.1715, from a start in motion.
        let row = &table.rows[&4];
        let exact = between(document.branch(branch).unwrap(), "voltage", "penetration", 0.1715);
        assert!(exact > 1e-5);
        close(row.points[penetration], exact, 1e-9);
        // V = 0.1705, from rest: it does not reach the stopper.
        assert!(table.rows[&0].points[penetration] < -1e-3, "{:?}", table.rows[&0]);
    }
}

/// Periodic points: doubled ones from the doubling, and those that impact in every second period,
/// both to 2e-8 of the flow's in fourth order; they end in the same grazing.
#[test]
fn periodic_points_are_followed() {
    let flow = "along: [(name: \"voltage\", low: 0.17, high: 0.18)]";
    let map = "local: (run: \"a\", kind: G, parameters: [\"voltage\"])";
    let half = format!("{map}, impacts: [true, false]");
    let switch =
        |run: &str, kind: &str| format!("start: From(run: \"{run}\", kind: {kind}, switch: true)");
    let [g, pd] = [["a", "A"].map(|run| switch(run, "G")), ["b", "B"].map(|run| switch(run, "PD"))];
    let text = format!(
        "Scene(title: \"t\", problem: Mita(method: shooting(), order: 4), parameters: [(\"voltage\", 0.171), \
         (\"frequency\", 0.487)], settings: (max_step: 0.02), runs: [\
         (name: \"a\", {flow}), (name: \"b\", {}, {flow}), (name: \"c\", {}, {flow}), \
         (name: \"A\", {map}, {flow}), (name: \"B\", {map}, {}, {flow}), (name: \"C\", {map}, {}, {flow}), \
         (name: \"D\", {half}, set: [(\"voltage\", \"0.1713\")], {flow})])",
        g[0], pd[0], g[1], pd[1]
    );
    let of_the_flow = text.replace(&half, "impacts: [true, false]");
    assert!(
        Scene::parse(&of_the_flow)
            .unwrap_err()
            .to_string()
            .contains("which is valid only for a local map")
    );
    let document = traced(&Scene::parse(&text).unwrap());
    close(one(&document, "b", Kind::PD, "voltage"), one(&document, "B", Kind::PD, "voltage"), 2e-8);
    let end = one(&document, "C", Kind::G, "voltage");
    close(one(&document, "c", Kind::G, "voltage"), end, 2e-8);
    assert_eq!(document.branch("C").unwrap().itinerary, "impact impact");
    let met = document.branch("D").unwrap().of_kind(Kind::EP).find(|p| p.event.contains("`C`"));
    close(met.expect("they meet").parameters[0], end, 1e-11);
}

/// A point of a map's branch is where to go on, after the map itself has been computed anew.
#[test]
fn branches_of_maps_are_restarted() {
    let scene = built_in("mita-near-grazing-1");
    let document = traced(&scene);
    let name = "P(1,1) by the local map";
    let branch = document.branch(name).unwrap().clone();
    let label = branch.of_kind(Kind::LP).next().unwrap().label;
    let outcome = execute(&scene, Some(&StartPoint::new(branch, label)), &mut ());
    assert_eq!(outcome.error, None);
    assert_eq!(outcome.document.branches.len(), 1);
    let deepest = |document| {
        let depths = column(document, name, Kind::EP, "depth");
        depths.into_iter().fold(0.0, f64::max)
    };
    let [before, again] = [&document, &outcome.document].map(deepest);
    assert!(before > 0.01);
    close(before, again, 1e-9);
}

/// A sweep of the map together with one of the motion: before grazing and beyond the doubling both
/// settle on the same cycle, with the same exponent; a parameter that is none of the map's is
/// refused.
#[test]
fn maps_are_swept() {
    let few =
        [("count", "3"), ("recorded_periods", "50"), ("lyapunov_periods", "100"), ("order", "5")];
    let scene = with("mita-lyapunov", &few);
    let sweeps = sweep(&scene, "few", Part::WHOLE, None, &mut ()).unwrap();
    let [flow, map] = &sweeps.sweeps[..] else { panic!("{}", sweeps.sweeps.len()) };
    let value = |table: &SweepTable, run: usize, name: &str| {
        table.rows[&run].values[table.run_columns.iter().position(|known| known == name).unwrap()]
    };
    for (run, impacts) in [(0, 0.0), (2, 1.0)] {
        assert_eq!([value(flow, run, "periods"), value(map, run, "periods")], [1.0, 1.0]);
        assert_eq!([value(flow, run, "front"), value(map, run, "impact")], [impacts, impacts]);
        let [a, b] = [flow, map].map(|table| value(table, run, "exponent"));
        assert!(a < 0.0 && (a - b).abs() < 1e-2 * a.abs(), "{run}: {a} {b}");
    }
    let text = include_str!("../../scenes/mita-lyapunov.ron");
    let text = text.replace("name: \"voltage\", low: 0.1715", "name: \"damping\", low: 0.1715");
    let refused = refusal(&text);
    assert!(
        refused.contains(
            "is not a parameter of the local map, whose parameters are voltage, frequency"
        ),
        "{refused}"
    );
}

/// Panels leave out branches without their columns, deviations are measured from a point that must
/// be there, and nothing is drawn outside of a range.
#[test]
fn diagrams_show_deviations_and_ranges() {
    let mut document = traced(&built_in("mita-near-grazing-2"));
    let drawn = figures(&[("near", &document)], &[], None, &[]).unwrap();
    let [[left, right], [low, high]] = drawn[0].extent().unwrap();
    let far = (0.1785 - 0.171741423232_f64).sqrt();
    assert!(left < 0.0 && low >= -0.0005 && high <= 0.001);
    close(right, far, 1e-9);
    document.plot.panels = vec![("voltage".into(), "depth".into())];
    let drawn = figures(&[("near", &document)], &[], None, &[]).unwrap();
    let seen = drawn[1].series.iter().filter(|series| !series.points.is_empty());
    assert!(seen.clone().count() > 0 && { seen }.all(|it| it.name == "P(1,1) by the local map"));
    document.plot.deviations[0].kind = Kind::HB;
    let refused = figures(&[("near", &document)], &[], None, &[]).unwrap_err();
    assert!(matches!(refused, FigureError::NoOrigin { kind: Kind::HB, .. }), "{refused}");
}

/// What a local map cannot follow is refused, with what to change.
#[test]
fn bad_runs_of_maps_are_refused() {
    let scene = |local: &str, rest: &str| {
        format!(
            "Scene(title: \"t\", problem: Mita(method: shooting()), parameters: [(\"voltage\", 0.2)], runs: [\
             (name: \"flow\", along: [(name: \"voltage\", low: 0.2, high: 0.3)]), \
             (name: \"map\", local: ({local}), {rest})])"
        )
    };
    let along = "along: [(name: \"voltage\", low: 0.2, high: 0.3)]";
    let at = "run: \"flow\", kind: G, parameters: [\"voltage\"]";
    for (local, rest, said) in [
        ("run: \"flaw\", kind: G, parameters: [\"voltage\"]", along, "did you mean `flow`"),
        (
            "run: \"flow\", kind: G, parameters: [\"frequency\"]",
            along,
            "`voltage` is not a parameter of the local map, whose parameters are frequency",
        ),
        ("run: \"flow\", kind: G, parameters: []", along, "names no parameters of the map"),
        (at, &format!("start: From(run: \"flow\", kind: G), {along}"), "the same local map"),
        (at, &format!("start: Simulated(), {along}"), "a simulation"),
    ] {
        let refused = refusal(&scene(local, rest));
        assert!(refused.contains(said), "{refused}");
    }
    let elsewhere = scene("run: \"flow\", kind: PD, parameters: [\"voltage\"]", along);
    let outcome = execute(&Scene::parse(&elsewhere).unwrap(), None, &mut ());
    assert!(matches!(outcome.error, Some(SceneError::NoSuchPoint { .. })), "{:?}", outcome.error);
    let nowhere = scene("run: \"flow\", kind: EP, parameters: [\"voltage\"]", along);
    let outcome = execute(&Scene::parse(&nowhere).unwrap(), None, &mut ());
    let Some(error @ SceneError::Run { .. }) = outcome.error else { panic!("{:?}", outcome.error) };
    assert!(one_line(&error).contains("locate the grazing (G) first"), "{error}");
    let high = Scene::parse(&scene(at, along)).unwrap().set("order", "8").unwrap_err();
    assert!(high.to_string().contains("between 1 and 7"), "{high}");
}
