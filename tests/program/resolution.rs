//! Nothing is lost between a scene, a request and the work, and settings without effect are refused.

use crate::common::close;
use crate::common::random::Random;
use crate::program::scenarios::{built_in, traced, with};
use std::collections::BTreeMap;
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{
    Following, LIBRARY, Purpose, Request, Scene, SceneError, StartPoint, execute, explore,
};

/// A fold at `a = −b`, traced with `b = 0`, and with another `b` from an end of that branch.
fn two_folds(b: &str) -> Scene {
    Scene::parse(&format!(
        "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a + b - x^2\")], solution: equilibrium),
            parameters: [(\"a\", 1), (\"b\", 0)],
            runs: [
                (name: \"plain\", start: Guess([(\"x\", 1)]), along: [(name: \"a\", low: -1, high: 1)]),
                (name: \"shifted\", set: [(\"b\", \"{b}\")], start: From(run: \"plain\", kind: EP),
                    along: [(name: \"a\", low: -1, high: 1)]),
            ])"
    ))
    .unwrap_or_else(|error| panic!("{error}"))
}

fn fold(branch: &Branch) -> f64 {
    branch.of_kind(Kind::LP).next().expect("a fold").parameters[0]
}

/// A run's own value counts as a formula, too, where the run starts from another one.
#[test]
fn values_of_a_run_may_be_formulas() {
    for b in ["0.5", "1/2", "2^-1"] {
        close(fold(&traced(&two_folds(b)).branches[1]), -0.5, 1e-12);
    }
}

/// A start point has the values of its branch, those that the run sets and those at which an
/// earlier run stopped; `changed` names others.
#[test]
fn a_start_point_has_the_values_of_its_branch() {
    let scene = two_folds("1/2");
    let document = traced(&scene);
    let shifted = &document.branches[1];
    let label = shifted.of_kind(Kind::EP).next().unwrap().label;
    let outcome = execute(&scene, Some(&StartPoint::new(shifted.clone(), label)), &mut ());
    close(fold(&outcome.document.branches[0]), -0.5, 1e-12);

    let plain = &document.branches[0];
    let mut other = two_folds("1/2");
    other.runs.truncate(1);
    other.set("b", "1/4").unwrap();
    let mut start = StartPoint::new(plain.clone(), 1);
    let resolution = other.resolve(Some(&start)).unwrap();
    let warnings = resolution.warnings().concat();
    assert!(warnings.contains("`b` is 0 at the start point but 0.25 in the scene"), "{warnings}");
    close(fold(&resolution.trace(&mut ()).document.branches[0]), 0.0, 1e-12);
    start.changed = vec!["b".into()];
    let changed = other.resolve(Some(&start)).unwrap();
    assert!(changed.warnings().is_empty());
    close(fold(&changed.trace(&mut ()).document.branches[0]), -0.25, 1e-12);
    start.changed = vec!["a".into()];
    let refused = one_line(&other.resolve(Some(&start)).unwrap_err());
    assert!(refused.contains("varies along the branch"), "{refused}");
}

/// Values that depend on each other may be given in any order.
#[test]
fn values_are_checked_together() {
    let value = |name: &str, value: &str| (name.to_string(), value.to_string());
    let mut both = vec![value("max_step", "1e-9"), value("min_step", "1e-12")];
    for _ in 0..2 {
        let request = Request { set: both.clone(), ..Request::default() };
        assert_eq!(built_in("bratu").requested(&request).unwrap().settings.max_step, 1e-9);
        both.reverse();
    }
    both.truncate(1);
    let request = Request { set: vec![value("max_step", "1e-9")], ..Request::default() };
    let refused = one_line(&built_in("bratu").requested(&request).unwrap_err());
    assert!(refused.contains("at least `min_step`"), "{refused}");
}

/// A parameter with the name of a setting cannot be told from it.
#[test]
fn parameters_have_other_names_than_settings() {
    for name in ["tolerance", "max_step", "intervals", "solution", "accuracy"] {
        let text = format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a - x + 0*{name}\")]), parameters: [(\"a\", 1), \
             (\"{name}\", 1)], runs: [(name: \"r\", along: [(name: \"a\", low: 0, high: 1)])])"
        );
        let refused = one_line(&Scene::parse(&text).unwrap_err());
        assert!(
            refused.contains(&format!("a parameter and a setting have the same name, `{name}`")),
            "{refused}"
        );
    }
}

/// An accuracy decides the discretisation of what is followed, too.
#[test]
fn an_accuracy_counts_where_branches_are_followed() {
    let text = "Scene(title: \"Brusselator\", accuracy: 1e-4, problem: Equations(
            states: [(\"x\", \"a - (b + 1)*x + x^2*y\"), (\"y\", \"b*x - x^2*y\")], initial: [(\"x\", 1), (\"y\", 1)]),
        parameters: [(\"a\", 1), (\"b\", 2.5)],
        runs: [(name: \"orbits\", start: Simulated(transient: 100), along: [(name: \"b\", low: 2.2, high: 3)],
            marks: [(\"b\", 2.8)])],
        settings: (refine: [\"period\"]))";
    let scene = Scene::parse(text).unwrap_or_else(|error| panic!("{error}"));
    let (_, outcome) = explore(&scene, 1, &mut ());
    assert_eq!(outcome.error, None);
    let chosen = outcome.document.chosen.expect("a choice");
    assert!(chosen.estimate < 1e-4, "{chosen:?}");
    let alone = execute(&scene, None, &mut ()).document;
    assert_eq!(outcome.document.branches[0].special, alone.branches[0].special);
}

/// `n` pitchforks, `x_k' = (r − k) x_k − x_k³`: from the pitchfork of state k branches with
/// `x_k ≠ 0` go on, beside each state of the others.
fn pitchforks(n: usize) -> Scene {
    let states: Vec<String> =
        (1..=n).map(|k| format!("(\"x{k}\", \"(r - {k})*x{k} - x{k}^3\")")).collect();
    let text = format!(
        "Scene(title: \"t\", problem: Equations(states: [{}], solution: equilibrium), parameters: [(\"r\", 0)],
            runs: [(name: \"rest\", along: [(name: \"r\", low: 0, high: {})])])",
        states.join(", "),
        n + 1
    );
    Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"))
}

/// The states at the ends of branches at `r = n + 1`, by the signs of their components.
fn signs(document: &Document, n: usize) -> BTreeMap<Vec<i8>, usize> {
    let mut found = BTreeMap::new();
    for end in document.branches.iter().flat_map(|branch| branch.of_kind(Kind::EP)) {
        if (end.parameters[0] - (n + 1) as f64).abs() < 1e-9 {
            let sign = |x: &f64| if x.abs() < 1e-6 { 0 } else { x.signum() as i8 };
            *found.entry(end.state.iter().map(sign).collect()).or_default() += 1;
        }
    }
    found
}

/// Every depth finds all branches with as many states that differ from zero, each once.
#[test]
fn all_branches_of_decoupled_pitchforks_are_found() {
    for (n, depth, branches) in [(2, 1, 5), (2, 2, 9), (3, 1, 7), (3, 2, 19), (3, 3, 27)] {
        let (_, outcome) = explore(&pitchforks(n), depth, &mut ());
        assert_eq!(outcome.error, None);
        let found = signs(&outcome.document, n);
        assert_eq!(found.len(), branches, "{n} pitchforks to depth {depth}: {found:?}");
        assert!(found.values().all(|times| *times == 1), "{found:?}");
    }
}

/// What is not followed is said.
#[test]
fn branches_beyond_the_limit_are_named() {
    let (scene, outcome) = explore(&pitchforks(5), 5, &mut ());
    assert_eq!((scene.runs.len(), outcome.error), (50, None));
    let warnings = outcome.document.branches.iter().flat_map(|branch| &branch.warnings);
    let left =
        warnings.filter(|warning| warning.contains("the limit of 50 runs is reached")).count();
    assert!(left > 0, "nothing is said");
}

/// Some kinds of points are followed, and others not.
#[test]
fn kinds_of_points_are_chosen() {
    let scene = Scene::parse(
        "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"r*x - x^3\"), (\"u\", \"(r - 1)*u - v - u*(u^2 + v^2)\"),
            (\"v\", \"u + (r - 1)*v - v*(u^2 + v^2)\")], solution: equilibrium), parameters: [(\"r\", -1)],
            runs: [(name: \"rest\", along: [(name: \"r\", low: -1, high: 2)])])",
    )
    .unwrap_or_else(|error| panic!("{error}"));
    let names = |kinds: &[Kind]| -> Vec<String> {
        let following = Following { kinds: kinds.to_vec(), ..Following::all(1) };
        let (scene, _) = scene.resolve(None).unwrap().explore(&following, &mut ());
        scene.runs.into_iter().map(|run| run.name).collect()
    };
    assert_eq!(names(&[Kind::BP]), ["rest", "rest-BP"]);
    assert_eq!(names(&[Kind::HB]), ["rest", "rest-HB"]);
    assert_eq!(names(&Following::OF_BRANCHES), ["rest", "rest-BP", "rest-HB"]);
}

/// Scenes of all kinds, small ones.
fn kinds() -> Vec<(&'static str, Scene)> {
    let equilibria = Scene::parse(
        "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a + b*x - x^3\")], solution: equilibrium),
            parameters: [(\"a\", -1), (\"b\", 1)], runs: [(name: \"r\", start: Guess([(\"x\", -1.3)]),
                along: [(name: \"a\", low: -1, high: 1)])])",
    );
    let map = Scene::parse(
        "Scene(title: \"t\", problem: Map(states: [(\"x\", \"r*x*(1 - x)\")]), parameters: [(\"r\", 2)],
            runs: [(name: \"r\", start: Guess([(\"x\", 0.5)]), along: [(name: \"r\", low: 1.5, high: 3.5)])])",
    );
    let residual = Scene::parse(
        "Scene(title: \"t\", problem: Residual(unknowns: [(\"x\", \"a - x^2\")]), parameters: [(\"a\", 1)],
            runs: [(name: \"r\", start: Guess([(\"x\", 1)]), along: [(name: \"a\", low: -1, high: 1)])])",
    );
    let cycles = Scene::parse(
        "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"mu*x - y - x*(x^2 + y^2)\"), (\"y\", \"x + mu*y - y*(x^2 + 4*y^2)\")]),
            parameters: [(\"mu\", 0.3)], runs: [(name: \"r\", start: Simulated(state: [(\"x\", 0.5)], transient: 50),
                along: [(name: \"mu\", low: 0.2, high: 0.5)])])",
    );
    let boundary = built_in("bratu");
    let impacts = built_in("impact-oscillator");
    let read = |scene: Result<Scene, SceneError>| scene.unwrap_or_else(|error| panic!("{error}"));
    vec![
        ("equilibria", read(equilibria)),
        ("map", read(map)),
        ("residual", read(residual)),
        ("cycles", read(cycles)),
        ("boundary", boundary),
        ("impacts", impacts),
    ]
}

/// A value of each setting that must change something: branches are shorter, coarser, or have other
/// columns. Those that act only where something fails are left out.
const CHANGES: &[(&str, &str)] = &[
    ("initial_step", "0.003"),
    ("max_step", "0.03"),
    ("max_points", "4"),
    ("curve_error", "1e-9"),
    ("tolerance", "1e-4"),
    ("refinement", "0"),
    ("target_mesh_error", "1e-9"),
    ("max_mesh_error", "1e-13"),
    ("max_period_growth", "1.0001"),
    ("stability", "false"),
    ("save_every", "2"),
    ("eigenvalues", "1"),
    ("method", "shooting"),
    ("method", "collocation"),
    ("intervals", "7"),
    ("degree", "3"),
    ("segments", "3"),
    ("scheme", "Radau5"),
    ("flow_tolerance", "1e-7"),
    ("iterates", "2"),
    ("penetration", "true"),
    ("transient", "3"),
    ("recorded_periods", "2"),
    ("itinerary", "flight:impact"),
    ("mode", "flight"),
    ("order", "3"),
    ("accuracy", "1e-3"),
];

/// Every setting that is accepted changes the result, and every other one is refused.
#[test]
fn settings_have_effects_or_are_refused() {
    for (kind, scene) in kinds() {
        let plain = traced(&scene);
        for change in CHANGES {
            changes_or_is_refused(kind, &scene, &plain, *change);
        }
    }
}

/// A setting changes what a scene finds, or is refused.
fn changes_or_is_refused(kind: &str, scene: &Scene, plain: &Document, change: (&str, &str)) {
    let (name, value) = change;
    let set = vec![(name.to_string(), value.to_string())];
    let requested = scene.clone().requested(&Request { set, ..Request::default() });
    let accepted = requested.and_then(|changed| {
        changed.check_effects([name], Purpose::Runs, None)?;
        Ok(changed)
    });
    let Ok(changed) = accepted else { return };
    if changed == *scene {
        return;
    }
    let outcome = execute(&changed, None, &mut ());
    let strip = |document: &Document| -> Vec<_> {
        let all = document.branches.iter();
        all.map(|it| (it.points.clone(), it.special.clone(), it.monitors.clone())).collect()
    };
    let differs = outcome.error.is_some() || strip(&outcome.document) != strip(plain);
    assert!(differs, "{kind}: `{name} = {value}` is accepted and changes nothing");
}

/// The reasons are those that a user can act on.
#[test]
fn settings_without_effect_are_refused_by_name() {
    let effect = |scene: &Scene, name: &str, purpose: Purpose| {
        let refused = scene.check_effects([name], purpose, None);
        refused.map_err(|error| error.to_string()).err().unwrap_or_default()
    };
    let all = kinds();
    let of = |kind: &str| &all.iter().find(|(name, _)| *name == kind).unwrap().1;
    for name in ["method", "intervals", "segments", "max_mesh_error", "max_period_growth", "refine"]
    {
        let said = effect(of("equilibria"), name, Purpose::Runs);
        assert!(said.contains("where `solution` is `equilibrium`"), "{said}");
        // Orbits may be found and followed.
        assert_eq!(effect(of("equilibria"), name, Purpose::Exploration), "");
    }
    for (kind, name, reason) in [
        ("map", "max_mesh_error", "where equations need no discretisation"),
        ("residual", "stability", "for equations without dynamics"),
        ("boundary", "max_period_growth", "on solutions without an unknown period"),
        ("boundary", "segments", "where `method` is `collocation`"),
        ("impacts", "target_mesh_error", "where `method` is `shooting`"),
        ("impacts", "transient", "because only sweeps use this setting"),
    ] {
        let said = effect(of(kind), name, Purpose::Runs);
        assert!(
            said.contains(&format!("`{name}` has no effect")) && said.contains(reason),
            "{said}"
        );
    }
    let basins = built_in("mita-basins");
    for name in ["max_step", "method", "itinerary", "refinement", "order", "accuracy"] {
        let said = effect(&basins, name, Purpose::Sweeps);
        assert!(said.contains("on sweeps of motion"), "{name}: {said}");
    }
    for name in ["flow_tolerance", "transient", "frequency"] {
        assert_eq!(effect(&basins, name, Purpose::Sweeps), "", "{name}");
    }
    let diagram = built_in("mita-diagram");
    let axis = &diagram.sweeps[0].over[0].name;
    assert_eq!(effect(&diagram, axis, Purpose::Sweeps), "", "its branches start there");
}

/// Each run, started again from each of its own points, is found again: all of its special points
/// but the one at which it starts.
#[test]
fn runs_go_on_from_their_own_points() {
    // Scenes of several seconds are left out.
    let slow = ["bang-bang", "swift-hohenberg", "buck-converter", "morris-lecar", "belt"];
    let quick = LIBRARY.iter().filter(|scene| !slow.contains(&scene.name));
    for scene in quick {
        let scene_of = Scene::parse(scene.text).unwrap_or_else(|error| panic!("{error}"));
        let document = traced(&scene_of);
        for branch in &document.branches {
            // Curves of special points are singular at their points of codimension two.
            let regular = |kind: Kind| branch.condition.is_none() || kind == Kind::EP;
            let mut points = branch.special.iter();
            let point = points.find(|point| point.converged && regular(point.kind));
            let Some(point) = point else { continue };
            goes_on(scene.name, &scene_of, (&document, branch, point));
        }
    }
}

/// A branch that is traced again from one of its points has all of its other special points, but
/// the ends, and points of the same kind.
fn goes_on(
    name: &str,
    scene: &Scene,
    (document, branch, point): (&Document, &Branch, &SpecialPoint),
) {
    let start = StartPoint::of(document, branch.clone(), point.label);
    let outcome = execute(scene, Some(&start), &mut ());
    let place = format!("{name}: {}/{}", branch.name, point.label);
    assert_eq!(outcome.error, None, "{place}");
    let again = &outcome.document.branches[0];
    assert_eq!(again.name, branch.name, "{place}");
    for own in branch.special.iter().filter(|own| own.label != point.label) {
        if !own.converged || own.kind == Kind::EP || own.kind == point.kind {
            continue;
        }
        let near = |there: &SpecialPoint| {
            let column = branch.column(&branch.released[0]).unwrap();
            let (a, b) = (own.value(column).unwrap(), there.value(column).unwrap());
            (a - b).abs() <= 10.0 * (own.error + there.error) + 1e-8 * a.abs().max(1.0)
        };
        let found = again.of_kind(own.kind).any(near);
        assert!(found, "{place}: {} {} is missing", own.kind, own.label);
    }
}

/// Each branch of a scene, started again from all of its converged points without a condition, and
/// from the ends of the others.
fn go_on(scene: &Scene) {
    let document = traced(scene);
    for branch in &document.branches {
        let regular = |kind: Kind| branch.condition.is_none() || kind == Kind::EP;
        for point in branch.special.iter().filter(|point| point.converged && regular(point.kind)) {
            goes_on(&scene.title, scene, (&document, branch, point));
        }
    }
}

/// A frequency below which branches end is that of a refined plate: on the plate that the branch
/// goes along on, the end lies beyond this bound.
#[test]
fn branches_go_on_from_ends_that_were_refined() {
    go_on(&built_in("plate-frequency"));
}

/// Branches of doubled solutions end where their amplitude vanishes, u² = p (1 − p), at p = 1, and go
/// back from there: cycles of a map, and orbits about one at rest (`size` 0) or in motion.
#[test]
fn doubled_branches_go_on_from_their_ends() {
    let map = r#"Map(states: [("x", "-(1 + p*(1 - p))*x + x^3")])"#.to_string();
    // In axes that turn by half a turn a period: u' = p (1 − p) u − u³, v' = −v.
    let flow = |size: u8| {
        format!(
            r#"Equations(
                definitions: [
                    ("d", "a - {size}*cos(t)"), ("u", "d*cos(t/2) + b*sin(t/2)"),
                    ("v", "b*cos(t/2) - d*sin(t/2)"), ("g", "p*(1 - p)*u - u^3"),
                ],
                states: [
                    ("a", "g*cos(t/2) + v*sin(t/2) - b/2 - {size}*sin(t)"),
                    ("b", "g*sin(t/2) - v*cos(t/2) + d/2"),
                ],
                period: "2*pi",
            )"#
        )
    };
    let problems = [(map, r#"("x", 0)"#), (flow(0), r#"("a", 0)"#), (flow(1), r#"("a", 1)"#)];
    for (problem, guess) in problems {
        let text = format!(
            r#"Scene(title: "t", problem: {problem}, parameters: [("p", -0.5)], runs: [
                (name: "once", start: Guess([{guess}]), along: [(name: "p", low: -0.5, high: 1.5)]),
                (name: "doubled", start: From(run: "once", kind: PD, nth: 0, switch: true), along: [(name: "p", low: -0.5, high: 1.5)]),
            ])"#
        );
        let scene = Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        let doubled = traced(&scene).branches.pop().unwrap();
        let found: Vec<(Kind, f64)> =
            doubled.special.iter().map(|it| (it.kind, it.parameters[0])).collect();
        let [(Kind::EP, first), (Kind::PD, last)] = found[..] else { panic!("{found:?}") };
        assert!(first.abs() < 1e-10 && (last - 1.0).abs() < 1e-10, "{found:?}");
        go_on(&scene);
    }
}

/// A branch of equilibria, zeros or fixed points of random cubics in one to three unknowns, that
/// goes through a random point.
fn random_model(seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let mut number = |low: f64, high: f64| {
        let part = random.number() as f64 / u64::MAX as f64;
        ((low + part * (high - low)) * 1e3).round() / 1e3
    };
    let kinds = [("Equations", "states"), ("Residual", "unknowns"), ("Map", "states")];
    let (kind, states) = kinds[seed as usize % 3];
    let count = 1 + seed as usize / 3 % 3;
    let at: Vec<f64> = (0..count).map(|_| number(-1.0, 1.0)).collect();
    let rate = |k: usize| {
        let u = |j: usize| format!("(x{j} - ({}))", at[j]);
        let [slope, square, cube] = [number(0.2, 2.0), number(-1.0, 1.0), number(-1.0, 1.0)];
        let next = (k + 1) % count;
        let own = if kind == "Map" { format!("x{k} + ") } else { String::new() };
        let (x, y, mixed) = (u(k), u(next), number(-0.5, 0.5));
        format!(
            "(\"x{k}\", \"{own}{slope}*a + ({square})*{x}^2 - {x} + ({cube})*{x}^3 + ({mixed})*{y}*{x}\")"
        )
    };
    let rates: Vec<String> = (0..count).map(rate).collect();
    let guess: Vec<String> = (0..count).map(|k| format!("(\"x{k}\", {})", at[k])).collect();
    let solution = if kind == "Equations" { ", solution: equilibrium" } else { "" };
    let squares: Vec<String> = (0..count).map(|k| format!("x{k}^2")).collect();
    let size = squares.join(" + ");
    let text = format!(
        "Scene(title: \"t\", problem: {kind}({states}: [{}], monitors: [(\"size\", \"{size}\")]{solution}), parameters: [(\"a\", 0)],
            runs: [(name: \"r\", start: Guess([{}]), along: [(name: \"a\", low: -1, high: 1)], bounds: [(name: \"size\", high: 20)])])",
        rates.join(", "),
        guess.join(", ")
    );
    Scene::parse(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// The same holds for random models, from each of their points.
#[test]
fn random_models_go_on_from_their_own_points() {
    for seed in 0..200 {
        let scene = random_model(seed);
        let document = traced(&scene);
        let branch = &document.branches[0];
        for point in branch.special.iter().filter(|point| point.converged) {
            goes_on(&format!("model {seed}"), &scene, (&document, branch, point));
        }
    }
}

/// And settings have effects on random models, or are refused.
#[test]
fn settings_of_random_models_have_effects_or_are_refused() {
    for seed in 0..200 {
        let scene = random_model(seed);
        let plain = traced(&scene);
        for k in 0..4 {
            let change = CHANGES[(4 * seed as usize + k) % CHANGES.len()];
            changes_or_is_refused(&format!("model {seed}"), &scene, &plain, change);
        }
    }
}

/// And on the scenes of the library, a sixth of them on each, as far as they are quick.
#[test]
fn settings_of_scenes_have_effects_or_are_refused() {
    let slow = ["bang-bang", "swift-hohenberg", "buck-converter", "morris-lecar", "belt"];
    let quick = LIBRARY.iter().filter(|scene| !slow.contains(&scene.name));
    for (number, scene) in quick.enumerate() {
        let name = scene.name;
        let scene = Scene::parse(scene.text).unwrap_or_else(|error| panic!("{error}"));
        let plain = traced(&scene);
        for change in CHANGES.iter().skip(number % 6).step_by(6) {
            changes_or_is_refused(name, &scene, &plain, *change);
        }
    }
}

/// A built-in scene is the scene of its name, changed as the library changes scenes.
#[test]
fn models_of_the_library_have_names() {
    let catalogue = tangency::scene::Catalogue::built_in();
    for scene in LIBRARY {
        let named = catalogue.scenes().iter().filter(|known| known.name == scene.name);
        assert_eq!(named.count(), 1, "{}", scene.name);
    }
    assert_eq!(with("bratu", &[("max_step", "0.05")]).settings.max_step, 0.05);
}

/// A setting of a method that only one run chooses belongs to that run.
#[test]
fn settings_belong_to_the_runs_that_have_them() {
    let mut scene = built_in("impact-oscillator");
    let refused = one_line(&scene.set("intervals", "30").unwrap_err());
    assert!(refused.contains("no effect where `method` is `shooting`"), "{refused}");
    scene.runs[0].set.push(("method".into(), "collocation".into()));
    scene.set("intervals", "30").unwrap();
    assert_eq!(scene.runs[0].set.last(), Some(&("intervals".into(), "30".into())));
    assert!(scene.runs[1..].iter().all(|run| run.set.iter().all(|(name, _)| name != "intervals")));
    assert!(scene.check_effects(["intervals"], Purpose::Runs, None).is_ok());
}
