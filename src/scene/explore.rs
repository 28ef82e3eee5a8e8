//! Automatic branch switching: traces the branches that emanate from branch points, Hopf points,
//! period doublings and grazings, and the curves through codimension-two points.

use super::discretisation::{SOLUTION, Solution};
use super::error::SceneError;
use super::fidelity::{Unseen, traced_to};
use super::identity::{is_one, is_one_grazing, passes};
use super::notation::written;
use super::observer::SceneObserver;
use super::resolve::Resolution;
use super::statement::{Run, Scene, Start};
use super::trace::{Outcome, Tracing};
use crate::core::bifurcation::catalogue;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::failure::{Failure, one_line};
use crate::core::system::Kind;
use std::collections::VecDeque;
use std::error::Error;

/// The maximum number of runs in a scene to which automatic branch switching adds runs.
const RUNS: usize = 50;

/// Traces the branches of a scene's runs, and then the branches that emanate from the special
/// points found, up to a depth: with depth 1, branches are switched at special points of the
/// scene's own runs; with depth 2, also at special points of the added runs. A special point that
/// two branches share is used only once. Returns the scene with all added runs; runs are added only
/// up to a total of 50 runs. Tracing the returned scene reproduces the result.
///
/// If several branches cross at a point, all branches that the equations at this point determine
/// are traced.
///
/// If an added run fails, it is omitted, the first such error is kept, and the other runs continue.
/// At a grazing, and at a special point with several critical eigenvalues, a failure is not an
/// error: the branch that contains the special point gets a warning with the reason. Special points
/// that have not converged, and runs beyond the maximum total of 50 runs, also cause warnings.
///
/// ```
/// use tangency::scene::{Scene, explore};
/// let scene = Scene::parse("Scene(
///     title: \"Brusselator\",
///     problem: Equations(
///         states: [(\"x\", \"a - (b + 1)*x + x^2*y\"), (\"y\", \"b*x - x^2*y\")],
///         initial: [(\"x\", 1), (\"y\", 1)],
///         solution: equilibrium,
///     ),
///     parameters: [(\"a\", 1), (\"b\", 1)],
///     runs: [Run(name: \"rest\", along: [(name: \"b\", low: 1, high: 3)])],
/// )")?;
/// let (scene, outcome) = explore(&scene, 1, &mut ());
/// assert_eq!(scene.runs[1].name, "rest-HB");
/// assert!(outcome.document.branches[1].column("period").is_some());
/// # Ok::<(), tangency::scene::SceneError>(())
/// ```
pub fn explore(scene: &Scene, depth: usize, observer: &mut dyn SceneObserver) -> (Scene, Outcome) {
    match scene.resolve(None) {
        Ok(resolution) => resolution.explore(&Following::all(depth), observer),
        Err(cause) => (scene.clone(), Outcome::failed(scene, cause)),
    }
}

/// The kinds of special points at which branches are switched, and the depth of the exploration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Following {
    /// The kinds of special points at which branches are switched, from
    /// [`OF_BRANCHES`](Self::OF_BRANCHES) and [`of_curves`](Self::of_curves).
    pub kinds: Vec<Kind>,
    /// The depth of the exploration: with depth 1, branches are switched at special points of the
    /// scene's own runs; with depth 2, also at special points of the added runs.
    pub depth: usize,
    /// Whether to omit a run if an earlier branch passes through the solution at which the run
    /// would start.
    pub distinct: bool,
}

impl Following {
    /// The kinds of special points of branches; from points of these kinds, other branches can
    /// emanate.
    pub const OF_BRANCHES: [Kind; 5] = [Kind::BP, Kind::LP, Kind::HB, Kind::PD, Kind::G];

    /// Selects special points of all kinds, up to a given depth.
    pub fn all(depth: usize) -> Self {
        let kinds = Self::OF_BRANCHES.into_iter().chain(Self::of_curves()).collect();
        Following { kinds, depth, distinct: false }
    }

