//! Scenes: the built-in ones, changes by name, and texts that are no scenes.

use proptest::prelude::*;
use tangency::core::continuation::{End, Kind};
use tangency::output::{Document, draw, figures};
use tangency::scene::{BUILT_IN, Scene, SceneError, StartPoint, execute};

fn built_in(name: &str) -> Scene {
    let scene = BUILT_IN.iter().find(|scene| scene.name == name).unwrap();
    Scene::parse(scene.text).unwrap()
}

/// A scene after changes as by `--set`.
fn with(name: &str, changes: &[(&str, &str)]) -> Scene {
    let mut scene = built_in(name);
    for (name, value) in changes {
        scene.set(name, value).unwrap_or_else(|error| panic!("{name} = {value}: {error}"));
    }
    scene
}

fn traced(scene: &Scene) -> Document {
    let outcome = execute(scene, None, &mut ());
    assert_eq!(outcome.error, None);
    outcome.document
}

fn pull_in(scene: &Scene) -> f64 {
    let document = traced(scene);
    document.branches[0].of_kind(Kind::LP).next().expect("a fold").parameters[0]
}

fn refusal(text: &str) -> String {
    Scene::parse(text).expect_err("refused").to_string()
}

/// Every built-in scene runs to its ends, is saved, read back the same, and drawn.
#[test]
fn built_in_scenes_run_are_saved_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for scene in BUILT_IN {
        let started = std::time::Instant::now();
        let document = traced(&Scene::parse(scene.text).unwrap());
        assert!(!document.branches.is_empty(), "{}", scene.name);
        for branch in &document.branches {
            let sound = branch.ends.iter().all(|end| {
                matches!(end, End::ParameterBound { .. } | End::MonitorBound { .. } | End::Start)
            });
            assert!(sound, "{}, {}: {:?}", scene.name, branch.name, branch.ends);
        }
        let path = folder.path().join(format!("{}.ron", scene.name));
        document.save(&path).unwrap();
        assert_eq!(Document::load(&path).unwrap(), document, "{}", scene.name);
        let svg = draw(&figures(&[(scene.name, &document)], None, None).unwrap()).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains(&document.title), "{}", scene.name);
        println!("{}: {:?}", scene.name, started.elapsed());
    }
}

/// `--set` reaches parameters, edges, theory, model and discretisation: known loads of pull-in answer.
#[test]
fn changes_by_name_lead_to_the_known_loads() {
    for (changes, load, tolerance) in [
        (&[("gap_ratio", "2")][..], 144.467913425, 1e-8),
        (&[("gap_ratio", "2"), ("in_plane", "free")], 61.243306692, 1e-8),
        (&[("gap_ratio", "2.0"), ("in_plane", "usual")], 144.467913425, 1e-8),
        (&[("supports", "cccc"), ("in_plane", "immovable")], 191.915137112, 1e-8),
        (&[("theory", "linear")], 52.633290209, 1e-8),
        (&[("aspect", "2")], 30.0071894, 1e-8),
        (&[("gap_ratio", "2"), ("model", "sine"), ("modes", "2")], 145.02589, 1e-7),
        (
            &[("gap_ratio", "2"), ("model", "sine"), ("modes", "6"), ("projection", "multiplied")],
            144.09066,
            1e-7,
        ),
        (&[("orders", "(transverse: (10, 10), in_plane: (14, 14))")], 71.252716501, 1e-8),
    ] {
        let found = pull_in(&with("plate-supported", changes));
        assert!((found / load - 1.0).abs() < tolerance, "{changes:?}: {found}, not {load}");
    }
}

