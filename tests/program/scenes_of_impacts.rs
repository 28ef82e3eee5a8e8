//! Promise: the scenes of Mita's actuator with impacts have their published values, whatever the
//! method; where two branches meet in a grazing it has one row.

use crate::common::close;
use crate::program::scenarios::{built_in, column, traced, with};
use std::f64::consts::PI;
use tangency::core::continuation::{Branch, End};
use tangency::core::failure::one_line;
use tangency::core::local_map::{Classification, Scenario};
use tangency::core::ode::work;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::problems::mita::SwitchOn;
use tangency::scene::execute;

/// Values of a parameter at all special points of a kind on a branch, in the order of the branch.
#[track_caller]
fn values(document: &Document, branch: &str, kind: Kind, name: &str, expected: &[(f64, f64)]) {
    let found = column(document, branch, kind, name);
    assert_eq!(found.len(), expected.len(), "{branch}, {kind}: {found:?}");
    for (found, (expected, digits)) in found.iter().zip(expected) {
        close(*found, *expected, *digits);
    }
}

/// The types of switching: grazing, fold, period doublings, and the second contact, where the
/// branch ends. The grazing points are the sheet's; folds and period doublings have nine digits
/// there.
#[test]
fn types_of_switching_have_their_points() {
    const NINE: f64 = 6e-10;
    for (scene, grazing, folds, doublings, contact) in [
        ("mita-type-1", 0.2271775831, &[0.176515441][..], &[0.555993297][..], 0.73377),
        ("mita-type-2", 0.1717414232, &[], &[0.176318773, 0.536380360], 0.72079),
        ("mita-type-3", 0.2286188177, &[], &[0.287389491, 0.500573906], 0.677752),
    ] {
        let document = traced(&built_in(scene));
        values(&document, "P(0,1)", Kind::G, "voltage", &[(grazing, 6e-11)]);
        let nine = |values: &[f64]| values.iter().map(|v| (*v, NINE)).collect::<Vec<_>>();
        values(&document, "P(1,1)", Kind::LP, "voltage", &nine(folds));
        values(&document, "P(1,1)", Kind::PD, "voltage", &nine(doublings));
        values(&document, "P(1,1)", Kind::G, "voltage", &[(contact, 5e-6)]);
        // The impacting branch begins at the grazing itself, with no impact yet.
        let impacting = document.branch("P(1,1)").unwrap();
        let speed = impacting.column("impact_velocity").unwrap();
        let births = |branch: &Branch| {
            let born = branch.of_kind(Kind::EP).map(|p| (p.parameters[0], p.value(speed).unwrap()));
            born.filter(|(v, u)| (v - grazing).abs() < 1e-9 && u.abs() < 1e-10).count()
        };
        assert_eq!(births(impacting), 1, "{scene}");
    }
    let document = traced(&built_in("mita-type-3"));
    values(&document, "P(0,1)", Kind::LP, "voltage", &[(0.235565434, NINE)]);
}

/// The types follow from the coefficients of the local map at the grazing: the branch with impacts
/// begins towards the side that they say, and stable motion without impacts ends where they say.
#[test]
fn types_of_switching_follow_from_coefficients() {
    for (scene, scenario, end) in [
        ("mita-type-1", Scenario::Jump, Kind::G),
        ("mita-type-2", Scenario::Continuous, Kind::G),
        ("mita-type-3", Scenario::Unstable, Kind::LP),
    ] {
        let document = traced(&built_in(scene));
        let free = document.branch("P(0,1)").unwrap();
        let switch_on = SwitchOn::of(free).unwrap();
        let Classification { scenario: found, depth, growth, .. } = switch_on.classification;
        assert_eq!(found, scenario, "{scene}");
        let [end, grazing] = [end, Kind::G].map(|kind| free.of_kind(kind).next().unwrap());
        close(switch_on.at.unwrap(), end.parameters[0], 1e-12);
        close(switch_on.grazing, grazing.parameters[0], 1e-12);
        // With impacts: away from the grazing, where a multiplier is near growth/y.
        let impacting = document.branch("P(1,1)").unwrap();
        let side = impacting.points[impacting.points.len() - 2].parameters[0] - switch_on.grazing;
        assert_eq!(side > 0.0, depth > 0.0, "{scene}");
        assert_eq!(growth > 0.0, scenario == Scenario::Jump, "{scene}");
        let refused = SwitchOn::of(impacting).unwrap_err();
        assert!(one_line(&refused).contains("`forward:rest stick:front`"), "{refused}");
    }
}

/// On both sides of the points of codimension two, ω = 0.480271127 and ω = 0.487808700.
#[test]
fn types_of_switching_change_at_points_of_codimension_two() {
    for (frequency, scenario) in [
        ("0.48017", Scenario::Unstable),
        ("0.48037", Scenario::Continuous),
        ("0.48780", Scenario::Continuous),
        ("0.48782", Scenario::Jump),
    ] {
        let mut scene = with("mita-type-1", &[("frequency", frequency)]);
        scene.runs.truncate(1);
        let switch_on = SwitchOn::of(&traced(&scene).branches[0]).unwrap();
        assert_eq!(switch_on.classification.scenario, scenario, "{frequency}");
    }
}

