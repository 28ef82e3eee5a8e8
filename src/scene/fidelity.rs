//! The choice of the cheapest discretisation that computes the special points with the requested
//! accuracy.
//!
//! A problem has a list of discretisations, ordered from the cheapest to the most expensive. With
//! discretisation `k`, a scene yields numbers `v_k`: the varied parameters of every special point,
//! and the columns that the setting `refine` names. All errors of these numbers are relative
//! errors. The numbers of a discretisation are compared with the numbers of the next two
//! discretisations, and of all finer discretisations that have been computed, by
//! [`error_of_first`]. The search starts at a guessed discretisation. If the estimated error of
//! this discretisation is below the requested accuracy, the search proceeds to coarser
//! discretisations, up to the coarsest one whose error is below the accuracy; otherwise it proceeds
//! to finer discretisations.

use super::error::SceneError;
use super::ladder::{ABOVE, Ladder};
use super::observer::SceneObserver;
use super::resolve::Resolution;
use super::trace::{Outcome, traced};
use crate::core::continuation::{Branch, End, Observer, Point, SpecialPoint};
use crate::core::failure::one_line;
use crate::core::numerics::error_of_first;
use crate::core::system::Kind;
use crate::output::{Chosen, Document};
use std::time::Duration;

/// An observer of trial computations with a discretisation: it passes on the user's cancellation,
/// but shows no results.
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

/// An estimated error, with the special point at which the error occurs.
#[derive(Clone, Debug, PartialEq)]
struct Estimate {
    error: f64,
    of: String,
}

/// The discretisations of a scene, ordered from coarse to fine, and the outcomes with the
/// discretisations that have already been computed.
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

    /// Returns whether a trial computation with a discretisation was interrupted.
    fn interrupted(&self) -> bool {
        let branches = self.found.iter().flatten().flat_map(|outcome| &outcome.document.branches);
        branches.into_iter().any(|branch| branch.ends.contains(&End::Interrupted))
    }

    /// Computes the next two discretisations that are finer than a given one, and estimates the
    /// error of the given one from all finer discretisations that have been computed.
    fn estimate(&mut self, rung: usize) -> Estimate {
        for needed in rung..=rung + ABOVE {
            self.trace(needed);
            if self.interrupted() {
                return Estimate { error: f64::INFINITY, of: "interrupted".into() };
            }
        }
        largest(&self.known(rung))
    }

    /// Returns the outcome with a discretisation, followed by the outcomes with all finer
    /// discretisations that have been computed.
    fn known(&self, rung: usize) -> Vec<&Outcome> {
        self.found[rung..].iter().flatten().collect()
    }

    /// Returns the coarsest discretisation whose estimated error is below an accuracy, or the
    /// finest discretisation whose error can be estimated if no estimated error is below the
    /// accuracy.
    fn choose(&mut self, accuracy: f64) -> (usize, Estimate) {
        let last = self.rungs.len() - 1 - ABOVE;
        // Each rung gains a digit, and the first one has two.
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

/// Traces runs with the cheapest discretisation that reaches an accuracy, and records the choice in
/// the document. Branches are shown to the observer only after the discretisation has been chosen.
/// Also returns the runs with the chosen discretisation.
pub(super) fn traced_to(
    accuracy: f64,
    resolution: &Resolution,
    observer: &mut dyn SceneObserver,
) -> (Outcome, Resolution) {
    let ladder = Ladder::of_scene(resolution.scene());
    let resolved = ladder.and_then(|ladder| Ok((ladder.resolutions(resolution)?, ladder)));
    let (rungs, ladder) = match resolved {
        Ok(resolved) => resolved,
        Err(cause) => return (Outcome::failed(resolution.scene(), cause), resolution.clone()),
    };
    let found = vec![None; rungs.len()];
    let mut search = Search { rungs, found, observer: Unseen(&mut *observer) };
    let (rung, Estimate { error: estimate, of }) = search.choose(accuracy);
    let interrupted = search.interrupted();
    let mut outcome = search.trace(rung).clone();
    let chosen = Chosen { accuracy, settings: ladder.settings(rung), estimate, of };
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

/// Returns the end of the branch that a special point marks; `None` if the special point is not at
/// an end.
fn end_at<'a>(branch: &'a Branch, special: &SpecialPoint) -> Option<&'a End> {
    branch.ends.iter().find(|end| end.to_string() == special.event)
}

/// The kinds of special points that are compared between discretisations.
#[derive(Clone, Copy, PartialEq)]
enum Counted {
    /// All special points except the ends of branches are compared.
    Special,
    /// All special points are compared, and also the ends of branches that are at bounds, events or
    /// grazings.
    Ends,
}