/// Settings of the continuation by name are those the branch is made with, and the document records all.
#[test]
fn settings_of_the_continuation_are_set_by_name_and_recorded() {
    let scene = with("plate-supported", &[("max_step", "0.02"), ("accuracy", "0")]);
    let document = traced(&scene);
    let settings = &document.branches[0].settings;
    assert_eq!((settings.max_step, settings.accuracy), (0.02, 0.0));
    let usual = traced(&built_in("plate-supported"));
    assert!(document.branches[0].points.len() > 2 * usual.branches[0].points.len());
    let recorded = |name: &str| {
        let entry = document.settings.iter().find(|(key, _)| key == name);
        entry.unwrap_or_else(|| panic!("{name}")).1.clone()
    };
    assert_eq!((recorded("supports").as_str(), recorded("gap_ratio").as_str()), ("SSSS", "1"));
    assert_eq!((recorded("in_plane").as_str(), recorded("model").as_str()), ("slide", "ritz"));
}

/// Names that do not exist are answered with the nearest that does.
#[test]
fn misspelt_names_are_answered_with_a_suggestion() {
    for (misspelt, meant) in [
        ("gap_ration", "gap_ratio"),
        ("suports", "supports"),
        ("inplane", "in_plane"),
        ("acuracy", "accuracy"),
        ("Load", "load"),
    ] {
        let error = built_in("plate-clamped").set(misspelt, "1").unwrap_err();
        assert!(matches!(error, SceneError::UnknownName(_)), "{error:?}");
        let text = error.to_string();
        assert!(text.contains(&format!("did you mean `{meant}`")), "{text}");
        assert!(text.contains(&format!("`{misspelt}`")), "{text}");
    }
}

/// Values that cannot be read or mean nothing are refused with the name, the value and what to do; a scene
/// they were refused by is as it was.
#[test]
fn values_out_of_range_are_refused_when_they_are_set() {
    for (name, value) in [
        ("gap_ratio", "NaN"),
        ("gap_ratio", "inf"),
        ("gap_ratio", "-inf"),
        ("gap_ratio", "1e999"),
        ("gap_ratio", "two"),
        ("gap_ratio", "1,5"),
        ("theory", "Linear"),
        ("in_plane", "movable"),
        ("model", "rits"),
        ("modes", "-1"),
        ("modes", "2.5"),
        ("symmetric", "yes"),
        ("accuracy", "1"),
        ("accuracy", "NaN"),
        ("max_step", "-1"),
        ("max_points", "0"),
        ("tolerance", "0.1"),
    ] {
        let scene = built_in("plate-supported");
        let mut changed = scene.clone();
        let error = changed.set(name, value).expect_err(&format!("{name} = {value}"));
        let text = error.to_string();
        assert!(text.contains(&format!("`{name}`")) && text.contains(value), "{text}");
        let kept = scene.value("gap_ratio") == changed.value("gap_ratio");
        assert!(kept && scene.problem == changed.problem, "{name} = {value} was taken");
    }
}

/// Values that only the plate can judge are refused when it is built or the branch begins.
#[test]
fn values_out_of_range_are_refused_by_the_plate() {
    for (name, value, said) in [
        ("aspect", "-1", "the ratio of the sides must be positive"),
        ("aspect", "0", "the ratio of the sides must be positive"),
        ("nu", "0.7", "between −1 and ½"),
        ("nu", "-1", "between −1 and ½"),
        ("supports", "XXXX", "supports \"XXXX\""),
        ("supports", "SSS", "supports \"SSS\""),
        ("supports", "FFFF", "free to move as a rigid body"),
        ("orders", "(transverse: (0, 6), in_plane: (8, 8))", "0 transverse functions along x"),
        ("orders", "(transverse: (6, 6), in_plane: (8, 900))", "900 in-plane functions along y"),
        ("load", "-5", "is not in its range"),
    ] {
        let mut scene = built_in("plate-clamped");
        let refused = scene.set(name, value).err().or_else(|| execute(&scene, None, &mut ()).error);
        let text = refused.unwrap_or_else(|| panic!("{name} = {value} was taken")).to_string();
        assert!(text.contains(said), "{name} = {value}: {text}");
    }
    for (model, modes) in [("sine", "0"), ("modal", "0")] {
        let mut scene = built_in("plate-supported");
        scene.set("model", model).unwrap();
        let set = scene.set("modes", modes).err();
        let refused = set.or_else(|| execute(&scene, None, &mut ()).error);
        let text = refused.unwrap_or_else(|| panic!("no modes were taken")).to_string();
        assert!(text.contains("0 modes") || text.contains("modes"), "{text}");
    }
    let mut clamped = built_in("plate-clamped");
    clamped.set("model", "sine").unwrap();
    let text = execute(&clamped, None, &mut ()).error.unwrap().to_string();
    assert!(text.contains("four supported edges") && text.contains("model=ritz"), "{text}");
}

