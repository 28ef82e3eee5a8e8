//! Promise: a restart traces and draws the branch of its point, and bounds and marks hold for every branch that has
//! the column.

use crate::program::command::{refused, succeeds, tangency};
use std::path::Path;
use tangency::core::continuation::{Branch, SpecialPoint};
use tangency::core::system::Kind;
use tangency::output::Document;
use tempfile::{TempDir, tempdir};

fn read(path: &Path) -> Document {
    let text = std::fs::read_to_string(path).expect("a document");
    Document::parse(&text).expect("a document")
}

fn folder() -> TempDir {
    tempdir().expect("a folder")
}

/// A restart draws what it has: the picture of the scene may show other branches.
#[test]
fn a_restart_is_drawn_without_the_other_branches() {
    let folder = folder();
    let at = folder.path();
    for (scene, point) in
        // Ranges of the last one are those of deviations from a point of another branch.
        [
            ("lorenz", "rest/2"),
            ("co-oxidation", "equilibria/2"),
            ("bouncing-ball", "doubled/1"),
            ("mita-near-grazing-1", "P(1,1)/2"),
        ]
    {
        succeeds(at, &["trace", scene, "--out", "a"]);
        let start = format!("a/{scene}.ron:{point}");
        succeeds(at, &["trace", scene, "--start", &start, "--out", "b"]);
        assert!(at.join(format!("b/{scene}.svg")).exists(), "{scene}");
    }
}

/// An enlargement stays where the branch that is traced again lies in it.
#[test]
fn a_restart_is_drawn_with_its_own_enlargements() {
    let folder = folder();
    let at = folder.path();
    let scene = r#"Scene(title: "t", problem: Map(states: [("x", "c + a*x/2")]), parameters: [("a", 0), ("c", 1)],
        plot: (x: "a", y: "x", enlargements: [(x: (0, 1), y: (0, 3)), (x: (0, 1), y: (-3, 0))]), runs: [
            (name: "above", along: [(name: "a", low: 0, high: 1)]),
            (name: "below", set: [("c", "-1")], along: [(name: "a", low: 0, high: 1)]),
        ])"#;
    std::fs::write(at.join("m.ron"), scene).unwrap();
    succeeds(at, &["trace", "m.ron", "--out", "a"]);
    succeeds(at, &["trace", "m.ron", "--start", "a/m.ron:below/1", "--out", "b"]);
    let document = std::fs::read_to_string(at.join("b/m.ron")).unwrap();
    assert_eq!(Document::parse(&document).unwrap().plot.enlargements[0].y, [-3.0, 0.0]);
    assert!(at.join("b/m.svg").exists());
}

/// A curve from a saved point seeks no start of its own: at ρ = 1, the end of the range that is nearest
/// to the model's value, Lorenz' equations have a branch point. The Hopf curve is
/// ρ = σ (σ + β + 3)/(σ − β − 1).
#[test]
fn a_curve_from_a_saved_point_seeks_no_other_start() {
    let folder = folder();
    let at = folder.path();
    let model = include_str!("../../examples/lorenz.ron");
    std::fs::write(at.join("lorenz.ron"), model).unwrap();
    let trace = ["trace", "lorenz.ron", "--along"];
    succeeds(at, &[&trace[..], &["rho=0..30", "--switch", "BP", "--out", "a"]].concat());
    let curve = ["--start", "a/lorenz.ron:branch-BP/1", "--hold", "HB", "--along", "sigma=4..20"];
    succeeds(at, &[&trace[..], &["rho=1..60"], &curve[..], &["--out", "b"]].concat());
    let text = std::fs::read_to_string(at.join("b/lorenz.ron")).unwrap();
    let document = Document::parse(&text).unwrap();
    let branch = &document.branches[0];
    let [rho, sigma] = ["rho", "sigma"].map(|name| branch.column(name).unwrap());
    assert!(branch.special.len() >= 2);
    for point in &branch.special {
        let [rho, sigma] = [rho, sigma].map(|column| point.value(column).unwrap());
        let beta = 8.0 / 3.0;
        let exact = sigma * (sigma + beta + 3.0) / (sigma - beta - 1.0);
        assert!((rho / exact - 1.0).abs() < 1e-10, "{rho} at sigma = {sigma}: {exact}");
    }
}