/// Returns whether a special point must be found with every discretisation. The end of a branch may
/// differ between discretisations unless the end is at a bound, an event or a grazing, or is the
/// start of the branch.
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

/// Returns the columns at a special point to which the requested accuracy applies: the varied
/// parameters and the columns that the setting `refine` names, except the column whose given value
/// defines the point. The requested accuracy does not apply to columns at the start of a branch.
fn columns(branch: &Branch, special: &SpecialPoint) -> Vec<usize> {
    let given = match end_at(branch, special) {
        Some(End::Start) => return Vec::new(),
        Some(End::ParameterBound { name, .. } | End::MonitorBound { name, .. }) => Some(&**name),
        _ => special.event.split(" = ").next(),
    };
    let names = branch.released.iter().chain(&branch.settings.refine);
    names.filter(|name| given != Some(name)).filter_map(|name| branch.column(name)).collect()
}

/// Returns the reference value by which an error is divided to give a relative error: the absolute
/// value of the number itself, or a hundredth of the largest absolute value on the branch,
/// whichever is larger. The reference value is at least the rounding error of numbers of order 1,
/// which matters for instance for the deflection of a flat plate.
fn size(branch: &Branch, column: usize, value: f64) -> f64 {
    let points = branch.points.iter().filter_map(|point| point.value(column));
    let largest = points.fold(0.0, |size: f64, value| size.max(value.abs()));
    value.abs().max(0.01 * largest).max(f64::EPSILON)
}

/// Returns an infinite estimated error, together with the reason why it is infinite.
fn unlike(of: impl Into<String>) -> Estimate {
    Estimate { error: f64::INFINITY, of: of.into() }
}

/// Returns the estimated error of the first of the given discretisations, for the value of a column
/// at a special point.
fn error_in(column: usize, rungs: &[&SpecialPoint]) -> f64 {
    let values = rungs.iter().map(|special| special.value(column));
    match values.collect::<Option<Vec<f64>>>() {
        Some(values) if values.iter().all(|value| value.is_finite()) => error_of_first(&values),
        _ => f64::INFINITY,
    }
}

/// Returns the special points of a branch that must be found with every discretisation, each as
/// computed with all discretisations; `None` if different discretisations found different points.
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

/// Returns, for each outcome, the branch with a given index.
fn nth<'a>(found: &[&'a Outcome], place: usize) -> Vec<&'a Branch> {
    found.iter().filter_map(|outcome| outcome.document.branches.get(place)).collect()
}

/// Returns the largest relative error of special points in the first outcome, estimated from the
/// outcomes with finer discretisations. If a scene has no special points other than ends of
/// branches, the ends at bounds are compared.
fn largest(found: &[&Outcome]) -> Estimate {
    if let Some(cause) = found.iter().find_map(|outcome| outcome.error.as_ref()) {
        return unlike(one_line(cause));
    }
    let all = largest_of(found, Counted::Special).or_else(|| largest_of(found, Counted::Ends));
    all.unwrap_or_else(|| {
        unlike(
            "the result has no special point at which the accuracy can be measured: add a value to \
             `marks`",
        )
    })
}

/// Returns the largest error among the special points that are compared; `None` if the outcomes
/// contain no such points.
fn largest_of(found: &[&Outcome], counted: Counted) -> Option<Estimate> {
    let mut largest: Option<Estimate> = None;
    for place in 0..found[0].document.branches.len() {
        let rungs = nth(found, place);
        let branch = rungs[rungs.len() - 1];
        let Some(points) = followed(&rungs, counted) else {
            let words = format!(
                "special points of `{}` appear and disappear with the discretisation",
                branch.name
            );
            return Some(unlike(words));
        };
        for point in points {
            let special = point[point.len() - 1];
            for column in columns(branch, special) {
                let value = special.value(column).unwrap_or(f64::NAN);
                let error = error_in(column, &point) / size(branch, column, value);
                if special.kind == Kind::EP && error == 0.0 {
                    // An end that agrees on all rungs was prescribed.
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

/// Adds the discretisation error to the error of each special point; the discretisation error is
/// estimated from this discretisation and finer ones.
fn add_errors(document: &mut Document, found: &[&Outcome]) {
    for (place, branch) in document.branches.iter_mut().enumerate() {
        let rungs = nth(found, place);
        let column = branch.released.first().and_then(|name| branch.column(name));
        let all = followed(&rungs, Counted::Ends);
        if all.is_none() {
            // Ends that appear and disappear with the discretisation have no known error.
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