/// What a run of a scene varies by itself is not overridden behind its back.
#[test]
fn what_the_scene_varies_is_not_set() {
    let error = built_in("plate-pull-in-gap").set("in_plane", "slide").unwrap_err();
    assert!(matches!(error, SceneError::Varied { .. }), "{error:?}");
    assert!(error.to_string().contains("copy the scene to a file"), "{error}");
}

const SMALL: &str = "Scene(\n  title: \"t\",\n  problem: Plate(supports: \"SSSS\"),\n  \
                     parameters: [(\"gap_ratio\", 1.0)],\n  runs: [(name: \"a\", along: [(name: \
                     \"load\", low: 0.0)])],\n)\n";

/// A name given twice is refused wherever a scene has names.
#[test]
fn names_given_twice_are_refused() {
    Scene::parse(SMALL).unwrap();
    let run = "(name: \"a\", along: [(name: \"load\", low: 0.0)])";
    for (from, to, twice) in [
        ("title: \"t\"", "title: \"t\", title: \"u\"", "title"),
        ("supports: \"SSSS\"", "supports: \"SSSS\", supports: \"CCCC\"", "supports"),
        ("(\"gap_ratio\", 1.0)", "(\"gap_ratio\", 1.0), (\"gap_ratio\", 2.0)", "gap_ratio"),
        (run, &format!("{run}, {run}"), "`a`"),
        (
            "(name: \"load\", low: 0.0)",
            "(name: \"load\", low: 0.0), (name: \"load\", low: 0.0)",
            "load",
        ),
        ("low: 0.0", "low: 0.0, low: 1.0", "low"),
    ] {
        let text = SMALL.replacen(from, to, 1);
        assert_ne!(text, SMALL, "{from}");
        let said = refusal(&text);
        assert!(said.contains(twice), "{said}");
        assert!(said.contains("twice") || said.to_lowercase().contains("duplicate"), "{said}");
    }
}

/// Numbers that are not finite are refused with their place.
#[test]
fn numbers_that_are_not_finite_are_refused_with_their_place() {
    for number in ["NaN", "inf", "-inf"] {
        for (from, to, place) in [
            ("1.0", number.to_owned(), "`gap_ratio`"),
            ("low: 0.0", format!("low: {number}"), "`load`"),
            ("runs:", format!("settings: (max_step: {number}), runs:"), "`max_step`"),
            ("low: 0.0)]", format!("low: 0.0)], marks: [(\"load\", {number})]"), "`load`"),
        ] {
            let text = SMALL.replacen(from, &to, 1);
            assert_ne!(text, SMALL, "{from}");
            let said = refusal(&text);
            assert!(said.contains(place) && said.contains(number), "{said}");
        }
    }
}

