//! The cheapest discretisation with which special points have the accuracy that a scene asks for.
//!
//! A problem has a ladder of discretisations, cheapest first. With rung `k` a scene finds numbers
//! `v_k`: the released parameters of every special point, and the columns that the setting `refine`
//! names, relative to themselves. They are compared with those of the next two rungs, and of finer
//! ones that are known, by [`error_of_first`]. The rung taken is the lowest one whose estimate is
//! below the accuracy, of those from a first guess downwards; or upwards, where the guess does not
//! suffice.

use super::error::SceneError;
use super::observer::SceneObserver;
use super::problem::Problem;
use super::resolve::{Resolution, Resolved, reach};
use super::statement::{Run, Scene};
use super::trace::{Outcome, traced};
use crate::core::continuation::{Branch, End, Observer, Point, Settings, SpecialPoint};
use crate::core::numerics::error_of_first;
use crate::core::system::Kind;
use crate::output::{Chosen, Document};
use std::ops::RangeInclusive;
use std::time::Duration;

/// Accuracies that can be asked for.
const RANGE: RangeInclusive<f64> = 1e-12..=0.1;

/// How many rungs finer the discretisation is at least that others are compared with.
const ABOVE: usize = 2;

/// A trial is watched for Ctrl-C, and not shown.
pub(super) struct Unseen<'a>(pub &'a mut dyn SceneObserver);

impl Observer for Unseen<'_> {
    fn point(&mut self, point: &Point) {
        self.0.point(point);
    }
}

impl SceneObserver for Unseen<'_> {
    fn work(&mut self, run: &str, what: &str, longest: Duration) {
        self.0.work(run, what, longest);
    }
}

/// An estimated error, and where it is.
#[derive(Clone, Debug, PartialEq)]
struct Estimate {
    error: f64,
    of: String,
}

/// The rungs of a scene, and what was found with them.
struct Search<'a> {
    rungs: Vec<Resolution>,
    found: Vec<Option<Outcome>>,
    observer: Unseen<'a>,
}

impl Search<'_> {
    fn trace(&mut self, rung: usize) -> &Outcome {
        let Search { rungs, found, observer } = self;
        found[rung].get_or_insert_with(|| traced(&rungs[rung], observer))
    }

    /// Whether a trial was interrupted.
    fn interrupted(&self) -> bool {
        let branches = self.found.iter().flatten().flat_map(|outcome| &outcome.document.branches);
        branches.into_iter().any(|branch| branch.ends.contains(&End::Interrupted))
    }

    /// The error of a rung, from those above it that are known, two at least.
    fn estimate(&mut self, rung: usize) -> Estimate {
        for needed in rung..=rung + ABOVE {
            self.trace(needed);
            if self.interrupted() {
                return Estimate { error: f64::INFINITY, of: "interrupted".into() };
            }
        }
        largest(&self.known(rung))
    }

    /// The values found with a rung and those above it.
    fn known(&self, rung: usize) -> Vec<&Outcome> {
        self.found[rung..].iter().flatten().collect()
    }

    /// The lowest rung whose estimated error is below an accuracy; or the highest one, whose is
    /// not.
    fn choose(&mut self, accuracy: f64) -> (usize, Estimate) {
        let last = self.rungs.len() - 1 - ABOVE;
        // A rung gains a digit, and the first one has two.
        let digits = -accuracy.log10();
        let mut rung = ((digits - 2.0).round().max(0.0) as usize).min(last);
        let mut estimate = self.estimate(rung);
        while estimate.error > accuracy && rung < last && !self.interrupted() {
            let missing = (estimate.error / accuracy).log10();
            rung += if missing.is_finite() { (missing as usize).max(1) } else { 1 };
            rung = rung.min(last);
            estimate = self.estimate(rung);
        }
        while rung > 0 && estimate.error <= accuracy {
            let lower = self.estimate(rung - 1);
            if lower.error > accuracy {
                break;
            }
            (rung, estimate) = (rung - 1, lower);
        }
        (rung, estimate)
    }
}

