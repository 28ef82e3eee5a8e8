//! Promise: a scene that states an accuracy is traced with the cheapest discretisation that meets
//! it.

use crate::program::scenarios::built_in;
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::Chosen;
use tangency::scene::{Scene, SceneError, execute};

/// It ends beyond its fold by the number of points: the ends are held to no accuracy.
const PLATE: &str = r#"Scene(
    title: "Plate through pull-in",
    problem: Plate(),
    settings: (max_step: 0.1, max_points: 16, refine: ["deflection"]),
    runs: [(name: "plate", along: [(name: "load", low: 0.0)], bounds: [(name: "max_deflection", high: 0.9)])],
)"#;

const MITA: &str = r#"Scene(
    title: "Mita's actuator with an impact a period and without",
    problem: Mita(method: shooting()),
    parameters: [("voltage", 0.1)],
    settings: (max_step: 0.1, refine: ["max_displacement"]),
    runs: [
        (name: "P(0,1)", along: [(name: "voltage", low: 0.01, high: 1.0)]),
        (name: "P(1,1)", start: From(run: "P(0,1)", kind: G, switch: true), along: [(name: "voltage", low: 0.01, high: 1.0)]),
    ],
)"#;

/// A number between 0 and 1 from a sequence that covers them evenly: an additive one of the plastic
/// number's kin, for three dimensions.
fn fraction(case: usize, dimension: i32) -> f64 {
    (0.5 + case as f64 * 0.819_172_513_396_164_5_f64.powi(dimension)).fract()
}

fn between(low: f64, high: f64, fraction: f64) -> f64 {
    low + (high - low) * fraction
}

fn with(text: &str, settings: &[(&str, String)]) -> Scene {
    let mut scene = Scene::parse(text).unwrap();
    settings.iter().for_each(|(name, value)| scene.set(name, value).unwrap());
    scene
}

/// What is said of a scene's accuracy, and the largest true error of parameters and the monitor
/// that settles, by a reference.
fn chosen_and_true(scene: &Scene, accuracy: f64, reference: &[(&str, String)]) -> (Chosen, f64) {
    let (mut asked, mut exact) = (scene.clone(), scene.clone());
    asked.set("accuracy", &accuracy.to_string()).unwrap();
    reference.iter().for_each(|(name, value)| exact.set(name, value).unwrap());
    let [found, exact] = [asked, exact].map(|scene| {
        let outcome = execute(&scene, None, &mut ());
        assert_eq!(outcome.error, None, "{scene:?}");
        outcome.document
    });
    let definite = |branch: &Branch| -> Vec<SpecialPoint> {
        branch.special.iter().filter(|special| special.kind != Kind::EP).cloned().collect()
    };
    let mut error = 0.0_f64;
    for (found, exact) in found.branches.iter().zip(&exact.branches) {
        let columns =
            [&found.released[0], &scene.settings.refine[0]].map(|name| found.column(name).unwrap());
        let [a, b] = [found, exact].map(definite);
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            let off = columns.map(|column| {
                let [a, b] = [a, b].map(|special| special.value(column).unwrap());
                [(a - b).abs(), b.abs()]
            });
            // Every point says by itself how good its parameter is.
            let [parameter, _] = off[0];
            assert!(
                parameter <= a.error + 1e-13,
                "{}: {parameter:.1e} of {:.1e}",
                a.event,
                a.error
            );
            error = off.iter().fold(error, |error, [off, size]| error.max(off / size));
        }
    }
    (found.chosen.unwrap(), error)
}

#[derive(Default)]
struct Count {
    all: usize,
    wasteful: Vec<String>,
}

impl Count {
    fn take(&mut self, what: &str, accuracy: f64, (chosen, error): (Chosen, f64)) {
        // Seen where it fails.
        println!("{what}: {chosen}; truly {error:.1e}, {:.0e} of what was asked", error / accuracy);
        assert!(error <= accuracy, "{what}: {error:.2e} where {accuracy:.2e} was asked: {chosen}");
        assert!(chosen.estimate <= accuracy && chosen.accuracy == accuracy);
        self.all += 1;
        if error < 1e-3 * accuracy {
            self.wasteful.push(what.to_string());
        }
    }

    fn finish(self, expected: usize) {
        assert_eq!(self.all, expected);
        assert!(10 * self.wasteful.len() <= self.all, "more than needed: {:?}", self.wasteful);
    }
}

