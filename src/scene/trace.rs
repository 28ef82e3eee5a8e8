//! Tracing of the branches of a scene's runs, one run after another.

use super::discretisation::Settled;
use super::error::SceneError;
use super::forecast;
use super::identity::size;
use super::join::{Joined, join};
use super::local::{Local, points_of, series_of};
use super::observer::SceneObserver;
use super::resolve::{Resolution, Resolved, ResolvedSweep};
use super::simulate::{Simulated, foresee_settling, simulate};
use super::statement::{Run, Start, Way};
use crate::core::bvp::Method;
use crate::core::continuation::{Branch, Continuation, End, SpecialPoint, Steps};
use crate::core::hybrid::HybridState;
use crate::core::local_map::LocalMap;
use crate::core::problem::{Group, position};
use crate::core::system::{Kind, System};
use crate::language::Model;
use crate::output::{Document, drop_missing_points, restrict_to_finished};
use cpu_time::ThreadTime;
use std::collections::HashSet;
use std::time::Duration;

/// Heuristic: a special point lies at a mark if its value differs by less than this fraction of the
/// largest value on the branch.
const AT_MARK: f64 = 1e-6;

/// The results of a scene: all traced branches, and the error that stopped the scene, if an error
/// occurred.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The document of the branches that are shown.
    pub document: Document,
    /// The reason why the scene stopped before its last run; `None` if all runs were traced.
    pub error: Option<SceneError>,
}

/// Traces the branches of the given runs, one run after another.
pub(super) fn traced(resolution: &Resolution, observer: &mut dyn SceneObserver) -> Outcome {
    let mut tracing = Tracing::default();
    for resolved in &resolution.runs {
        observer.run(resolved.name(), resolved.run.shown);
        tracing.error = tracing.run(resolved, observer).err();
        if tracing.error.is_some() || resolved.settings.cancel.is_cancelled() {
            break;
        }
    }
    tracing.outcome(resolution)
}

/// Traces the branches of the given runs, one run after another, and omits runs that fail. Returns
/// the outcome, which contains the first error, and a list of all errors with the names of the
/// failed runs.
pub(super) fn traced_each(
    resolution: &Resolution,
    observer: &mut dyn SceneObserver,
) -> (Outcome, Vec<(String, SceneError)>) {
    let mut tracing = Tracing::default();
    let mut failed = Vec::new();
    for resolved in &resolution.runs {
        observer.run(resolved.name(), resolved.run.shown);
        if let Err(cause) = tracing.run(resolved, observer) {
            failed.push((resolved.name().to_string(), cause));
        }
        if resolved.settings.cancel.is_cancelled() {
            break;
        }
    }
    tracing.error = failed.first().map(|(_, cause)| cause.clone());
    (tracing.outcome(resolution), failed)
}

/// The runs that have been traced, with their branches.
#[derive(Default)]
pub(super) struct Tracing {
    pub runs: Vec<Run>,
    pub done: Vec<Branch>,
    last: LastStates,
    /// The bounds and marks that have no effect on a branch because the branch lacks their column:
    /// the index of the branch, and the name of the column.
    idle: Vec<(usize, String)>,
    /// The error of the run that failed, if any.
    pub error: Option<SceneError>,
}

impl Tracing {
    /// Traces the branch of one more run, and adds the branch to the results.
    pub fn run(
        &mut self,
        resolved: &Resolved,
        observer: &mut dyn SceneObserver,
    ) -> Result<(), SceneError> {
        let run = &resolved.run;
        // Branches of other motions do not meet this one.
        let both = self.runs.iter().zip(&self.done);
        let alike: Vec<&Branch> =
            both.filter(|(other, _)| other.is_akin_to(run)).map(|(_, branch)| branch).collect();
        let branch = match (&run.start, run.along.is_empty()) {
            (Start::Simulated(simulated), true) => {
                history(resolved, simulated, (&mut self.last, observer))
                    .map(|branch| (branch, Vec::new()))
            }
            _ => {
                let mut joined = Joined { done: &alike, observer };
                trace(resolved, &self.done, &mut joined)
            }
        };
        let (mut branch, idle) = branch.map_err(|cause| resolved.unless_cancelled(cause))?;
        let mut special = std::mem::take(&mut branch.special);
        special.iter_mut().for_each(|special| join(&branch, special, &alike));
        branch.special = special;
        self.idle.extend(idle.into_iter().map(|name| (self.done.len(), name)));
        self.runs.push(run.clone());
        self.done.push(branch);
        Ok(())
    }

