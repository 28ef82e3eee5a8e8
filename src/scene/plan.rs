//! Which runs of a scene are traced, and how far their parameters go.

use super::error::SceneError;
use super::statement::{Run, Scene, Start};
use crate::core::continuation::Branch;
use crate::core::system::{Kind, System};

/// A special point of an earlier result, from which a scene's first shown run is to start.
#[derive(Clone, Debug, PartialEq)]
pub struct StartPoint {
    /// The branch.
    pub branch: Branch,
    /// The label.
    pub label: usize,
}

/// A run that is to be traced.
pub(super) struct Planned<'a> {
    pub run: &'a Run,
    pub start: Option<&'a StartPoint>,
    pub shown: bool,
}

/// What is traced: all runs, or the one that goes on from a start point after those which lead to
/// its local map.
pub(super) fn plan<'a>(scene: &'a Scene, start: Option<&'a StartPoint>) -> Vec<Planned<'a>> {
    let Some(point) = start else {
        let all = scene.runs.iter().map(|run| Planned { run, start, shown: run.shown });
        return all.collect();
    };
    let Some(run) = continuing(scene, &point.branch) else { return Vec::new() };
    let mut names = Vec::new();
    if let Some(local) = &run.local {
        leading(scene, &local.run, &mut names);
    }
    let before = scene.runs.iter().filter(|run| names.contains(&run.name.as_str()));
    let before = before.map(|run| Planned { run, start: None, shown: false });
    before.chain([Planned { run, start, shown: true }]).collect()
}

/// The names of a run and of all that it starts from.
pub(super) fn leading<'a>(scene: &'a Scene, name: &'a str, names: &mut Vec<&'a str>) {
    names.push(name);
    let run = scene.runs.iter().find(|run| run.name == name);
    if let Some(Start::From { run: from, .. }) = run.map(|run| &run.start) {
        leading(scene, from, names);
    }
}

/// The shown run that goes on with a branch.
fn continuing<'a>(scene: &'a Scene, branch: &Branch) -> Option<&'a Run> {
    let shown = || scene.runs.iter().filter(|run| run.shown);
    let alike = |run: &&Run| {
        let held = run.hold.or(run.hold_level.as_ref().map(|_| Kind::UZ));
        held == branch.condition
            && run.local.is_none()
            && scene.seen_by(run).and_then(|seen| seen.system(scene)).is_ok_and(|system| {
                let groups = &system.names().unknowns;
                groups.iter().map(|group| &group.name).eq(branch.unknowns.iter().map(|g| &g.name))
            })
    };
    shown().find(|run| run.name == branch.name).or(shown().find(alike)).or(shown().next())
}

impl Scene {
    /// The system of a scene as one run sees it; `whole` is the scene with all its runs.
    pub(super) fn system(&self, whole: &Scene) -> Result<Box<dyn System>, SceneError> {
        let values = self.values()?;
        self.problem.model().system(&values, &reach(self, &whole.runs, &values))
    }
}

/// How far each parameter goes from its start in any run of the scene, by ratio: what a
/// discretisation must be fit for. All runs share it, so that one can start where another ended.
pub(super) fn reach(scene: &Scene, runs: &[Run], values: &[f64]) -> Vec<f64> {
    let names = scene.problem.parameters();
    let mut reach = values.to_vec();
    for ((reach, value), (name, _)) in reach.iter_mut().zip(values).zip(&names) {
        let ranges = runs.iter().flat_map(|run| &run.along).filter(|range| range.name == *name);
        for end in ranges.flat_map(|range| [range.low, range.high]).flatten() {
            // By ratio, as an aspect ratio is meant; from zero, by size.
            let far = |end: f64| if *value == 0.0 { end.abs() } else { (end / value).ln().abs() };
            if far(end).is_finite() && far(end) > far(*reach) {
                *reach = end;
            }
        }
    }
    reach
}
