//! Scenes: the built-in ones, changes by name, and texts that are no scenes.

use crate::program::scenarios::{any_text, built_in, column, refusal, traced, with};
use proptest::prelude::*;
use tangency::core::continuation::{Branch, End, SpecialPoint};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::{Document, PAGE, draw, figures};
use tangency::scene::{BUILT_IN, LIBRARY, Outcome, Scene, SceneError, StartPoint, execute};

fn pull_in(scene: &Scene) -> f64 {
    let document = traced(scene);
    document.branches[0].of_kind(Kind::LP).next().expect("a fold").parameters[0]
}

/// Every built-in scene runs to its ends, is saved, read back the same, and drawn.
#[test]
fn built_in_scenes_run_are_saved_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    for scene in BUILT_IN {
        let started = std::time::Instant::now();
        let parsed = Scene::parse(scene.text).unwrap();
        if !parsed.runs.iter().any(|run| run.shown) {
            continue;
        }
        let document = traced(&parsed);
        assert!(!document.branches.is_empty(), "{}", scene.name);
        for branch in &document.branches {
            let sound = branch.ends.iter().all(|end| {
                matches!(
                    end,
                    End::ParameterBound { .. }
                        | End::MonitorBound { .. }
                        | End::Grazing { .. }
                        | End::Start
                )
            });
            assert!(sound, "{}, {}: {:?}", scene.name, branch.name, branch.ends);
        }
        let path = folder.path().join(format!("{}.ron", scene.name));
        document.save(&path).unwrap();
        assert_eq!(Document::load(&path).unwrap(), document, "{}", scene.name);
        let svg =
            draw(&figures(&[(scene.name, &document)], &[], None, &[]).unwrap(), PAGE).unwrap();
        let title = document.title.replace('\'', "&apos;");
        assert!(svg.starts_with("<svg") && svg.contains(&title), "{}", scene.name);
        println!("{}: {:?}", scene.name, started.elapsed());
    }
}

/// Scenes that end early, since their branches have few points, are drawn without the missing branches; a
/// warning names the special points that the picture lacks.
#[test]
fn scenes_cut_short_are_drawn() {
    let (mut incomplete, mut lacking) = (0, 0);
    for known in LIBRARY {
        let mut scene = Scene::parse(known.text).unwrap();
        if scene.set("max_points", "8").is_err() {
            continue;
        }
        let Outcome { document, error } = execute(&scene, None, &mut ());
        if document.branches.is_empty() {
            continue;
        }
        let figures = figures(&[(known.name, &document)], &[], None, &[]);
        let figures = figures.unwrap_or_else(|cause| panic!("{}: {cause}", known.name));
        draw(&figures, PAGE).unwrap_or_else(|cause| panic!("{}: {cause}", known.name));
        let warnings = document.branches.iter().flat_map(|branch| &branch.warnings);
        let lacks = warnings.filter(|warning| warning.contains("the picture lacks")).count();
        assert!(error.is_none() || lacks == 0, "{}", known.name);
        incomplete += usize::from(error.is_some());
        lacking += usize::from(lacks > 0);
    }
    assert!(incomplete >= 5 && lacking >= 1, "{incomplete}, {lacking}");
}

/// `--set` reaches parameters, edges, theory, model and discretisation: known loads of pull-in
/// answer.
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

/// Settings of the continuation by name are those the branch is made with, and the document records
/// all.
#[test]
fn settings_of_the_continuation_are_set_by_name_and_recorded() {
    let scene = with("plate-supported", &[("max_step", "0.02"), ("refinement", "0")]);
    let document = traced(&scene);
    let settings = &document.branches[0].settings;
    assert_eq!((settings.max_step, settings.refinement), (0.02, 0.0));
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
        ("refinment", "refinement"),
        ("Load", "load"),
    ] {
        let error = built_in("plate-clamped").set(misspelt, "1").unwrap_err();
        assert!(matches!(error, SceneError::UnknownName(_)), "{error:?}");
        let text = one_line(&error);
        assert!(text.contains(&format!("did you mean `{meant}`")), "{text}");
        assert!(text.contains(&format!("`{misspelt}`")), "{text}");
    }
}

