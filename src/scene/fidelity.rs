//! The cheapest discretisation with which special points have the accuracy that a scene asks for.
//!
//! A problem has a ladder of discretisations, cheapest first. With rung `k` a scene finds numbers `v_k`: the released
//! parameters and the first monitor of every special point, relative to themselves. If each rung halves the error at least, that of rung `k` is
//!
//! `|v_k − v| ≤ |v_k − v_f| / (1 − 2^{k−f})`,  `f ≥ k + 2`,
//!
//! and `4/3 |v_k − v_f|` at most. A difference may be small by accident, so that the estimate of a rung is the larger one
//! of its own and the next rung's. The rung taken is the lowest one whose estimate is below the accuracy, of those from
//! a first guess downwards; or upwards, where the guess does not suffice.

use super::execute::{Outcome, SceneObserver, StartPoint, reach, traced};
use super::{Problem, Run, Scene, SceneError};
use crate::core::continuation::{Branch, End, Kind, Observer, Point, Settings, SpecialPoint};
use crate::output::{Chosen, Document};
use std::ops::{ControlFlow, RangeInclusive};

/// Accuracies that can be asked for.
const RANGE: RangeInclusive<f64> = 1e-12..=0.1;

/// How many rungs finer the discretisation is at least that others are compared with.
const ABOVE: usize = 2;

/// The bound of an error by the difference from that many rungs above.
const BOUND: f64 = 4.0 / 3.0;

/// A trial is watched for Ctrl-C, and not shown.
struct Unseen<'a>(&'a mut dyn SceneObserver);

impl Observer for Unseen<'_> {
    fn point(&mut self, point: &Point) -> ControlFlow<()> {
        self.0.point(point)
    }
}

impl SceneObserver for Unseen<'_> {}

/// An estimated error, and where it is.
#[derive(Clone, Debug, PartialEq)]
struct Estimate {
    error: f64,
    of: String,
}

/// The rungs of a scene, and what was found with them.
struct Search<'a> {
    rungs: Vec<Scene>,
    found: Vec<Option<Outcome>>,
    start: Option<&'a StartPoint>,
    observer: Unseen<'a>,
}

impl Search<'_> {
    fn trace(&mut self, rung: usize) -> &Outcome {
        let Search { rungs, found, start, observer } = self;
        found[rung].get_or_insert_with(|| traced(&rungs[rung], *start, observer))
    }

    /// Whether a trial was interrupted.
    fn interrupted(&self) -> bool {
        let branches = self.found.iter().flatten().flat_map(|outcome| &outcome.document.branches);
        branches.into_iter().any(|branch| branch.ends.contains(&End::Interrupted))
    }

    /// The error of a rung, from the finest one that is known.
    fn estimate(&mut self, rung: usize) -> Estimate {
        for needed in rung..=rung + ABOVE {
            self.trace(needed);
            if self.interrupted() {
                return Estimate { error: f64::INFINITY, of: "interrupted".into() };
            }
        }
        let fine = self.found.iter().flatten().next_back();
        let against = |rung: usize| match (&self.found[rung], fine) {
            (Some(rough), Some(fine)) => difference(rough, fine),
            _ => unlike("a rung that was not traced"),
        };
        let [own, next] = [against(rung), against(rung + 1)];
        let Estimate { error, of } = if own.error >= next.error { own } else { next };
        Estimate { error: BOUND * error, of }
    }

    /// The lowest rung whose estimated error is below an accuracy; or the highest one, whose is not.
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

/// Traces a scene with the cheapest discretisation that meets its accuracy, and notes the choice in the document. Branches
/// are shown when the choice is made.
pub(super) fn traced_to(
    accuracy: f64,
    scene: &Scene,
    start: Option<&StartPoint>,
    observer: &mut dyn SceneObserver,
) -> Outcome {
    let ladder = match scene.ladder() {
        Ok(ladder) => ladder,
        Err(cause) => {
            let document = Document::new(scene.title.clone(), Vec::new());
            return Outcome { document, error: Some(cause) };
        }
    };
    let rungs = ladder.iter().map(|problem| scene.on(problem)).collect();
    let found = vec![None; ladder.len()];
    let mut search = Search { rungs, found, start, observer: Unseen(&mut *observer) };
    let (rung, Estimate { error: estimate, of }) = search.choose(accuracy);
    let interrupted = search.interrupted();
    let mut outcome = search.trace(rung).clone();
    let chosen = Chosen { accuracy, settings: chosen(&ladder, rung), estimate, of };
    let mut finer = search.found[rung + 1..].iter().flatten();
    if let (Some(next), Some(fine)) = (finer.next(), finer.next_back()) {
        add_errors(&mut outcome.document, &next.document, &fine.document);
    }
    if estimate > accuracy && !interrupted {
        let unmet = || SceneError::Unmet { chosen: Box::new(chosen.clone()) };
        outcome.error.get_or_insert_with(unmet);
    }
    outcome.document.chosen = Some(chosen);
    for branch in &outcome.document.branches {
        observer.begin(branch);
        branch.special.iter().for_each(|special| observer.special(branch, special));
    }
    outcome
}

/// What of the settings differs along a ladder, on one rung of it.
fn chosen(ladder: &[Problem], rung: usize) -> Vec<(String, String)> {
    let names = varied(ladder);
    let settings = ladder[rung].settings().into_iter();
    let those = settings.filter(|(name, _)| names.contains(name));
    those.map(|(name, value)| (name.to_string(), value)).collect()
}

