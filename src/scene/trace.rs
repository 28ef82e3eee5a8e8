//! Tracing the runs of a scene, one after the other.

use super::discretisation::Started;
use super::error::SceneError;
use super::forecast;
use super::join::{Joined, join};
use super::local::{Local, points_of, series_of};
use super::observer::SceneObserver;
use super::plan::{StartPoint, leading, plan};

use super::simulate::{Simulated, foresee_settling, simulate};
use super::statement::{Run, Scene, Start, Way};
use crate::core::continuation::{Branch, Continuation, SpecialPoint};
use crate::core::hybrid::HybridState;
use crate::core::local_map::LocalMap;
use crate::core::problem::{Group, position};
use crate::core::system::{Kind, System};
use crate::output::Document;
use cpu_time::ThreadTime;

/// The results of a scene: all branches that were traced, and the error that stopped it, if one
/// did.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The branches that are shown.
    pub document: Document,
    /// Why the scene stopped before its last run.
    pub error: Option<SceneError>,
}

/// Traces a scene's runs with the discretisation that it states.
pub(super) fn traced(
    scene: &Scene,
    start: Option<&StartPoint>,
    observer: &mut dyn SceneObserver,
) -> Outcome {
    let plan = plan(scene, start);
    let mut tracing = Tracing::default();
    for planned in &plan {
        observer.run(&planned.run.name, planned.run.shown);
        let outcome = tracing.run(scene, planned.run, planned.start, observer);
        tracing.error = outcome.err();
        if tracing.error.is_some() || scene.settings.cancel.is_cancelled() {
            break;
        }
    }
    let shown = |name: &str| plan.iter().any(|planned| planned.shown && planned.run.name == name);
    tracing.outcome(scene, shown)
}

/// The branches of a scene that have been traced.
#[derive(Default)]
pub(super) struct Tracing {
    pub done: Vec<Branch>,
    last: LastStates,
    /// Why a run failed.
    pub error: Option<SceneError>,
}

impl Tracing {
    /// Traces one more run.
    pub fn run(
        &mut self,
        scene: &Scene,
        run: &Run,
        start: Option<&StartPoint>,
        observer: &mut dyn SceneObserver,
    ) -> Result<(), SceneError> {
        let akin = scene.runs.iter().filter(|other| other.is_akin_to(run));
        let akin: Vec<&str> = akin.map(|other| other.name.as_str()).collect();
        // Branches of other motions do not meet this one.
        let alike: Vec<&Branch> =
            self.done.iter().filter(|other| akin.contains(&other.name.as_str())).collect();
        let branch = match (&run.start, run.along.is_empty()) {
            (Start::Simulated(simulated), true) => {
                history(scene, run, simulated, (&mut self.last, observer))
            }
            _ => {
                let mut joined = Joined { done: &alike, observer };
                trace(scene, run, start, &self.done, &mut joined)
            }
        };
        let mut branch = branch.map_err(|cause| match scene.settings.cancel.is_cancelled() {
            true => SceneError::GivenUp { run: run.name.clone() },
            false => cause,
        })?;
        let mut special = std::mem::take(&mut branch.special);
        special.iter_mut().for_each(|special| join(&branch, special, &alike));
        branch.special = special;
        self.done.push(branch);
        Ok(())
    }

    /// The results, with the branches that are shown.
    pub fn outcome(self, scene: &Scene, shown: impl Fn(&str) -> bool) -> Outcome {
        let mut document = Document::new(scene.title.clone(), Vec::new());
        document.plot = scene.plot.clone();
        document.settings = scene.record();
        let different = scene.runs.iter().filter(|run| run.shown && !run.set.is_empty());
        document.differences = different.map(|run| (run.name.clone(), run.set.clone())).collect();
        document.branches = self.done.into_iter().filter(|branch| shown(&branch.name)).collect();
        Outcome { document, error: self.error }
    }
}

/// The states in which simulated runs ended, by the run's name.
type LastStates = Vec<(String, HybridState<f64>)>;

/// A simulated history as a branch of one point.
fn history(
    scene: &Scene,
    run: &Run,
    simulated: &Simulated,
    (last, observer): (&mut LastStates, &mut dyn SceneObserver),
) -> Result<Branch, SceneError> {
    let seen = scene.seen_by(run)?;
    seen.check_begin(run, None)?;
    let before = |name: &String| last.iter().find(|(run, _)| run == name).map(|(_, s)| s.clone());
    let start = simulated.after.as_ref().and_then(before);
    let motion = seen.problem.model().motion()?;
    let p = seen.values()?;
    let simulated = simulated.from(&seen.problem.initial(&p));
    let at = (&p[..], &seen.settings.cancel);
    let (branch, end) = simulate(&*motion, &run.name, &simulated, at, (start, observer))?;
    last.push((run.name.clone(), end));
    Ok(branch)
}

/// The system of a run with the solution on which motion settles.
fn settled(
    seen: &Scene,
    run: &Run,
    simulated: &Simulated,
    observer: &mut dyn SceneObserver,
) -> Result<Started, SceneError> {
    let (model, p) = (seen.problem.model(), seen.values()?);
    let simulated = simulated.from(&seen.problem.initial(&p));
    if let Ok(motion) = model.motion() {
        foresee_settling(&*motion, &run.name, &simulated, &p, observer)?;
    }
    model.settled(&run.name, &simulated, &p, &seen.settings.cancel)
}