    /// Returns the selection for branches that were found by branch switching: the same kinds of
    /// special points, and the depth reduced by one. Returns `None` if branches are not switched at
    /// special points of these branches.
    pub fn next_generation(self) -> Option<Self> {
        let depth = self.depth.checked_sub(1).filter(|depth| *depth > 0)?;
        Some(Following { depth, ..self })
    }

    /// Returns the kinds of special points of curves in two parameters; from points of these kinds,
    /// other curves can emanate.
    pub fn of_curves() -> Vec<Kind> {
        catalogue::crossings()
    }
}

impl Resolution {
    /// Traces the branches of the runs, and then the branches that emanate from special points, as
    /// the function [`explore`] does. If the scene requests an accuracy, the discretisation is
    /// chosen for the scene's own runs and also used for the added runs.
    pub fn explore(
        &self,
        following: &Following,
        observer: &mut dyn SceneObserver,
    ) -> (Scene, Outcome) {
        let Some(accuracy) = self.scene().accuracy else {
            return Exploration::new(self, following).all(observer);
        };
        let (found, on_rung) = traced_to(accuracy, self, &mut Unseen(observer));
        if found.error.is_some() {
            for branch in &found.document.branches {
                observer.begin(branch);
                branch.special.iter().for_each(|special| observer.special(branch, special));
            }
            return (self.scene().clone(), found);
        }
        let (explored, mut outcome) = Exploration::new(&on_rung, following).all(observer);
        for own in found.document.branches {
            let same = outcome.document.branches.iter_mut().find(|branch| branch.name == own.name);
            // These special points include the errors of the discretisation.
            same.into_iter().for_each(|branch| branch.special = own.special.clone());
        }
        outcome.document.chosen = found.document.chosen;
        (Scene { runs: explored.runs, ..self.scene().clone() }, outcome)
    }
}

/// The runs that have been traced so far, and the runs from their special points that will be
/// traced next.
struct Exploration<'a> {
    resolution: &'a Resolution,
    following: &'a Following,
    tracing: Tracing,
    /// The runs that will be traced next, each with the number of branch switches that lead to the
    /// run.
    coming: VecDeque<(Run, usize)>,
}

impl<'a> Exploration<'a> {
    fn new(resolution: &'a Resolution, following: &'a Following) -> Self {
        let coming = resolution.runs.iter().map(|resolved| (resolved.run.clone(), 0)).collect();
        Exploration { resolution, following, tracing: Tracing::default(), coming }
    }

    /// Traces the scene's own runs and all added runs; returns the scene with all these runs, and
    /// the outcome.
    fn all(mut self, observer: &mut dyn SceneObserver) -> (Scene, Outcome) {
        while let Some((run, steps)) = self.coming.pop_front() {
            // The scene's own runs are always traced, unless several starts may lie on one branch.
            let known = steps > 0 && (is_known(&run, &self.tracing.done) || self.is_started(&run));
            if known || self.following.distinct && self.is_passed(&run) {
                continue;
            }
            let run = self.numbered(run);
            observer.run(&run.name, run.shown);
            let traced = self.resolution.further(&run);
            let traced = traced.and_then(|resolved| self.tracing.run(&resolved, observer));
            if self.resolution.scene().settings.cancel.is_cancelled() {
                self.tracing.error = traced.err();
                break;
            }
            match traced {
                Ok(()) => self.follow(&run, steps),
                // Later runs of the scene may start from this one.
                Err(cause) if steps == 0 => {
                    self.tracing.error.get_or_insert(cause);
                    break;
                }
                Err(cause) => self.leave_out(&run, steps, cause),
            }
        }
        let runs = self.tracing.runs.clone();
        let scene = Scene { runs, ..self.resolution.scene().clone() };
        (scene, self.tracing.outcome(self.resolution))
    }

