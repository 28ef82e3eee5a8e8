//! Tracing the runs of a scene, one after the other.

use super::fidelity::traced_to;
use super::join::{Joined, join};
use super::local::{points_of, series_of};
use super::simulate::Simulation;
use super::{Local, Run, Scene, SceneError, Simulated, Start, Way};
use crate::core::continuation::{Branch, Continuation, End, Kind, Observer, SpecialPoint};
use crate::core::grazing::{GrazingError, LocalMap};
use crate::core::hybrid::HybridState;
use crate::core::names::UnknownName;
use crate::core::zero::{Group, System};
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

/// Traces a scene's runs. With a start point, only one shown run is traced, from there: the one named as
/// the point's branch; else the first one that makes the same kind of curve of the same unknowns; else the
/// first one. (If it follows points of a local map, after the runs that find the map's grazing.)
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
///
/// If the scene states an accuracy, the discretisation is chosen for it; [`Document::chosen`] says which, and what its error is
/// estimated to be:
///
/// ```
/// # use tangency::scene::{BUILT_IN, Scene, execute};
/// # let text = BUILT_IN.iter().find(|s| s.name == "impact-oscillator").unwrap().text;
/// let mut scene = Scene::parse(text)?;
/// scene.set("accuracy", "1e-6")?;
/// let chosen = execute(&scene, None, &mut ()).document.chosen.unwrap();
/// assert_eq!(chosen.settings[0].0, "flow_tolerance");
/// assert!(chosen.estimate < 1e-6);
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
pub fn execute(
    scene: &Scene,
    start: Option<&StartPoint>,
    observer: &mut dyn SceneObserver,
) -> Outcome {
    match scene.accuracy {
        Some(accuracy) => traced_to(accuracy, scene, start, observer),
        None => traced(scene, start, observer),
    }
}

/// Traces a scene's runs with the discretisation that it states.
pub(super) fn traced(
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
    let mut last = LastStates::new();
    let mut error = None;
    let plan = plan(scene, start);
    for (index, Planned { run, start, .. }) in plan.iter().enumerate() {
        observer.run(run, index, plan.len());
        let akin = scene.runs.iter().filter(|other| other.is_akin_to(run));
        let akin: Vec<&str> = akin.map(|other| other.name.as_str()).collect();
        // Branches of other motions do not meet this one.
        let alike: Vec<&Branch> =
            done.iter().filter(|other| akin.contains(&other.name.as_str())).collect();
        let outcome = match (&run.start, run.along.is_empty()) {
            (Start::Simulated(simulated), true) => history(scene, run, simulated, &mut last),
            _ => {
                let mut joined = Joined { done: &alike, observer: &mut *observer };
                trace(scene, run, *start, &done, &mut joined)
            }
        };
        match outcome {
            Ok(mut branch) => {
                let mut special = std::mem::take(&mut branch.special);
                special.iter_mut().for_each(|special| join(&branch, special, &alike));
                branch.special = special;
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
    let shown = |branch: &Branch| {
        plan.iter().any(|planned| planned.shown && planned.run.name == branch.name)
    };
    document.branches = done.into_iter().filter(shown).collect();
    Outcome { document, error }
}

/// A run that is to be traced.
struct Planned<'a> {
    run: &'a Run,
    start: Option<&'a StartPoint>,
    shown: bool,
}

/// What is traced: all runs, or the one that goes on from a start point after those which lead to its local map.
fn plan<'a>(scene: &'a Scene, start: Option<&'a StartPoint>) -> Vec<Planned<'a>> {
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
fn leading<'a>(scene: &'a Scene, name: &'a str, names: &mut Vec<&'a str>) {
    names.push(name);
    let run = scene.runs.iter().find(|run| run.name == name);
    if let Some(Start::From { run: from, .. }) = run.map(|run| &run.start) {
        leading(scene, from, names);
    }
}

/// The states in which simulated runs ended, by the run's name.
type LastStates = Vec<(String, HybridState<f64>)>;

/// A simulated history as a branch of one point.
fn history(
    scene: &Scene,
    run: &Run,
    simulated: &Simulated,
    last: &mut LastStates,
) -> Result<Branch, SceneError> {
    let seen = scene.as_seen_by(run)?;
    let before = |name: &String| last.iter().find(|(run, _)| run == name).map(|(_, s)| s.clone());
    let start = simulated.after.as_ref().and_then(before);
    let Simulation { branch, end } =
        seen.problem.entry().history(&run.name, simulated, &seen.values()?, start)?;
    last.push((run.name.clone(), end));
    Ok(branch)
}

/// The shown run that goes on with a branch.
fn continuing<'a>(scene: &'a Scene, branch: &Branch) -> Option<&'a Run> {
    let shown = || scene.runs.iter().filter(|run| run.shown);
    let alike = |run: &&Run| {
        let held = run.hold.or(run.hold_level.as_ref().map(|_| Kind::UZ));
        held == branch.condition
            && run.local.is_none()
            && scene.as_seen_by(run).and_then(|seen| seen.system(scene)).is_ok_and(|system| {
                let groups = &system.names().unknowns;
                groups.iter().map(|group| &group.name).eq(branch.unknowns.iter().map(|g| &g.name))
            })
    };
    shown().find(|run| run.name == branch.name).or(shown().find(alike)).or(shown().next())
}

