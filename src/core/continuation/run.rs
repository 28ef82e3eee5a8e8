//! Running along a curve: step after step, event after event, to an end with a reason.

use super::closing::Reference;
use super::event::{Event, Test};
use super::found::Located;
use super::halves::Half;
use super::hermite::MOST_KNOTS;
use super::homoclinic::CycleLimits;
use super::metric::Metric;
use super::stepper::{AT_START, Before, Place, Step, Stepper};
use super::unexplained::LEAST_UNEXPLAINED;
use super::{Branch, End, Kind, Observer, Point, Settings, SpecialPoint, TraceError};
use crate::core::condition::Quantity;
use crate::core::solution::Solution;

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
    /// Whether the start is a branch point that the curve leaves: where it is a pitchfork, the parameter
    /// turns there, which is no fold.
    pub from_branch_point: bool,
    /// The error of the special point that the start is.
    pub error: f64,
    /// The kinds of the special point that the start is, and of the curve that it lies on.
    pub origin: Vec<Kind>,
    /// How many labels have been given.
    pub labels: usize,
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
    /// Refuses a start beyond a bound.
    pub fn check_bounds(&self) -> Result<(), TraceError> {
        let beyond = |i: &usize| self.start.tests[*i] * self.bounds[*i].side > 0.0;
        let Some(i) = (0..self.bounds.len()).find(beyond) else { return Ok(()) };
        let Event { name, test: Test::Level(_, level), .. } = &self.stepper.events[i] else {
            return Ok(());
        };
        let [low, high] = self.bounds[i].range;
        let value = level + self.start.tests[i];
        Err(TraceError::OutOfRange { name: name.clone(), value, low, high })
    }

    /// Traces both halves and joins them.
    pub fn run(mut self, observer: &mut dyn Observer) -> Branch {
        observer.begin(&self.branch);
        let start = self.start.clone();
        let mesh = self.stepper.equations.system().mesh();
        let metric = self.stepper.metric.clone();
        let stopped = observer.point(&start.point).is_break();
        let [backward, forward] = self.directions;
        let marked = self.marked_start(observer);
        // A start that is an end is found, and labelled, first.
        let behind = match (self.leaves_at_once(true), backward) {
            (Some(end), true) => Some(self.no_half(end, observer)),
            (_, false) => Some(self.no_half(End::Start, observer)),
            (None, true) => None,
        };
        let ahead = match (stopped, forward) {
            (true, _) => self.no_half(End::Interrupted, observer),
            (_, true) => self.half(start.clone(), false, observer),
            (_, false) => self.no_half(End::Start, observer),
        };
        let behind = match (behind, &ahead.end) {
            (Some(behind), End::Closed { .. }) => Half { end: ahead.end.clone(), ..behind },
            (Some(behind), _) => behind,
            (None, end @ (End::Closed { .. } | End::Interrupted)) => {
                self.return_to(&start, mesh, metric);
                self.no_half(end.clone(), observer)
            }
            (None, _) => {
                self.return_to(&start, mesh, metric);
                let mut turned = start.clone();
                self.stepper.turn(&mut turned);
                self.half(turned, true, observer)
            }
        };
        let ahead = Half { special: [marked, ahead.special].concat(), ..ahead };
        behind.join(start.point, ahead, self.branch)
    }

    /// The marks that the start lies on.
    fn marked_start(&mut self, observer: &mut dyn Observer) -> Vec<SpecialPoint> {
        let start = self.start.clone();
        let events = self.stepper.events.iter().zip(&start.tests).skip(self.bounds.len());
        let on_mark = |(event, test): &(&Event, &f64)| {
            event.kind == Kind::UZ && matches!(event.test, Test::Level(..)) && **test == 0.0
        };
        let names: Vec<String> =
            events.filter(on_mark).map(|(event, _)| event.name.clone()).collect();
        let mut half = Half { points: Vec::new(), special: Vec::new(), end: End::Start };
        for name in names {
            let mut special = self.stepper.end_point(&start, &End::Start, 0);
            (special.kind, special.event) = (Kind::UZ, name);
            self.stepper.refine_start(&mut special);
            self.mark(&mut half, special, observer);
        }
        half.special
    }

    /// Gives the system the mesh of the start back, which may have followed the branch, and forgets all that has been
    /// learned on the way: each half of a branch is what it would be alone.
    fn return_to(&mut self, start: &Place, mesh: Vec<f64>, metric: Metric) {
        self.give_mesh(start, mesh);
        self.stepper.restore(&start.unknowns, metric);
    }

    fn give_mesh(&mut self, start: &Place, mesh: Vec<f64>) {
        if mesh.is_empty() {
            return;
        }
        let equations = &mut self.stepper.equations;
        let n = equations.dimension();
        let x = equations.load(&start.unknowns);
        let [state, parameters] = [&x[..n], &x[n..]].map(<[f64]>::to_vec);
        let (kind, itinerary) = (Kind::EP, equations.system().itinerary());
        let solution =
            Solution { kind, itinerary, mesh, state, parameters, tangent: None, switch: false };
        // It was a solution on this mesh; if it is none any more, the first step says so.
        let _ = equations.system().resume_from(&solution);
    }

    /// Nothing but the start, as an end of the branch.
    fn no_half(&mut self, end: End, observer: &mut dyn Observer) -> Half {
        let start = self.start.clone();
        let mut special = self.stepper.end_point(&start, &end, 0);
        if self.from_branch_point {
            // The equations are singular there; it was finished where it was found.
            special.error = self.error.max(special.error);
        } else {
            self.stepper.refine_start(&mut special);
        }
        let mut half = Half { points: Vec::new(), special: Vec::new(), end };
        self.mark(&mut half, special, observer);
        half
    }

    fn half(&mut self, mut start: Place, backward: bool, observer: &mut dyn Observer) -> Half {
        let mut half = Half { points: Vec::new(), special: Vec::new(), end: End::Start };
        let mut place = start.clone();
        let closing = self.reference(&start, backward);
        half.end = match self.leaves_at_once(backward) {
            Some(end) => end,
            None => {
                let closing = closing.as_ref();
                self.walk(&mut half, &mut place, (&mut start, closing), backward, observer)
            }
        };
        let ended =
            half.special.last().is_some_and(|s| s.after == half.points.len() && s.after > 0);
        if !ended {
            let special = self.stepper.end_point(&place, &half.end, half.points.len());
            self.mark(&mut half, special, observer);
        }
        half
    }

    /// Labels a special point, shows it, and adds it.
    fn mark(&mut self, half: &mut Half, mut special: SpecialPoint, observer: &mut dyn Observer) {
        self.labels += 1;
        special.label = self.labels;
        observer.special(&self.branch, &special);
        half.special.push(special);
    }

    /// Steps until something ends the branch.
    fn walk(
        &mut self,
        half: &mut Half,
        place: &mut Place,
        (start, closing): (&mut Place, Option<&Reference>),
        backward: bool,
        observer: &mut dyn Observer,
    ) -> End {
        let Settings { max_points, min_step, max_step, initial_step, .. } = self.stepper.settings;
        let mut length = initial_step.min(max_step);
        let mut before: Vec<Before> = Vec::new();
        let mut limits = CycleLimits::default();
        loop {
            let points = half.points.len();
            if points >= max_points {
                return End::PointLimit { points };
            }
            let mut step = match self.stepper.step(&before, place, length) {
                Ok(step) => step,
                Err((step, cause)) => return End::StepTooSmall { step, cause: cause.to_string() },
            };
            if self.stepper.ends_on_special_point(place, &step) {
                length = BESIDE * step.length;
                continue;
            }
            if points == 0
                && let Some(end) = self.leaves(start, |i| step.place.tests[i])
            {
                return end;
            }
            if let Some(before) = before.first()
                && let Some(shorter) = self.stepper.hidden(before, place, &step)
            {
                step = shorter;
            }
            let Some(mut found) = self.explained(place, &step, backward, points == 0) else {
                length = 0.5 * step.length;
                continue;
            };
            length = step.next.clamp(min_step, max_step);
            let ending = self.ending(&mut found, place, &step, points, closing);
            for Located { mut special, .. } in found {
                special.after = points;
                self.mark(half, special, observer);
            }
            if let Some(ending) = ending {
                return self.end_half(half, ending, place, start, observer);
            }
            let end = limits.reached(&mut self.stepper, &step.place, place);
            self.accept(&mut before, place, step, start);
            half.points.push(place.point.clone());
            self.save_regular(half, place, observer);
            if let Some(end) = end {
                return end;
            }
            if observer.point(&place.point).is_break() {
                return End::Interrupted;
            }
        }
    }

    /// The events in a step, if they explain how the number of unstable eigenvalues changes; `None` if a shorter step may.
    fn explained(
        &mut self,
        from: &Place,
        step: &Step,
        backward: bool,
        at_start: bool,
    ) -> Option<Vec<Located>> {
        let mut found = self.events_between(from, step, backward, at_start);
        let origin = if at_start { &self.origin[..] } else { &[] };
        if let Some(changed) = self.stepper.unexplained(from, step, &found, origin) {
            if step.length > LEAST_UNEXPLAINED {
                return None;
            }
            found.extend(self.stepper.unclassified(from, step, changed));
            found.sort_by(|a, b| a.along.total_cmp(&b.along));
        }
        Some(found)
    }

    /// Saves every so many points.
    fn save_regular(&mut self, half: &mut Half, place: &Place, observer: &mut dyn Observer) {
        let (points, every) = (half.points.len(), self.stepper.settings.save_every);
        if every > 0 && points.is_multiple_of(every) {
            let special = self.stepper.saved_point(place, Kind::RG, Kind::RG.meaning(), points);
            self.mark(half, special, observer);
        }
    }

    /// Makes a step: the mesh follows, and what is to stay comparable with it.
    fn accept(
        &mut self,
        before: &mut Vec<Before>,
        place: &mut Place,
        step: Step,
        start: &mut Place,
    ) {
        let left = std::mem::replace(place, step.place);
        // A test function that is unknown at a point changes its sign, if it does, with the next point at which it is known.
        for (test, before) in place.tests.iter_mut().zip(&left.tests) {
            *test = if test.is_nan() { *before } else { *test };
        }
        before.insert(0, Before { place: left, length: step.length });
        before.truncate(MOST_KNOTS - 1);
        let places =
            std::iter::once(start).chain(before.iter_mut().map(|before| &mut before.place));
        let others = places.flat_map(|other| [&mut other.unknowns[..], &mut other.tangent[..]]);
        self.stepper.settle(place, others.collect());
    }

    /// Records the last point, at which the run ends.
    fn end_half(
        &mut self,
        half: &mut Half,
        (end, at): Ending,
        place: &mut Place,
        start: &Place,
        observer: &mut dyn Observer,
    ) -> End {
        let last = at.as_ref().map_or(start.point.clone(), |last| self.point_of(&last.special));
        // The branch ends here: the answer of the observer changes nothing.
        let _ = observer.point(&last);
        half.points.push(last);
        let Some(Located { mut special, .. }) = at else {
            *place = start.clone();
            return end;
        };
        special.after = half.points.len();
        self.mark(half, special, observer);
        end
    }

    fn point_of(&mut self, special: &SpecialPoint) -> Point {
        let admissible = self.stepper.is_admissible(&special.monitors, &special.parameters);
        Point { admissible, ..special.point() }
    }

    /// The end of a half that starts on a bound and is about to leave.
    fn leaves_at_once(&self, backward: bool) -> Option<End> {
        let way = if backward { -1.0 } else { 1.0 };
        self.leaves(&self.start, |i| way * self.slopes[i])
    }

    /// The end of a half that starts on a bound which such changes of the test functions lead beyond.
    fn leaves(&self, start: &Place, change: impl Fn(usize) -> f64) -> Option<End> {
        let leaves = |i: &usize| start.tests[*i] == 0.0 && change(*i) * self.bounds[*i].side > 0.0;
        (0..self.bounds.len()).find(leaves).and_then(|i| self.bound(i))
    }

    fn bound(&self, index: usize) -> Option<End> {
        let event = &self.stepper.events[index];
        let name = event.name.clone();
        match event.test {
            Test::Level(..) if event.kind == Kind::G => Some(End::Grazing { name }),
            Test::Level(Quantity::Parameter(_), value) => Some(End::ParameterBound { name, value }),
            Test::Level(Quantity::Monitor(_), value) => Some(End::MonitorBound { name, value }),
            _ => None,
        }
    }

    /// Whether the branch ends in this step: at a terminal event, or because the curve has closed.
    /// What was found beyond the end is dropped.
    fn ending(
        &mut self,
        found: &mut Vec<Located>,
        from: &Place,
        step: &Step,
        points: usize,
        closing: Option<&Reference>,
    ) -> Option<Ending> {
        if let Some(closing) = closing.filter(|_| points >= 2)
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
        // Of several at one point, as where an impact vanishes with the leg behind it, the first event names the end.
        let reach = found[first].along + AT_START;
        let same = (first..found.len()).filter(|&k| terminal(&found[k]) && found[k].along <= reach);
        let mut at = found.swap_remove(same.min_by_key(|&k| found[k].event)?);
        found.truncate(first);
        let bound = at.event.filter(|event| *event < self.bounds.len());
        let end = bound.and_then(|event| self.bound(event));
        if let Some(end) = &end {
            at.special.event = end.to_string();
        }
        let event = at.special.event.clone();
        Some((end.unwrap_or(End::Event { event }), Some(at)))
    }
}