    /// Appends the index of the branch to the name of a run, if the run is one of several runs that
    /// start at given solutions.
    fn numbered(&self, run: Run) -> Run {
        let is_start = self.following.distinct && matches!(run.start, Start::Guess(_));
        let first = self.tracing.runs.iter().find(|_| is_start);
        let Some(Run { name, .. }) = first else { return run };
        let starts = self.tracing.runs.iter().filter(|it| matches!(it.start, Start::Guess(_)));
        Run { name: format!("{name} {}", starts.count() + 1), ..run }
    }

    /// Returns whether a traced branch passes through the solution at which a run would start.
    fn is_passed(&self, run: &Run) -> bool {
        let Start::Guess(at) = &run.start else { return false };
        let Ok(resolved) = self.resolution.further(run) else { return false };
        let Ok(mut system) = resolved.system() else { return false };
        let names = system.names().clone();
        let value = |name: &String| at.iter().find(|(known, _)| known == name).map(|(_, x)| *x);
        let start: Option<Vec<f64>> = names.elements().map(|it| value(&it)).collect();
        let alike =
            |branch: &&Branch| branch.condition.is_none() && branch.unknowns == names.unknowns;
        let mut others = self.tracing.done.iter().filter(alike);
        start.is_some_and(|z| others.any(|it| passes(it, &mut *system, &resolved.values, &z)))
    }

    /// Returns whether the curve of a given run is already traced by another run, which starts at
    /// the same special point on another curve.
    fn is_started(&self, run: &Run) -> bool {
        let Tracing { runs, done, .. } = &self.tracing;
        let Some(point) = origin(run, done).filter(|_| run.hold.is_some()) else { return false };
        let number = |run: &Run, from| match run.start {
            _ if is_of_doubled(run, from) => None,
            Start::From { which, .. } => Some(which),
            _ => None,
        };
        let (number, own) = (&number, number(run, point));
        let alike = runs
            .iter()
            .filter(|other| other.hold == run.hold)
            .filter_map(|other| origin(other, done).filter(|there| number(other, *there) == own));
        alike.into_iter().any(|there| there.1.kind == point.1.kind && is_one(point, there))
    }

    /// Adds the runs that continue from the special points of a traced run.
    fn follow(&mut self, run: &Run, steps: usize) {
        if steps > 0 {
            self.warn_if_one_of_several(run);
            let next = next_across(run, &self.tracing.done);
            self.come(next, steps);
        }
        let Some(branch) = self.tracing.done.last().filter(|_| steps < self.following.depth) else {
            return;
        };
        let unconverged = branch.special.iter().filter(|point| {
            !point.converged && self.following.kinds.contains(&point.kind) && point.kind != Kind::LP
        });
        let why = unconverged.map(|point| {
            let (kind, label) = (point.kind, point.label);
            format!(
                "no branch is traced from the special point {kind} with label {label}, because \
                     the point has not converged"
            )
        });
        let symmetric = branch
            .special
            .iter()
            .filter(|point| self.following.kinds.contains(&point.kind) && is_pitchfork_hopf(point));
        let symmetric = symmetric.map(|point| {
            format!(
                "no curve is traced from the pitchfork–Hopf point with label {}, because curves \
                 that emanate from pitchfork–Hopf points are not supported",
                point.label
            )
        });
        let next = following(self.resolution, run, branch, &self.following.kinds);
        let without = lacks_orbits(branch, &self.following.kinds, &next).then(|| {
            "no periodic orbits are traced from Hopf points, because the problem defines equilibria \
             only: write a text model as `Equations` instead of `Residual`"
                .to_owned()
        });
        let why: Vec<String> = why.chain(symmetric).chain(without).collect();
        let own = &self.resolution.scene().runs;
        let next = next.into_iter().filter(|next| {
            !own.iter().any(|run| (&run.start, run.hold) == (&next.start, next.hold))
        });
        let next: Vec<Run> = next.collect();
        self.warn(&run.name, why);
        self.come(next, steps + 1);
    }