impl Scene {
    /// The system of a scene as one run sees it; `whole` is the scene with all its runs.
    fn system(&self, whole: &Scene) -> Result<Box<dyn System>, SceneError> {
        let values = self.values()?;
        self.problem.entry().system(&values, &reach(self, &whole.runs, &values))
    }
}

fn trace(
    scene: &Scene,
    run: &Run,
    start: Option<&StartPoint>,
    done: &[Branch],
    observer: &mut dyn Observer,
) -> Result<Branch, SceneError> {
    let seen = scene.as_seen_by(run)?;
    let settled = match (start, &run.start) {
        (None, Start::Simulated(simulated)) => {
            Some(seen.problem.entry().settled(&run.name, simulated, &seen.values()?)?)
        }
        _ => None,
    };
    let (mut system, guess) = match (settled, start, &run.start) {
        (Some(settled), ..) => settled,
        (None, None, Start::Guess(values)) => {
            let system = system_of(scene, &seen, run, done)?;
            let guess = guess(&*system, values)?;
            (system, guess)
        }
        _ => {
            let system = system_of(scene, &seen, run, done)?;
            let rest = vec![0.0; system.names().dimension()];
            (system, rest)
        }
    };
    let known = system.names().parameters.clone();
    let mut curve = Continuation::of(&mut *system)
        .named(&run.name)
        .settings(seen.settings.clone())
        .from(&guess);
    for ((name, _), value) in seen.problem.parameters().iter().zip(seen.values()?) {
        // A local map has but a few of them.
        if known.contains(name) {
            curve = curve.at(name, value);
        }
    }
    curve = match (start, &run.start) {
        (Some(start), _) => start.begin(curve, scene, run),
        (None, Start::Rest | Start::Guess(_) | Start::Simulated(_)) => curve,
        (None, Start::From { run: from, kind, nth, switch }) => {
            let (branch, special) = point_of(&run.name, done, from, *kind, *nth)?;
            let curve = begin_from(curve.restart(branch, special.label), &seen, run);
            if *switch { curve.switch() } else { curve }
        }
    };
    let failed = |cause| SceneError::Trace { run: run.name.clone(), cause: Box::new(cause) };
    conditions(curve, run).trace_with(observer).map_err(failed)
}

/// The system of a run: the problem's own, or that of the points of a local map.
fn system_of(
    scene: &Scene,
    seen: &Scene,
    run: &Run,
    done: &[Branch],
) -> Result<Box<dyn System>, SceneError> {
    let Some(local @ Local { run: from, kind, nth, .. }) = &run.local else {
        return seen.system(scene);
    };
    let at = point_of(&run.name, done, from, *kind, *nth)?;
    let map = seen.problem.entry().local_map(&run.name, local, at)?;
    let system = match run.expanded {
        None => points_of(map, &run.impacts),
        Some(kind) => series_of(&map, kind, &run.along[0].name),
    };
    system.map_err(|cause| failed_map(&run.name, cause))
}