fn trace(
    scene: &Scene,
    run: &Run,
    start: Option<&StartPoint>,
    done: &[Branch],
    observer: &mut dyn SceneObserver,
) -> Result<Branch, SceneError> {
    let mut seen = scene.seen_by(run)?;
    seen.check_begin(run, start)?;
    let states = match (start, &run.start) {
        (None, Start::Rest) => Some(&[][..]),
        (None, Start::Guess(values)) => Some(&values[..]),
        _ => None,
    };
    if let Some(states) = states {
        seen.problem = seen.problem.begun_at(states, &seen.values()?);
    }
    let (mut system, guess) = match (start, &run.start) {
        (None, Start::Simulated(simulated)) => settled(&seen, run, simulated, observer)?,
        (start, begin) => {
            let system = system_of(scene, &seen, run, done)?;
            let p = seen.values()?;
            let groups = &system.names().unknowns;
            let profile = match (start, begin) {
                (None, Start::Profile(profile)) => Some(profile),
                _ => None,
            };
            if let Some(profile) = profile {
                profile.check_names(groups)?;
            }
            let initial = match (seen.problem.sampled(&p, profile)?, profile) {
                (Some(profiles), _) => profiles,
                (None, Some(_)) => {
                    let rule = "only boundary-value problems begin at a profile";
                    let place = format!("run `{}`, start", run.name);
                    return Err(SceneError::invalid(place, "a profile", rule));
                }
                (None, None) => {
                    let zero = vec![0.0; system.names().dimension()];
                    with_values(groups, &seen.problem.initial(&p), zero)
                }
            };
            let guess = match (start, begin) {
                (None, Start::Guess(values)) => guess(groups, values, initial)?,
                _ => initial,
            };
            (system, guess)
        }
    };
    let known = system.names().parameters.clone();
    let mut curve = Continuation::new(&mut *system)
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
        (None, Start::Rest | Start::Guess(_) | Start::Profile(_) | Start::Simulated(_)) => curve,
        (None, Start::From { run: from, kind, nth, switch, which, unconverged }) => {
            let (branch, special) = point_of(&run.name, done, from, *kind, *nth)?;
            let curve = match unconverged {
                true => curve.restart_anyway(branch, special.label),
                false => curve.restart(branch, special.label),
            };
            let curve = begin_from(curve, &seen, run);
            if *switch { curve.switch_to(*which) } else { curve }
        }
    };
    let begin = ThreadTime::now();
    let steps = conditions(curve, run).steps();
    let steps = steps.map_err(|cause| SceneError::of_run(&run.name, cause))?;
    forecast::branch(&run.name, &steps, begin.elapsed(), observer);
    let mut branch = steps.run(observer);
    branch.warnings.splice(..0, scene.jumps());
    Ok(branch)
}

impl Scene {
    /// Refuses a run that begins where equations which are given as text have no finite value.
    fn check_begin(&self, run: &Run, start: Option<&StartPoint>) -> Result<(), SceneError> {
        let given = match (start, &run.start) {
            (None, Start::Rest) => &[][..],
            (None, Start::Guess(values)) => values,
            (None, Start::Simulated(simulated)) => &simulated.state,
            _ => return Ok(()),
        };
        let Some(model) = self.problem.text() else { return Ok(()) };
        let p = self.values()?;
        let initial = self.problem.initial(&p);
        let value = |state: &String| {
            let mut all = given.iter().chain(&initial);
            all.find(|(name, _)| name == state).map_or(0.0, |(_, value)| *value)
        };
        let x: Vec<f64> = model.states().iter().map(value).collect();
        Ok(model.undefined_at(&x, &p).map_or(Ok(()), Err)?)
    }
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
    let map = seen.problem.model().local_map(&run.name, local, at, &seen.settings.cancel)?;
    match run.expanded {
        None => points_of(map, &run.impacts).map_err(|cause| SceneError::of_run(&run.name, cause)),
        Some(kind) => series_of(&map, kind, &run.along[0].name)
            .map_err(|cause| SceneError::of_run(&run.name, cause)),
    }
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
    seen.problem.model().local_map(sweep, local, at, &seen.settings.cancel)
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

/// The settings of a run hold at the point that it starts from, too.
fn begin_from<'a>(curve: Continuation<'a>, seen: &Scene, run: &Run) -> Continuation<'a> {
    let number = |(name, value): &'_ (String, String)| {
        let value = value.parse::<f64>().ok()?;
        seen.value(name).map(|_| (name.clone(), value))
    };
    run.set.iter().filter_map(number).fold(curve, |curve, (name, value)| curve.at(&name, value))
}

/// The parameters that a run releases, bounds, marks and holds, and its direction.
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

/// The unknowns where a branch begins, with the values of a guess in place of some groups.
fn guess(
    groups: &[Group],
    values: &[(String, f64)],
    initial: Vec<f64>,
) -> Result<Vec<f64>, SceneError> {
    for (name, _) in values {
        position("variable", name, groups.iter().map(|group| &group.name))?;
    }
    Ok(with_values(groups, values, initial))
}

/// Unknowns with the same value all over each group that is named.
fn with_values(groups: &[Group], values: &[(String, f64)], mut z: Vec<f64>) -> Vec<f64> {
    let mut rest = &mut z[..];
    for group in groups {
        let (own, others) = rest.split_at_mut(group.length);
        if let Some((_, value)) = values.iter().find(|(name, _)| *name == group.name) {
            own.fill(*value);
        }
        rest = others;
    }
    z
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
