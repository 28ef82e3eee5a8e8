//! Following what runs find: branches across branch points, orbits from Hopf points, doubled ones
//! from period doublings, and what begins at grazings.

use super::error::SceneError;
use super::join::same;
use super::observer::SceneObserver;
use super::set::SOLUTION;
use super::statement::{Run, Scene, Start};
use super::trace::{Outcome, Tracing};
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::failure::Failure;
use crate::core::system::Kind;
use std::collections::VecDeque;
use std::error::Error;

/// The most runs that are added to a scene.
const RUNS: usize = 50;

/// Traces a scene's runs, and then what goes on from the special points found, to a depth: 1
/// follows what the scene's own runs find, 2 also what is found then. A point that two branches
/// share is followed once. Gives the scene with all runs that were added, at most 50, which traces
/// the same.
///
/// Where several branches cross at a point, all are followed that its equations determine.
///
/// A run that fails is left out, and the first error is kept; the others go on. A grazing at which
/// no other branch begins is no error, nor is a point at which several eigenvalues are critical and
/// branches are not determined: the observer gets the reason.
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
    let mut whole = Scene { runs: Vec::new(), ..scene.clone() };
    // Runs that are to come, with how many special points lead to them.
    let mut coming: VecDeque<(Run, usize)> =
        scene.runs.iter().map(|run| (run.clone(), 0)).collect();
    let mut tracing = Tracing::default();
    while let Some((run, steps)) = coming.pop_front() {
        // What the scene states itself is traced in any case.
        if steps > 0 && is_known(&run, &tracing.done) {
            continue;
        }
        whole.runs.push(run.clone());
        observer.run(&run.name, run.shown);
        match tracing.run(&whole, &run, None, observer) {
            Ok(()) if scene.settings.cancel.is_cancelled() => break,
            Ok(()) => {
                if let Some((_, point)) = origin(&run, &tracing.done).filter(|_| steps > 0)
                    && point.kind == Kind::HB
                    && point.multiplicity > 1
                {
                    observer.one_of_several(&run.name, point);
                }
            }
            Err(cause) => {
                whole.runs.pop();
                let point = origin(&run, &tracing.done).filter(|_| steps > 0);
                let point = point.map(|(_, point)| (point.kind, point.multiplicity));
                match (failure(&cause), point) {
                    // All branches that cross there have been followed.
                    (Some(Failure::NoBranch { which: 1.., .. }), Some(_)) => continue,
                    // An orbit whose event goes elsewhere ends there for good, and where several
                    // eigenvalues are critical branches may not be determined.
                    (_, Some((Kind::G, _) | (_, 2..))) => observer.left_out(&run.name, &cause),
                    _ => _ = tracing.error.get_or_insert(cause.clone()),
                }
                let determined = !matches!(failure(&cause), Some(Failure::Undetermined(_)));
                let next = next_across(&run, &tracing.done).filter(|_| steps > 0 && determined);
                coming.extend(next.map(|next| (next, steps)));
                // Of the scene's own runs later ones may start from this one.
                if steps == 0 {
                    break;
                }
                continue;
            }
        }
        let room = RUNS.saturating_sub(whole.runs.len() + coming.len());
        let next = next_across(&run, &tracing.done).filter(|_| steps > 0 && room > 0);
        coming.extend(next.map(|next| (next, steps)));
        if let Some(branch) = tracing.done.last().filter(|_| steps < depth) {
            let room = RUNS.saturating_sub(whole.runs.len() + coming.len());
            let stated = |next: &Run| {
                let mut runs = scene.runs.iter();
                runs.any(|run| run.start == next.start)
            };
            let next = following(&whole, &run, branch).into_iter().filter(|next| !stated(next));
            for mut run in next.take(room) {
                // A scene may have given the name to another run.
                let mut names = whole.runs.iter().chain(coming.iter().map(|(run, _)| run));
                if names.any(|known| known.name == run.name) {
                    run.name += "'";
                }
                coming.push_back((run, steps + 1));
            }
        }
    }
    let shown: Vec<String> =
        whole.runs.iter().filter(|run| run.shown).map(|run| run.name.clone()).collect();
    let outcome = tracing.outcome(&whole, |name| shown.iter().any(|known| known == name));
    (whole, outcome)
}

/// The special point that a run starts from.
fn origin<'a>(run: &Run, done: &'a [Branch]) -> Option<(&'a Branch, &'a SpecialPoint)> {
    let Start::From { run: from, kind, nth, .. } = &run.start else { return None };
    let branch = done.iter().find(|branch| branch.name == *from)?;
    Some((branch, branch.of_kind(*kind).nth(*nth)?))
}

/// What a system or its equations have to say about an error of a run.
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