    /// Returns the results of all runs, with the branches that are shown. A warning about a bound
    /// or mark is given only if the bound or mark has no effect on any branch, because no branch
    /// has its column.
    pub fn outcome(self, resolution: &Resolution) -> Outcome {
        let Tracing { runs, mut done, idle, error, .. } = self;
        for (branch, name) in idle {
            if done.iter().any(|other| !other.columns_showing(&name).is_empty()) {
                continue;
            }
            done[branch].warnings.push(format!(
                "the bound or mark of `{name}` has no effect: no branch has a column `{name}`"
            ));
        }
        let interrupted = |branch: &Branch| branch.ends.contains(&End::Interrupted);
        let is_complete = error.is_none() && !done.iter().any(interrupted);
        if is_complete && !resolution.scene().settings.cancel.is_cancelled() {
            warn_of_missed_marks(&runs, &mut done);
        }
        let shown = runs.iter().zip(done).filter(|(run, _)| run.shown);
        let branches = shown.map(|(_, branch)| branch).collect();
        let mut document = resolution.document(runs.iter(), branches);
        // The plot of an incomplete scene may show branches that were not traced.
        match is_complete {
            true => drop_missing_points(&mut document),
            false => restrict_to_finished(&mut document),
        }
        Outcome { document, error }
    }
}

/// The final states of simulated runs, by the names of the runs.
type LastStates = Vec<(String, HybridState<f64>)>;

/// Returns a simulated history as a branch with one point.
fn history(
    resolved: &Resolved,
    simulated: &Simulated,
    (last, observer): (&mut LastStates, &mut dyn SceneObserver),
) -> Result<Branch, SceneError> {
    resolved.check_begin()?;
    let before = |name: &String| last.iter().find(|(run, _)| run == name).map(|(_, s)| s.clone());
    let start = simulated.after.as_ref().and_then(before);
    let (motion, p) = (resolved.motion()?, &resolved.values);
    let simulated = simulated.from(&resolved.initial());
    let at = (&p[..], &resolved.settings.cancel);
    let (branch, end) = simulate(&*motion, resolved.name(), &simulated, at, (start, observer))?;
    last.push((resolved.name().into(), end));
    Ok(branch)
}

/// Returns the system of equations of a run, with the solution to which the simulated motion
/// converges.
fn settled(
    resolved: &Resolved,
    simulated: &Simulated,
    observer: &mut dyn SceneObserver,
) -> Result<Settled, SceneError> {
    let (model, p, run) = (resolved.problem.model(), &resolved.values, resolved.name());
    let simulated = simulated.from(&resolved.initial());
    if let Ok(motion) = model.motion() {
        foresee_settling(&*motion, run, &simulated, p, observer)?;
    }
    model.settled(run, &simulated, p, &resolved.settings.cancel)
}

/// Returns the system of equations of a run, and the initial unknowns for Newton's method; also
/// returns a warning if the motion at the start is probably not the expected one.
fn started(
    resolved: &Resolved,
    done: &[Branch],
    observer: &mut dyn SceneObserver,
) -> Result<Settled, SceneError> {
    let (run, p) = (&resolved.run, &resolved.values);
    let start = if resolved.from.is_some() { None } else { Some(&run.start) };
    let states = match start {
        Some(Start::Simulated(simulated)) => return settled(resolved, simulated, observer),
        Some(Start::Rest) => Some(&[][..]),
        Some(Start::Guess(values)) => Some(&values[..]),
        _ => None,
    };
    let problem = states.map(|states| resolved.problem.begun_at(states, p));
    let begun = Resolved {
        problem: problem.unwrap_or_else(|| resolved.problem.clone()),
        ..resolved.clone()
    };
    let system = system_of(&begun, done)?;
    let names = system.names();
    let groups = &names.unknowns;
    let profile = match start {
        Some(Start::Profile(profile)) => Some(profile),
        _ => None,
    };
    if let Some(profile) = profile {
        profile.check_names(names)?;
    }
    let initial = match (begun.problem.sampled(p, profile)?, profile) {
        (Some(profiles), _) => profiles,
        (None, Some(_)) => {
            return Err(SceneError::invalid(format!(
                "run `{}` starts at a profile, but only boundary-value problems have profiles",
                run.name
            )));
        }
        (None, None) => with_values(groups, &begun.initial(), vec![0.0; names.dimension()]),
    };
    let guess = match start {
        Some(Start::Guess(values)) => guess(groups, values, initial)?,
        _ => initial,
    };
    Ok(((system, guess), None))
}

