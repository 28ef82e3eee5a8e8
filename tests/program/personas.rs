//! Promise: what strangers want first takes one command each, without a detour. A neuron's modeller, a
//! mechanical engineer and a designer of plates each do their work by a script of commands.

use crate::program::command::{failure, succeeds, tangency};
use std::path::Path;
use tangency::core::system::Kind;
use tangency::output::{Document, Wall, figures};
use tempfile::{TempDir, tempdir};

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// A script: a command in each line. The standard output of the last one.
fn script(at: &Path, lines: &str) -> String {
    let commands = lines.lines().map(str::trim).filter(|line| !line.is_empty());
    let run = |line: &str| succeeds(at, &line.split_whitespace().collect::<Vec<_>>());
    commands.fold(String::new(), |_, line| run(line))
}

fn picture(at: &Path, name: &str) -> String {
    std::fs::read_to_string(at.join(name)).unwrap()
}

/// FitzHugh and Nagumo's neuron as XPPAUT has it.
const NEURON: &str =
    "par I=0\nv' = v - v^3/3 - w + I\nw' = 0.08*(v + 0.7 - 0.8*w)\ninit v=-1.2, w=-0.6\ndone\n";

/// A diagram with both extremes, the period, an orbit as data, and a curve of Hopf points.
#[test]
fn a_modeller_of_neurons_has_the_diagram_and_the_data() {
    let folder = folder(&[("fhn.ode", NEURON)]);
    let at = folder.path();
    let table = script(
        at,
        "trace fhn.ode --along I=0..2 --settle 500 --switch all --mark I=1
        plot out/fhn.ron --x I --y period --out period.svg
        plot out/fhn.ron --y max_v,min_v --out extremes.svg
        plot out/fhn.ron --points all --out orbits.npz
        plot out/fhn.ron --out points.csv
        table out/fhn.ron --kind HB --columns branch,I,hopf_frequency",
    );
    // v* = ∓√(1 − 0.064) at the Hopf points, and w* = (v* + 0.7)/0.8.
    let v = (1.0_f64 - 0.064).sqrt();
    let current = |v: f64| v.powi(3) / 3.0 - v + (v + 0.7) / 0.8;
    let found: Vec<f64> = table
        .lines()
        .skip(1)
        .map(|line| line.split_whitespace().nth(1).unwrap().parse().unwrap())
        .collect();
    for expected in [current(-v), current(v)] {
        assert!(found.iter().any(|found| (found - expected).abs() < 1e-8), "{expected}: {table}");
    }
    // Cycles between both Hopf points are one family.
    let document = Document::load(at.join("out/fhn.ron")).unwrap();
    let names: Vec<&str> = document.branches.iter().map(|branch| branch.name.as_str()).collect();
    assert_eq!(names, ["branch", "branch-HB1"]);
    let svg = picture(at, "out/fhn.svg");
    for text in ["\nI\n", "\nv\n", "\nperiod\n", "\ntime\n"] {
        assert!(svg.contains(text), "{text}");
    }
}

/// A mass before a stop: 0.5 kg, 2000 N/m, a stop at 2 mm, forced at f hertz.
const STOP: &str = r#"HybridEquations(
    modes: [(name: "free", states: [("x", "v"), ("v", "(F*cos(2*pi*f*t) - c*v - k*x)/m")])],
    guards: [(name: "stop", modes: ["free"], function: "0.002 - x", reset: [("v", "-0.8*v")])],
    period: "1/f",
    parameters: [("f", 8), ("F", 1.0), ("c", 0.8), ("k", 2000), ("m", 0.5)],
    labels: [("x", "displacement"), ("f", "frequency")], units: [("x", "m"), ("f", "Hz"), ("t", "s")],
)"#;