/// The run along the next one of several branches that cross at the point which a run starts from.
fn next_across(run: &Run, done: &[Branch]) -> Option<Run> {
    let several = origin(run, done).is_some_and(|(_, point)| point.multiplicity > 1);
    let mut next = run.clone();
    let Start::From { switch: true, which, .. } = &mut next.start else { return None };
    let base = run.name.strip_suffix(&format!(".{}", *which + 1)).unwrap_or(&run.name);
    *which += 1;
    next.name = format!("{base}.{}", *which + 1);
    several.then_some(next)
}

/// Whether another branch has come to the point that a run would start from.
fn is_known(run: &Run, done: &[Branch]) -> bool {
    let Some((from, point)) = origin(run, done) else { return false };
    let others = done.iter().filter(|other| other.name != from.name && other.condition.is_none());
    // Where several folds coincide other branches see a branch point.
    let crosses =
        |it: &SpecialPoint| it.kind == Kind::BP || it.kind == Kind::LP && it.multiplicity > 1;
    let alike =
        |there: &&SpecialPoint| there.kind == point.kind || crosses(point) && crosses(there);
    let mut points = others
        .flat_map(|other| other.special.iter().filter(alike).map(move |there| (other, there)));
    points.any(|there| match point.kind {
        Kind::G => same((from, point), there),
        _ => is_one((from, point), there),
    })
}

/// Two special points are one if the parameters along their branches differ by no more than this
/// many times their errors, or this part of what they are on the branches.
const ERRORS: f64 = 10.0;
const ROUNDING: f64 = 1e-12;

/// And if no other number of both branches differs by more than this part of what it is there.
const SAME: f64 = 1e-6;

/// Whether the special points of two branches are one.
fn is_one(
    (branch, point): (&Branch, &SpecialPoint),
    (other, there): (&Branch, &SpecialPoint),
) -> bool {
    let doubles = point.kind == Kind::PD;
    let columns = branch.columns().filter(|column| !(doubles && *column == "period"));
    let both = columns.filter_map(|name| {
        let (here, elsewhere) = (branch.column(name)?, other.column(name)?);
        let difference = (point.value(here)? - there.value(elsewhere)?).abs();
        Some((name, difference, size(branch, here).max(size(other, elsewhere))))
    });
    let both: Vec<(&str, f64, f64)> = both.collect();
    // A column that is rounding along both branches, compared with other states, tells nothing.
    // Parameters may have any units.
    let of_states = both.iter().filter(|(name, ..)| !branch.parameters.iter().any(|p| p == name));
    let largest = of_states.fold(0.0, |most: f64, (_, _, size)| most.max(*size));
    both.iter().all(|(name, difference, size)| {
        let near = match branch.released.first().is_some_and(|released| released == name) {
            true => ERRORS * (point.error + there.error) + ROUNDING * size,
            false => SAME * size + ROUNDING * largest,
        };
        *difference <= near
    })
}

/// The largest absolute value of a column along a branch.
fn size(branch: &Branch, column: usize) -> f64 {
    let values = branch.points.iter().filter_map(|point| point.value(column));
    values.fold(0.0, |size: f64, value| size.max(value.abs()))
}

/// The runs that go on from the special points of a branch.
fn following(scene: &Scene, run: &Run, branch: &Branch) -> Vec<Run> {
    if branch.condition.is_some() {
        return Vec::new();
    }
    let mut runs: Vec<Run> = Vec::new();
    for kind in [Kind::BP, Kind::LP, Kind::HB, Kind::PD, Kind::G] {
        let points: Vec<&SpecialPoint> = branch.of_kind(kind).collect();
        let leads =
            |point: &SpecialPoint| point.converged && (kind != Kind::LP || point.multiplicity > 1);
        let converged = points.iter().enumerate().filter(|(_, point)| leads(point));
        let several = points.len() > 1;
        let name = |count: usize| match several {
            true => format!("{}-{kind}{count}", run.name),
            false => format!("{}-{kind}", run.name),
        };
        let next = converged.filter_map(|(nth, _)| next(scene, run, kind, nth));
        runs.extend(next.enumerate().map(|(k, next)| Run { name: name(k + 1), ..next }));
    }
    runs
}

/// The run that goes on from a special point, if there is one of its kind.
fn next(scene: &Scene, run: &Run, kind: Kind, nth: usize) -> Option<Run> {
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
    let solution = |scene: &Scene| {
        let all = scene.problem.settings().into_iter();
        all.filter(|(name, _)| *name == SOLUTION).map(|(_, value)| value).next()
    };
    let seen = solution(&scene.seen_by(run).ok()?);
    if kind == Kind::HB {
        // Orbits begin where equilibria lose stability, in problems that have both.
        seen.filter(|value| value == "equilibrium")?;
        next.set.retain(|(name, _)| name != SOLUTION);
    } else if let Some(orbits) = seen.filter(|value| value == "orbit")
        && solution(scene).is_some_and(|value| value != orbits)
        && !next.set.iter().any(|(name, _)| name == SOLUTION)
    {
        // A run from a Hopf point has them without saying so.
        next.set.push((SOLUTION.into(), orbits));
    }
    Some(next)
}
