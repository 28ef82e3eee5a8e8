//! Promise: branches that are corrected for changed values are solutions at these values, and curves between their
//! points are as smooth as traced curves.

use std::sync::Arc;
use std::time::{Duration, Instant};
use tangency::core::continuation::Branch;
use tangency::core::system::Kind;
use tangency::scene::{BUILT_IN, Correctable, Scene};

/// Returns a built-in scene with a changed value; its points keep their solutions.
fn scene(name: &str, set: Option<(&str, &str)>) -> Scene {
    let text = BUILT_IN.iter().find(|it| it.name == name).expect("a scene").text;
    let mut scene = Scene::parse(text).expect("a scene");
    set.iter().for_each(|(name, value)| scene.set(name, value).expect("a value"));
    scene.settings.keep_solutions = true;
    scene
}

/// Returns the branches of a scene at a few points, and the same branches corrected for a changed value.
fn corrected(name: &str, (parameter, value): (&str, &str)) -> [Vec<Branch>; 2] {
    let first = Arc::new(scene(name, None));
    let (mut outcome, failed) = first.resolve(None).unwrap().trace_each(&mut ());
    assert!(failed.is_empty(), "{failed:?}");
    let few = Correctable::of(&first, &mut outcome.document.branches);
    let points = |branch: &Branch| branch.points.iter().all(|point| point.solution.is_none());
    assert!(outcome.document.branches.iter().all(points));
    let changed = scene(name, Some((parameter, value)));
    let until = Instant::now() + Duration::from_secs(600);
    let corrected = few.corrected(&changed.resolve(None).unwrap(), until).expect("branches");
    [few, corrected].map(|it| it.branches().to_vec())
}

/// Marks every corrected value of the continued parameter on the branch that is traced with the changed value,
/// and compares a column. Most points of each branch must be corrected.
fn agree(name: &str, set: (&str, &str), column: &str) {
    let [few, corrected] = corrected(name, set);
    assert_eq!(few.len(), corrected.len());
    for (few, corrected) in few.iter().zip(&corrected) {
        let counts = [few, corrected].map(|branch| branch.points.len());
        // Points that leave the range of a bound are omitted.
        assert!(counts[0] <= 30 && 3 * counts[1] >= 2 * counts[0], "{}: {counts:?}", few.name);
    }
    let mut changed = scene(name, Some(set));
    changed.settings.refinement = 0.0;
    for run in &mut changed.runs {
        let Some(branch) = corrected.iter().find(|branch| branch.name == run.name) else {
            continue;
        };
        let range = &run.along[0];
        let p = branch.column(&range.name).unwrap();
        let values = branch.points.iter().map(|point| point.value(p).unwrap());
        let inside = values.filter(|value| {
            range.low.is_none_or(|low| low < *value) && range.high.is_none_or(|high| *value < high)
        });
        run.marks.extend(inside.map(|value| (range.name.clone(), value)));
    }
    let (outcome, failed) = changed.resolve(None).unwrap().trace_each(&mut ());
    assert!(failed.is_empty(), "{failed:?}");
    for branch in &corrected {
        let traced = outcome.document.branch(&branch.name).unwrap();
        let p = branch.column(&branch.released[0]).unwrap();
        let y = branch.column(column).or(branch.column("x")).unwrap();
        let (width, height) = (extent(branch, p), extent(branch, y));
        let mut compared = 0;
        for point in &branch.points {
            let [value, here] = [p, y].map(|column| point.value(column).unwrap());
            let marks = traced
                .of_kind(Kind::UZ)
                .filter(|mark| (mark.value(p).unwrap() - value).abs() < 1e-9 * width);
            let distances = marks.map(|mark| (mark.value(y).unwrap() - here).abs());
            let Some(least) = distances.reduce(f64::min) else { continue };
            assert!(least <= 1e-5 * height, "{name}, {}: {value} {here} {least:e}", branch.name);
            compared += 1;
        }
        assert!(2 * compared > branch.points.len(), "{}: {compared}", branch.name);
    }
}

/// Returns the width of the range of a column.
fn extent(branch: &Branch, column: usize) -> f64 {
    let values: Vec<f64> = branch.points.iter().filter_map(|point| point.value(column)).collect();
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    largest - values.iter().copied().fold(f64::INFINITY, f64::min)
}

#[test]
fn corrected_equilibria_and_cycles_lie_on_the_traced_branches() {
    agree("lure", ("beta", "1.02"), "max_x");
}

#[test]
fn corrected_plates_lie_on_the_traced_branches() {
    agree("plate-clamped", ("aspect", "1.05"), "deflection");
}

/// Pictures draw cubics with the slopes of the points: over long intervals, the mean slope leads from one point to
/// the next up to a third of the chord.
#[test]
fn slopes_of_corrected_points_continue_the_branch() {
    for branches in corrected("plate-clamped", ("aspect", "1.05")) {
        let branch = &branches[0];
        let load = branch.column("load").unwrap();
        let size = extent(branch, load);
        let mut compared = 0;
        for [a, b] in branch.points.array_windows() {
            let chord = b.value(load).unwrap() - a.value(load).unwrap();
            if chord.abs() < 0.15 * size {
                continue;
            }
            let [from, to] = [a, b].map(|point| point.slopes.as_ref().expect("slopes"));
            let mean = 0.5 * (from.columns[load].unwrap() + to.columns[load].unwrap());
            let step = mean * (to.position - from.position);
            assert!((step - chord).abs() < 0.33 * chord.abs(), "{step} {chord}");
            compared += 1;
        }
        assert!(compared > 0, "{}", branch.points.len());
    }
}