/// Fixed points show each state in its own column, and a bound of a state holds for the cycles of two
/// iterates, too. Hénon's map has the fixed point `y = b x`, `a x² + (1 − b) x = 1`.
#[test]
fn fixed_points_of_maps_show_and_bound_every_state() {
    let folder = folder();
    let at = folder.path();
    let model = r#"Map(states: [("x", "1 - a*x^2 + y"), ("y", "b*x")], parameters: [("a", 0.1), ("b", 0.3)])"#;
    std::fs::write(at.join("henon.ron"), model).unwrap();
    let trace = [
        "trace",
        "henon.ron",
        "--along",
        "a=0.15..1",
        "--switch",
        "PD",
        "--bound",
        "y=0..0.36",
        "--mark",
        "y=0.25",
    ];
    succeeds(at, &trace);
    let text = std::fs::read_to_string(at.join("out/henon.ron")).unwrap();
    let document = Document::parse(&text).unwrap();
    let [fixed, cycles] = &document.branches[..] else { panic!("two branches") };
    let value = |branch: &Branch, point: &SpecialPoint, name: &str| {
        point.value(branch.column(name).unwrap()).unwrap()
    };
    for point in &fixed.special {
        let [a, x, y] = ["a", "x", "y"].map(|name| value(fixed, point, name));
        assert!((y - 0.3 * x).abs() < 1e-12 && (a * x * x + 0.7 * x - 1.0).abs() < 1e-12);
    }
    let mark = fixed.of_kind(Kind::UZ).next().expect("a mark");
    assert!((value(fixed, mark, "y") - 0.25).abs() < 1e-12);
    // At the doubling 3 (1 − b)²/4 = a = 0.3675 the bound is not reached; the cycle reaches it.
    let end = cycles.special.iter().find(|point| {
        point.kind == Kind::EP && (value(cycles, point, "max_y") - 0.36).abs() < 1e-10
    });
    assert!(end.is_some(), "{:?}", cycles.ends);
}

/// A bound of the period holds for the cycles that emanate from a Hopf point. Equilibria have no
/// period: a warning says so if no cycles are traced. A name that neither has is an error.
#[test]
fn a_bound_holds_for_the_branches_that_have_the_column() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(
        at.join("fhn.ode"),
        "v'=v-v^3/3-w+I\nw'=0.15*(v+0.7-0.8*w)\npar I=0\ninit v=-1.2,w=-0.6\ndone\n",
    )
    .unwrap();
    let alone = ["trace", "fhn.ode", "--along", "I=0..1.2", "--bound", "period=..30"];
    let warned = |extra: &[&str]| {
        let output = tangency(at, &[&alone[..], extra].concat());
        assert!(output.status.success());
        String::from_utf8_lossy(&output.stderr).contains("bound or mark of `period` has no effect")
    };
    assert!(warned(&[]) && !warned(&["--switch", "HB"]));
    let trace = ["trace", "fhn.ode", "--along", "I=0..1.2", "--switch", "HB", "--bound"];
    let text = std::fs::read_to_string(at.join("out/fhn.ron")).unwrap();
    let document = Document::parse(&text).unwrap();
    let cycles = &document.branches[1];
    let end = cycles.special.last().unwrap();
    assert!((end.value(cycles.column("period").unwrap()).unwrap() - 30.0).abs() < 1e-8);
    refused(at, &[&trace[..], &["perod=..30"]].concat(), &["perod"]);
    // Neither a simulation nor switching has an effect where a saved point is the start.
    let start = ["trace", "fhn.ode", "--along", "I=0..1.2", "--start", "out/fhn.ron:branch/2"];
    refused(at, &[&start[..], &["--settle", "10"]].concat(), &["cannot be combined with --settle"]);
    // Cycles from a saved Hopf point are the cycles that emanate from the branch.
    refused(at, &[&start[..], &["--switch", "PD"]].concat(), &["is of the kind HB"]);
    for way in [["--switch", "HB"], ["--switch", "all"], ["--set", "solution=orbit"]] {
        let bounded = ["--bound", "period=..30", "--out", "again"];
        let output = tangency(at, &[&start[..], &way, &bounded].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let document = Document::load(at.join("again/fhn.ron")).unwrap();
        let again = document.branches[0].special.last().unwrap();
        assert_eq!(document.branches.len(), 1);
        assert!((again.parameters[0] - end.parameters[0]).abs() < 1e-8 * end.parameters[0].abs());
    }
}

