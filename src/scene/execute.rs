//! Tracing the runs of a scene, one after the other.

use super::{Run, Scene, SceneError, Start, Way};
use crate::core::continuation::{Branch, Continuation, End, Kind, Observer};
use crate::output::Document;

/// A special point of an earlier result, from which a scene's first shown run is to start.
#[derive(Clone, Debug, PartialEq)]
pub struct StartPoint {
    /// The branch.
    pub branch: Branch,
    /// The label.
    pub label: usize,
}

/// Sees the runs of a scene.
pub trait SceneObserver: Observer {
    /// A run begins.
    fn run(&mut self, _run: &Run, _number: usize, _of: usize) {}
}

impl SceneObserver for () {}

/// What came of a scene: all branches that were traced, and the error that stopped it, if one did.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The branches that are shown.
    pub document: Document,
    /// Why the scene stopped before its last run.
    pub error: Option<SceneError>,
}

/// Traces a scene's runs. With a start point, only the first shown run that holds the same kind of
/// curve is traced, from there.
///
/// ```
/// use tangency::scene::{BUILT_IN, Scene, execute};
/// let scene = Scene::parse(BUILT_IN.iter().find(|s| s.name == "plate-supported").unwrap().text)?;
/// let outcome = execute(&scene, None, &mut ());
/// let plate = &outcome.document.branches[0];
/// let fold = plate.of_kind(tangency::core::continuation::Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] / 71.252716501 - 1.0).abs() < 1e-9);
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
pub fn execute(
    scene: &Scene,
    start: Option<&StartPoint>,
    observer: &mut dyn SceneObserver,
) -> Outcome {
    let mut document = Document::new(scene.title.clone(), Vec::new());
    document.plot = scene.plot.clone();
    document.settings = scene.record();
    let different = scene.runs.iter().filter(|run| run.shown && !run.set.is_empty());
    document.differences = different.map(|run| (run.name.clone(), run.set.clone())).collect();
    let mut done: Vec<Branch> = Vec::new();
    let mut error = None;
    let runs: Vec<&Run> = match start {
        None => scene.runs.iter().collect(),
        Some(_) => scene.runs.iter().filter(|run| run.shown).take(1).collect(),
    };
    for (index, run) in runs.iter().enumerate() {
        observer.run(run, index, runs.len());
        match trace(scene, run, start, &done, &mut *observer) {
            Ok(branch) => {
                let interrupted = branch.ends.contains(&End::Interrupted);
                done.push(branch);
                if interrupted {
                    break;
                }
            }
            Err(cause) => {
                error = Some(cause);
                break;
            }
        }
    }
    let shown = |branch: &Branch| runs.iter().any(|run| run.shown && run.name == branch.name);
    document.branches = done.into_iter().filter(shown).collect();
    Outcome { document, error }
}

fn trace(
    scene: &Scene,
    run: &Run,
    start: Option<&StartPoint>,
    done: &[Branch],
    observer: &mut dyn SceneObserver,
) -> Result<Branch, SceneError> {
    let seen = scene.as_seen_by(run)?;
    let values = seen.values();
    let mut system = seen.problem.system(&values, &reach(&seen, &scene.runs, &values))?;
    let failed = |cause| SceneError::Trace { run: run.name.clone(), cause: Box::new(cause) };
    let mut curve = Continuation::of(&mut *system).named(&run.name).settings(seen.settings.clone());
    for ((name, _), value) in seen.problem.parameters().iter().zip(&values) {
        curve = curve.at(name, *value);
    }
    match (start, &run.start) {
        (Some(StartPoint { branch, label }), _) => {
            curve = curve.restart(branch, *label);
            for (name, value) in &scene.parameters {
                if !run.along.iter().any(|range| range.name == *name) {
                    curve = curve.at(name, *value);
                }
            }
        }
        (None, Start::Rest) => {}
        (None, Start::From { run: from, kind, nth, switch }) => {
            let (branch, label) = point_of(run, done, from, *kind, *nth)?;
            curve = curve.restart(branch, label);
            for (name, value) in &run.set {
                if let Ok(value) = value.parse::<f64>()
                    && seen.value(name).is_some()
                {
                    curve = curve.at(name, value);
                }
            }
            if *switch {
                curve = curve.switch();
            }
        }
    }
    for range in &run.along {
        curve = curve.along(&range.name, range.interval());
    }
    for range in &run.bounds {
        curve = curve.bound(&range.name, range.interval());
    }
    for (name, level) in &run.marks {
        curve = curve.mark(name, *level);
    }
    if let Some(kind) = run.hold {
        curve = curve.hold(kind);
    }
    if let Some((name, level)) = &run.hold_level {
        curve = curve.hold_level(name, *level);
    }
    curve = match run.direction {
        Way::Both => curve,
        Way::Forward => curve.forward(),
        Way::Backward => curve.backward(),
    };
    curve.trace_with(observer).map_err(failed)
}

/// The special point of an earlier run that a run starts from.
fn point_of<'a>(
    run: &Run,
    done: &'a [Branch],
    from: &str,
    kind: Kind,
    nth: usize,
) -> Result<(&'a Branch, usize), SceneError> {
    let branch = done.iter().find(|branch| branch.name == from);
    let found: Vec<usize> = branch
        .map(|branch| branch.of_kind(kind).map(|point| point.label).collect())
        .unwrap_or_default();
    match (branch, found.get(nth)) {
        (Some(branch), Some(&label)) => Ok((branch, label)),
        _ => Err(SceneError::NoSuchPoint {
            run: run.name.clone(),
            from: from.into(),
            kind: kind.to_string(),
            nth,
            found: found.len(),
            ends: branch
                .map(|branch| format!("it ended: {}; {}", branch.ends[0], branch.ends[1]))
                .unwrap_or_default(),
        }),
    }
}

/// How far each parameter goes from its start in any run of the scene, by ratio: what a discretisation
/// must be fit for. All runs share it, so that one can start where another ended.
fn reach(scene: &Scene, runs: &[Run], values: &[f64]) -> Vec<f64> {
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
