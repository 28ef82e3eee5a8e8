//! Promise: the errors of work-precision diagrams, orders of convergence included, are those of
//! their page.

use crate::orders::falls_with_order;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use tangency::core::ode::Scheme;
use tangency::problems::plate::{Model, Orders, PlateSettings};
use tangency::scene::{Discretisation, HybridOrbitSettings, Scene, ShootingSettings};
use tangency_reports::work_precision::{Answer, DIAGRAMS, Effort, Method, Plan, measure};
use tangency_reports::{Clock, Measured, Report, WorkPrecision};

/// All work-precision diagrams, each method run once.
static QUICK: LazyLock<Vec<WorkPrecision>> =
    LazyLock::new(|| DIAGRAMS.iter().map(|entry| measure(entry, Effort::Quick).unwrap()).collect());

fn panel(diagram: &str, panel: usize) -> &'static Measured {
    let name = format!("work-precision-{diagram}");
    &QUICK.iter().find(|known| known.name == name).expect("a diagram").panels[panel]
}

fn errors(panel: &Measured, line: &str) -> Vec<f64> {
    let line = panel.lines.iter().find(|known| known.name == line).expect("a line");
    line.points.iter().map(|point| point.error).collect()
}

#[track_caller]
fn error(panel: &Measured, line: &str, setting: &str) -> f64 {
    panel.point(line, setting).unwrap_or_else(|| panic!("{line}, {setting}")).error
}

/// Steps, each a `factor` less than the one before, with the errors that belong to them.
fn steps(errors: &[f64], factor: f64) -> Vec<(f64, f64)> {
    errors.iter().enumerate().map(|(k, error)| (factor.powi(-(k as i32)), *error)).collect()
}

#[test]
fn plates_need_polynomials_for_digits_and_no_work_repairs_linear_theory() {
    let models = panel("plate-models", 0);
    assert!(error(models, "full model", "6 and 8") < 3e-6);
    assert!(error(models, "full model", "11 and 15") < 1e-9);
    for modes in ["4 modes", "8 modes", "15 modes"] {
        for kind in ["sine", "modal"] {
            let [direct, multiplied] = ["direct", "multiplied"]
                .map(|projection| error(models, &format!("{kind}, {projection}"), modes));
            assert!(direct < 0.1 * multiplied, "{kind}, {modes}: {direct:.1e} {multiplied:.1e}");
        }
    }
    let linear = errors(models, "linear theory");
    assert!(linear.iter().all(|error| (error - linear[2]).abs() < 0.02 && *error > 0.6));
    // Few functions in the plane bound what any number across can do.
    let orders = panel("plate-orders", 0);
    let bound = errors(orders, "in-plane order 3");
    assert!(bound[3..].iter().all(|error| *error > 1e-5), "{bound:?}");
    assert!(error(orders, "in-plane order 11", "8 and 11") < 1e-7);
}

#[test]
fn integrators_keep_their_tolerances_and_say_where_they_fail() {
    for k in [0, 1] {
        let motion = panel("flow", k);
        for line in &motion.lines {
            for (tolerance, point) in
                [1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13].iter().zip(&line.points)
            {
                assert!(
                    point.error < 60.0 * tolerance,
                    "{}, {}: {point:?}",
                    motion.title,
                    line.name
                );
            }
        }
    }
    let stiff = panel("flow", 2);
    assert!(error(stiff, "Rodas5P, order 5", "1e-10") < 1e-9);
    let failures = stiff.failures();
    assert_eq!(failures.iter().map(|(line, _)| *line).collect::<Vec<_>>(), ["order 8", "order 5"]);
    assert!(failures.iter().all(|(_, cause)| cause.contains("use the implicit method")));
    // Derivatives change the motion by rounding only.
    let duals = panel("flow", 3);
    for (a, b) in errors(duals, "f64").iter().zip(errors(duals, "second derivatives")) {
        assert!((a - b).abs() < 1e-14, "{a:.3e} {b:.3e}");
    }
}