/// Values that cannot be read or mean nothing are refused with the name, the value and what to do;
/// a scene they were refused by is as it was.
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
        ("refinement", "1"),
        ("refinement", "NaN"),
        ("max_step", "-1"),
        ("max_points", "0"),
        ("tolerance", "0.1"),
    ] {
        let scene = built_in("plate-supported");
        let mut changed = scene.clone();
        let error = changed.set(name, value).expect_err(&format!("{name} = {value}"));
        let text = one_line(&error);
        assert!(text.contains(&format!("`{name}`")) && text.contains(value), "{text}");
        let kept = scene.value("gap_ratio") == changed.value("gap_ratio");
        assert!(kept && scene.problem == changed.problem, "{name} = {value} was taken");
    }
}

/// Values that only the plate can judge are refused when it is built or the branch begins.
#[test]
fn values_out_of_range_are_refused_by_the_plate() {
    for (name, value, said) in [
        ("aspect", "-1", "the ratio of the plate's sides must be positive"),
        ("aspect", "0", "the ratio of the plate's sides must be positive"),
        ("nu", "0.7", "between −1 and ½"),
        ("nu", "-1", "between −1 and ½"),
        ("supports", "XXXX", "supports \"XXXX\""),
        ("supports", "SSS", "supports \"SSS\""),
        ("supports", "FFFF", "free to move as a rigid body"),
        ("orders", "(transverse: (0, 6), in_plane: (8, 8))", "transverse functions along x is 0"),
        ("orders", "(transverse: (6, 6), in_plane: (8, 900))", "in-plane functions along y is 900"),
        ("load", "-5", "is not in the range of load"),
    ] {
        let mut scene = built_in("plate-clamped");
        let refused = scene.set(name, value).err().or_else(|| execute(&scene, None, &mut ()).error);
        let text = one_line(&refused.unwrap_or_else(|| panic!("{name} = {value} was taken")));
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
    let text = one_line(&execute(&clamped, None, &mut ()).error.unwrap());
    assert!(text.contains("four supported edges") && text.contains("model=ritz"), "{text}");
}

/// A parameter that a run of a scene varies is not overridden silently.
#[test]
fn what_the_scene_varies_is_not_set() {
    let error = built_in("plate-pull-in-gap").set("in_plane", "slide").unwrap_err();
    assert!(matches!(error, SceneError::Varied { .. }), "{error:?}");
    assert!(one_line(&error).contains("copy the scene to a file"), "{error}");
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

/// Texts of another kind, values of the wrong type and unknown names are refused with line and
/// column or with what was meant.
#[test]
fn foreign_texts_and_wrong_types_are_refused_with_their_place() {
    for foreign in ["", "hello", "{\"title\": 3}", "(modes: 3)", "[1, 2]", "Figure(x: 1)"] {
        let said = refusal(foreign);
        assert!(said.starts_with("line 1, column "), "{foreign}: {said}");
        assert!(said.contains("begin a scene with"), "{said}");
    }
    for (from, to, said) in [
        ("\"t\"", "3", "line 2, column 10: expected a text in quotes"),
        ("1.0", "\"one\"", "line 4,"),
        ("1.0", "[1]", "line 4,"),
        ("\"SSSS\"", "4", "line 3,"),
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

/// A restart from a fold or an end reproduces the branch: the same fold, from either side, and the
/// same end, met by other steps.
#[test]
fn restarts_reproduce_the_branch() {
    let scene = built_in("plate-clamped");
    let document = Document::parse(&traced(&scene).to_ron().unwrap()).unwrap();
    let branch = &document.branches[0];
    let fold = branch.of_kind(Kind::LP).next().unwrap();
    let end = branch.of_kind(Kind::EP).find(|end| end.monitors[0] > 0.8).unwrap();
    for label in branch.special.iter().map(|special| special.label) {
        let start = StartPoint::new(branch.clone(), label);
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
    let start = StartPoint::new(branch.clone(), 99);
    let said = one_line(&execute(&scene, Some(&start), &mut ()).error.unwrap());
    assert!(said.contains("no special point with the label 99"), "{said}");
    // Another discretisation has other unknowns.
    let mut other = scene.clone();
    other.set("orders", "(transverse: (4, 4), in_plane: (6, 6))").unwrap();
    let start = StartPoint::new(branch.clone(), fold.label);
    let said = one_line(&execute(&other, Some(&start), &mut ()).error.unwrap());
    assert!(said.contains("unknowns"), "{said}");
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
        prop_assert!(matches!(error, SceneError::Model(_)), "{error}");
    }

    /// No text makes the reader panic.
    #[test]
    fn no_text_makes_the_reader_panic(text in any_text()) {
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
    fn no_change_makes_a_scene_panic(name in any_text(), value in any_text()) {
        let mut scene = built_in("plate-supported");
        let _ = scene.set(&name, "1");
        let _ = scene.set("gap_ratio", &value);
        let _ = scene.set("orders", &value);
        if let Some(number) = scene.value("gap_ratio") {
            prop_assert!(number.is_finite());
        }
    }
}

/// Doubled orbits that come back to the orbit that they are doubles of end there, and do not go
/// round.
#[test]
fn doubled_branches_end_at_their_parents() {
    for frequency in ["0.57", "0.571"] {
        let scene = with("mita-type-1", &[("frequency", frequency), ("damping", "0.1")]);
        let document = traced(&scene);
        let parents = column(&document, "P(1,1)", Kind::PD, "voltage");
        let ends = column(&document, "P(2,2)", Kind::PD, "voltage");
        assert_eq!((parents.len(), ends.len()), (2, 1));
        assert!((parents[1] - ends[0]).abs() < 1e-9, "{parents:?} {ends:?}");
        assert!(document.branch("P(2,2)").unwrap().of_kind(Kind::BP).next().is_none());
    }
}

/// Likewise by collocation, where both halves of the orbit lie on meshes of their own.
#[test]
fn doubled_branches_end_at_their_parents_by_collocation() {
    let changes = [("frequency", "0.57"), ("damping", "0.1"), ("method", "collocation")];
    let document = traced(&with("mita-type-1", &changes));
    let [parents, ends] =
        ["P(1,1)", "P(2,2)"].map(|name| column(&document, name, Kind::PD, "voltage"));
    assert!((parents[1] - ends[0]).abs() < 1e-9 && ends.len() == 1);
}

/// At the smallest tolerance of flows, which has no finer one, other steps tell the error.
#[test]
fn special_points_have_errors_at_the_smallest_tolerance() {
    for name in ["bratu", "mita-type-1"] {
        let changes = [("method", "shooting"), ("flow_tolerance", "1e-14")];
        let [finest, usual] =
            [&changes[..], &changes[..1]].map(|changes| traced(&with(name, changes)));
        let special = |document: &Document| -> Vec<(Kind, f64, f64)> {
            let all = document.branches.iter().flat_map(|b| b.special.iter().map(move |s| (b, s)));
            let row = |(branch, point): (&Branch, &SpecialPoint)| {
                assert!(point.converged, "{name}: {:?}", point.kind);
                let column = branch.column(&branch.released[0]).unwrap();
                (point.kind, point.value(column).unwrap(), point.error)
            };
            all.map(row).collect()
        };
        let (finest, usual) = (special(&finest), special(&usual));
        assert_eq!(finest.len(), usual.len());
        for (a, b) in finest.iter().zip(&usual) {
            assert!(a.0 == b.0 && (a.1 - b.1).abs() <= 1e-12 + a.2 + b.2, "{name}: {a:?} {b:?}");
        }
    }
}

/// Near a homoclinic orbit a branch ends with that reason, before its rows are noise.
#[test]
fn branches_end_near_homoclinic_orbits() {
    for beta in ["0.81062", "0.69395"] {
        let document = execute(&with("lure", &[("beta", beta)]), None, &mut ()).document;
        let doubled = document.branch("doubled").unwrap();
        let reason = &doubled.ends[1];
        assert!(matches!(reason, End::Homoclinic { .. }), "{beta}: {reason}");
        assert!(doubled.special.iter().all(|point| point.converged), "{beta}");
    }
}