/// An end far beyond the fold costs nothing, and says its own error. Where there are no other
/// points, the ends count.
#[test]
fn ends_count_where_there_is_nothing_else() {
    let of = |text: &str, accuracy: &str| {
        let mut scene = with(text, &[]);
        let exact = execute(&scene, None, &mut ()).document;
        scene.set("accuracy", accuracy).unwrap();
        let found = execute(&scene, None, &mut ()).document;
        let [found_end, exact_end] = [&found, &exact].map(|document| {
            let branch = &document.branches[0];
            branch.special.iter().rfind(|it| it.kind == Kind::EP).unwrap().clone()
        });
        let off = (found_end.parameters[0] - exact_end.parameters[0]).abs();
        assert!(off <= found_end.error + exact_end.error, "{off} of {}", found_end.error);
        (found.chosen.unwrap(), off / exact_end.parameters[0].abs())
    };
    let whole = PLATE.replace("max_points: 16, ", "");
    let (chosen, off) = of(&whole, "1e-2");
    assert!(chosen.of.starts_with("fold of") && chosen.estimate <= 1e-2, "{chosen}");
    assert!(off > 1e-2, "the end is as good as the fold: {off}");
    let short = whole.replace("high: 0.9", "high: 0.2");
    let (chosen, off) = of(&short, "1e-3");
    assert!(chosen.of.contains("reached its bound 0.2") && off <= 1e-3, "{chosen} {off}");
}

/// Plates of all kinds of edges, 1e-2 to 1e-7.
#[test]
fn plates_are_as_accurate_as_asked_and_no_more() {
    let mut count = Count::default();
    let edges = ["SSSS", "CCCC", "CSCS", "CCSS", "SCSC"];
    let in_plane = ["immovable", "slide", "straight"];
    for case in (0..25).step_by(4) {
        let accuracy = 10f64.powf(-between(2.0, 7.0, fraction(case, 1)));
        let gap = between(0.2, 2.5, fraction(case, 2));
        let aspect = between(1.0, 2.5, fraction(case, 3));
        let settings = [
            ("supports", edges[case % 5].to_string()),
            ("in_plane", in_plane[case % 3].into()),
            ("gap_ratio", gap.to_string()),
            ("aspect", aspect.to_string()),
        ];
        let what = format!(
            "{}, {}, gap ratio {gap:.3}, aspect {aspect:.3}",
            edges[case % 5],
            in_plane[case % 3]
        );
        let reference = [("refinement", (1e-2 * accuracy).to_string())];
        count.take(&what, accuracy, chosen_and_true(&with(PLATE, &settings), accuracy, &reference));
    }
    count.finish(7);
}

/// Grazings, folds and period doublings of Mita's actuator by shooting and by collocation, 1e-3 to
/// 1e-9.
#[test]
fn orbits_with_impacts_are_as_accurate_as_asked_and_no_more() {
    let mut count = Count::default();
    for case in (0..25).step_by(6) {
        let accuracy = 10f64.powf(-between(3.0, 9.0, fraction(case, 1)));
        let frequency = between(0.44, 0.52, fraction(case, 2));
        let method = if case % 5 == 4 { "collocation" } else { "shooting" };
        let settings = [("frequency", frequency.to_string()), ("method", method.to_string())];
        let what = format!("{method}, frequency {frequency:.4}");
        let reference = [
            ("method", "shooting".to_string()),
            ("flow_tolerance", "1e-14".into()),
            ("refinement", "0".into()),
        ];
        count.take(&what, accuracy, chosen_and_true(&with(MITA, &settings), accuracy, &reference));
    }
    count.finish(5);
}

/// Ends at bounds say the error of their discretisation, too.
#[test]
fn ends_at_bounds_say_how_accurate_they_are() {
    // Good to 1e-8.
    let orders = ("orders", "(transverse: (9, 9), in_plane: (13, 13))");
    let mesh = vec![("degree", "7"), ("intervals", "60")];
    for (name, accuracy, fine) in [
        ("plate-device", 1e-3, vec![orders]),
        ("bratu", 1e-3, mesh.clone()),
        ("bratu", 1e-5, mesh.clone()),
        ("mita-nonimpacting", 1e-3, mesh.clone()),
        ("mita-nonimpacting", 1e-5, mesh),
    ] {
        let scene = |settings: &[(&str, &str)]| {
            let mut scene = built_in(name);
            settings.iter().for_each(|(name, value)| scene.set(name, value).unwrap());
            let outcome = execute(&scene, None, &mut ());
            assert_eq!(outcome.error, None);
            outcome.document.branches.into_iter().next().unwrap()
        };
        let found = scene(&[("accuracy", &accuracy.to_string())]);
        let exact = scene(&[fine, vec![("refinement", "0")]].concat());
        let column = found.column(&found.released[0]).unwrap();
        let ends = |branch: &Branch| branch.of_kind(Kind::EP).cloned().collect::<Vec<_>>();
        let mut compared = 0;
        for (found, exact) in ends(&found).iter().zip(&ends(&exact)) {
            let [value, exact] = [found, exact].map(|end| end.value(column).unwrap());
            let off = (value - exact).abs();
            println!("{name}, {accuracy:e}: {}: {off:.1e} of {:.1e}", found.event, found.error);
            assert!(off <= 3.0 * found.error + 1e-12, "{name}: {off:.1e} of {:.1e}", found.error);
            compared += usize::from(found.error > 1e-9);
        }
        assert_eq!(compared, 1, "{name}");
    }
}