    /// Adds runs until the maximum number of runs is reached.
    fn come(&mut self, runs: impl IntoIterator<Item = Run>, steps: usize) {
        for mut run in runs {
            if self.tracing.runs.len() + self.coming.len() >= RUNS {
                let Start::From { run: from, .. } = &run.start else { continue };
                let why = format!(
                    "the branch `{}` is not traced, because the limit of {RUNS} runs \
                                   is reached",
                    run.name
                );
                self.warn(from, [why]);
                continue;
            }
            // The scene may have used the name for another run.
            let known = |name: &str| {
                let coming = self.coming.iter().map(|(run, _)| run);
                self.tracing.runs.iter().chain(coming).any(|known| known.name == name)
            };
            while known(&run.name) {
                run.name += "'";
            }
            self.coming.push_back((run, steps));
        }
    }

    /// Records the failure of an added run, and omits the run from the scene.
    fn leave_out(&mut self, run: &Run, steps: usize, cause: SceneError) {
        let Some((from, point)) = origin(run, &self.tracing.done) else { return };
        let (from, kind, label) = (from.name.clone(), point.kind, point.label);
        let several = point.multiplicity > 1;
        let determined = match failure(&cause) {
            // All crossing branches have been traced.
            Some(Failure::NoBranch { which: 1.., .. }) => return,
            failure => !matches!(failure, Some(Failure::Undetermined(_))),
        };
        // An orbit may end for good at its grazing, and where several eigenvalues are critical
        // branches may not be determined.
        if kind == Kind::G || several || run.hold.is_some() {
            let why = format!(
                "the branch `{}` that emanates from the special point {kind} with label {label} is \
                 not traced: {}",
                run.name,
                one_line(&cause)
            );
            self.warn(&from, [why]);
        } else {
            self.tracing.error.get_or_insert(cause);
        }
        if determined {
            let next = next_across(run, &self.tracing.done);
            self.come(next, steps);
        }
    }

    /// Warns if several branches of periodic orbits emanate from a Hopf point, because only the branches
    /// that terms of third order determine are traced.
    fn warn_if_one_of_several(&mut self, run: &Run) {
        let point = origin(run, &self.tracing.done).map(|(_, point)| point);
        let Some(point) = point.filter(|it| it.kind == Kind::HB && it.multiplicity > 1) else {
            return;
        };
        let why = format!(
            "this branch is one of several branches that emanate from a Hopf point of multiplicity \
             {}: branches that terms of third order do not determine are not traced",
            point.multiplicity
        );
        self.warn(&run.name, [why]);
    }

    /// Adds warnings to the branch that a run has traced.
    fn warn(&mut self, branch: &str, why: impl IntoIterator<Item = String>) {
        if let Some(done) = self.tracing.done.iter_mut().find(|done| done.name == branch) {
            done.warnings.extend(why);
        }
    }
}

/// Returns the special point at which a run starts, with the branch that contains the point.
fn origin<'a>(run: &Run, done: &'a [Branch]) -> Option<(&'a Branch, &'a SpecialPoint)> {
    let Start::From { run: from, kind, nth, .. } = &run.start else { return None };
    let branch = done.iter().find(|branch| branch.name == *from)?;
    Some((branch, branch.of_kind(*kind).nth(*nth)?))
}

/// Returns whether a run that starts at a special point traces a curve of period-doubled orbits; a
/// curve of the orbits themselves may start at the same point.
fn is_of_doubled(run: &Run, (branch, point): (&Branch, &SpecialPoint)) -> bool {
    let Start::From { which, .. } = run.start else { return false };
    let on = (point.kind, branch.condition);
    run.hold.is_some_and(|held| catalogue::is_of_doubled(on, held, which))
}

/// Returns the failure of the equations that caused the error of a run; `None` if the error has
/// another cause.
fn failure(cause: &SceneError) -> Option<&Failure> {
    let mut error: Option<&dyn Error> = Some(cause);
    while let Some(cause) = error {
        if let Some(failure) = cause.downcast_ref() {
            return Some(failure);
        }
        error = cause.source();
    }
    None
}