/// Adds a warning for each mark whose value no branch reaches, although branches have its column.
fn warn_of_missed_marks(runs: &[Run], done: &mut [Branch]) {
    let of_run = runs.iter().enumerate().filter(|(_, run)| run.shown);
    let marks = of_run.flat_map(|(k, run)| run.marks.iter().map(move |mark| (k, mark)));
    let mut seen = HashSet::new();
    for (k, (name, level)) in marks.filter(|(_, (name, at))| seen.insert((name, at.to_bits()))) {
        let has_column = |branch: &&Branch| !branch.columns_showing(name).is_empty();
        let mut having = done.iter().filter(has_column).peekable();
        if having.peek().is_some() && !having.any(|branch| reaches(branch, name, *level)) {
            done[k].warnings.push(format!(
                "the mark at {name} = {level} has no effect: no branch reaches this value"
            ));
        }
    }
}

/// Whether a special point of a branch, which may be an end of the branch, lies at a value of a
/// column.
fn reaches(branch: &Branch, name: &str, level: f64) -> bool {
    let names: Vec<&str> = branch.columns().collect();
    branch.columns_showing(name).into_iter().any(|column| {
        let near = AT_MARK * size(branch, column);
        let event = names.get(column).map(|name| format!("{name} = {level}"));
        branch.special.iter().any(|special| {
            let value = special.value(column);
            Some(&special.event) == event.as_ref()
                || value.is_some_and(|value| (value - level).abs() <= near)
        })
    })
}

/// The warning about equations of motion that jump within an interval of a mesh.
const JUMPING: &str = "an equation contains `if` or a discontinuous function: if the equation jumps within an \
                       interval of the mesh, the errors of collocation are larger than stated; take \
                       `--set method=shooting`, or state the jumps as events (`HybridEquations`)";

/// Returns the branch of a run, and the names of the columns that have bounds or marks but do not
/// exist on the branch.
fn trace(
    resolved: &Resolved,
    done: &[Branch],
    observer: &mut dyn SceneObserver,
) -> Result<(Branch, Vec<String>), SceneError> {
    let (applied, idle) = resolved.without_idle();
    let (mut branch, warning) = begun(&applied, done, observer, |steps, began, observer| {
        forecast::branch(&resolved.run.name, &steps, began, observer);
        steps.run(observer)
    })?;
    let on_mesh = matches!(branch.method.parse(), Ok(Method::Collocation(_)));
    let jumps = resolved.problem.text().is_some_and(Model::may_jump);
    let jumping = (on_mesh && jumps).then(|| JUMPING.to_string());
    let warnings = warning.into_iter().chain(resolved.problem.jumps()).chain(jumping);
    branch.warnings.splice(..0, warnings);
    Ok((branch, idle))
}

/// Corrects the first point of a run's branch by Newton's method, and then calls a function with
/// the started continuation and the elapsed time. Returns the result of the function, and a warning
/// if the motion at the start is probably not the expected one.
fn begun<R>(
    resolved: &Resolved,
    done: &[Branch],
    observer: &mut dyn SceneObserver,
    go_on: impl FnOnce(Steps, Duration, &mut dyn SceneObserver) -> R,
) -> Result<(R, Option<String>), SceneError> {
    let run = &resolved.run;
    resolved.check_begin()?;
    let ((mut system, guess), warning) = started(resolved, done, observer)?;
    let names = system.names().clone();
    let known = &names.parameters;
    let mut curve = Continuation::new(&mut *system)
        .named(&run.name)
        .settings(resolved.settings.clone())
        .from(&guess);
    // A local map has only some of the parameters.
    for (name, value) in resolved.parameters().filter(|(name, _)| known.contains(name)) {
        curve = curve.at(&name, value);
    }
    let again = resolved.from.as_ref().filter(|point| point.is_origin(run));
    let done = again.map_or(done, |point| &point.beside);
    curve = match (&resolved.from, &run.start) {
        (Some(point), _) if again.is_none() => {
            let curve = begin_from(curve.restart(&point.branch, point.label), resolved);
            // Cycles at a Hopf point are solutions of another system.
            let switches = point.switch && point.kind() != Some(Kind::HB);
            if switches { curve.switch_to(0) } else { curve }
        }
        (_, Start::Rest | Start::Guess(_) | Start::Profile(_) | Start::Simulated(_)) => curve,
        (_, Start::From { run: from, kind, nth, switch, which, unconverged }) => {
            let (branch, special) = point_of(&run.name, done, from, *kind, *nth)?;
            let curve = match unconverged {
                true => curve.restart_anyway(branch, special.label),
                false => curve.restart(branch, special.label),
            };
            let curve = begin_from(curve, resolved);
            if *switch { curve.switch_to(*which) } else { curve }
        }
    };
    let begin = ThreadTime::now();
    let steps = conditions(curve, run).steps();
    let steps = steps.map_err(|cause| SceneError::of_run(&run.name, cause))?;
    Ok((go_on(steps, begin.elapsed(), observer), warning))
}