/// The same special points by shooting and by collocation, to 1e-10.
#[test]
fn methods_agree() {
    let by = |method| traced(&with("mita-type-1", &[("method", method)]));
    let (shooting, collocation) = (by("shooting"), by("collocation"));
    for (branch, kind) in [
        ("P(0,1)", Kind::G),
        ("P(1,1)", Kind::LP),
        ("P(1,1)", Kind::PD),
        ("P(1,1)", Kind::G),
        ("P(2,2)", Kind::G),
    ] {
        let [a, b] = [&shooting, &collocation].map(|d| column(d, branch, kind, "voltage"));
        assert!(a.len() == 1 && b.len() == 1, "{branch}, {kind}: {a:?} {b:?}");
        close(a[0], b[0], 1e-10);
    }
    // P(2,2) loses contact where a third impact begins: the sheet's 0.580286 is 0.580285066 by both
    // methods.
    close(column(&shooting, "P(2,2)", Kind::G, "voltage")[0], 0.580285065648, 1e-10);
}

/// Frequency responses, with the fold of the nonimpacting orbits and those of the impacting ones;
/// the grazing in which both end has one row, and what goes on as if there were no stoppers is
/// virtual.
#[test]
fn frequency_responses_have_their_points() {
    let document = traced(&built_in("mita-frequency"));
    let one = |branch: &str, kind, expected: f64| {
        values(&document, branch, kind, "frequency", &[(expected, 6e-10)]);
    };
    one("P(0,1), V = 0.18", Kind::G, 0.493217623);
    one("P(0,1), V = 0.18, slow", Kind::LP, 0.478283662);
    one("P(1,1), V = 0.18", Kind::LP, 0.504605955);
    one("P(0,1), V = 0.175", Kind::G, 0.491430091);
    one("P(1,1), V = 0.175", Kind::LP, 0.497583180);
    let impacting = document.branch("P(1,1), V = 0.18").unwrap();
    assert_eq!(impacting.of_kind(Kind::G).count(), 0);
    assert!(impacting.ends.iter().all(|end| matches!(end, End::Grazing { .. })));
    let free = document.branch("no stoppers, V = 0.175").unwrap();
    let beyond = free.points.iter().filter(|point| !point.admissible).count();
    assert!(beyond > 5 && beyond < free.points.len());
    // The frame is fastest at ω = 0.50347.
    let velocity = impacting.column("average_velocity").unwrap();
    let fastest = impacting.points.iter().filter_map(|p| p.value(velocity)).fold(0.0, f64::max);
    close(fastest, 3.2325e-5, 2e-7);
}

/// An impacting orbit is born on a surface that it touches, and is as far from the next contact by
/// one method as by the other.
#[test]
fn distances_are_known_at_births() {
    let changes = [
        ("frequency", "0.5295"),
        ("clearance", "0.46585"),
        ("restitution", "0.81998"),
        ("damping", "0.040558"),
        ("static_friction", "0.47004"),
        ("dynamic_friction", "0.25174"),
        ("frame_mass", "4.2119"),
        ("gravity", "10.883"),
    ];
    for (method, digits) in [("shooting", 1e-10), ("collocation", 1e-6)] {
        let scene = with("mita-type-3", &[&changes[..], &[("method", method)]].concat());
        let distance = column(&traced(&scene), "P(1,1)", Kind::EP, "distance")[0];
        close(distance, 0.188435172856, digits);
    }
}

/// On the curve of births one leg has no length. Its mesh causes no error, and the curve goes on to
/// its bounds by both methods.
#[test]
fn births_have_one_curve() {
    let mut scene = with("mita-near-grazing-1", &[]);
    scene.runs.iter_mut().for_each(|run| run.shown = run.name == "births");
    for method in ["shooting", "collocation"] {
        scene.set("method", method).unwrap();
        let document = traced(&scene);
        for (kind, expected) in
            [(Kind::EP, &[0.48, 0.493217623147][..]), (Kind::GD, &[0.487808700441])]
        {
            let mut found = column(&document, "births", kind, "frequency");
            found.sort_by(f64::total_cmp);
            assert_eq!(found.len(), expected.len(), "{method}, {kind}: {found:?}");
            found.iter().zip(expected).for_each(|(f, e)| close(*f, *e, 1e-9));
        }
    }
}

/// A branch that starts at a mark on its bound states how far from the bound it starts.
#[test]
fn starts_on_bounds_state_their_error() {
    let document = traced(&with("mita-band", &[("tolerance", "1e-8")]));
    for name in ["P(0,1), ω = 0.45", "P(0,1), ω = 0.485"] {
        let start = document.branch(name).unwrap().of_kind(Kind::EP).next().unwrap();
        let apart = (start.parameters[0] - 0.16).abs();
        assert!(apart <= start.error && start.error < 1e-11, "{apart:e} {:e}", start.error);
    }
}

