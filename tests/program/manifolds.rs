//! `tangency manifolds` as a user meets it.

use crate::program::command::{refused, succeeds};
use tangency::output::Document;

const HENON: &str = "Map(states: [(\"x\", \"1 - a*x^2 + y\"), (\"y\", \"b*x\")],
    parameters: [(\"a\", 1.4), (\"b\", 0.3)], initial: [(\"x\", 0.6), (\"y\", 0.2)])";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("henon.ron"), HENON).unwrap();
    folder
}

#[test]
fn manifolds_are_printed_saved_and_drawn() {
    let folder = folder();
    let printed = succeeds(folder.path(), &["manifolds", "henon.ron", "--length", "5"]);
    let lines: Vec<&str> = printed.lines().collect();
    let first =
        "unstable manifold: saddle (0.63135447709, 0.189406343127), multiplier -1.92373885815";
    assert!(lines[0].starts_with(first), "{printed}");
    assert!(lines[1].starts_with("  arclength 5, "), "{printed}");
    assert!(lines[1].ends_with("; arclength reached its bound 5"), "{printed}");
    assert!(lines[3].starts_with("stable manifold: saddle"), "{printed}");
    assert_eq!(
        lines[6..],
        ["out/henon-manifolds.ron", "out/henon-manifolds.svg", "out/henon-manifolds.csv"]
    );
    let document = Document::load(folder.path().join("out/henon-manifolds.ron")).unwrap();
    let [unstable, stable] = &document.branches[..] else { panic!("two branches") };
    assert_eq!(unstable.monitors, ["x", "y", "arclength"]);
    assert_eq!(document.setting("a"), Some("1.4"));
    for branch in [unstable, stable] {
        let deviation = |k: usize| branch.special[k].number("deviation").unwrap().value;
        assert!(deviation(0) <= 1e-4 && deviation(2) <= 1e-4);
    }
    let table = std::fs::read_to_string(folder.path().join("out/henon-manifolds.csv")).unwrap();
    assert!(table.starts_with("branch,point,a,b,x,y,arclength"), "{}", &table[..80]);
    let svg = std::fs::read_to_string(folder.path().join("out/henon-manifolds.svg")).unwrap();
    assert!(svg.contains("unstable manifold") && svg.contains("stable manifold"));
    // A saved result is drawn again as others are.
    let plot = ["plot", "out/henon-manifolds.ron", "--x", "arclength", "--y", "x"];
    succeeds(folder.path(), &plot);
}

/// The saddle may be a point of a branch, a fixed point or a cycle, with the parameters of the point.
#[test]
fn a_point_of_a_branch_has_manifolds() {
    let folder = folder();
    let trace = ["trace", "henon.ron", "--along", "a=0..1.4", "--switch", "all", "--mark", "a=1.2"];
    succeeds(folder.path(), &trace);
    let document = Document::load(folder.path().join("out/henon.ron")).unwrap();
    let marked = |cycle: bool| {
        let branch = document.branches.iter().find(|branch| {
            (branch.unknowns[0].length == 2) == cycle && branch.labelled(1).is_some()
        });
        let branch = branch.unwrap();
        let point = branch.special.iter().find(|point| point.event == "a = 1.2").unwrap();
        format!("out/henon.ron:{}/{}", branch.name, point.label)
    };
    let [fixed, cycle] = [false, true].map(marked);
    let of = |start: &str| {
        let start = ["manifolds", "henon.ron", "--start", start, "--length", "2"];
        succeeds(folder.path(), &start);
        Document::load(folder.path().join("out/henon-manifolds.ron")).unwrap()
    };
    let of_fixed = of(&fixed);
    assert_eq!((of_fixed.branches.len(), of_fixed.setting("a")), (2, Some("1.2")));
    let of_cycle = of(&cycle);
    let names: Vec<&str> = of_cycle.branches.iter().map(|branch| branch.name.as_str()).collect();
    let expected =
        ["unstable manifold 1", "unstable manifold 2", "stable manifold 1", "stable manifold 2"];
    assert_eq!(names, expected);
    // The same cycle from its first state.
    let x = of_cycle.branches[0].special[1].monitors.clone();
    let start = format!("x={},y={}", x[0], x[1]);
    let set = ["--set", "iterates=2", "--set", "a=1.2", "--start", &start, "--length", "2"];
    succeeds(folder.path(), &[&["manifolds", "henon.ron"], &set[..]].concat());
    let again = Document::load(folder.path().join("out/henon-manifolds.ron")).unwrap();
    let [a, b] = [&again, &of_cycle].map(|document| &document.branches[3].special[1].monitors);
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14), "{a:?} {b:?}");
}

#[test]
fn what_has_no_manifolds_is_refused() {
    let folder = folder();
    let stable = ["manifolds", "henon.ron", "--set", "a=0.1", "--start", "x=0.8,y=0.2"];
    refused(folder.path(), &stable, &["stable node, not a saddle", "only saddles"]);
    let bound = ["manifolds", "henon.ron", "--bound", "z=0..1"];
    refused(folder.path(), &bound, &["unknown state `z`", "x, y"]);
    refused(folder.path(), &["manifolds", "henon.ron", "--start", "all"], &["one saddle"]);
    refused(folder.path(), &["manifolds", "henon.ron", "--length", "0"], &["`length` is 0"]);
    refused(folder.path(), &["manifolds", "lorenz"], &["only for saddles of maps"]);
}