/// The names of the settings that differ along a ladder.
fn varied(ladder: &[Problem]) -> Vec<&'static str> {
    let [Some(first), Some(last)] = [ladder.first(), ladder.last()] else { return Vec::new() };
    let pairs = first.settings().into_iter().zip(last.settings());
    pairs.filter(|(a, b)| a.1 != b.1).map(|((name, _), _)| name).collect()
}

impl Scene {
    /// The problem by discretisations of growing accuracy, for what all runs need.
    fn ladder(&self) -> Result<Vec<Problem>, SceneError> {
        let values = self.values()?;
        self.problem.ladder(&values, &reach(self, &self.runs, &values))
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
        let defaults = self.problem.with_defaults().settings();
        let stated = self.problem.settings().into_iter().zip(defaults);
        let mut different = stated.filter(|(own, default)| own != default).map(|(own, _)| own.0);
        if let Some(name) = different.find(|name| names.contains(name)) {
            return refused(format!("stated beside `{name}`"), DECIDES);
        }
        self.runs.iter().try_for_each(|run| self.check_accuracy_of(run, &names))
    }

    /// Refuses a run that is discretised otherwise than by the settings chosen.
    fn check_accuracy_of(&self, run: &Run, names: &[&str]) -> Result<(), SceneError> {
        let decides = |name: &str| names.contains(&name) || name == "refinement";
        if let Some((name, _)) = run.set.iter().find(|(name, _)| decides(name)) {
            return refused(format!("stated beside `{name}` by the run `{}`", run.name), DECIDES);
        }
        if run.local.is_some() {
            let found = format!("stated for the run `{}` of a local map", run.name);
            return refused(found, "is of flows: that of a map is its distance from the grazing");
        }
        let own = varied(&self.as_seen_by(run)?.ladder()?);
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
    Err(SceneError::Invalid { place: "`accuracy`".into(), found, rule: rule.into() })
}

/// Special points that methods must agree on: all but ends, which may be anywhere.
fn definite(branch: &Branch) -> impl Iterator<Item = &SpecialPoint> {
    branch.special.iter().filter(|special| special.kind != Kind::EP)
}

/// The released parameters and the first monitor.
fn columns(branch: &Branch) -> Vec<usize> {
    let names = branch.released.iter().chain(branch.monitors.first());
    names.filter_map(|name| branch.column(name)).collect()
}

/// What an error is relative to: the value itself, and where it passes zero a hundredth of the largest on the branch. Below
/// the precision of numbers about 1 is rounding: the deflection of a flat plate.
fn size(branch: &Branch, column: usize, value: f64) -> f64 {
    let points = branch.points.iter().filter_map(|point| point.value(column));
    let largest = points.fold(0.0, |size: f64, value| size.max(value.abs()));
    value.abs().max(0.01 * largest).max(f64::EPSILON)
}

/// An error without bound, and why.
fn unlike(of: impl Into<String>) -> Estimate {
    Estimate { error: f64::INFINITY, of: of.into() }
}

/// The largest difference between special points of a rung and of a finer one, relative to what they measure.
fn difference(rough: &Outcome, fine: &Outcome) -> Estimate {
    if let Some(cause) = rough.error.as_ref().or(fine.error.as_ref()) {
        return unlike(cause.to_string());
    }
    let mut largest = Estimate { error: -1.0, of: String::new() };
    for (rough, branch) in rough.document.branches.iter().zip(&fine.document.branches) {
        let kinds = |branch: &Branch| definite(branch).map(|s| s.kind).collect::<Vec<_>>();
        if kinds(rough) != kinds(branch) {
            return unlike(format!("special points of `{}` come and go with it", branch.name));
        }
        for (a, b) in definite(rough).zip(definite(branch)) {
            for column in columns(branch) {
                let [a, b] = [a, b].map(|special| special.value(column).unwrap_or(f64::NAN));
                let error = (a - b).abs() / size(branch, column, b);
                if error.is_nan() || error > largest.error {
                    let error = if error.is_nan() { f64::INFINITY } else { error };
                    largest = Estimate { error, of: String::new() };
                }
            }
            if largest.of.is_empty() {
                largest.of = format!("{} of `{}`", b.event, branch.name);
            }
        }
    }
    match largest.error < 0.0 {
        true => unlike("no special point to hold it to: state one by `marks`"),
        false => largest,
    }
}

/// Adds what the discretisation adds to the errors of special points: from what they are on this rung and the next one.
fn add_errors(document: &mut Document, next: &Document, fine: &Document) {
    let branches = document.branches.iter_mut().zip(&next.branches).zip(&fine.branches);
    for ((branch, next), fine) in branches {
        let Some(column) = columns(fine).first().copied() else { continue };
        let values = |branch: &Branch| -> Vec<f64> {
            let values = definite(branch).map(|special| special.value(column));
            values.map(|value| value.unwrap_or(f64::NAN)).collect()
        };
        let (own, next, fine) = (values(branch), values(next), values(fine));
        let special = branch.special.iter_mut().filter(|special| special.kind != Kind::EP);
        for (special, ((own, next), fine)) in special.zip(own.iter().zip(&next).zip(&fine)) {
            special.error += BOUND * (own - fine).abs().max((next - fine).abs());
        }
    }
}