/// Where an impact vanishes with the leg after it the branch ends for one reason, whatever the
/// steps.
#[test]
fn ends_have_one_name() {
    for step in ["0.01", "0.05", "0.1", "0.25"] {
        let document = traced(&with("mita-frequency", &[("max_step", step)]));
        for name in ["P(1,1), V = 0.18", "P(1,1), V = 0.175"] {
            let ends = document.branch(name).unwrap().ends.each_ref().map(End::to_string);
            assert_eq!(ends, ["the solution grazes: approach vanishes"; 2], "{step}, {name}");
        }
    }
}

/// Codimension-two points on the grazing curve, from both sides; and the curves of folds and of
/// period doublings end in them.
#[test]
fn curves_meet_in_codimension_two_points() {
    let degenerate = [0.487808700440, 0.171066688958];
    let nonhyperbolic = [0.480271127402, 0.176795673315];
    let near = |document: &Document, branch: &str, kind, expected: [f64; 2]| {
        values(document, branch, kind, "frequency", &[(expected[0], 1e-10)]);
        values(document, branch, kind, "voltage", &[(expected[1], 1e-10)]);
    };
    // Traced here, by this thread: documents are shared among tests.
    let before = work();
    let outcome = execute(&built_in("mita-grazing-curve"), None, &mut ());
    let (flowed, document) = (work().time - before.time, outcome.document);
    // All in all less than 1800 flows over a period π/ω, which is shortest at ω = 0.52, with the slopes
    // of all columns at each point.
    assert!(flowed < 1800.0 * PI / 0.52, "{}", flowed * 0.52 / PI);
    for side in ["grazing", "births"] {
        near(&document, side, Kind::GL, nonhyperbolic);
        near(&document, side, Kind::GD, degenerate);
        let others = [Kind::LP, Kind::PD, Kind::GF, Kind::GP];
        let branch = document.branch(side).unwrap();
        assert!(others.iter().all(|kind| branch.of_kind(*kind).count() == 0), "{side}");
    }
    let document = traced(&built_in("mita-switching"));
    near(&document, "SN of P(0,1)", Kind::G, nonhyperbolic);
    near(&document, "SN of P(1,1)", Kind::G, degenerate);
    near(&document, "PD of P(1,1), birth", Kind::G, degenerate);
}

/// `c_n`, where `P(n, 1)` becomes stable: `c_4` to its printed digits, the others below what
/// simulations print, with errors below 1e-9; and the ratios of their distances.
#[test]
fn the_ladder_of_chatter_has_its_rungs() {
    let document = traced(&built_in("mita-ladder"));
    let folds = column(&document, "P(3,1)", Kind::LP, "voltage");
    assert!(folds.len() == 2 && folds.iter().all(|v| (0.808..0.809).contains(v)), "{folds:?}");
    values(&document, "P(3,1)", Kind::G, "voltage", &[(0.834671, 6e-7)]);
    let rungs: Vec<f64> = (4..=10)
        .map(|n| {
            let branch = format!("P({n},1)");
            let found = column(&document, &branch, Kind::PD, "voltage");
            assert_eq!(found.len(), 1, "{branch}: {found:?}");
            assert!(document.branch(&branch).unwrap().of_kind(Kind::PD).all(|p| p.error < 1e-9));
            found[0]
        })
        .collect();
    close(rungs[0], 0.839470615, 6e-10);
    for (rung, simulated) in rungs[1..].iter().zip([0.85520, 0.86318, 0.86728, 0.86944]) {
        // Simulations settle late: they are above by up to 6e-5.
        assert!((-1e-6..7e-5).contains(&(simulated - rung)), "{rung} {simulated}");
    }
    let ratios = rungs.windows(3).map(|c| (c[2] - c[1]) / (c[1] - c[0]));
    // They rise, and fall again from n = 9 on.
    for (ratio, expected) in ratios.zip([0.508138, 0.515115, 0.518232, 0.517988, 0.516010]) {
        close(ratio, expected, 1e-6);
    }
}

/// Simulated histories: impacts a period as the figures name them, and complete chatter at the end.
#[test]
fn histories_count_their_impacts() {
    let mut document = traced(&built_in("mita-histories"));
    document.branches.append(&mut traced(&built_in("mita-chatter")).branches);
    assert!(document.branches.iter().all(|branch| {
        branch.special[0].profiles.iter().any(|profile| profile.name == "displacement")
    }));
    // Two events for each impact: the impact, and the rest of the frame.
    for (name, events) in [
        ("V = 0.24 (4.4)", 2.0),
        ("V = 0.2, without impacts (6.1b)", 0.0),
        ("V = 0.18 (6.1d)", 2.0),
        ("V = 0.575, P(2,2) (6.4b)", 2.0),
        ("V = 0.58, P(3,2) (6.4d)", 3.0),
        ("V = 0.82, P(3,1) (6.7)", 6.0),
        ("V = 0.85 (6.8b)", 8.0),
    ] {
        let branch = document.branch(name).unwrap();
        let column = branch.column("events").unwrap();
        assert_eq!(branch.points[0].value(column), Some(events), "{name}");
    }
}