/// Returns the run along the next of several branches that cross at the point where a given run
/// starts.
fn next_across(run: &Run, done: &[Branch]) -> Option<Run> {
    let several = origin(run, done).is_some_and(|(_, point)| point.multiplicity > 1);
    let mut next = run.clone();
    let Start::From { switch: true, which, .. } = &mut next.start else { return None };
    let base = run.name.strip_suffix(&format!(".{}", *which + 1)).unwrap_or(&run.name);
    *which += 1;
    next.name = format!("{base}.{}", *which + 1);
    several.then_some(next)
}

/// Returns whether another branch has already passed through the point at which a run would start.
fn is_known(run: &Run, done: &[Branch]) -> bool {
    let Some((from, point)) = origin(run, done) else { return false };
    if is_of_doubled(run, (from, point)) {
        return false;
    }
    if run.hold.is_some() {
        // The other curve through the point also has this point.
        let others = done.iter().filter(|it| it.name != from.name && it.condition == run.hold);
        let mut points =
            others.flat_map(|other| other.of_kind(point.kind).map(move |there| (other, there)));
        return points.any(|there| is_one((from, point), there));
    }
    let others = done.iter().filter(|other| other.name != from.name && other.condition.is_none());
    // Where several folds coincide, other branches have a branch point.
    let crosses =
        |it: &SpecialPoint| it.kind == Kind::BP || it.kind == Kind::LP && it.multiplicity > 1;
    // The branch on the other side of a grazing ends at the grazing.
    let ends = |it: &SpecialPoint| point.kind == Kind::G && it.kind == Kind::EP && it.converged;
    let alike = |there: &&SpecialPoint| {
        there.kind == point.kind || crosses(point) && crosses(there) || ends(there)
    };
    let mut points = others
        .flat_map(|other| other.special.iter().filter(alike).map(move |there| (other, there)));
    points.any(|there| match point.kind {
        Kind::G => is_one_grazing((from, point), there),
        _ => is_one((from, point), there),
    })
}

/// Whether a branch of equilibria has Hopf points that should be followed, and no run starts there.
fn lacks_orbits(branch: &Branch, kinds: &[Kind], runs: &[Run]) -> bool {
    let starts = |run: &Run| matches!(run.start, Start::From { kind: Kind::HB, .. });
    // Cycles can end at a Hopf point.
    let of_cycles = branch.column("period").is_some();
    let wanted = kinds.contains(&Kind::HB) && branch.condition.is_none() && !of_cycles;
    wanted && branch.of_kind(Kind::HB).any(|it| it.converged) && !runs.iter().any(starts)
}

/// Whether a special point is a pitchfork–Hopf point.
fn is_pitchfork_hopf(point: &SpecialPoint) -> bool {
    point.number("ph_p11").is_some()
}

/// Returns whether a curve of special points of a given kind emanates from a special point. A curve
/// of torus points of cycles emanates from a fold–Hopf point only if `s θ < 0`, and a curve of
/// torus points of doubled orbits emanates from a 1:2 resonance only if `a < 0`.
fn begins_at(point: &SpecialPoint, held: Kind, doubled: bool) -> bool {
    let number = |name| point.number(name).map(|number| number.value);
    let product = number("zh_s").zip(number("zh_theta")).map(|(s, theta)| s * theta);
    let decides = product.or(number("r2_a").filter(|_| doubled));
    !is_pitchfork_hopf(point) && (held != Kind::TR || decides.is_none_or(|decides| decides < 0.0))
}

/// Returns the setting that makes a run trace orbits, unless the scene or the run already states
/// this setting.
pub(super) fn orbits_of(resolution: &Resolution, run: &Run) -> Option<(String, String)> {
    let seen = resolution.further(run).ok()?.problem.solution();
    let orbits = seen.filter(|solution| *solution == Solution::Orbit)?;
    let differs = resolution.scene().problem.solution().is_some_and(|value| value != orbits);
    let says = run.set.iter().any(|(name, _)| name == SOLUTION);
    (differs && !says).then(|| (SOLUTION.into(), written(&orbits)))
}