#[test]
fn finite_differences_have_their_orders_and_never_reach_dual_numbers() {
    for k in [0, 1] {
        let derivatives = panel("derivatives", k);
        for (line, order) in [("one-sided differences", 1.0), ("central differences", 2.0)] {
            falls_with_order(line, &steps(&errors(derivatives, line)[..4], 10.0), order);
        }
        let exact = error(derivatives, "dual numbers", "");
        for line in ["one-sided differences", "central differences"] {
            assert!(errors(derivatives, line).iter().all(|error| *error > 3.0 * exact), "{line}");
        }
    }
}

/// The fold needs derivatives of derivatives. Its voltage is stationary along the curve of orbits,
/// so that the error of differences is squared there; in the state it is as it is.
#[test]
fn a_fold_by_differences_needs_a_lucky_step_and_dual_numbers_none() {
    let [voltage, state] = [2, 3].map(|k| panel("derivatives", k));
    let [exact, exact_state] = [voltage, state].map(|panel| error(panel, "dual numbers", ""));
    // The branch finds the same fold, by another defining system.
    let on_the_branch = error(voltage, "on the branch of orbits", "1e-12");
    assert!(exact < 1e-12 && on_the_branch < 1e-12, "{exact:.1e} {on_the_branch:.1e}");
    for line in ["one-sided differences", "central differences"] {
        let errors = errors(state, line);
        assert!(
            errors.iter().all(|error| error.is_nan() || *error > 3.0 * exact_state),
            "{errors:?}"
        );
        // Long steps leave the orbits that there are.
        assert!(state.point(line, "step 1e-2").is_some_and(|point| point.failure.is_some()));
    }
    let [in_voltage, in_state] = [voltage, state].map(|panel| {
        let at = |step: &str| error(panel, "one-sided differences", step);
        [at("step 1e-4") / at("step 1e-5"), at("step 1e-5") / at("step 1e-6")].map(f64::log10)
    });
    assert!(in_voltage.iter().all(|order| (order / 2.0 - 1.0).abs() < 0.1), "{in_voltage:?}");
    assert!(in_state.iter().all(|order| (order - 1.0).abs() < 0.1), "{in_state:?}");
}

#[test]
fn derivatives_by_many_parameters_are_those_by_few() {
    let parameters = panel("scaling", 2);
    let [together, one_by_one, differences] = [
        "dual numbers, all parameters in one pass",
        "dual numbers, one parameter per pass",
        "one-sided differences, step 1e-7",
    ]
    .map(|line| errors(parameters, line));
    assert_eq!((together.len(), one_by_one.len()), (4, 4));
    for exact in together.iter().chain(&one_by_one) {
        assert!(*exact < 1e-10 && differences.iter().all(|error| *error > 100.0 * exact));
    }
}

/// What a sweep finds has the same bits on any number of threads.
#[test]
fn threads_change_nothing_but_time() {
    let threads = panel("scaling", 3);
    assert_eq!(threads.clock, Clock::Wall);
    assert_eq!(errors(threads, "a sweep over 32 voltages"), [0.0; 3]);
}

#[test]
fn more_unknowns_are_more_digits() {
    let plate = errors(panel("scaling", 0), "full model");
    assert!(plate.windows(2).all(|pair| pair[1] < pair[0]) && plate[4] < 1e-8, "{plate:?}");
    let unknowns = |line: &str| -> Vec<f64> {
        let line = panel("scaling", 1).lines.iter().find(|known| known.name == line).unwrap();
        line.points.iter().map(|point| point.work).collect()
    };
    // Two states at as many points in every interval, and two where it ends.
    assert_eq!(
        unknowns("collocation, 5 points"),
        [10.0, 20.0, 40.0, 80.0, 160.0].map(|n| 10.0 * n + 2.0)
    );
}

#[test]
fn grazings_are_true_maxima() {
    let events = panel("events", 0);
    assert!(error(events, "defining system on a branch", "1e-12") < 1e-11);
    assert!(error(events, "secant method", "1e-11") < 1e-11);
    let mesh = errors(events, "secant method, largest value on a mesh");
    assert!(mesh[0] > 1e-4 && mesh.iter().all(|error| *error > 1e-10), "{mesh:?}");
}

