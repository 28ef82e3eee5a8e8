//! Promise: the scenes of periodic orbits and of boundary-value problems have their published
//! values by both methods, and are changed and restarted by name.

use crate::common::close;
use crate::program::scenarios::{built_in, column, refusal, traced, with};
use tangency::core::failure::one_line;
use tangency::core::system::Kind;
use tangency::output::Document;
use tangency::scene::{BUILT_IN, Scene, SceneError, StartPoint, execute};

/// The nonimpacting branch of Mita's actuator has its published fold and grazings, by both methods,
/// and goes on beyond them.
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
                close(column(&document, branch, Kind::LP, "voltage")[0], fold, 1e-11);
            }
            let digits = if frequency == "0.485" { 1e-10 } else { 1e-11 };
            close(column(&document, branch, Kind::G, "voltage")[0], grazing, digits);
            close(column(&document, branch, Kind::G, "max_displacement")[0], 0.5, 1e-12);
            let grazing = document.branches[0].of_kind(Kind::G).next().unwrap();
            assert_eq!(grazing.event, "max_displacement = 0.5");
        }
    }
}

/// At every frequency from 0.3 to 0.6 and by both methods the branch reaches the bound of the
/// displacement: through one fold far below the cusp's frequency, through two just below it, and
/// through one beyond it, where the period doubles twice.
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
            close(last.value(branch.column("max_displacement").unwrap()).unwrap(), 0.9, 1e-9);
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
    close(cusps[0][0], cusps[1][0], 1e-9);
    close(cusps[0][1], cusps[1][1], 1e-9);
    close(cusps[0][0], 0.481968540866, 1e-9);
    close(cusps[0][1], 0.175072777148, 1e-9);
}

/// Lur'e's orbits from the Hopf point double their period twice at the published values.
#[test]
fn lure_doubles_its_period() {
    for method in ["collocation", "shooting"] {
        let document = traced(&with("lure", &[("method", method)]));
        let doubling = |branch: &str, name: &str| column(&document, branch, Kind::PD, name)[0];
        close(column(&document, "equilibria", Kind::HB, "alpha")[0], 1.0, 1e-12);
        close(doubling("orbits", "alpha"), 0.630302006160, 1e-11);
        close(doubling("orbits", "period"), 6.3640713394, 1e-10);
        close(doubling("doubled", "alpha"), 0.57962985, 1e-8);
        close(doubling("doubled", "period"), 12.734366, 1e-6);
        assert_eq!(column(&document, "doubled twice", Kind::PD, "alpha").len(), 1);
    }
}

/// The isothermal reaction has its cascade, and no branch points beside it.
#[test]
fn the_isothermal_reaction_has_its_cascade() {
    for method in ["collocation", "shooting"] {
        let document = traced(&with("isothermal", &[("method", method)]));
        close(column(&document, "equilibria", Kind::HB, "lambda")[0], 12.143462567, 5e-9);
        for (branch, lambda, period) in [
            ("orbits", 10.571047456, 0.751234),
            ("doubled", 10.146517655, 1.636055),
            ("doubled twice", 10.091209039, 3.344771),
        ] {
            close(column(&document, branch, Kind::PD, "lambda")[0], lambda, 2e-9);
            close(column(&document, branch, Kind::PD, "period")[0], period, 1e-6);
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
        close(column(&document, "solutions", Kind::LP, "lambda")[0], 3.51383071912516, 1e-12);
        close(column(&document, "solutions", Kind::EP, "max_u")[1], 5.0, 1e-10);
    }
}

/// Settings of the discretisation are set by name, recorded, and refused out of their ranges.
#[test]
fn discretisations_are_set_by_name() {
    // The method may be named after its settings.
    let shooting = [
        ("segments", "3"),
        ("scheme", "DormandPrince5"),
        ("flow_tolerance", "1e-10"),
        ("method", "shooting"),
    ];
    let collocation = [("intervals", "40"), ("degree", "5")];
    for changes in [&shooting[..], &collocation] {
        let document = traced(&with("mita-nonimpacting", changes));
        for &(name, value) in changes {
            let recorded = document.setting(name);
            assert_eq!(recorded.map(str::parse::<f64>), Some(value.parse()), "{name}");
            assert!(value.parse::<f64>().is_ok() || recorded == Some(value));
        }
        close(column(&document, "nonimpacting", Kind::LP, "voltage")[0], 0.235565433583, 1e-9);
    }
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
        let of_shooting = ["segments", "scheme", "flow_tolerance"].contains(&name);
        match error {
            SceneError::NoEffect { .. } if of_shooting => {
                changed.set("method", "shooting").unwrap();
                let error = changed.set(name, value).expect_err(&format!("{name} = {value}"));
                assert!(one_line(&error).contains(&format!("`{name}`")), "{error}");
                continue;
            }
            SceneError::Value { .. } | SceneError::Invalid { .. } => {}
            other => panic!("{other:?}"),
        }
        assert!(one_line(&error).contains(&format!("`{name}`")), "{error}");
        assert!(changed == scene, "{name} = {value} was taken");
    }
    let misspelt = one_line(&built_in("bratu").set("metod", "shooting").unwrap_err());
    assert!(misspelt.contains("did you mean `method`"), "{misspelt}");
    // Bratu's problem knows no equilibria, and none of its names is that of a field's solution.
    assert!(built_in("bratu").set("solution", "orbit").is_err());
}

/// What only the problem can judge is refused when it is built or the branch begins.
#[test]
fn discretisations_that_cannot_be_are_refused_with_a_reason() {
    for (name, value, said) in [
        ("solution", "equilibrium", "forced systems have no equilibria"),
        ("frequency", "-1", "frequency"),
        ("voltage", "2", "is not in the range of voltage"),
    ] {
        let scene = with("mita-nonimpacting", &[(name, value)]);
        let text = execute(&scene, None, &mut ()).error.expect(name).to_string();
        assert!(text.contains(said), "{text}");
    }
    let text = BUILT_IN.iter().find(|scene| scene.name == "isothermal").unwrap().text;
    let said =
        refusal(&text.replace("Isothermal()", "Isothermal(method: collocation(intervals: 0))"));
    assert!(said.contains("`intervals`") && said.contains("between 1 and 4096"), "{said}");
    let scene = Scene::parse(&text.replace("\"y2\", 21.0", "\"y4\", 21.0")).unwrap();
    let said = one_line(&execute(&scene, None, &mut ()).error.unwrap());
    assert!(said.contains("`y4`") && said.contains("did you mean `y1`"), "{said}");
    let scene = Scene::parse(&text.replace("kind: HB", "kind: LP")).unwrap();
    let said = one_line(&execute(&scene, None, &mut ()).error.unwrap());
    assert!(said.contains("starts at LP number 1"), "{said}");
}

/// A point of an orbit goes on with the run of orbits, not with the scene's first run, also where
/// its branch has another name, and by another method.
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
        let outcome =
            execute(&with("lure", changes), Some(&StartPoint::new(branch, label)), &mut ());
        assert_eq!(outcome.error, None);
        assert_eq!(outcome.document.branches[0].name, run);
        close(column(&outcome.document, run, Kind::PD, "alpha")[0], 0.630302006160, 1e-9);
    }
    let branch = document.branch("equilibria").unwrap().clone();
    let start = StartPoint::new(branch.clone(), branch.special[0].label);
    let outcome = execute(&scene, Some(&start), &mut ());
    assert_eq!(outcome.document.branches[0].name, "equilibria");
}