/// Texts of another kind, values of the wrong type and unknown names are refused with line and column or
/// with what was meant.
#[test]
fn foreign_texts_and_wrong_types_are_refused_with_their_place() {
    for foreign in ["", "hello", "{\"title\": 3}", "(modes: 3)", "[1, 2]", "Figure(x: 1)"] {
        let said = refusal(foreign);
        assert!(said.starts_with("1:"), "{foreign}: {said}");
        assert!(said.contains("a scene begins with"), "{said}");
    }
    for (from, to, said) in [
        ("\"t\"", "3", "2:"),
        ("1.0", "\"1\"", "4:"),
        ("\"SSSS\"", "4", "3:"),
        ("Plate(", "Beam(", "`Beam`"),
        ("supports:", "suports:", "`suports`"),
        ("\"gap_ratio\"", "\"gap_ration\"", "did you mean `gap_ratio`"),
        ("name: \"load\"", "name: \"laod\"", "did you mean `load`"),
        ("[(name: \"a\"", "[(name: \"a\", start: From(run: \"b\", kind: LP)", "`b`"),
        ("[(name: \"a\"", "[(name: \"a\", hold: XX", "`XX`"),
    ] {
        let text = SMALL.replacen(from, to, 1);
        assert_ne!(text, SMALL, "{from}");
        let refusal = refusal(&text);
        assert!(refusal.contains(said), "{to}: {refusal}");
    }
}

/// A saved document is no scene.
#[test]
fn a_document_is_no_scene() {
    let document = Document::new("t", vec![tangency::output::example_branch()]);
    refusal(&document.to_ron().unwrap());
}

/// A restart from a fold or an end reproduces the branch: the same fold, from either side, and the same
/// end, met by other steps.
#[test]
fn restarts_reproduce_the_branch() {
    let scene = built_in("plate-clamped");
    let document = Document::parse(&traced(&scene).to_ron().unwrap()).unwrap();
    let branch = &document.branches[0];
    let fold = branch.of_kind(Kind::LP).next().unwrap();
    let end = branch.of_kind(Kind::EP).find(|end| end.monitors[0] > 0.8).unwrap();
    for label in branch.special.iter().map(|special| special.label) {
        let start = StartPoint { branch: branch.clone(), label };
        let outcome = execute(&scene, Some(&start), &mut ());
        assert_eq!(outcome.error, None, "label {label}");
        let again = &outcome.document.branches[0];
        if label != fold.label {
            let found = again.of_kind(Kind::LP).next().expect("the fold");
            assert!((found.parameters[0] - fold.parameters[0]).abs() < 1e-10 * fold.parameters[0]);
            assert!((found.monitors[0] - fold.monitors[0]).abs() < 1e-8);
        }
        if label != end.label {
            let last = again.of_kind(Kind::EP).find(|end| end.monitors[0] > 0.8).unwrap();
            assert!((last.parameters[0] - end.parameters[0]).abs() < 1e-9, "label {label}");
        }
    }
    let start = StartPoint { branch: branch.clone(), label: 99 };
    let said = execute(&scene, Some(&start), &mut ()).error.unwrap().to_string();
    assert!(said.contains("no label 99"), "{said}");
    // Another discretisation has other unknowns.
    let mut other = scene.clone();
    other.set("orders", "(transverse: (4, 4), in_plane: (6, 6))").unwrap();
    let start = StartPoint { branch: branch.clone(), label: fold.label };
    let said = execute(&other, Some(&start), &mut ()).error.unwrap().to_string();
    assert!(said.contains("unknowns"), "{said}");
}

/// The special points of a kind on a branch: the values of a column, in the order of the branch.
fn column(document: &Document, branch: &str, kind: Kind, name: &str) -> Vec<f64> {
    let branch = document.branch(branch).unwrap();
    let column = branch.column(name).unwrap();
    branch.of_kind(kind).map(|point| point.value(column).unwrap()).collect()
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found:.15}, not {expected:.15}");
}

