//! Models without a scene: from equations typed as text to a diagram by one command.

use crate::common::close;
use crate::program::command::tangency;
use std::path::Path;
use std::process::Output;
use tangency::core::system::Kind;
use tangency::output::Document;

const LORENZ: &str = include_str!("../../examples/lorenz.ron");

const ODE: &str = "# Brusselator\nx'=a-(b+1)*x+x^2*y\ny'=b*x-x^2*y\npar a=1,b=1,unused=3\ninit x=1,y=1\n\
    @ total=50,dt=.05,ntst=30,xlo=0\ndone\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lorenz.ron"), LORENZ).unwrap();
    std::fs::write(folder.path().join("brusselator.ode"), ODE).unwrap();
    folder
}

fn succeeds(folder: &Path, arguments: &[&str]) -> (String, String) {
    let Output { status, stdout, stderr } = tangency(folder, arguments);
    let (out, err) = (String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap());
    assert!(status.success(), "{arguments:?}\n{out}\n{err}");
    (out, err)
}

fn fails(folder: &Path, arguments: &[&str]) -> String {
    let Output { status, stderr, .. } = tangency(folder, arguments);
    let message = String::from_utf8(stderr).unwrap();
    assert!(matches!(status.code(), Some(1 | 2)) && message.starts_with("error: "), "{message}");
    message
}

fn hopf(document: &Document, branch: usize) -> f64 {
    let rho = document.branches[branch].column("rho").expect("a column");
    document.branches[branch].of_kind(Kind::HB).next().expect("a Hopf point").value(rho).unwrap()
}

/// σ (σ + β + 3)/(σ − β − 1) for σ = 10, β = 8/3.
const HOPF: f64 = 470.0 / 19.0;

#[test]
fn a_first_diagram_by_one_command() {
    let folder = folder();
    let path = folder.path();
    succeeds(
        path,
        &["trace", "lorenz.ron", "--along", "rho=0..30", "--switch", "all", "--depth", "2"],
    );
    let document = Document::load(path.join("out/lorenz.ron")).unwrap();
    let names: Vec<&str> = document.branches.iter().map(|branch| branch.name.as_str()).collect();
    assert_eq!(names, ["branch", "branch-BP", "branch-BP-HB1", "branch-BP-HB2"]);
    assert!((hopf(&document, 1) - HOPF).abs() < 1e-11);
    // The scene that it amounts to is a file, which traces the same.
    let arguments =
        ["show", "lorenz.ron", "--along", "rho=0..30", "--switch", "all", "--depth", "2"];
    let (scene, _) = succeeds(path, &arguments);
    std::fs::write(path.join("again.ron"), scene).unwrap();
    succeeds(path, &["trace", "again.ron"]);
    let again = Document::load(path.join("out/again.ron")).unwrap();
    assert_eq!(again.branches.len(), 4);
    assert_eq!(hopf(&again, 1), hopf(&document, 1));
}

/// A value is marked by the command line, in models and in scenes; in an unknown column it is refused.
#[test]
fn values_are_marked() {
    let folder = folder();
    let path = folder.path();
    for scene in ["lorenz.ron", "lorenz"] {
        let trace = ["trace", scene, "--along", "rho=0..30", "--mark", "rho=40/4"];
        succeeds(path, &trace);
        let document = Document::load(path.join("out/lorenz.ron")).unwrap();
        let branch = &document.branches[0];
        let marked: Vec<f64> = branch
            .of_kind(Kind::UZ)
            .map(|point| point.value(branch.column("rho").unwrap()).unwrap())
            .collect();
        assert_eq!(marked, [10.0], "{scene}");
    }
    let message = fails(path, &["trace", "lorenz.ron", "--along", "rho=0..30", "--mark", "roh=1"]);
    assert!(message.contains("did you mean `rho`"), "{message}");
}