/// A curve of special points from a saved point leads to further curves. In Bogdanov and Takens'
/// equations `x' = y`, `y' = b1 + b2 x + x² − x y`, Hopf points have `b1 = 0`, `b2 < 0`, and folds have
/// `4 b1 = b2²`; both curves meet at the origin.
#[test]
fn curves_of_a_saved_point_lead_to_further_curves() {
    let folder = folder();
    let at = folder.path();
    let model = r#"Equations(states: [("x", "y"), ("y", "b1 + b2*x + x^2 - x*y")], parameters: [("b1", -0.5), ("b2", -1)])"#;
    std::fs::write(at.join("bt.ron"), model).unwrap();
    let trace = ["trace", "bt.ron", "--along", "b1=-1..0.5"];
    succeeds(at, &[&trace[..], &["--start", "x=-0.4", "--out", "a"]].concat());
    let document = read(&at.join("a/bt.ron"));
    let hopf = document.branches[0].of_kind(Kind::HB).next().expect("a Hopf point").label;
    let start = format!("a/bt.ron:{hopf}");
    let curve = ["--along", "b2=-2..1", "--start", &start, "--hold", "HB", "--switch", "all"];
    succeeds(at, &[&trace[..], &curve, &["--out", "b"]].concat());
    let document = read(&at.join("b/bt.ron"));
    let of = |kind| document.branches.iter().find(|branch| branch.condition == Some(kind));
    let values = |branch: &Branch| -> Vec<[f64; 2]> {
        let columns = ["b1", "b2"].map(|name| branch.column(name).unwrap());
        let points = branch.points.iter();
        points.map(|point| columns.map(|column| point.value(column).unwrap())).collect()
    };
    let [hopf, folds] = [Kind::HB, Kind::LP].map(|kind| values(of(kind).expect("a curve")));
    assert!(hopf.len() > 5 && hopf.iter().all(|[b1, b2]| b1.abs() < 1e-9 && *b2 < 1e-3));
    assert!(folds.len() > 5 && folds.iter().all(|[b1, b2]| (4.0 * b1 - b2 * b2).abs() < 1e-9));
    let homoclinic = of(Kind::HOM).expect("homoclinic orbits emanate from the point");
    assert!(homoclinic.points.len() > 5);
}

/// Each generation of `--depth` counts from the saved point: the cycles of the logistic map double at
/// `1 + √6` and, from there, at 3.5440903596 (Kotsireas and Karamanos, 2004).
#[test]
fn switching_at_a_saved_point_has_generations() {
    let folder = folder();
    let at = folder.path();
    let model = r#"Map(states: [("x", "r*x*(1 - x)")], parameters: [("r", 2)])"#;
    std::fs::write(at.join("m.ron"), model).unwrap();
    let trace = ["trace", "m.ron", "--along", "r=2.5..3.56"];
    succeeds(at, &[&trace[..], &["--start", "x=0.6", "--out", "a"]].concat());
    let document = read(&at.join("a/m.ron"));
    let doubling = document.branches[0].of_kind(Kind::PD).next().expect("a doubling").label;
    let start = format!("a/m.ron:{doubling}");
    for depth in 1..=3 {
        let count = depth.to_string();
        let switch = ["--start", &start, "--switch", "PD", "--depth", &count, "--out", &count];
        succeeds(at, &[&trace[..], &switch].concat());
        let document = read(&at.join(&count).join("m.ron"));
        assert_eq!(document.branches.len(), depth);
        let exact = [1.0 + 6.0_f64.sqrt(), 3.544_090_359_551_922_8];
        for (branch, exact) in document.branches.iter().zip(exact) {
            let r = branch.column("r").unwrap();
            let doubling = branch.of_kind(Kind::PD).next().expect("a doubling");
            assert!((doubling.value(r).unwrap() - exact).abs() < 1e-9);
        }
    }
}

/// A curve of homoclinic orbits ends where their equilibrium is no longer a saddle. In the equations of
/// Morris and Lecar with the parameters of class 1 (J. Rinzel and B. Ermentrout, 1998), the curve ends at
/// the two folds of equilibria: at the Bogdanov–Takens point with i = −9.949, and at i = 39.963.
#[test]
fn homoclinic_orbits_end_where_the_saddle_is_lost() {
    let folder = folder();
    let at = folder.path();
    let model = "minf(v)=.5*(1+tanh((v+1.2)/18))\nwinf(v)=.5*(1+tanh((v-12)/17.4))\n\
        v'=(i-4*minf(v)*(v-120)-8*w*(v+84)-2*(v+60))/20\nw'=phi*cosh((v-12)/34.8)*(winf(v)-w)\n\
        par i=0,phi=.23\ninit v=-60,w=.01\ndone\n";
    std::fs::write(at.join("c1.ode"), model).unwrap();
    let trace = ["trace", "c1.ode", "--along", "i=-20..150"];
    succeeds(at, &[&trace[..], &["--switch", "HB", "--out", "a"]].concat());
    let document = read(&at.join("a/c1.ron"));
    let cycles = &document.branches[1];
    let label = cycles.of_kind(Kind::HOM).next().expect("a homoclinic orbit").label;
    let start = format!("a/c1.ron:{}/{label}", cycles.name);
    let curve = ["--along", "phi=0.05..1", "--start", &start, "--hold", "HOM", "--set"];
    succeeds(at, &[&trace[..], &curve, &["solution=orbit", "--out", "b"]].concat());
    let document = read(&at.join("b/c1.ron"));
    let curve = &document.branches[0];
    let [i, unstable] = ["i", "leading_unstable"].map(|name| curve.column(name).unwrap());
    assert!(curve.points.iter().all(|point| point.value(unstable).unwrap() > -1e-9));
    let mut ends =
        [curve.points.first(), curve.points.last()].map(|it| it.unwrap().value(i).unwrap());
    ends.sort_by(f64::total_cmp);
    assert!((ends[0] + 9.949).abs() < 1e-3 && (ends[1] - 39.963).abs() < 1e-3, "{ends:?}");
}

