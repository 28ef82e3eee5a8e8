//! Running along a curve: step after step, event after event, to an end with a reason.

use super::branch::{Half, Traced};
use super::closing::Reference;
use super::early_end::EarlyEnd;
use super::event::Event;
use super::hermite::MOST_KNOTS;
use super::located::Located;
use super::metric::Metric;
use super::stepper::{AT_START, Before, Place, Step, Stepper};
use super::unexplained::LEAST_UNEXPLAINED;
use super::{Branch, End, Kind, Point, Settings, SpecialPoint, TraceError};
use crate::core::condition::Quantity;
use crate::core::solution::Solution;
use crate::core::test_function::{Test, VERTICAL};
use std::collections::VecDeque;

/// A trace under way.
pub(super) struct Tracer<'a> {
    pub stepper: Stepper<'a>,
    pub branch: Branch,
    pub start: Place,
    /// The bounds, which are the first events.
    pub bounds: Vec<Bound>,
    /// How fast the levels' test functions grow at the start.
    pub slopes: Vec<f64>,
    /// Whether to trace backward, forward.
    pub directions: [bool; 2],
    /// Whether the start is a branch point that the curve leaves: where it is a pitchfork, the
    /// parameter turns there, which is no fold.
    pub from_branch_point: bool,
    /// The error of the special point that the start is.
    pub error: f64,
    /// The kinds of the special point that the start is, and of the curve that it lies on.
    pub origin: Vec<Kind>,
    /// How many labels have been given.
    pub labels: usize,
    /// What has been traced, and nobody has seen.
    pub shown: VecDeque<Traced>,
}

/// One of the two halves of a branch while it is traced.
pub(super) struct Walk {
    pub half: Half,
    pub backward: bool,
    /// The last point, and the start, which follows its mesh.
    place: Place,
    start: Place,
    /// Where the curve is met again, if it is closed.
    closing: Option<Reference>,
    /// The length of the next step.
    length: f64,
    /// The places before the last one.
    before: Vec<Before>,
    early_end: EarlyEnd,
    /// Whether the continued parameter has turned, as it must before a curve can close.
    turned: bool,
    /// The end, if it leaves its bounds at once.
    end: Option<End>,
}

impl Walk {
    /// Takes back a step that was refused: the next one is of this length, and is forecast anew.
    fn try_again(&mut self, length: f64) -> Option<End> {
        self.length = length;
        self.place.quiet = 0.0;
        None
    }
}

/// A step that ends on a special point is made shorter by this factor.
const BESIDE: f64 = 0.93;

/// A level that bounds a branch.
pub(super) struct Bound {
    /// −1 for a lower bound, 1 for an upper one.
    pub side: f64,
    /// The range that it belongs to.
    pub range: [f64; 2],
}

/// How a run ends with a step, and the last point if it lies within the step.
type Ending = (End, Option<Located>);