/// Labels and units of a model are at the axes, without a scene.
#[test]
fn axes_have_the_words_and_units_of_the_model() {
    let folder = folder();
    let path = folder.path();
    let model = "Equations(states: [(\"x\", \"r + x - x^3\")], parameters: [(\"r\", -1)], initial: [(\"x\", -1)],
        labels: [(\"x\", \"deflection\")], units: [(\"x\", \"mm\"), (\"r\", \"V\")])";
    std::fs::write(path.join("m.ron"), model).unwrap();
    succeeds(path, &["trace", "m.ron", "--along", "r=-1..1"]);
    let svg = std::fs::read_to_string(path.join("out/m.svg")).unwrap();
    assert!(svg.contains("\ndeflection (mm)\n") && svg.contains("\nr (V)\n"));
    // The words of a scene count before those of its model, and columns have their own.
    let scene = format!(
        "Scene(title: \"t\", problem: {}, plot: (labels: [(\"x\", \"own\")]), runs: [(name: \"b\",
            start: Simulated(transient: 50), along: [(name: \"r\", low: -1, high: 1)])])",
        model
            .replace("labels:", "monitors: [(\"max_x\", \"2*x\")], solution: equilibrium, labels:")
    );
    std::fs::write(path.join("s.ron"), scene).unwrap();
    succeeds(path, &["trace", "s.ron"]);
    let document = Document::load(path.join("out/s.ron")).unwrap();
    let labels: Vec<[&str; 2]> =
        document.plot.labels.iter().map(|(name, words)| [name.as_str(), words]).collect();
    let expected = [["x", "own"], ["min_x", "smallest deflection (mm)"], ["r", "r (V)"]];
    assert_eq!(labels, expected);
    for (wrong, said) in [
        (
            model.replace("(\"r\", \"V\")", "(\"s\", \"V\")"),
            "unknown state, parameter or monitor `s`",
        ),
        (
            model.replace("(\"r\", \"V\")", "(\"x\", \"V\")"),
            "the label or unit of this quantity is given twice",
        ),
        (model.replace("\"V\"", "\"\""), "a label or unit must not be empty"),
        (model.replace("\"V\"", "\"V\\n\""), "a label or unit must not be empty"),
    ] {
        std::fs::write(path.join("m.ron"), wrong).unwrap();
        let message = fails(path, &["trace", "m.ron", "--along", "r=-1..1"]);
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn starts_settle_where_they_must() {
    let folder = folder();
    let path = folder.path();
    // From (1, 1, 1) at ρ = 15 motion settles on a stable equilibrium off the middle.
    let rho = ["--set", "rho=15", "--along", "rho=0..30"];
    let start = ["trace", "lorenz.ron", "--start", "x=1,y=1,z=1", "--settle", "200"];
    succeeds(path, &[&start[..], &rho].concat());
    let document = Document::load(path.join("out/lorenz.ron")).unwrap();
    assert!((hopf(&document, 0) - HOPF).abs() < 1e-11);
    assert!(document.branches[0].of_kind(Kind::BP).next().is_some());
    // At b = 3 the Brusselator oscillates: its orbit is followed back to the Hopf point at b = 1 +
    // a².
    succeeds(
        path,
        &["trace", "brusselator.ode", "--set", "b=3", "--settle", "300", "--along", "b=1.5..4"],
    );
    let document = Document::load(path.join("out/brusselator.ron")).unwrap();
    let orbit = &document.branches[0];
    assert!(orbit.column("period").is_some());
    let end = orbit.special.iter().find(|special| special.kind == Kind::HB).expect("a Hopf point");
    assert!((end.value(orbit.column("b").unwrap()).unwrap() - 2.0).abs() < 1e-6);
}

#[test]
fn curves_of_special_points_and_bounds() {
    let folder = folder();
    let path = folder.path();
    let along =
        ["--along", "b=1..3", "--along", "a=0.5..2", "--hold", "hb", "--bound", "max_x=..1.5"];
    let (_, warnings) = succeeds(path, &[&["trace", "brusselator.ode"][..], &along].concat());
    let document = Document::load(path.join("out/brusselator.ron")).unwrap();
    let curve = &document.branches[1];
    assert_eq!(curve.condition, Some(Kind::HB));
    let [a, b] = ["a", "b"].map(|name| curve.column(name).unwrap());
    for point in &curve.special {
        assert!((point.value(b).unwrap() - 1.0 - point.value(a).unwrap().powi(2)).abs() < 1e-9);
        assert!(point.value(a).unwrap() < 1.5 + 1e-9);
    }
    assert!(warnings.contains("warning: no formula uses the parameter `unused`"), "{warnings}");
    let without = warnings.lines().filter(|line| line.contains("without effect"));
    let [line] = without.collect::<Vec<_>>()[..] else { panic!("{warnings}") };
    let said = "the file has 3 options or lines without effect: ";
    for part in [said, "option `xlo=0`", "option `total=50`", "`plot --x-range`", "`--time`"] {
        assert!(line.contains(part), "{line}");
    }
}

#[test]
fn flags_change_the_ranges_of_a_scene() {
    let folder = folder();
    let path = folder.path();
    succeeds(path, &["trace", "bratu", "--along", "lambda=0..2", "--bound", "max_u=..0.1"]);
    let bratu = Document::load(path.join("out/bratu.ron")).unwrap();
    let lambda = bratu.branches[0].column("lambda").unwrap();
    assert!(bratu.branches[0].special.iter().all(|point| point.value(lambda).unwrap() < 1.0));
    let message = fails(path, &["trace", "bratu", "--along", "lamda=0..2"]);
    assert!(
        message.contains("unknown released parameter `lamda`\nhelp: did you mean `lambda`?"),
        "{message}"
    );
}

#[test]
fn models_of_xppaut_become_files_of_equations() {
    let folder = folder();
    let path = folder.path();
    let (out, _) = succeeds(path, &["import", "brusselator.ode", "--out", "model.ron"]);
    assert_eq!(out, "model.ron\n");
    succeeds(path, &["trace", "model.ron", "--along", "b=1..3"]);
    succeeds(path, &["trace", "brusselator.ode", "--along", "b=1..3", "--out", "ode"]);
    let [ron, ode] = ["out/model.ron", "ode/brusselator.ron"]
        .map(|file| Document::load(path.join(file)).unwrap());
    let hopf = |document: &Document| {
        document.branches[0].of_kind(Kind::HB).next().unwrap().parameters.clone()
    };
    assert_eq!(hopf(&ron), hopf(&ode));
    // A scene may name the file.
    let scene =
        "Scene(title: \"t\", problem: Equations(model: \"brusselator.ode\", solution: equilibrium),
        runs: [Run(name: \"r\", along: [(name: \"b\", low: 1, high: 3)])])";
    std::fs::write(path.join("scene.ron"), scene).unwrap();
    succeeds(path, &["trace", "scene.ron", "--set", "b=4/3"]);
    // From another start the point differs by rounding.
    let from_scene = hopf(&Document::load(path.join("out/scene.ron")).unwrap());
    from_scene.iter().zip(hopf(&ron)).for_each(|(found, known)| close(*found, known, 1e-14));
}

#[test]
fn mistakes_are_shown_in_their_line() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("wrong.ode"), "x'=a*y\ny'=-x\npar b=1\ndone\n").unwrap();
    let message = fails(path, &["trace", "wrong.ode", "--along", "b=0..1"]);
    assert!(
        message.contains("wrong.ode, line 1, column 4: ") && message.contains("\n  |    ^"),
        "{message}"
    );
    std::fs::write(path.join("wrong.ron"), LORENZ.replace("x*y", "x*w")).unwrap();
    let message = fails(path, &["trace", "wrong.ron", "--along", "rho=0..1"]);
    assert!(message.contains("unknown name `w`"), "{message}");
    let message = fails(path, &["trace", "lorenz.ron"]);
    assert!(message.contains("as in `--along rho=0..30`"), "{message}");
    let message = fails(path, &["trace", "lorenz.ron", "--along", "rho=0-30"]);
    assert!(message.contains("NAME=LOW..HIGH"), "{message}");
    let message = fails(path, &["trace", "lorenz.ron", "--along", "rho=0..1", "--hold", "XX"]);
    assert!(message.contains("XX"), "{message}");
    let two = ["trace", "lorenz.ron", "--along", "rho=0..1", "--along", "sigma=1..2"];
    assert!(fails(path, &two).contains("as in `--hold HB`"));
    let message = fails(path, &["trace", "lorenz.ron", "--along", "sgima=0..1"]);
    assert!(message.contains("did you mean `sigma`?"), "{message}");
}

/// What is wrong with a file of equations is said of the file, once; what is wrong with a scene, of
/// the scene.
#[test]
fn errors_name_the_file_that_is_meant() {
    let folder = folder();
    let path = folder.path();
    std::fs::create_dir(path.join("models")).unwrap();
    let model =
        "\u{feff}Equations(\n    states: [(\"x\", \"a - y\")],\n    parameters: [(\"a\", 1)],\n)";
    std::fs::write(path.join("models/decay.ron"), model).unwrap();
    let scene = "Scene(title: \"t\", model: \"models/decay.ron\", runs: [(name: \"r\", along: [(name: \"a\", low: 0)])])";
    std::fs::write(path.join("scene.ron"), scene).unwrap();
    for arguments in
        [&["trace", "scene.ron"][..], &["trace", "models/decay.ron", "--along", "a=0..1"]]
    {
        let message = fails(path, arguments);
        assert!(
            message.starts_with("error: models/decay.ron, line 2, column 25: unknown name `y`"),
            "{message}"
        );
        assert!(!message.contains("scene.ron"), "{message}");
    }
    std::fs::write(path.join("models/decay.ron"), model.replace("a - y", "a - x")).unwrap();
    let message = fails(path, &["trace", "scene.ron", "--set", "b=2"]);
    assert!(message.starts_with("error: scene.ron: unknown parameter or setting `b`"), "{message}");
    std::fs::write(path.join("scene.ron"), scene.replace("decay", "none")).unwrap();
    let message = fails(path, &["trace", "scene.ron"]);
    assert!(message.starts_with("error: models/none.ron cannot be read: "), "{message}");
}

/// What cannot be is refused before the work: kinds of points without curves, pictures of columns
/// that there are not.
#[test]
fn what_cannot_be_is_refused_before_the_work() {
    let folder = folder();
    let path = folder.path();
    for kind in ["EP", "MX", "UZ", "ND", "RG", "CP", "BT"] {
        let along = ["--along", "rho=0..30", "--along", "sigma=5..15", "--hold", kind];
        let message = fails(path, &[&["trace", "lorenz.ron"][..], &along].concat());
        let rule = "hold one of BP, LP, HB, PD, TR, G";
        assert!(
            message.contains(&format!("holds {kind} (")) && message.contains(rule),
            "{message}"
        );
    }
    let scene = "Scene(title: \"t\", model: \"lorenz.ron\", plot: (x: \"rho\", y: \"max_y\", panels: [(\"rho\", \"max_zz\")]),
        runs: [(name: \"r\", along: [(name: \"rho\", low: 0, high: 2)])])";
    std::fs::write(path.join("scene.ron"), scene).unwrap();
    let message = fails(path, &["trace", "scene.ron"]);
    assert!(message.contains("unknown column `max_zz`\nhelp: did you mean `max_z`?"), "{message}");
    assert!(!path.join("out").exists());
}

/// Where neither a state nor the motion from there is a start, both reasons are given.
#[test]
fn why_no_branch_starts() {
    let folder = folder();
    let path = folder.path();
    let model = "Equations(states: [(\"x\", \"a + x^2 + 1/(x - 1)^2\")], parameters: [(\"a\", 1)])";
    std::fs::write(path.join("runaway.ron"), model).unwrap();
    let message = fails(path, &["trace", "runaway.ron", "--along", "a=1..2", "--start", "x=1"]);
    assert!(message.contains("a branch cannot start at the given state either: "), "{message}");
    assert!(message.contains("a division by zero at the start"), "{message}");
    assert!(
        message.contains(
            "the simulated motion from the given state does not converge to an attractor: "
        ),
        "{message}"
    );
}