/// Behind the order of the map is one more, since folds lie one order higher than what is left out.
#[test]
fn local_maps_gain_an_order_each() {
    let maps = panel("local-map", 0);
    let [two, three] = ["order 2", "order 3"].map(|line| errors(maps, line));
    assert!(two.iter().zip(&three).all(|(two, three)| three < two));
    let towards = |errors: &[f64]| errors.iter().rev().copied().collect::<Vec<_>>();
    falls_with_order("order 2", &steps(&towards(&two[..4]), 2.0), 3.0);
    falls_with_order("order 3", &steps(&towards(&three[1..5]), 2.0), 4.0);
}

#[test]
fn orbits_by_shooting_and_collocation_agree() {
    for k in 0..3 {
        let orbit = panel("orbit", k);
        assert!(error(orbit, "shooting, order 8", "1e-12") < 1e-10, "{}", orbit.title);
        for segments in [2, 4] {
            let line = format!("shooting, order 8, {segments} segments");
            assert!(error(orbit, &line, "1e-12") < 1e-10, "{}, {line}", orbit.title);
        }
        assert!(error(orbit, "collocation, 7 points", "40 intervals") < 1e-9, "{}", orbit.title);
    }
}

fn saved(name: &str) -> WorkPrecision {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/evidence/measured");
    let text = std::fs::read_to_string(folder.join(format!("work-precision-{name}.ron"))).unwrap();
    WorkPrecision::parse(&text).unwrap()
}

#[test]
fn the_page_is_what_the_command_has_printed() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/evidence/speed-and-accuracy.md");
    let page = std::fs::read_to_string(page).unwrap();
    for (entry, now) in DIAGRAMS.iter().zip(&*QUICK) {
        let then = saved(entry.name);
        assert!(page.contains(&then.summary()), "{}: the page has another table", entry.name);
        assert_eq!(then.panels.len(), now.panels.len());
        for (then, now) in then.panels.iter().zip(&now.panels) {
            for (line, point) in
                then.lines.iter().flat_map(|l| l.points.iter().map(move |p| (l, p)))
            {
                let again = now.point(&line.name, &point.setting).expect("the same methods");
                let failures = [&point.failure, &again.failure];
                let where_ = (&then.title, &line.name, &point.setting);
                assert_eq!(
                    failures[0].is_some(),
                    failures[1].is_some(),
                    "{where_:?}: {failures:?}"
                );
                let rounding = 1e-11;
                let same = (point.error / again.error).ln().abs() < 0.7;
                let both_small = point.error < rounding && again.error < rounding;
                assert!(
                    same || both_small || point.failure.is_some(),
                    "{}, {}, {}: {:.1e} then, {:.1e} now",
                    then.title,
                    line.name,
                    point.setting,
                    point.error,
                    again.error
                );
            }
        }
    }
}

/// The settings that scenes have by default, in the words of the diagrams: panels with the method
/// and setting of each.
fn defaults() -> Vec<(&'static str, usize, String, String)> {
    let scene = Scene::parse(
        "Scene(title: \"a\", problem: Mita(), parameters: [], \
         sweeps: [(name: \"b\", over: [(name: \"voltage\", low: 0.1, high: 0.2, count: 2)])])",
    )
    .unwrap();
    let Discretisation::Shooting(ShootingSettings { segments, scheme, flow_tolerance }) =
        HybridOrbitSettings::default().method
    else {
        panic!("hybrid orbits are not shot for by default")
    };
    let stated = ("segments".to_string(), segments.to_string());
    assert!(scene.problem.settings().contains(&stated), "{stated:?}");
    let scheme = match scheme {
        Scheme::DormandPrince8 => "order 8",
        Scheme::DormandPrince5 => "order 5",
        _ => "Rodas5P",
    };
    let method = match segments {
        1 => format!("shooting, {scheme}"),
        segments => format!("shooting, {scheme}, {segments} segments"),
    };
    let tolerance = format!("{flow_tolerance:.0e}");
    let plate = PlateSettings::default();
    assert_eq!((plate.model, plate.orders), (Model::Ritz, None));
    let Orders { transverse, in_plane } = Orders::usual([true; 2], 1.0);
    let orders = format!("{} and {}", transverse[0], in_plane[0]);
    let flow_tolerance = format!("{:.0e}", scene.sweeps[0].flow_tolerance);
    let mut defaults = vec![
        ("plate-models", 0, "full model".into(), orders.clone()),
        ("plate-orders", 0, format!("in-plane order {}", in_plane[0]), orders),
        // Orbits and histories, and sweeps.
        ("flow", 0, scheme.into(), tolerance.clone()),
        ("flow", 1, scheme.into(), flow_tolerance),
        // No scene has another way.
        ("derivatives", 0, "dual numbers".into(), String::new()),
        ("events", 0, "defining system on a branch".into(), tolerance.clone()),
    ];
    defaults.extend((0..3).map(|panel| ("orbit", panel, method.clone(), tolerance.clone())));
    defaults
}