/// Returns runs along the curves that emanate from the special points of a curve.
fn leaving(
    resolution: &Resolution,
    run: &Run,
    (branch, held): (&Branch, Kind),
    kinds: &[Kind],
) -> Vec<Run> {
    let mut set = run.set.clone();
    set.extend(orbits_of(resolution, run));
    let mut runs: Vec<Run> = Vec::new();
    for point in branch.special.iter().filter(|it| it.converged && kinds.contains(&it.kind)) {
        let kind = point.kind;
        let of_kind = || branch.of_kind(kind);
        let nth = of_kind().position(|it| it.label == point.label).unwrap_or_default();
        let number = if of_kind().count() > 1 { (nth + 1).to_string() } else { String::new() };
        let all = catalogue::leaving(held, kind);
        for (k, next) in all.iter().enumerate() {
            let which = all[..k].iter().filter(|before| *before == next).count();
            let doubled = catalogue::is_of_doubled((kind, branch.condition), *next, which);
            if !begins_at(point, *next, doubled) {
                continue;
            }
            let start = Start::From {
                run: run.name.clone(),
                kind,
                nth,
                switch: which > 0,
                which,
                unconverged: false,
            };
            let other = if which > 0 { format!(".{}", which + 1) } else { String::new() };
            let name = format!("{}-{kind}{number}-{next}{other}", run.name);
            let mut next = Run { name, start, hold: Some(*next), set: set.clone(), ..run.clone() };
            if catalogue::is_of_cycles(kind, all[k]) {
                next.set.retain(|(name, _)| name != SOLUTION);
            }
            runs.push(next);
        }
    }
    runs
}

/// Returns the runs that continue from the special points of a branch.
pub(super) fn following(
    resolution: &Resolution,
    run: &Run,
    branch: &Branch,
    kinds: &[Kind],
) -> Vec<Run> {
    if let Some(held) = branch.condition {
        return leaving(resolution, run, (branch, held), kinds);
    }
    let mut runs: Vec<Run> = Vec::new();
    for kind in Following::OF_BRANCHES.into_iter().filter(|kind| kinds.contains(kind)) {
        let points: Vec<&SpecialPoint> = branch.of_kind(kind).collect();
        let leads =
            |point: &SpecialPoint| point.converged && (kind != Kind::LP || point.multiplicity > 1);
        let converged = points.iter().enumerate().filter(|(_, point)| leads(point));
        let several = points.len() > 1;
        let name = |count: usize| match several {
            true => format!("{}-{kind}{count}", run.name),
            false => format!("{}-{kind}", run.name),
        };
        let next = converged.filter_map(|(nth, _)| next(resolution, run, kind, nth));
        runs.extend(next.enumerate().map(|(k, next)| Run { name: name(k + 1), ..next }));
    }
    runs
}

/// Returns the run that continues from a special point, or `None` if no branch emanates from points
/// of this kind.
fn next(resolution: &Resolution, run: &Run, kind: Kind, nth: usize) -> Option<Run> {
    let start = |switch| Start::From {
        run: run.name.clone(),
        kind,
        nth,
        switch,
        which: 0,
        unconverged: false,
    };
    let mut next = Run { grazings: Vec::new(), ..run.clone() };
    next.start = start(kind != Kind::HB);
    if kind == Kind::HB {
        // Orbits emanate from Hopf points of equilibria, in problems with both kinds of solutions.
        let seen = resolution.further(run).ok()?.problem.solution();
        seen.filter(|solution| *solution == Solution::Equilibrium)?;
        next.set.retain(|(name, _)| name != SOLUTION);
    } else {
        // A run from a Hopf point traces orbits by default.
        next.set.extend(orbits_of(resolution, run));
    }
    Some(next)
}