/// Where impacts begin, in words; pictures with units, in pixels; a family of curves named by their
/// damping; data for a spreadsheet.
#[test]
fn an_engineer_has_the_impacts_in_words_and_pictures() {
    let folder = folder(&[("stop.ron", STOP)]);
    let at = folder.path();
    let said = script(at, "trace stop.ron --along f=8..14 --settle 100 --switch all --depth 2");
    let document = Document::load(at.join("out/stop.ron")).unwrap();
    let branch = &document.branches[0];
    let grazing = branch.of_kind(Kind::G).next().expect("a grazing").parameters[0];
    // Without impacts |x| = F/|k − mω² + icω|, which is 2 mm where impacts begin.
    let omega = std::f64::consts::TAU * grazing;
    let size = 1.0 / (2000.0 - 0.5 * omega * omega).hypot(0.8 * omega);
    assert!((size - 0.002).abs() < 1e-10, "{size} at {grazing} Hz");
    assert!(said.contains("f from") && said.contains("grazing"), "{said}");
    let svg = picture(at, "out/stop.svg");
    assert!(svg.contains("frequency (Hz)") && svg.contains("displacement (mm)"));
    script(
        at,
        "trace stop.ron --along f=8..14 --settle 100 --set c=3 --out c3 --quiet
        plot out/stop.ron c3/stop.ron --out family.svg
        plot out/stop.ron --panel a --width 84 --out stop.png
        plot out/stop.ron --out stop.csv --separator ;
        plot out/stop.ron --out stop.pdf --width 84
        plot out/stop.ron --out stop.html
        sweep stop.ron --over f=8..14:7 --both --set c=3 --out c3
        plot c3/stop.ron c3/stop-sweep.npz --out both.svg",
    );
    // The stop is a wall of the phase portrait: what is hatched is beyond it.
    let figures = figures(&[("stop", &document)], &[], None, &[]).unwrap();
    let walls: Vec<Wall> = figures.iter().flat_map(|figure| figure.walls.clone()).collect();
    assert!(walls.len() >= 2 && walls.iter().all(|wall| (wall.at, wall.side) == (0.002, 1.0)));
    let svg = picture(at, "both.svg");
    assert!(svg.contains("up") && svg.contains("down"));
    let svg = picture(at, "family.svg");
    assert!(svg.contains("c = 0.8") && svg.contains("c = 3"));
    assert!(std::fs::read(at.join("stop.png")).unwrap().starts_with(b"\x89PNG"));
    assert!(picture(at, "stop.csv").starts_with("branch;point;f;"));
}

/// Pull-in in volts, against the gap, for a grid of designs, and for an accuracy.
#[test]
fn a_designer_has_the_pull_in_of_many_plates() {
    let folder = folder(&[]);
    let at = folder.path();
    let table = script(
        at,
        "trace plate-device --set gap=1.9e-6 --set supports=SSSS --out one
        trace plate-device --along voltage=0..200 --along gap=1e-6..4e-6 --hold LP --out curve
        trace plate-device --set accuracy=1e-3 --grid gap=1e-6..3e-6:3 --out many --quiet
        table many/plate-device/gap=1e-6.ron many/plate-device/gap=3e-6.ron --kind LP --columns gap,voltage,error",
    );
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|line| line.split_whitespace().map(|cell| cell.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [1e-6, 3e-6]);
    assert!(rows[0][1] < rows[1][1] && rows.iter().all(|row| row[2] < 1e-2 * row[1]), "{table}");
    let curve = picture(at, "curve/plate-device.svg");
    assert!(curve.contains("gap"), "the curve of folds has a panel of its two parameters");
}

/// A run that fails in an engineer's CI when a fold moves, and says by how much; one that passes; the
/// number itself; an end with another code where something did not converge.
#[test]
fn an_engineer_has_a_regression_test() {
    let folder = folder(&[]);
    let at = folder.path();
    let table = script(
        at,
        "trace plate-device --out kept --strict --quiet
        trace plate-device --out now --check kept/plate-device.ron --strict
        compare kept/plate-device.ron now/plate-device.ron
        table now/plate-device.ron --kind LP --columns voltage,converged",
    );
    let row = table.lines().nth(1).unwrap();
    assert!(row.trim().ends_with("true") && row.contains("69.18"), "{table}");
    let moved = [
        "trace",
        "plate-device",
        "--set",
        "gap=1.99e-6",
        "--out",
        "b",
        "--check",
        "kept/plate-device.ron",
    ];
    let output = tangency(at, &moved);
    failure(&output, 1);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("LP") && said.contains("voltage"), "{said}");
}