/// Which of two errors below this is smaller is chance: it is the tolerance of scenes.
const ROUNDING: f64 = 1e-12;

/// No other setting has half of the error for as much work. Orbits by collocation count unknowns,
/// those by shooting evaluations.
#[test]
fn scenes_have_the_recommended_settings_by_default() {
    let family = |name: &str| name.split(',').next().map(String::from);
    for (diagram, k, line, setting) in defaults() {
        let now = panel(diagram, k);
        assert_eq!(now.recommended, Some((line.clone(), setting.clone())), "{}", now.title);
        let chosen = now.point(&line, &setting).expect("a measurement");
        let alike = |known: &str| diagram != "orbit" || family(known) == family(&line);
        for other in now.lines.iter().filter(|known| alike(&known.name)) {
            for point in other.points.iter().filter(|point| point.work <= chosen.work) {
                let [other_error, chosen_error] =
                    [point, chosen].map(|point| point.error.max(ROUNDING));
                let worse = point.error.is_nan() || other_error > 0.5 * chosen_error;
                assert!(worse, "{}: {} {point:?}, {chosen:?}", now.title, other.name);
            }
        }
    }
}

#[test]
fn a_failing_reference_is_an_error_and_a_failing_method_a_measurement() {
    let fails = || Method::new("hope", "none", || Err("there is none".to_string()));
    let works = || Method::new("work", "1", || Ok(Answer { numbers: vec![1.0], work: 1.0 }));
    let refused = Plan::of("a", fails()).measure(Effort::Quick).unwrap_err();
    assert_eq!(refused.to_string(), "the reference fails, hope, none: there is none");
    let measured = Plan::of("a", works()).with([fails(), works()]).measure(Effort::Full).unwrap();
    assert_eq!(measured.failures(), [("hope", "there is none")]);
    assert_eq!(measured.front(), [("work", "1")]);
}

#[test]
fn the_command_saves_diagrams_and_explains_itself() {
    let folder = tempfile::tempdir().unwrap();
    let tangency = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tangency-reports"));
        command.current_dir(folder.path()).args(arguments).output().unwrap()
    };
    let listed = tangency(&["work-precision"]);
    let names = String::from_utf8(listed.stdout).unwrap();
    assert!(DIAGRAMS.iter().all(|entry| names.contains(entry.name)), "{names}");
    let page = folder.path().join("page.md");
    std::fs::write(&page, "Before.\n<!-- work-precision-events -->\n<!-- end -->\nAfter.\n")
        .unwrap();
    let done =
        tangency(&["work-precision", "events", "--quick", "--out", "here", "--page", "page.md"]);
    assert!(done.status.success(), "{done:?}");
    let written: Vec<PathBuf> = ["svg", "md", "ron"]
        .map(|e| folder.path().join(format!("here/work-precision-events.{e}")))
        .into();
    assert!(written.iter().all(|path| path.exists()));
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("### Voltage of a grazing") && page.ends_with("<!-- end -->\nAfter.\n"));
    let unknown = tangency(&["work-precision", "event"]);
    let message = String::from_utf8(unknown.stderr).unwrap();
    assert!(
        message.contains("did you mean `events`?")
            && message.contains("`tangency-reports work-precision`")
    );
}
