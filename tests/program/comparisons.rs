//! Promise: results are compared, and listed side by side.

use crate::program::command::{stderr, succeeds, tangency};
use tangency::output::{Document, compare};
use tempfile::{TempDir, tempdir};

fn folder() -> TempDir {
    tempdir().expect("a folder")
}

/// Two results are compared, and the exit code says whether they agree.
#[test]
fn results_are_compared() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, &["trace", "lorenz", "--out", "a"]);
    let said = succeeds(at, &["trace", "lorenz", "--out", "b", "--check", "a/lorenz.ron"]);
    assert!(said.contains("no differences from a/lorenz.ron"), "{said}");
    succeeds(at, &["compare", "a/lorenz.ron", "b/lorenz.ron"]);
    let other = ["trace", "lorenz", "--out", "c", "--set", "beta=2.6", "--check", "a/lorenz.ron"];
    let output = tangency(at, &other);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("convection: HB moved from rho = 24.7368421053 to 24.375"), "{said}");
    assert!(stderr(&output).contains("differences from a/lorenz.ron"));
    let text = std::fs::read_to_string(at.join("a/lorenz.ron")).unwrap();
    std::fs::write(at.join("d.ron"), text.replace("name: \"rest\"", "name: \"trivial\"")).unwrap();
    let output = tangency(at, &["compare", "a/lorenz.ron", "d.ron"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("`rest` is missing") && said.contains("`trivial` is new"), "{said}");
}

/// A fold that moves by 0.05 % passes a check that allows 0.1 %, and one that moves by 0.2 % does not:
/// `a = x − b x³/3` has the folds `x = ±1/√b`, `a = ±2/(3√b)`.
#[test]
fn a_comparison_allows_a_fraction() {
    let folder = folder();
    let at = folder.path();
    let model =
        r#"Equations(states: [("x", "a - x + b*x^3/3")], parameters: [("a", 0), ("b", 1)])"#;
    std::fs::write(at.join("m.ron"), model).unwrap();
    let trace = ["trace", "m.ron", "--along", "a=-0.2..2", "--bound", "x=..2", "--out"];
    succeeds(at, &[&trace[..], &["old"]].concat());
    let check = |b: &str, allowed: &str| {
        let changed = ["new", "--set", b, "--check", "old/m.ron", "--allow", allowed];
        tangency(at, &[&trace[..], &changed].concat()).status.code()
    };
    assert_eq!([check("b=1.001", "1e-3"), check("b=1.004", "1e-3")], [Some(0), Some(1)]);
    assert_eq!(check("b=1.001", "0"), Some(1));
    let compared = |allowed: &str| {
        let output = tangency(at, &["compare", "old/m.ron", "new/m.ron", "--allow", allowed]);
        output.status.code()
    };
    assert_eq!([compared("1e-2"), compared("1e-5")], [Some(0), Some(1)]);
    assert_eq!(
        tangency(at, &["trace", "m.ron", "--along", "a=0..1", "--allow", "1e-3"]).status.code(),
        Some(2)
    );
}

/// One point that is missing is one difference; values of monitors count; rounding matches nothing.
#[test]
fn differences_are_those_that_there_are() {
    let scene = |rate: &str, marks: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"{rate}\"), (\"y\", \"-y\")], solution: equilibrium), parameters: [(\"a\", 0)],
                runs: [(name: \"r\", along: [(name: \"a\", low: 0, high: 2)], marks: [{marks}])])"
        );
        let scene = tangency::scene::Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        tangency::scene::execute(&scene, None, &mut ()).document
    };
    let marks = |from: usize| -> String {
        (from..6).map(|k| format!("(\"a\", {}),", 0.3 * k as f64)).collect()
    };
    let said = |old: &Document, new: &Document| -> Vec<String> {
        compare(old, new).iter().map(ToString::to_string).collect()
    };
    let all = scene("a - x", &marks(1));
    assert_eq!(said(&all, &scene("a - x", &marks(2))), ["r: UZ at a = 0.3 is missing"]);
    assert_eq!(said(&scene("a - x", &marks(2)), &all), ["r: UZ at a = 0.3 is new"]);
    let steeper = said(&all, &scene("a - 1.01*x", &marks(1)));
    assert!(steeper.iter().any(|it| it.contains("x was 0.6 and is now 0.594")), "{steeper:?}");
}