/// Settings are judged by the solutions of the saved point: ṙ = r (m + c r² − r⁴) has cycles whose folds
/// are at m = −c²/4, and equilibria without a mesh.
#[test]
fn settings_have_an_effect_on_the_solutions_of_the_saved_point() {
    let folder = folder();
    let at = folder.path();
    let model = r#"Equations(parameters: [("m", -0.5), ("c", 1)], states: [
        ("x", "x*(m + c*(x^2 + y^2) - (x^2 + y^2)^2) - y"), ("y", "y*(m + c*(x^2 + y^2) - (x^2 + y^2)^2) + x")])"#;
    std::fs::write(at.join("r.ron"), model).unwrap();
    let range = ["trace", "r.ron", "--along", "m=-0.5..0.5"];
    succeeds(at, &[&range[..], &["--switch", "HB", "--out", "a"]].concat());
    let traced = read(&at.join("a/r.ron"));
    let cycles = traced.branches.iter().find(|branch| branch.name == "branch-HB").unwrap();
    let start = format!("a/r.ron:branch-HB/{}", cycles.of_kind(Kind::LP).next().unwrap().label);
    let curve = ["--along", "c=0.5..2", "--hold", "LP", "--set", "intervals=30"];
    succeeds(at, &[&range[..], &curve[..], &["--start", &start, "--out", "b"]].concat());
    let traced = read(&at.join("b/r.ron"));
    let branch = &traced.branches[0];
    let [m, c] = ["m", "c"].map(|name| branch.column(name).unwrap());
    for end in &branch.special {
        let [m, c] = [m, c].map(|column| end.value(column).unwrap());
        assert!((m + c * c / 4.0).abs() < 1e-7, "m = {m} at c = {c}");
    }
    let options = ["--set", "intervals=30", "--start", "a/r.ron:branch/1"];
    let reason = "`intervals` has no effect where `solution` is `equilibrium`";
    refused(at, &[&range[..], &options[..]].concat(), &[reason]);
}

/// The attractor of Duffing's oscillator at F = 0.28 repeats after two periods of the forcing, and
/// at F = 0.2 after one.
#[test]
fn a_start_on_a_motion_of_several_periods_is_announced() {
    let folder = folder();
    let at = folder.path();
    let model = r#"Equations(parameters: [("F", 0.28)], period: "2*pi/1.2",
        states: [("x", "v"), ("v", "x - x^3 - 0.3*v + F*cos(1.2*t)")])"#;
    std::fs::write(at.join("d.ron"), model).unwrap();
    for (force, said) in [("F=0.28", true), ("F=0.2", false)] {
        let options = ["trace", "d.ron", "--along", "F=0.1..0.5", "--start", "x=1", "--set", force];
        succeeds(at, &[&options[..], &["--set", "max_points=3"]].concat());
        let warnings = &read(&at.join("out/d.ron")).branches[0].warnings;
        let found = warnings
            .iter()
            .any(|it| it.starts_with("the branch starts from a motion of 2 forcing periods:"));
        assert_eq!(found, said, "{force}: {warnings:?}");
    }
}