impl Resolved {
    /// Returns the error of a run that failed; if the run was cancelled, returns the error of a
    /// cancelled run.
    fn unless_cancelled(&self, cause: SceneError) -> SceneError {
        match self.settings.cancel.is_cancelled() {
            true => SceneError::GivenUp { run: self.run.name.clone() },
            false => cause,
        }
    }

    /// Checks that a branch begins at the solution from which the run starts.
    ///
    /// # Errors
    /// [`SceneError`] with the reason why no branch begins at the solution from which the run
    /// starts.
    pub(super) fn begins(&self) -> Result<(), SceneError> {
        begun(&self.without_idle().0, &[], &mut (), |_, _, _| ())
            .map(|_| ())
            .map_err(|cause| self.unless_cancelled(cause))
    }

    /// Returns an error if the equations are given as text and do not have finite values at the
    /// start of a run.
    fn check_begin(&self) -> Result<(), SceneError> {
        let given = match (&self.from, &self.run.start) {
            (None, Start::Rest) => &[][..],
            (None, Start::Guess(values)) => values,
            (None, Start::Simulated(simulated)) => &simulated.state,
            _ => return Ok(()),
        };
        let Some(model) = self.problem.text() else { return Ok(()) };
        let initial = self.initial();
        let states = Group::of_states(&model.states());
        let values = [&initial[..], given].concat();
        let x = with_values(&states, &values, vec![0.0; states.iter().map(|it| it.length).sum()]);
        Ok(model.undefined_at(&x, &self.values).map_or(Ok(()), Err)?)
    }
}

/// Returns the system of equations of a run: the problem's own system, or the system of points of a
/// local map.
fn system_of(resolved: &Resolved, done: &[Branch]) -> Result<Box<dyn System>, SceneError> {
    let run = &resolved.run;
    let Some(local @ Local { run: from, kind, nth, .. }) = &run.local else {
        return resolved.system();
    };
    let at = point_of(&run.name, done, from, *kind, *nth)?;
    let cancel = &resolved.settings.cancel;
    let map = resolved.problem.model().local_map(&run.name, local, at, cancel)?;
    match run.expanded {
        None => points_of(map, &run.impacts).map_err(|cause| SceneError::of_run(&run.name, cause)),
        Some(kind) => series_of(&map, kind, &run.along[0].name)
            .map_err(|cause| SceneError::of_run(&run.name, cause)),
    }
}

/// Returns the local map that a sweep iterates, after tracing the runs that find the grazing at
/// which the map is built.
pub(super) fn map_of(
    resolution: &Resolution,
    resolved: &ResolvedSweep,
    local: &Local,
) -> Result<LocalMap, SceneError> {
    let mut done = Vec::new();
    for run in resolution.leading(&local.run) {
        done.push(trace(run, &done, &mut ())?.0);
    }
    let name = &resolved.sweep.name;
    let at = point_of(name, &done, &local.run, local.kind, local.nth)?;
    resolved.problem.model().local_map(name, local, at, &resolved.cancel)
}

/// Changes the values at the special point at which a run starts, according to the values that the
/// run sets.
fn begin_from<'a>(curve: Continuation<'a>, resolved: &Resolved) -> Continuation<'a> {
    resolved.changed.iter().fold(curve, |curve, (name, value)| curve.at(name, *value))
}

/// Passes the varied parameters, bounds, marks and direction of a run to its continuation; for a
/// curve of special or marked points, also passes the condition that all points of the curve
/// satisfy.
pub(super) fn conditions<'a>(mut curve: Continuation<'a>, run: &Run) -> Continuation<'a> {
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

/// Returns the initial unknowns of a branch; if a guess is given, its values replace the initial
/// values of the unknowns that it names.
fn guess(
    groups: &[Group],
    values: &[(String, f64)],
    initial: Vec<f64>,
) -> Result<Vec<f64>, SceneError> {
    for (name, _) in values {
        if !groups.iter().any(|group| group.range(name).is_some()) {
            position("variable", name, groups.iter().map(|group| &group.name))?;
        }
    }
    Ok(with_values(groups, values, initial))
}

/// Returns unknowns in which each named group of unknowns, or each named element of a group, has a
/// constant value; if a name occurs several times, its last value is used.
fn with_values(groups: &[Group], values: &[(String, f64)], mut z: Vec<f64>) -> Vec<f64> {
    for (name, value) in values {
        let mut rest = &mut z[..];
        for group in groups {
            let (own, others) = rest.split_at_mut(group.length);
            if let Some(range) = group.range(name) {
                own[range].fill(*value);
                break;
            }
            rest = others;
        }
    }
    z
}

/// Returns the special point of an earlier run at which a given run starts.
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