/// A constant parameter that differs is the first difference, and no point is missing for it alone.
#[test]
fn parameters_that_differ_come_first() {
    let old = Document::new("plate", vec![tangency::output::example_branch()]);
    let mut new = old.clone();
    let branch = &mut new.branches[0];
    branch.points.iter_mut().for_each(|point| point.parameters[1] = 3.0);
    branch.special.iter_mut().for_each(|point| point.parameters[1] = 3.0);
    let found: Vec<String> = compare(&old, &new).iter().map(ToString::to_string).collect();
    assert_eq!(found, ["plate: the parameter aspect_ratio was 1.2 and is now 3"]);
}

/// Columns that only one result has, and other continuation parameters, are differences.
#[test]
fn columns_are_compared() {
    let scene = |parameters: &str, monitor: &str, along: &str| {
        let text = format!(
            "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a + q - x\")], monitors: [(\"{monitor}\", \"x^2\")], solution: equilibrium), parameters: [{parameters}],
                runs: [(name: \"r\", along: [(name: \"{along}\", low: 0, high: 2)])])"
        );
        let scene = tangency::scene::Scene::parse(&text).unwrap_or_else(|error| panic!("{error}"));
        tangency::scene::execute(&scene, None, &mut ()).document
    };
    let said = |old: &Document, new: &Document| -> Vec<String> {
        compare(old, new).iter().map(ToString::to_string).collect()
    };
    let old = scene("(\"a\", 0), (\"q\", 0)", "m", "a");
    let renamed = scene("(\"a\", 0), (\"q\", 0)", "n", "a");
    assert_eq!(said(&old, &renamed), ["r: the column m is missing", "r: the column n is new"]);
    let longer = scene("(\"a\", 0), (\"q\", 0), (\"c\", 1)", "m", "a");
    assert_eq!(said(&old, &longer), ["r: the column c is new"]);
    let along_q = scene("(\"a\", 0), (\"q\", 0)", "m", "q");
    let found = said(&old, &along_q);
    assert_eq!(found[0], "r: the branch was continued in a and is now continued in q");
}

/// A table of several results has a column of their files, and only the named sensitivities.
#[test]
fn tables_have_files_and_chosen_sensitivities() {
    let folder = folder();
    let at = folder.path();
    let text = "Equations(states: [(\"x\", \"a - b*x^2\"), (\"y\", \"-c*y\")],
        parameters: [(\"a\", 1), (\"b\", 2), (\"c\", 1)], initial: [(\"x\", 0.7)])";
    std::fs::write(at.join("m.ron"), text).unwrap();
    for out in ["one", "two"] {
        let trace = ["trace", "m.ron", "--set", "solution=equilibrium", "--along", "a=-1..1"];
        succeeds(at, &[&trace[..], &["--out", out]].concat());
    }
    succeeds(at, &["plot", "one/m.ron", "two/m.ron", "--out", "both.csv"]);
    let table = std::fs::read_to_string(at.join("both.csv")).unwrap();
    assert!(table.starts_with("file,branch,point,a,"), "{table}");
    let files: std::collections::BTreeSet<&str> =
        table.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert_eq!(files.into_iter().collect::<Vec<_>>(), ["one/m.ron", "two/m.ron"]);
    let fold = ["table", "one/m.ron", "--kind", "LP", "--sensitivity", "--csv", "--columns"];
    let of = |columns: &str| succeeds(at, &[&fold[..], &[columns]].concat());
    // The fold at a = 0 does not depend on b and c.
    assert_eq!(of("kind,da/dc"), "kind,da/dc\nLP,0\n");
    assert!(of("kind").starts_with("kind,da/db,da/dc\n"));
}

/// Parameters may have the names of columns: the table tells them apart.
#[test]
fn columns_of_a_table_have_different_names() {
    let folder = folder();
    let at = folder.path();
    let text = "Equations(states: [(\"x\", \"error - x\")], parameters: [(\"error\", 1)], monitors: [(\"unstable\", \"2*x\")])";
    std::fs::write(at.join("m.ron"), text).unwrap();
    succeeds(at, &["trace", "m.ron", "--along", "error=0..2"]);
    let table = succeeds(at, &["table", "out/m.ron", "--csv"]);
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    for name in ["parameter error", "error", "monitor unstable", "unstable"] {
        assert_eq!(header.iter().filter(|column| **column == name).count(), 1, "{header:?}");
    }
}