fn failed_map(run: &str, cause: GrazingError) -> SceneError {
    SceneError::Local { run: run.into(), cause: Box::new(cause) }
}

/// The local map that a sweep iterates, after the runs that find its grazing.
pub(super) fn map_of(
    scene: &Scene,
    seen: &Scene,
    sweep: &str,
    local: &Local,
) -> Result<LocalMap, SceneError> {
    let mut names = Vec::new();
    leading(scene, &local.run, &mut names);
    let mut done = Vec::new();
    for run in scene.runs.iter().filter(|run| names.contains(&run.name.as_str())) {
        done.push(trace(scene, run, None, &done, &mut ())?);
    }
    let at = point_of(sweep, &done, &local.run, local.kind, local.nth)?;
    seen.problem.entry().local_map(sweep, local, at)
}

impl StartPoint {
    /// Starts at this point, with the scene's own parameters where they do not vary.
    fn begin<'a>(&self, curve: Continuation<'a>, scene: &Scene, run: &Run) -> Continuation<'a> {
        let varies = |name: &str| run.along.iter().any(|range| range.name == *name);
        let own = scene.parameters.iter().filter(|(name, _)| !varies(name));
        own.fold(curve.restart(&self.branch, self.label), |curve, (name, value)| {
            curve.at(name, *value)
        })
    }
}

/// What a run sets by itself holds at the point it starts from, too.
fn begin_from<'a>(curve: Continuation<'a>, seen: &Scene, run: &Run) -> Continuation<'a> {
    let number = |(name, value): &'_ (String, String)| {
        let value = value.parse::<f64>().ok()?;
        seen.value(name).map(|_| (name.clone(), value))
    };
    run.set.iter().filter_map(number).fold(curve, |curve, (name, value)| curve.at(&name, value))
}

/// What a run releases, bounds, marks and holds, and the way it takes.
fn conditions<'a>(mut curve: Continuation<'a>, run: &Run) -> Continuation<'a> {
    for range in &run.along {
        curve = curve.along(&range.name, range.interval());
    }
    for range in &run.bounds {
        curve = curve.bound(&range.name, range.interval());
    }
    for (name, level) in &run.marks {
        curve = curve.mark(name, *level);
    }
    for (name, level) in &run.grazings {
        curve = curve.graze(name, *level);
    }
    if run.beyond_grazings {
        curve = curve.beyond_grazings();
    }
    if let Some(kind) = run.hold {
        curve = curve.hold(kind);
    }
    if let Some((name, level)) = &run.hold_level {
        curve = curve.hold_level(name, *level);
    }
    match run.direction {
        Way::Both => curve,
        Way::Forward => curve.forward(),
        Way::Backward => curve.backward(),
    }
}

/// The unknowns of a guess: the same value all over a group.
fn guess(system: &dyn System, values: &[(String, f64)]) -> Result<Vec<f64>, SceneError> {
    let groups = &system.names().unknowns;
    let known = || groups.iter().map(|group| group.name.as_str());
    if let Some((name, _)) = values.iter().find(|(name, _)| !known().any(|known| known == name)) {
        return Err(UnknownName::new("unknown", name.clone(), known()).into());
    }
    let value = |group: &Group| values.iter().find(|(name, _)| *name == group.name);
    let all = |group: &Group| vec![value(group).map_or(0.0, |(_, value)| *value); group.length];
    Ok(groups.iter().flat_map(all).collect())
}

/// The special point of an earlier run that a run starts from.
fn point_of<'a>(
    run: &str,
    done: &'a [Branch],
    from: &str,
    kind: Kind,
    nth: usize,
) -> Result<(&'a Branch, &'a SpecialPoint), SceneError> {
    let branch = done.iter().find(|branch| branch.name == from);
    let found: Vec<&SpecialPoint> =
        branch.map(|branch| branch.of_kind(kind).collect()).unwrap_or_default();
    match (branch, found.get(nth)) {
        (Some(branch), Some(special)) => Ok((branch, special)),
        _ => Err(SceneError::NoSuchPoint {
            run: run.into(),
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