impl Tracer<'_> {
    /// Whether the work was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.stepper.settings.cancel.is_cancelled()
    }

    /// Refuses a start beyond a bound.
    pub fn check_bounds(&self) -> Result<(), TraceError> {
        let beyond = self.bounds.iter().enumerate().find_map(|(i, bound)| {
            let test = self.start.tests[i].filter(|test| test * bound.side > 0.0)?;
            let Event { name, test: function, .. } = &self.stepper.events[i];
            Some((name.clone(), function.level()?.1 + test, bound.range))
        });
        match beyond {
            Some((name, value, [low, high])) => {
                Err(TraceError::OutOfRange { name, value, low, high })
            }
            None => Ok(()),
        }
    }

    /// The marks that the start lies on.
    pub fn marked_start(&mut self) -> Vec<SpecialPoint> {
        let start = self.start.clone();
        let events = self.stepper.events.iter().zip(&start.tests).skip(self.bounds.len());
        let on_mark = |(event, test): &(&Event, &Option<f64>)| {
            event.kind == Kind::UZ && event.test.level().is_some() && **test == Some(0.0)
        };
        let names: Vec<String> =
            events.filter(on_mark).map(|(event, _)| event.name.clone()).collect();
        let mut half = Half::new(End::Start);
        for name in names {
            let mut special = self.stepper.end_point(&start, &End::Start, 0);
            (special.kind, special.event) = (Kind::UZ, name);
            self.stepper.refine_start(&mut special);
            self.mark(&mut half, special);
        }
        half.special
    }

    /// Gives the system the mesh of the start back, which may have followed the branch, and forgets
    /// all that has been learned on the way: each half of a branch is what it would be alone.
    pub fn return_to(&mut self, start: &Place, home: &Solution, metric: Metric) {
        if !home.mesh.is_empty() {
            // It was a solution on this mesh; if it is none any more, the first step says so.
            let _ = self.stepper.equations.system().resume_from(home);
        }
        self.stepper.restore(&start.unknowns, metric);
    }

    /// Nothing but the start, as an end of the branch.
    pub fn no_half(&mut self, end: End) -> Half {
        let start = self.start.clone();
        let mut special = self.stepper.end_point(&start, &end, 0);
        if self.from_branch_point {
            // The equations are singular there; it was finished where it was found.
            special.error = self.error.max(special.error);
        } else {
            self.stepper.refine_start(&mut special);
        }
        let mut half = Half::new(end);
        self.mark(&mut half, special);
        half
    }

    /// Sets out from the start, or from the start seen in the other direction.
    pub fn set_out(&mut self, start: Place, backward: bool) -> Walk {
        let closing = self.reference(&start, backward);
        let Settings { max_step, initial_step, .. } = self.stepper.settings;
        Walk {
            half: Half::new(End::Start),
            place: start.clone(),
            start,
            closing,
            backward,
            length: initial_step.min(max_step),
            before: Vec::new(),
            early_end: EarlyEnd::default(),
            turned: false,
            end: self.leaves_at_once(backward),
        }
    }

    /// The half of the branch that a walk has gone along, with its end.
    pub fn arrived(&mut self, walk: Walk, end: End) -> Half {
        let Walk { mut half, place, .. } = walk;
        half.end = end;
        let ended =
            half.special.last().is_some_and(|s| s.after == half.points.len() && s.after > 0);
        if !ended {
            let special = self.stepper.end_point(&place, &half.end, half.points.len());
            self.mark(&mut half, special);
        }
        half
    }

    /// Labels a special point, shows it, and adds it.
    fn mark(&mut self, half: &mut Half, mut special: SpecialPoint) {
        self.labels += 1;
        special.label = self.labels;
        self.shown.push_back(Traced::Special(Box::new(special.clone())));
        half.special.push(special);
    }

    /// Shows a point.
    pub fn show(&mut self, point: &Point) {
        self.shown.push_back(Traced::Point(point.clone()));
    }

    /// Goes on, by a step at most; the end, if something ends the half.
    pub fn advance(&mut self, walk: &mut Walk) -> Option<End> {
        if let Some(end) = walk.end.take() {
            return Some(end);
        }
        let Settings { max_points, min_step, max_step, .. } = self.stepper.settings;
        let points = walk.half.points.len();
        if points >= max_points {
            return Some(End::PointLimit { points });
        }
        let mut step = match self.stepper.step(&walk.before, &walk.place, walk.length) {
            Ok(step) => step,
            Err(_) if self.is_cancelled() => return Some(End::Interrupted),
            Err((step, cause)) => {
                return Some(End::StepTooSmall { step, cause: cause.to_string() });
            }
        };
        if self.stepper.ends_on_special_point(&walk.place, &step) {
            return walk.try_again(BESIDE * step.length);
        }
        if points == 0
            && let Some(index) = self.leaves(&walk.start, |i| step.place.tests[i].unwrap_or(0.0))
            && let Some(end) = self.bound_at(index, &walk.start)
        {
            return Some(end);
        }
        if let Some(before) = walk.before.first()
            && let Some(shorter) = self.stepper.hidden(before, &walk.place, &step)
        {
            step = shorter;
        }
        let found = self.explained(&walk.place, &step, walk.backward, points == 0);
        // What was looked for in vain need not be missing.
        if self.is_cancelled() {
            return Some(End::Interrupted);
        }
        let Some(mut found) = found else {
            return walk.try_again(0.5 * step.length);
        };
        walk.length = step.next.clamp(min_step, max_step);
        let ending = self.ending(&mut found, walk, &step);
        for Located { mut special, .. } in found {
            special.after = points;
            self.mark(&mut walk.half, special);
        }
        if let Some(ending) = ending {
            return Some(self.end_half(walk, ending));
        }
        let end = walk.early_end.reached(&mut self.stepper, &step.place, &walk.place);
        self.accept(walk, step);
        walk.half.points.push(walk.place.point.clone());
        self.save_regular(walk);
        self.show(&walk.place.point);
        end
    }

    /// The events in a step, if they explain how the number of unstable eigenvalues changes; `None`
    /// if a shorter step may.
    fn explained(
        &mut self,
        from: &Place,
        step: &Step,
        backward: bool,
        at_start: bool,
    ) -> Option<Vec<Located>> {
        let found = self.events_between(from, step, backward, at_start);
        let origin = if at_start { &self.origin[..] } else { &[] };
        let mut found = self.without_neutral_saddles(from, step, found, origin);
        if let Some(changed) = self.stepper.unexplained(from, step, &found, origin) {
            if step.length > LEAST_UNEXPLAINED {
                return None;
            }
            let unclassified = self.stepper.unclassified(from, step, changed);
            if unclassified.as_ref().is_some_and(|it| it.special.converged) {
                // Newton's iteration was at the same point, and did not converge.
                found.retain(|it| it.special.kind != Kind::BP || it.special.converged);
            }
            found.extend(unclassified);
            found.sort_by(|a, b| a.along.total_cmp(&b.along));
        }
        Some(found)
    }

    /// Saves the point if its number is a multiple of `save_every`.
    fn save_regular(&mut self, walk: &mut Walk) {
        let (points, every) = (walk.half.points.len(), self.stepper.settings.save_every);
        if every > 0 && points.is_multiple_of(every) {
            let (kind, words) = (Kind::RG, Kind::RG.meaning());
            let special = self.stepper.saved_point(&walk.place, kind, words, points);
            self.mark(&mut walk.half, special);
        }
    }

    /// Makes a step: the mesh follows, and what is to stay comparable with it.
    fn accept(&mut self, walk: &mut Walk, step: Step) {
        let Walk { before, place, start, turned, .. } = walk;
        let parameter = self.stepper.equations.parameters_at();
        let scale = self.stepper.weights[parameter].sqrt();
        let [first, last] =
            [&start.tangent, &step.place.tangent].map(|tangent| tangent[parameter] * scale);
        *turned |= first.abs().min(last.abs()) < VERTICAL || first * last < 0.0;
        let left = std::mem::replace(place, step.place);
        // A test function that is unknown at a point changes its sign, if it does, with the next
        // point at which it is known.
        for (test, before) in place.tests.iter_mut().zip(&left.tests) {
            *test = test.or(*before);
        }
        before.insert(0, Before { place: left, length: step.length });
        before.truncate(MOST_KNOTS - 1);
        let places =
            std::iter::once(start).chain(before.iter_mut().map(|before| &mut before.place));
        let others = places.flat_map(|other| [&mut other.unknowns[..], &mut other.tangent[..]]);
        self.stepper.settle(place, others.collect());
    }

    /// Records the last point, at which the run ends.
    fn end_half(&mut self, walk: &mut Walk, (end, at): Ending) -> End {
        let Walk { half, place, start, .. } = walk;
        // Where events lead elsewhere at the point before, they do here.
        let admissible = place.point.admissible;
        let last = at.as_ref().map_or(start.point.clone(), |last| {
            let last = self.point_of(&last.special);
            Point { admissible: last.admissible && admissible, ..last }
        });
        self.show(&last);
        half.points.push(last);
        let Some(Located { mut special, .. }) = at else {
            *place = start.clone();
            return end;
        };
        special.after = half.points.len();
        self.mark(half, special);
        end
    }

    fn point_of(&mut self, special: &SpecialPoint) -> Point {
        let admissible = self.stepper.is_admissible(&special.monitors, &special.parameters);
        Point { admissible, ..special.point() }
    }

    /// The end of a half that starts on a bound and is about to leave.
    pub fn leaves_at_once(&mut self, backward: bool) -> Option<End> {
        let way = if backward { -1.0 } else { 1.0 };
        let index = self.leaves(&self.start, |i| way * self.slopes[i])?;
        let start = self.start.clone();
        self.bound_at(index, &start)
    }

    /// The bound of a half that starts on it which such changes of the test functions lead beyond.
    fn leaves(&self, start: &Place, change: impl Fn(usize) -> f64) -> Option<usize> {
        let leaves =
            |i: &usize| start.tests[*i] == Some(0.0) && change(*i) * self.bounds[*i].side > 0.0;
        (0..self.bounds.len()).find(leaves)
    }

    /// The end at a bound that a place is on.
    fn bound_at(&mut self, index: usize, place: &Place) -> Option<End> {
        let subkind = self.stepper.subkind(index, (&place.unknowns, &place.point.parameters));
        self.bound(index, subkind)
    }

    /// The end at a bound; what the field calls it is known.
    fn bound(&self, index: usize, subkind: Option<String>) -> Option<End> {
        let event = &self.stepper.events[index];
        let name = event.name.clone();
        Some(match event.test.level()? {
            _ if event.kind == Kind::G => End::Grazing { name, subkind },
            (Quantity::Parameter(_), value) => End::ParameterBound { name, value },
            (Quantity::Monitor(_), value) => End::MonitorBound { name, value },
        })
    }

    /// Whether the branch ends in this step: at a terminal event, or because the curve has closed.
    /// What was found beyond the end is dropped.
    fn ending(&mut self, found: &mut Vec<Located>, walk: &Walk, step: &Step) -> Option<Ending> {
        let (from, points) = (&walk.place, walk.half.points.len());
        if let Some(closing) = walk.closing.as_ref().filter(|_| points >= 2 && walk.turned)
            && let Some(along) = self.stepper.closes(closing, from, step)
        {
            found.retain(|located| located.along <= along + AT_START);
            return Some((End::Closed { points: points + 1 }, None));
        }
        if let Some(k) = self.stepper.returns_to_parent(found, from) {
            found.truncate(k + 1);
            let mut at = found.pop()?;
            let event = "period doubling of the orbit of half the period".to_string();
            (at.special.kind, at.special.event) = (Kind::PD, event.clone());
            return Some((End::Event { event }, Some(at)));
        }
        let events = &self.stepper.events;
        let terminal =
            |located: &Located| located.event.is_some_and(|event| events[event].terminal);
        let first = found.iter().position(terminal)?;
        // Of several at one point, as where an impact vanishes with the leg behind it, the first
        // event names the end; of those that do not converge that of the itinerary, from which
        // others follow.
        let reach = found[first].along + AT_START;
        let same = (first..found.len()).filter(|&k| terminal(&found[k]) && found[k].along <= reach);
        let rank = |k: &usize| {
            let Located { event, special, .. } = &found[*k];
            let follows = event.is_some_and(|event| events[event].test != Test::Itinerary);
            (!special.converged, follows, *event)
        };
        let mut at = found.swap_remove(same.min_by_key(rank)?);
        found.truncate(first);
        // Where the equations of a grazing are singular signs of determinants change that mean
        // nothing.
        if at.special.kind == Kind::G {
            let bifurcation = |it: &Located| {
                let test = it.event.map(|event| events[event].test);
                it.special.kind != Kind::UZ && test.is_some_and(|test| test.level().is_none())
            };
            found.retain(|it| !bifurcation(it) || it.along < at.along - AT_START);
        }
        let bound = at.event.filter(|event| *event < self.bounds.len());
        let end = bound.and_then(|event| self.bound(event, at.special.subkind.clone()));
        if let Some(end) = &end {
            at.special.event = end.to_string();
        }
        let event = at.special.event.clone();
        Some((end.unwrap_or(End::Event { event }), Some(at)))
    }
}