/// Traces runs with the cheapest discretisation that meets an accuracy, and notes the choice in the
/// document. Branches are shown when the choice is made. Gives the runs on the rung that was
/// chosen, too.
pub(super) fn traced_to(
    accuracy: f64,
    resolution: &Resolution,
    observer: &mut dyn SceneObserver,
) -> (Outcome, Resolution) {
    let rungs = resolution.rungs();
    let (ladder, rungs): (Vec<Problem>, Vec<Resolution>) = match rungs {
        Ok(rungs) => rungs.into_iter().unzip(),
        Err(cause) => {
            return (Outcome::failed(resolution.scene(), cause), resolution.clone());
        }
    };
    let found = vec![None; ladder.len()];
    let mut search = Search { rungs, found, observer: Unseen(&mut *observer) };
    let (rung, Estimate { error: estimate, of }) = search.choose(accuracy);
    let interrupted = search.interrupted();
    let mut outcome = search.trace(rung).clone();
    let chosen = Chosen { accuracy, settings: chosen(&ladder, rung), estimate, of };
    add_errors(&mut outcome.document, &search.known(rung));
    if estimate > accuracy && !interrupted {
        let unmet = || SceneError::Unmet { chosen: Box::new(chosen.clone()) };
        outcome.error.get_or_insert_with(unmet);
    }
    outcome.document.chosen = Some(chosen);
    let on_rung = search.rungs.swap_remove(rung);
    for branch in &outcome.document.branches {
        observer.begin(branch);
        branch.special.iter().for_each(|special| observer.special(branch, special));
    }
    (outcome, on_rung)
}

/// What of the settings differs along a ladder, on one rung of it.
fn chosen(ladder: &[Problem], rung: usize) -> Vec<(String, String)> {
    let names = varied(ladder);
    let settings = ladder[rung].settings().into_iter();
    settings.filter(|(name, _)| names.contains(name)).collect()
}

/// The names of the settings that differ along a ladder.
fn varied(ladder: &[Problem]) -> Vec<String> {
    let [Some(first), Some(last)] = [ladder.first(), ladder.last()] else { return Vec::new() };
    let pairs = first.settings().into_iter().zip(last.settings());
    pairs.filter(|(a, b)| a.1 != b.1).map(|((name, _), _)| name).collect()
}

impl Resolution {
    /// The same runs by discretisations of growing accuracy, with the problem on each of them.
    fn rungs(&self) -> Result<Vec<(Problem, Resolution)>, SceneError> {
        let rung = |problem: Problem| {
            let resolution = self.scene().on(&problem).resolve(self.start())?;
            Ok((problem, resolution))
        };
        self.scene().ladder()?.into_iter().map(rung).collect()
    }
}

impl Scene {
    /// The problem by discretisations of growing accuracy, for what all runs need.
    fn ladder(&self) -> Result<Vec<Problem>, SceneError> {
        let values = self.values()?;
        self.problem.ladder(&values, &reach(&self.problem, &self.runs, &values))
    }

    /// The scene on one rung of the ladder, whose special points are not refined any further.
    fn on(&self, problem: &Problem) -> Scene {
        let settings = Settings { refinement: 0.0, ..self.settings.clone() };
        Scene { problem: problem.clone(), settings, accuracy: None, ..self.clone() }
    }

    /// Refuses an accuracy that cannot be asked for, or beside what it chooses.
    pub(super) fn check_accuracy(&self) -> Result<(), SceneError> {
        let Some(accuracy) = self.accuracy else { return Ok(()) };
        if !RANGE.contains(&accuracy) {
            return refused(accuracy.to_string(), "must be between 1e-12 and 0.1");
        }
        let ladder = self.ladder()?;
        if ladder.len() <= ABOVE {
            let rule = "has nothing to choose from: this problem has no discretisation of its own";
            return refused(accuracy.to_string(), rule);
        }
        let names = varied(&ladder);
        let (own, mut defaults) = (self.problem.settings(), self.problem.with_defaults());
        for (name, value) in own.iter().filter(|(name, _)| self.problem.model().chooses(name)) {
            defaults.set(name, value)?;
        }
        let stated = own.into_iter().zip(defaults.settings());
        let mut different = stated.filter(|(own, default)| own != default).map(|(own, _)| own.0);
        if let Some(name) = different.find(|name| names.contains(name)) {
            return refused(format!("stated beside `{name}`"), DECIDES);
        }
        self.runs.iter().try_for_each(|run| self.check_accuracy_of(run, &names))
    }