/// The nonimpacting branch of Mita's actuator has its published fold and grazings, by both methods, and goes
/// on behind them.
#[test]
fn mita_has_its_fold_and_grazings_by_both_methods() {
    for method in ["collocation", "shooting"] {
        for (frequency, fold, grazing) in [
            ("0.45", Some(0.235565433583), 0.228618817738),
            ("0.5", None, 0.227177583102),
            ("0.485", None, 0.1717414232),
        ] {
            let scene = with("mita-nonimpacting", &[("method", method), ("frequency", frequency)]);
            let document = traced(&scene);
            let branch = "nonimpacting";
            if let Some(fold) = fold {
                near(column(&document, branch, Kind::LP, "voltage")[0], fold, 1e-11);
            }
            let digits = if frequency == "0.485" { 1e-10 } else { 1e-11 };
            near(column(&document, branch, Kind::G, "voltage")[0], grazing, digits);
            near(column(&document, branch, Kind::G, "max_displacement")[0], 0.5, 1e-12);
            let grazing = document.branches[0].of_kind(Kind::G).next().unwrap();
            assert_eq!(grazing.event, "max_displacement = 0.5");
        }
    }
}

/// At every frequency from 0.3 to 0.6 the branch reaches the bound of the displacement, through one fold below the
/// cusp's frequency by much, two just below it, and one beyond, where the period doubles twice, by both methods.
#[test]
fn mita_is_followed_through_every_fold() {
    for method in ["collocation", "shooting"] {
        for (frequency, folds, doublings) in [
            ("0.3", 1, 0),
            ("0.36", 1, 0),
            ("0.42", 1, 0),
            ("0.47", 2, 0),
            ("0.48", 2, 0),
            ("0.485", 1, 2),
            ("0.55", 1, 2),
            ("0.6", 1, 2),
        ] {
            let scene = with("mita-nonimpacting", &[("method", method), ("frequency", frequency)]);
            let document = traced(&scene);
            let branch = &document.branches[0];
            let count = |kind| branch.of_kind(kind).count();
            let place = format!("{method}, {frequency}");
            assert_eq!(count(Kind::LP), folds, "{place}");
            assert_eq!(count(Kind::PD), doublings, "{place}");
            assert_eq!(count(Kind::G), 1, "{place}");
            assert!(branch.special.iter().all(|point| point.converged), "{place}");
            let last = branch.special.last().unwrap();
            near(last.value(branch.column("max_displacement").unwrap()).unwrap(), 0.9, 1e-9);
        }
    }
}

/// The folds meet in a cusp; both methods place it alike, and no point of the curve is met twice.
#[test]
fn mita_folds_meet_in_a_cusp() {
    let mut cusps = Vec::new();
    for method in ["collocation", "shooting"] {
        let document = traced(&with("mita-nonimpacting-folds", &[("method", method)]));
        let cusp = |name: &str| column(&document, "folds", Kind::CP, name)[0];
        cusps.push([cusp("frequency"), cusp("voltage")]);
        let branch = &document.branches[0];
        let frequency = branch.column("frequency").unwrap();
        let values: Vec<f64> = branch.points.iter().filter_map(|p| p.value(frequency)).collect();
        let turns = values.windows(3).filter(|v| (v[1] - v[0]) * (v[2] - v[1]) < 0.0).count();
        assert_eq!(turns, 1, "{method}: the frequency turns at the cusp only");
    }
    near(cusps[0][0], cusps[1][0], 1e-9);
    near(cusps[0][1], cusps[1][1], 1e-9);
    near(cusps[0][0], 0.481968540866, 1e-9);
    near(cusps[0][1], 0.175072777148, 1e-9);
}

/// Lur'e's orbits from the Hopf point double their period twice at the published values.
#[test]
fn lure_doubles_its_period() {
    for method in ["collocation", "shooting"] {
        let document = traced(&with("lure", &[("method", method)]));
        let doubling = |branch: &str, name: &str| column(&document, branch, Kind::PD, name)[0];
        near(column(&document, "equilibria", Kind::HB, "alpha")[0], 1.0, 1e-12);
        near(doubling("orbits", "alpha"), 0.630302006160, 1e-11);
        near(doubling("orbits", "period"), 6.3640713394, 1e-10);
        near(doubling("doubled", "alpha"), 0.57962985, 1e-8);
        near(doubling("doubled", "period"), 12.734366, 1e-6);
        assert_eq!(column(&document, "doubled twice", Kind::PD, "alpha").len(), 1);
    }
}