/// A deflection that vanishes has no digits, and is not asked for any.
#[test]
fn what_vanishes_is_not_held_to_an_accuracy() {
    let mut scene = built_in("plate-buckling");
    scene.set("accuracy", "1e-5").unwrap();
    let outcome = execute(&scene, None, &mut ());
    assert_eq!(outcome.error, None);
    let branch = outcome.document.branch("flat").unwrap();
    let buckling = branch.of_kind(Kind::BP).next().unwrap();
    // 4π² for a supported square plate, pressed from one side.
    let exact = 4.0 * std::f64::consts::PI.powi(2);
    assert!(
        (buckling.parameters[branch.column("edge_force_x").unwrap()] / exact - 1.0).abs() < 1e-5
    );
}

/// Reduced models have a ladder of modes; what they do not reach is said, with the best there is.
#[test]
fn an_accuracy_out_of_reach_is_said_and_the_finest_result_kept() {
    let mut scene = with(
        PLATE,
        &[("model", "sine".into()), ("max_points", "13".into()), ("accuracy", "1e-3".into())],
    );
    let outcome = execute(&scene, None, &mut ());
    assert_eq!(outcome.error, None);
    let chosen = outcome.document.chosen.unwrap();
    assert_eq!(chosen.settings[0].0, "modes");
    scene.set("accuracy", "1e-11").unwrap();
    let outcome = execute(&scene, None, &mut ());
    let Some(SceneError::Unmet { chosen }) = &outcome.error else { panic!("{:?}", outcome.error) };
    assert!(chosen.estimate > 1e-11 && chosen.settings == [("modes".into(), "20".into())]);
    let text = one_line(outcome.error.as_ref().unwrap());
    assert!(text.contains("modes = 20") && text.contains("request a lower accuracy"), "{text}");
    assert!(outcome.document.branches[0].of_kind(Kind::LP).count() == 1);
}

/// What an accuracy chooses cannot be stated beside it, and it needs something to be held to.
#[test]
fn accuracies_without_a_meaning_are_refused() {
    let refused = |scene: &Scene, value: &str| {
        let mut changed = scene.clone();
        let error = changed.set("accuracy", value).unwrap_err();
        assert_eq!(&changed, scene);
        one_line(&error)
    };
    let plate = Scene::parse(PLATE).unwrap();
    for value in ["0", "1", "1e-13", "NaN", "-1e-3"] {
        assert!(refused(&plate, value).contains("between 1e-12 and 0.1"));
    }
    let orders = ("orders", "(transverse: (4, 4), in_plane: (6, 6))".to_string());
    assert!(refused(&with(PLATE, &[orders]), "1e-4").contains("`orders`"));
    // In either order.
    let mut asked = plate.clone();
    asked.set("accuracy", "1e-4").unwrap();
    assert!(asked.set("modes", "3").is_ok());
    let orders = "(transverse: (4, 4), in_plane: (6, 6))";
    assert!(asked.set("orders", orders).unwrap_err().to_string().contains("`orders`"));
    let tolerance = with(MITA, &[("flow_tolerance", "1e-8".into())]);
    assert!(refused(&tolerance, "1e-4").contains("`flow_tolerance`"));
    assert!(refused(&built_in("plate-modes"), "1e-4").contains("`modes`"));
    assert!(refused(&built_in("mita-near-grazing-1"), "1e-4").contains("local map"));
    let equilibria = with(
        r#"Scene(title: "t", problem: Lure(solution: equilibrium), runs: [(name: "r", along: [(name: "alpha", low: 0.5, high: 1.5)])])"#,
        &[],
    );
    assert!(refused(&equilibria, "1e-4").contains("on this problem without a discretisation"));
    // It is of all runs.
    let by_a_run =
        PLATE.replace("name: \"plate\",", "name: \"plate\", set: [(\"accuracy\", \"1e-3\")],");
    assert!(matches!(Scene::parse(&by_a_run), Err(SceneError::UnknownName(_))));
    let refined =
        PLATE.replace("name: \"plate\",", "name: \"plate\", set: [(\"refinement\", \"1e-9\")],");
    assert!(refused(&Scene::parse(&refined).unwrap(), "1e-4").contains("`refinement`"));
    // No special point but ends.
    let short = PLATE.replace("low: 0.0", "low: 0.0, high: 1.0");
    let mut short = Scene::parse(&short.replace(", refine: [\"deflection\"]", "")).unwrap();
    short.set("model", "sine").unwrap();
    short.set("accuracy", "1e-4").unwrap();
    let outcome = execute(&short, None, &mut ());
    assert!(outcome.error.unwrap().to_string().contains("`marks`"));
}