    /// Refuses a run that is discretised otherwise than by the settings chosen.
    fn check_accuracy_of(&self, run: &Run, names: &[String]) -> Result<(), SceneError> {
        let decides = |name: &str| names.iter().any(|known| known == name) || name == "refinement";
        if let Some((name, _)) = run.set.iter().find(|(name, _)| decides(name)) {
            return refused(format!("stated beside `{name}` by the run `{}`", run.name), DECIDES);
        }
        if run.local.is_some() {
            let found = format!("stated for the run `{}` of a local map", run.name);
            return refused(found, "is of flows: that of a map is its distance from the grazing");
        }
        let Resolved { problem, values, reach, .. } = self.resolved(run)?;
        let own = varied(&problem.ladder(&values, &reach)?);
        match own.iter().find(|name| !names.contains(name)) {
            Some(name) => refused(
                format!("stated for the run `{}`, which has `{name}`", run.name),
                "chooses one discretisation for all runs",
            ),
            None => Ok(()),
        }
    }
}

/// The rule for what accuracy stands in place of.
const DECIDES: &str = "is what decides it: leave one of both out";

fn refused(found: String, rule: &str) -> Result<(), SceneError> {
    Err(SceneError::invalid("`accuracy`", found, rule))
}

/// The end of a branch at a special point.
fn end_at<'a>(branch: &'a Branch, special: &SpecialPoint) -> Option<&'a End> {
    branch.ends.iter().find(|end| end.to_string() == special.event)
}

/// Which special points count.
#[derive(Clone, Copy, PartialEq)]
enum Counted {
    /// All but ends.
    Special,
    /// Ends at bounds, too.
    Ends,
}

/// Whether discretisations must agree on a special point. An end may be anywhere unless it is at a
/// bound, at a grazing, or the start.
fn is_definite(branch: &Branch, special: &SpecialPoint, counted: Counted) -> bool {
    let fixed = |end: &End| {
        use End::{Event, Grazing, MonitorBound, ParameterBound, Start};
        matches!(
            end,
            ParameterBound { .. } | MonitorBound { .. } | Grazing { .. } | Event { .. } | Start
        )
    };
    let end = || counted == Counted::Ends && end_at(branch, special).is_some_and(fixed);
    special.kind != Kind::EP || end()
}

/// The columns that the accuracy concerns at a special point: the released parameters and the ones
/// that the setting `refine` names, but for the one whose level defines the point. The start is
/// where it was put.
fn columns(branch: &Branch, special: &SpecialPoint) -> Vec<usize> {
    let given = match end_at(branch, special) {
        Some(End::Start) => return Vec::new(),
        Some(End::ParameterBound { name, .. } | End::MonitorBound { name, .. }) => Some(&**name),
        _ => special.event.split(" = ").next(),
    };
    let names = branch.released.iter().chain(&branch.settings.refine);
    names.filter(|name| given != Some(name)).filter_map(|name| branch.column(name)).collect()
}

/// What an error is relative to: the value itself, and where it passes zero a hundredth of the
/// largest on the branch. Below the precision of numbers about 1 is rounding: the deflection of a
/// flat plate.
fn size(branch: &Branch, column: usize, value: f64) -> f64 {
    let points = branch.points.iter().filter_map(|point| point.value(column));
    let largest = points.fold(0.0, |size: f64, value| size.max(value.abs()));
    value.abs().max(0.01 * largest).max(f64::EPSILON)
}

/// An error without bound, and why.
fn unlike(of: impl Into<String>) -> Estimate {
    Estimate { error: f64::INFINITY, of: of.into() }
}