/// A fold or Hopf point in one parameter is a fold or Hopf point in every other: a branch lists the special point at
/// which it starts. (The heat loss at the second fold of this reactor has a slope of exactly zero.)
#[test]
fn a_branch_lists_the_special_point_at_its_start() {
    let folder = folder();
    let at = folder.path();
    let reactor = r#"Equations(
        states: [("x", "-x + D*(1 - x)*exp(y)"), ("y", "-y + B*D*(1 - x)*exp(y) - beta*y")],
        parameters: [("D", 0), ("B", 14), ("beta", 2)])"#;
    std::fs::write(at.join("reactor.ron"), reactor).unwrap();
    succeeds(at, &["trace", "reactor.ron", "--along", "D=0..0.4", "--out", "a"]);
    for (label, kind) in [(2, Kind::LP), (3, Kind::LP), (4, Kind::HB)] {
        for (along, name, value) in [("beta=1..3", "beta", 2.0), ("B=10..18", "B", 14.0)] {
            let start = format!("a/reactor.ron:{label}");
            succeeds(
                at,
                &["trace", "reactor.ron", "--start", &start, "--along", along, "--out", "b"],
            );
            let document = read(&at.join("b/reactor.ron"));
            let branch = &document.branches[0];
            let column = branch.column(name).unwrap();
            let here = |it: &&SpecialPoint| (it.value(column).unwrap() - value).abs() < 1e-9;
            assert_eq!(branch.of_kind(kind).filter(here).count(), 1, "{label} {along}");
        }
    }
}

/// A curve that starts from a file follows the device of the file: a linear plate, for which the pull-in voltage is
/// proportional to `gap^1.5`.
#[test]
fn a_start_from_a_file_keeps_the_settings_of_the_device() {
    let folder = folder();
    let at = folder.path();
    let linear = ["--set", "theory=linear", "--set", "gap=1.5e-6", "--out", "a"];
    succeeds(at, &[&["trace", "plate-device"][..], &linear].concat());
    let start = ["--start", "a/plate-device.ron:plate/3", "--hold", "LP", "--out", "b"];
    let along = ["--along", "voltage=0..200", "--along", "gap=1.5e-6..3e-6"];
    succeeds(at, &[&["trace", "plate-device"][..], &start, &along].concat());
    let document = read(&at.join("b/plate-device.ron"));
    assert_eq!(document.setting("theory"), Some("linear"));
    let branch = &document.branches[0];
    let voltage = branch.column("voltage").unwrap();
    let mut ends: Vec<f64> =
        branch.of_kind(Kind::EP).map(|end| end.value(voltage).unwrap()).collect();
    ends.sort_by(f64::total_cmp);
    assert_eq!(ends.len(), 2);
    assert!((ends[1] / ends[0] - 2.0_f64.powf(1.5)).abs() < 1e-6, "{ends:?}");
}

/// A mark that no branch reaches has no effect, and a warning says so.
#[test]
fn a_mark_that_no_branch_reaches_is_a_warning() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("q.ode"), "x'=r+x^2\npar r=-1\ninit x=-1\ndone\n").unwrap();
    let warned = |mark: &str| {
        let output = tangency(at, &["trace", "q.ode", "--along", "r=-1..1", "--mark", mark]);
        assert!(output.status.success());
        let (said, why) = (String::from_utf8_lossy(&output.stderr), "no branch reaches this value");
        assert_eq!(said.contains(why), document_warns(&at.join("out/q.ron"), why));
        said.contains(why)
    };
    assert!(warned("r=0.5") && warned("x=-2"));
    // Inside the branch, at its start, and at its fold.
    assert!(!warned("r=-0.5") && !warned("x=-1") && !warned("r=0"));
}

/// A model of equilibria only has no periodic orbits to follow from its Hopf points.
#[test]
fn hopf_points_without_orbits_are_a_warning() {
    let folder = folder();
    let at = folder.path();
    let warned = |kind: &str, own: &str, more: &str, set: &[&str]| {
        let equations = r#"("x", "a*x - y - x^3"), ("y", "x + a*y - y^3")"#;
        let text = format!("{kind}({own}: [{equations}], parameters: [(\"a\", -1)], {more})");
        std::fs::write(at.join("m.ron"), text).unwrap();
        let trace = ["trace", "m.ron", "--along", "a=-1..0.5", "--switch", "HB"];
        let output = tangency(at, &[&trace[..], set].concat());
        assert!(output.status.success());
        let why = "no periodic orbits are traced from Hopf points";
        let said = String::from_utf8_lossy(&output.stderr).contains(why);
        assert_eq!(said, document_warns(&at.join("out/m.ron"), why));
        said
    };
    assert!(warned("Residual", "unknowns", "dynamics: flow", &[]));
    assert!(!warned("Equations", "states", "", &["--set", "solution=equilibrium"]));
}

/// Whether a saved branch has a warning that contains a text.
fn document_warns(path: &Path, why: &str) -> bool {
    let all = read(path).branches;
    all.iter().flat_map(|branch| &branch.warnings).any(|warning| warning.contains(why))
}