/// The isothermal reaction has its cascade, and no branch points beside it.
#[test]
fn the_isothermal_reaction_has_its_cascade() {
    for method in ["collocation", "shooting"] {
        let document = traced(&with("isothermal", &[("method", method)]));
        near(column(&document, "equilibria", Kind::HB, "lambda")[0], 12.143462567, 5e-9);
        for (branch, lambda, period) in [
            ("orbits", 10.571047456, 0.751234),
            ("doubled", 10.146517655, 1.636055),
            ("doubled twice", 10.091209039, 3.344771),
        ] {
            near(column(&document, branch, Kind::PD, "lambda")[0], lambda, 2e-9);
            near(column(&document, branch, Kind::PD, "period")[0], period, 1e-6);
            assert_eq!(
                column(&document, branch, Kind::BP, "lambda").len(),
                0,
                "{method}, {branch}"
            );
        }
    }
}

/// Bratu's fold, to all digits.
#[test]
fn bratu_has_its_fold() {
    for method in ["collocation", "shooting"] {
        let document = traced(&with("bratu", &[("method", method)]));
        near(column(&document, "solutions", Kind::LP, "lambda")[0], 3.51383071912516, 1e-12);
        near(column(&document, "solutions", Kind::EP, "max_u")[1], 5.0, 1e-10);
    }
}

/// Settings of the discretisation are set by name, recorded, and refused out of their ranges.
#[test]
fn discretisations_are_set_by_name() {
    let changes = [
        ("method", "shooting"),
        ("segments", "3"),
        ("scheme", "DormandPrince5"),
        ("flow_tolerance", "1e-10"),
        ("intervals", "40"),
        ("degree", "5"),
    ];
    let document = traced(&with("mita-nonimpacting", &changes));
    for (name, value) in changes {
        assert_eq!(document.setting(name).map(str::parse::<f64>), Some(value.parse()), "{name}");
        if value.parse::<f64>().is_err() {
            assert_eq!(document.setting(name), Some(value));
        }
    }
    near(column(&document, "nonimpacting", Kind::LP, "voltage")[0], 0.235565433583, 1e-9);
    for (name, value) in [
        ("method", "galerkin"),
        ("solution", "torus"),
        ("intervals", "0"),
        ("intervals", "5000"),
        ("intervals", "-1"),
        ("degree", "1"),
        ("degree", "8"),
        ("segments", "0"),
        ("scheme", "Euler"),
        ("flow_tolerance", "0"),
        ("flow_tolerance", "NaN"),
        ("flow_tolerance", "1e-20"),
        ("frequency", "NaN"),
    ] {
        let scene = built_in("mita-nonimpacting");
        let mut changed = scene.clone();
        let error = changed.set(name, value).expect_err(&format!("{name} = {value}"));
        assert!(matches!(error, SceneError::Value { .. }), "{error:?}");
        assert!(error.to_string().contains(&format!("`{name}`")), "{error}");
        assert!(changed == scene, "{name} = {value} was taken");
    }
    let misspelt = built_in("bratu").set("metod", "shooting").unwrap_err().to_string();
    assert!(misspelt.contains("did you mean `method`"), "{misspelt}");
    // Bratu's problem knows no equilibria, and none of its names is that of a field's solution.
    assert!(built_in("bratu").set("solution", "orbit").is_err());
}