/// The error of a column of a special point on the first of some rungs.
fn error_in(column: usize, rungs: &[&SpecialPoint]) -> f64 {
    let values = rungs.iter().map(|special| special.value(column));
    match values.collect::<Option<Vec<f64>>>() {
        Some(values) if values.iter().all(|value| value.is_finite()) => error_of_first(&values),
        _ => f64::INFINITY,
    }
}

/// The definite special points of a branch, each on one rung after another; `None` if they are
/// others on another rung.
fn followed<'a>(rungs: &[&'a Branch], counted: Counted) -> Option<Vec<Vec<&'a SpecialPoint>>> {
    let definite = |branch: &&'a Branch| -> Vec<&'a SpecialPoint> {
        let definite = |special: &&SpecialPoint| is_definite(branch, special, counted);
        branch.special.iter().filter(definite).collect()
    };
    let all: Vec<Vec<&SpecialPoint>> = rungs.iter().map(definite).collect();
    let first = all.first()?;
    let same = |(a, b): (&&SpecialPoint, &&SpecialPoint)| {
        a.kind == b.kind && (a.kind != Kind::EP || a.event == b.event)
    };
    let alike = |on: &Vec<_>| on.len() == first.len() && on.iter().zip(first).all(same);
    let point = |k: usize| all.iter().map(|on| on[k]).collect();
    all.iter().all(alike).then(|| (0..first.len()).map(point).collect())
}

/// The branch at this place among those of each result.
fn nth<'a>(found: &[&'a Outcome], place: usize) -> Vec<&'a Branch> {
    found.iter().filter_map(|outcome| outcome.document.branches.get(place)).collect()
}

/// The largest relative error of special points in the first result, by finer ones. Where there are
/// no others, ends at bounds are held to the accuracy.
fn largest(found: &[&Outcome]) -> Estimate {
    if let Some(cause) = found.iter().find_map(|outcome| outcome.error.as_ref()) {
        return unlike(cause.to_string());
    }
    let all = largest_of(found, Counted::Special).or_else(|| largest_of(found, Counted::Ends));
    all.unwrap_or_else(|| unlike("no special point to hold it to: state one by `marks`"))
}

/// The largest error of those points that count; `None` without any.
fn largest_of(found: &[&Outcome], counted: Counted) -> Option<Estimate> {
    let mut largest: Option<Estimate> = None;
    for place in 0..found[0].document.branches.len() {
        let rungs = nth(found, place);
        let branch = rungs[rungs.len() - 1];
        let Some(points) = followed(&rungs, counted) else {
            let words = format!("special points of `{}` come and go with it", branch.name);
            return Some(unlike(words));
        };
        for point in points {
            let special = point[point.len() - 1];
            for column in columns(branch, special) {
                let value = special.value(column).unwrap_or(f64::NAN);
                let error = error_in(column, &point) / size(branch, column, value);
                if special.kind == Kind::EP && error == 0.0 {
                    // An end that is the same on all rungs was given.
                    continue;
                }
                if largest.as_ref().is_none_or(|largest| error > largest.error) {
                    let of = format!("{} of `{}`", special.event, branch.name);
                    largest = Some(Estimate { error, of });
                }
            }
        }
    }
    largest
}

/// Adds the errors of the discretisation to those of special points, by the results on this rung
/// and finer ones.
fn add_errors(document: &mut Document, found: &[&Outcome]) {
    for (place, branch) in document.branches.iter_mut().enumerate() {
        let rungs = nth(found, place);
        let column = branch.released.first().and_then(|name| branch.column(name));
        let all = followed(&rungs, Counted::Ends);
        if all.is_none() {
            // Ends that come and go with the discretisation are not known.
            let ends = branch.special.iter_mut().filter(|own| own.kind == Kind::EP);
            ends.for_each(|own| own.converged = false);
        }
        let points = all.or_else(|| followed(&rungs, Counted::Special));
        let (Some(points), Some(column)) = (points, column) else { continue };
        for point in points {
            let own = branch.special.iter_mut().filter(|own| own.label == point[0].label);
            own.for_each(|own| own.error += error_in(column, &point));
        }
    }
}
