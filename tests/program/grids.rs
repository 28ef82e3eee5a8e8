//! Promise: a scene over a grid of designs is one command, which goes on where it was left, and one
//! table.

use crate::program::command::{failure, refused, succeeds, tangency};
use std::collections::BTreeMap;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// A fold at `r = b²/4`, `x = b/2`.
const FOLD: &str =
    "Equations(states: [(\"x\", \"r - b*x + x^2\")], parameters: [(\"r\", 0), (\"b\", 1)])";

fn folder() -> TempDir {
    let folder = tempdir().expect("a folder");
    std::fs::write(folder.path().join("fold.ron"), FOLD).unwrap();
    folder
}

const GRID: [&str; 8] =
    ["trace", "fold.ron", "--along", "r=-1..3", "--grid", "b=1..3:5", "--out", "out"];

/// The rows of a table by the names of its columns.
fn rows(table: &str) -> Vec<BTreeMap<&str, &str>> {
    let mut lines = table.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines.map(|line| columns.iter().copied().zip(line.split(',')).collect()).collect()
}

fn modified(at: &Path) -> Vec<std::time::SystemTime> {
    let files = std::fs::read_dir(at.join("out/fold")).unwrap();
    let files = files.map(|file| file.unwrap().path());
    let documents = files.filter(|path| path.extension().is_some_and(|ending| ending == "ron"));
    documents.map(|path| path.metadata().unwrap().modified().unwrap()).collect()
}

#[test]
fn a_grid_is_traced_in_parts_and_goes_on() {
    let folder = folder();
    let at = folder.path();
    let said = succeeds(at, &[&GRID[..], &["--part", "1/2"]].concat());
    assert!(
        said.contains("b=1: branch: r from")
            && said.contains("2 of 5 designs of the grid are not finished")
    );
    assert!(!at.join("out/fold/points.csv").exists());
    let said = succeeds(at, &GRID);
    assert!(said.contains("b=1.5: ") && !said.contains("b=1: "), "{said}");
    let table = std::fs::read_to_string(at.join("out/fold/points.csv")).unwrap();
    let rows = rows(&table);
    let folds: Vec<[f64; 3]> = rows
        .iter()
        .filter(|row| row["kind"] == "LP")
        .map(|row| ["b", "r", "x"].map(|name| row[name].parse().unwrap()))
        .collect();
    assert_eq!(folds.iter().map(|[b, _, _]| *b).collect::<Vec<_>>(), [1.0, 1.5, 2.0, 2.5, 3.0]);
    for [b, r, x] in folds {
        assert!((r - b * b / 4.0).abs() < 1e-12 && (x - b / 2.0).abs() < 1e-6, "{b} {r} {x}");
    }
    // All is done: nothing is written again, and a quiet command says nothing.
    let before = modified(at);
    assert_eq!(succeeds(at, &[&GRID[..], &["--quiet"]].concat()), "");
    assert_eq!(modified(at), before);
    let files = ["out/fold/b=3.ron", "out/fold/b=1.ron"];
    let columns = ["--kind", "LP", "--columns", "b,r"];
    let shown = succeeds(at, &[&["table"][..], &files, &columns].concat());
    assert_eq!(shown, "b     r\n1  0.25\n3  2.25\n");
}

#[test]
fn a_grid_of_another_scene_is_refused() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &GRID);
    let made_of = std::fs::read_to_string(at.join("out/fold/scene.txt")).unwrap();
    assert!(made_of.starts_with("// tangency "), "{made_of}");
    assert!(!made_of.contains("RequestArgs"), "{made_of}");
    let changed = [&GRID[..], &["--set", "max_step=0.05"]].concat();
    refused(at, &changed, &["out/fold contains the results of another grid", "scene.txt"]);
    for (more, said) in [
        (&["--check", "out/fold/b=1.ron"][..], "cannot be combined with --check"),
        (&["--verbose"], "cannot be combined with --verbose"),
        (&["--wide"], "cannot be combined with --wide"),
        (
            &["--set", "b=2"],
            "the options `--set b` and `--grid b` give the same setting\nhelp: omit one",
        ),
        (
            &["--grid", "r=1..1:2"],
            "two designs (combinations of settings) of the grid have the same name `b=1,r=1`",
        ),
        (&["--grid", "c=1..2:2", "--out", "new"], "unknown parameter or setting `c`"),
        (&["--grid", "b=1..2:2"], "`b` occurs twice"),
        (&["--grid", "q=1..2:100000"], "from 1 to 100 000"),
    ] {
        refused(at, &[&GRID[..6], more].concat(), &[said]);
    }
    assert!(!at.join("new").exists());
    succeeds(at, &[&GRID[..4], &["--grid", "b=1,3", "--out", "list"]].concat());
    assert!(at.join("list/fold/b=1.ron").exists() && at.join("list/fold/b=3.ron").exists());
    let output = tangency(at, &["trace", "fold.ron", "--grid", "b=1..3"]);
    let message = failure(&output, 2);
    assert!(message.contains("NAME=LOW..HIGH:COUNT"), "{message}");
}

/// Doubts and warnings are those of all designs, whenever these were done.
#[test]
fn doubts_and_warnings_of_designs_are_said() {
    let folder = folder();
    let at = folder.path();
    let strict = [&GRID[..], &["--set", "max_points=5", "--strict"]].concat();
    for _ in 0..2 {
        let output = tangency(at, &strict);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{message}");
        assert!(message.contains("b=1: branch: ") && message.contains("b=3: branch: "));
    }
    std::fs::write(at.join("fold.ron"), FOLD.replace("(\"b\", 1)", "(\"b\", 1), (\"c\", 1)"))
        .unwrap();
    let unused =
        ["trace", "fold.ron", "--along", "r=-1..3", "--grid", "c=1..2:2", "--out", "other"];
    let message = String::from_utf8_lossy(&tangency(at, &unused).stderr).into_owned();
    assert_eq!(message.matches("no formula uses the parameter `c`").count(), 1, "{message}");
    // A folder without designs is nobody's.
    std::fs::remove_file(at.join("other/fold/c=1.ron")).unwrap();
    std::fs::remove_file(at.join("other/fold/c=2.ron")).unwrap();
    succeeds(at, &[&unused[..], &["--set", "max_step=0.05"]].concat());
}

/// Designs that fail are named, and the others are there.
#[test]
fn designs_that_fail_are_named() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("fold.ron"), FOLD.replace("b*x", "sqrt(b)*x")).unwrap();
    let grid = ["trace", "fold.ron", "--along", "r=-1..3", "--grid", "b=1..-1:2"];
    let output = tangency(at, &grid);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(
        message.contains("warning: b=-1: ")
            && message.contains("1 of 2 designs of the grid failed")
    );
    assert!(at.join("out/fold/b=1.ron").exists() && !at.join("out/fold/b=-1.ron").exists());
    assert!(!at.join("out/fold/points.csv").exists());
}