/// What only the problem can judge is refused when it is built or the branch begins.
#[test]
fn discretisations_that_cannot_be_are_refused_with_a_reason() {
    for (name, value, said) in [
        ("solution", "equilibrium", "forced in time"),
        ("frequency", "-1", "frequency"),
        ("voltage", "2", "is not in its range"),
    ] {
        let scene = with("mita-nonimpacting", &[(name, value)]);
        let text = execute(&scene, None, &mut ()).error.expect(name).to_string();
        assert!(text.contains(said), "{text}");
    }
    let text = BUILT_IN.iter().find(|scene| scene.name == "isothermal").unwrap().text;
    let said = refusal(&text.replace("Isothermal()", "Isothermal(intervals: 0)"));
    assert!(said.contains("`intervals`") && said.contains("between 1 and 4096"), "{said}");
    let scene = Scene::parse(&text.replace("\"y2\", 21.0", "\"y4\", 21.0")).unwrap();
    let said = execute(&scene, None, &mut ()).error.unwrap().to_string();
    assert!(said.contains("`y4`") && said.contains("did you mean `y1`"), "{said}");
    let scene = Scene::parse(&text.replace("kind: HB", "kind: LP")).unwrap();
    let said = execute(&scene, None, &mut ()).error.unwrap().to_string();
    assert!(said.contains("starts from point 0 of kind LP"), "{said}");
}

/// A point of an orbit goes on with the run of orbits, not with the scene's first run, also where its branch
/// has another name, and by another method.
#[test]
fn points_of_orbits_start_runs_of_orbits() {
    let scene = built_in("lure");
    let document = Document::parse(&traced(&scene).to_ron().unwrap()).unwrap();
    let orbits = document.branch("orbits").unwrap();
    let label = orbits.special.last().unwrap().label;
    for (name, run, changes) in [
        ("orbits", "orbits", &[][..]),
        ("mine", "orbits", &[]),
        ("doubled", "doubled", &[]),
        ("orbits", "orbits", &[("method", "shooting")]),
    ] {
        let mut branch = orbits.clone();
        branch.name = name.into();
        let outcome = execute(&with("lure", changes), Some(&StartPoint { branch, label }), &mut ());
        assert_eq!(outcome.error, None);
        assert_eq!(outcome.document.branches[0].name, run);
        near(column(&outcome.document, run, Kind::PD, "alpha")[0], 0.630302006160, 1e-9);
    }
    let branch = document.branch("equilibria").unwrap().clone();
    let start = StartPoint { label: branch.special[0].label, branch };
    let outcome = execute(&scene, Some(&start), &mut ());
    assert_eq!(outcome.document.branches[0].name, "equilibria");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// No beginning of a scene is taken for a scene, and its end is where it breaks off.
    #[test]
    fn scenes_cut_short_are_refused(part in 0.0..1.0_f64, which in 0..BUILT_IN.len()) {
        let text = BUILT_IN[which].text;
        let closing = text.rfind(')').unwrap();
        let cut = (0..=(part * closing as f64) as usize).rev().find(|i| text.is_char_boundary(*i));
        let error = Scene::parse(&text[..cut.unwrap()]).unwrap_err();
        prop_assert!(matches!(error, SceneError::Syntax { .. }), "{error}");
    }

    /// No text makes the reader panic.
    #[test]
    fn no_text_makes_the_reader_panic(text in any::<String>()) {
        let _ = Scene::parse(&text);
    }

    /// Nor does a scene with a few bytes exchanged; and what is read is sound enough to be changed.
    #[test]
    fn no_damage_makes_the_reader_panic(
        which in 0..BUILT_IN.len(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut bytes = BUILT_IN[which].text.as_bytes().to_vec();
        for (place, byte) in damage {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        if let Ok(text) = String::from_utf8(bytes)
            && let Ok(mut scene) = Scene::parse(&text)
        {
            let _ = scene.set("nu", "0.25");
        }
    }

    /// No name or value makes a change panic.
    #[test]
    fn no_change_makes_a_scene_panic(name in any::<String>(), value in any::<String>()) {
        let mut scene = built_in("plate-supported");
        let _ = scene.set(&name, "1");
        let _ = scene.set("gap_ratio", &value);
        let _ = scene.set("orders", &value);
        if let Some(number) = scene.value("gap_ratio") {
            prop_assert!(number.is_finite());
        }
    }
}
