//! The iterator over the points of a branch, which computes the points one after another.

use super::admissible::{is_within_at_end, subkind};
use super::bounds::{AT_START, Bounds, end_at};
use super::branch::{Branch, HALVED, Point, SpecialPoint, Traced};
use super::closing::{Reference, returns_to_parent};
use super::conservative::{self, family_changes};
use super::curve::Curve;
use super::curve_point::{CurvePoint, Interval};
use super::double_crossing::double_crossing;
use super::early_end::stopping_growth;
use super::end::End;
use super::events_between::{AtStart, events_between};
use super::fitting::{restate_determinant, return_to_mesh, settle};
use super::half::Half;
use super::homoclinic_end;
use super::located::Located;
use super::log::Log;
use super::mesh_check::{self, adapt_mesh, rescue};
use super::metric::Metric;
use super::newton::NewtonError;
use super::predictor::Predictor;
use super::separation::Parts;
use super::settings::Settings;
use super::slopes::Slopes;
use super::snaking::PERIOD;
use super::step_control::{Step, StepControl};
use super::stretches::{between_changes, divides};
use super::turns;
use super::unexplained::{LEAST_UNEXPLAINED, ends_on_special_point, unseen};
use crate::core::failure::one_line;
use crate::core::problem::Dynamics;
use crate::core::system::{Kind, Solution};
use std::sync::Arc;

/// Observes a branch while it is traced, for example to print points, to show progress, or to
/// cancel the continuation.
pub trait Observer {
    /// Called before the first point of a branch is computed; the branch contains its names but no
    /// points.
    fn begin(&mut self, _branch: &Branch) {}

    /// Called for each point; the first call is for the start. An observer that holds a clone of
    /// [`Settings::cancel`] can end the continuation.
    fn point(&mut self, _point: &Point) {}

    /// Called for each special point. The labels of special points are final only when the branch
    /// is complete.
    fn special(&mut self, _branch: &Branch, _special: &SpecialPoint) {}
}

/// An observer that does nothing.
impl Observer for () {}

/// A branch that is being traced: an iterator over its points and special points in the order in
/// which they are computed. The start comes first, followed by the points of one half of the branch
/// and the points of the other half. Points are computed only when the iterator is advanced.
///
/// ```
/// use tangency::core::continuation::{Continuation, End, Traced};
/// use tangency::core::system::{Dense, Kind};
/// use tangency::problems::classic::ParallelPlate;
/// // Up to the fold at u = 1/3, and not farther.
/// let mut plate = Dense::new(ParallelPlate);
/// let mut steps = Continuation::new(&mut plate).along("load", 0.0..=1.0).steps()?;
/// let fold = steps.find_map(|item| match item {
///     Traced::Special(point) if point.kind == Kind::LP => Some(point.state[0]),
///     _ => None,
/// });
/// assert!((fold.unwrap() - 1.0 / 3.0).abs() < 1e-12);
/// let branch = steps.finish();
/// assert_eq!(branch.ends[1], End::Interrupted);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
pub struct Steps<'a> {
    pub(super) curve: Curve<'a>,
    pub(super) control: StepControl,
    pub(super) settings: Settings,
    pub(super) log: Log,
    pub(super) start: CurvePoint,
    /// The start on its mesh, and the scales at the start, which are restored before the second
    /// half is traced.
    pub(super) home: (Solution, Metric),
    pub(super) bounds: Bounds,
    /// Whether to trace the branch backward, and whether to trace it forward.
    pub(super) directions: [bool; 2],
    /// Whether the curve starts at a branch point. At a pitchfork, the parameter has an extremum at
    /// the start, which is not reported as a fold.
    pub(super) from_branch_point: bool,
    /// The error of the special point at the start.
    pub(super) error: f64,
    /// The kind of the special point at the start, and the kind of the curve on which the point
    /// lies.
    pub(super) origin: Vec<Kind>,
    /// The kinds of events that are reported at the start.
    pub(super) reported: Vec<Kind>,
    /// The special points at marked values of parameters or monitors that coincide with the start.
    pub(super) marked: Vec<SpecialPoint>,
    /// The half of the branch that is being traced.
    pub(super) current: Option<Half>,
    pub(super) behind: Option<Half>,
    pub(super) ahead: Option<Half>,
}

/// Heuristic: the factor by which a step is shortened if it ends exactly at a special point. The
/// shortening is large enough to determine the signs of test functions, and avoids fractions of the
/// step, such as one half, at which symmetric problems are singular.
const BESIDE: f64 = 0.93;

/// Heuristic: the distances from a branch point at the start, in scaled arclength, at which the
/// reference point of a closed curve may be chosen. Smaller distances are used if another event
/// lies between the branch point and the reference point.
const BEHIND: [f64; 4] = [2e-2, 5e-3, 1e-3, 2e-4];

/// The remedies if Newton's method stagnates at the smallest step along a curve.
const STAGNATION: &str = "lower `min_step`, give `scales` that match the sizes of the unknowns, or, if the solutions \
                          have a mesh, take more `intervals`";

impl Iterator for Steps<'_> {
    type Item = Traced;

    fn next(&mut self) -> Option<Traced> {
        loop {
            if let Some(item) = self.log.next() {
                return Some(item);
            }
            let begins = self.current.is_none() && self.ahead.is_none();
            if self.settings.cancel.is_cancelled() && (begins || self.current.is_some()) {
                self.interrupt();
                continue;
            }
            match self.current.take() {
                Some(mut half) => match self.advance(&mut half) {
                    None => self.current = Some(half),
                    Some(end) => self.end_half(half, end),
                },
                None if begins => self.begin(),
                None => return None,
            }
        }
    }
}

impl Steps<'_> {
    /// Returns the names and settings of the branch, without its points.
    pub fn branch(&self) -> &Branch {
        &self.log.branch
    }

    /// Returns whether the branch is traced backward, and whether it is traced forward.
    ///
    /// ```
    /// use tangency::core::{continuation::Continuation, system::Dense};
    /// let mut plate = Dense::new(tangency::problems::classic::ParallelPlate);
    /// let branch = Continuation::new(&mut plate).along("load", 0.0..=1.0);
    /// assert_eq!(branch.steps()?.directions(), [true, true]);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn directions(&self) -> [bool; 2] {
        self.directions
    }

    /// Ends the continuation, and returns the branch traced so far. The ends of an incomplete
    /// branch are [`End::Interrupted`].
    pub fn finish(mut self) -> Branch {
        self.interrupt();
        let system = self.curve.corrector.equations.system();
        self.log.branch.warnings.extend(system.doubts());
        self.log.short_of(self.settings.refinement);
        // The matrix method is known only after the first point.
        self.log.branch.method = system.representation().method;
        let (start, family) = (self.start.point.clone(), self.curve.recorder.family);
        let missing =
            || Half { end: End::Interrupted, ..Half::new(self.start.clone(), false, 0.0) };
        let [behind, mut ahead] =
            [self.behind.take(), self.ahead.take()].map(|half| half.unwrap_or_else(missing));
        ahead.special.splice(..0, self.marked);
        let mut branch = behind.join(start, ahead, self.log.branch);
        branch.warnings.extend(match family {
            true => Some(conservative::warning(&branch)),
            false => turns::unexplained(&branch),
        });
        branch
    }

    /// Traces the whole branch, and reports its points to an observer.
    pub fn run(mut self, observer: &mut dyn Observer) -> Branch {
        observer.begin(self.branch());
        while let Some(item) = self.next() {
            match item {
                Traced::Special(special) => observer.special(self.branch(), &special),
                Traced::Point(point) => observer.point(&point),
            }
        }
        self.finish()
    }

    /// Interrupts the trace.
    fn interrupt(&mut self) {
        if self.current.is_none() && self.ahead.is_none() {
            self.begin();
        }
        while let Some(half) = self.current.take() {
            self.end_half(half, End::Interrupted);
        }
    }

    /// Records the start, and begins the first half of the branch.
    fn begin(&mut self) {
        self.start.point.solution = self.solution_at(&self.start.clone());
        let monitors = self.start.point.monitors.len();
        let columns = self.curve.corrector.slopes(self.start.on_curve(), monitors);
        self.start.point.slopes = Some(Slopes { position: 0.0, columns });
        self.log.point(&self.start.point);
        self.marked = self.marked_start();
        let [backward, forward] = self.directions;
        // A start that is an end is labelled first.
        self.behind = match (self.end_at_once(true), backward) {
            (Some(end), true) => Some(self.empty_half(end)),
            (_, false) => Some(self.empty_half(End::Start)),
            (None, true) => None,
        };
        if forward {
            self.current = Some(self.first_half(self.start.clone(), false));
        } else {
            let ahead = self.empty_half(End::Start);
            self.turn_back(ahead);
        }
    }

    /// Returns the special points at marked values of parameters or monitors that coincide with the
    /// start.
    fn marked_start(&mut self) -> Vec<SpecialPoint> {
        let Curve { corrector, detector, recorder, refiner, .. } = &mut self.curve;
        let mut marked = Vec::new();
        for (index, event) in detector.events.iter().enumerate() {
            let is_mark = event.kind == Kind::UZ && event.test.level().is_some();
            if self.bounds.holds(index) || !is_mark || self.start.tests[index] != Some(0.0) {
                continue;
            }
            let mut special = recorder.end_point(corrector, &self.start, &End::Start, 0);
            (special.kind, special.event) = (Kind::UZ, event.name.clone());
            refiner.refine_start(corrector, recorder, &mut special);
            self.log.special(&mut marked, special);
        }
        marked
    }

    /// Creates a half of the branch that consists of the start only, so that the start is an end of
    /// the branch.
    fn empty_half(&mut self, end: End) -> Half {
        let Curve { corrector, recorder, refiner, .. } = &mut self.curve;
        let mut special = recorder.end_point(corrector, &self.start, &end, 0);
        if self.from_branch_point {
            // The equations are singular at the start, which was refined when it was located.
            special.error = self.error.max(special.error);
        } else {
            refiner.refine_start(corrector, recorder, &mut special);
        }
        let mut half = Half { end, ..Half::new(self.start.clone(), false, 0.0) };
        self.log.special(&mut half.special, special);
        half
    }

    /// Creates a half of the branch that begins at the start, in the given direction.
    fn first_half(&mut self, start: CurvePoint, backward: bool) -> Half {
        let closing = self.reference(&start, backward);
        let length = self.settings.initial_step.min(self.settings.max_step);
        // Very small cycles are inaccurate.
        let dynamics = self.curve.corrector.equations.system().dynamics();
        let beside = match self.from_branch_point && dynamics != Dynamics::Periodic {
            true => self.control.stability_beside(&mut self.curve, &start, length),
            false => None,
        };
        Half { closing, beside, ..Half::new(start, backward, length) }
    }

    /// Returns the reference point, which a half of the branch passes again if the curve is closed;
    /// `None` if the branch emanates from a branch point in one direction only. The reference point
    /// is the start; if the start is a branch point, it is a point before the start with no event
    /// between the two points.
    fn reference(&mut self, start: &CurvePoint, backward: bool) -> Option<Reference> {
        if !self.from_branch_point {
            return Some(Reference::new(&mut self.curve.corrector, start.clone()));
        }
        if !self.directions[0] {
            return None;
        }
        let mut turned = start.clone();
        self.curve.detector.reverse(&mut turned);
        let row = self.curve.corrector.norm.covector(&turned.tangent);
        let none = Predictor::default();
        let step = BEHIND.iter().find_map(|&length| {
            let tried = self.control.try_step(&mut self.curve, &none, &turned, &row, length);
            let step = tried.ok()?;
            let events = self.events_before(step.since(&turned), !backward);
            events.is_empty().then_some(step)
        });
        let mut place = step?.place;
        self.curve.detector.reverse(&mut place);
        Some(Reference::new(&mut self.curve.corrector, place))
    }

    /// Returns the end of a half of the branch that starts at a bound and would immediately cross
    /// it.
    fn end_at_once(&mut self, backward: bool) -> Option<End> {
        let index = self.bounds.left_at_once(&self.start, backward)?;
        let start = self.start.clone();
        self.end_on_bound(index, &start)
    }

    /// Returns the end of the branch at the bound on which a point lies.
    fn end_on_bound(&mut self, index: usize, place: &CurvePoint) -> Option<End> {
        let event = &self.curve.detector.events[index];
        let equations = &mut self.curve.corrector.equations;
        let x = equations.load(&place.unknowns).to_vec();
        end_at(event, subkind(event, equations.system(), &x))
    }

    /// Ends a half.
    fn end_half(&mut self, mut half: Half, end: End) {
        let backward = half.backward;
        if end == End::Interrupted && half.points.is_empty() {
            half = self.empty_half(end);
        } else {
            half.end = half.early_end.explained(end);
            let after = half.points.len();
            let is_end = |it: &SpecialPoint| it.after == after && it.kind != Kind::RG;
            if after == 0 || !half.special.last().is_some_and(is_end) {
                let Curve { corrector, recorder, refiner, .. } = &mut self.curve;
                let mut special = recorder.end_point(corrector, &half.last, &half.end, after);
                if let (End::Homoclinic { .. }, true) = (&half.end, recorder.solutions) {
                    let outcome =
                        homoclinic_end::locate((corrector, refiner), &half.last, &mut special);
                    half.doubt_stability(&mut special);
                    let cause = outcome.err().filter(|cause| !cause.is_unsupported());
                    cause.iter().for_each(|cause| self.log.homoclinic_not_located(cause));
                }
                if let Some(growth) = stopping_growth(corrector, &half.end) {
                    self.log.stopped_by_growth(growth);
                }
                self.log.special(&mut half.special, special);
            }
        }
        if backward {
            self.behind = Some(half);
        } else {
            self.turn_back(half);
        }
    }

    /// Returns to the start and begins the other half of the branch, if both halves are traced. The
    /// mesh of the start is restored, and all data adapted along the first half are reset, so that
    /// the two halves are independent of each other.
    fn turn_back(&mut self, ahead: Half) {
        let end = ahead.end.clone();
        self.ahead = Some(ahead);
        let closed = matches!(end, End::Closed { .. });
        if let Some(behind) = &mut self.behind {
            if closed {
                behind.end = end;
            }
            return;
        }
        let mut start = self.start.clone();
        let (home, metric) = &self.home;
        let moved = !home.mesh.is_empty();
        let Curve { corrector, detector, refiner, .. } = &mut self.curve;
        if moved {
            return_to_mesh(&mut corrector.equations, home, &start.unknowns);
        }
        // The defining systems were started at this point before.
        let _ = corrector.restore(&start.unknowns, metric.clone(), &refiner.held);
        detector.restate(&mut corrector.equations, &mut start);
        if moved {
            // If the matrix is singular, the start is a special point, where signs are meaningless.
            let _ = restate_determinant(&mut self.curve, &mut start);
        }
        if closed || end == End::Interrupted {
            self.behind = Some(self.empty_half(end));
        } else {
            self.curve.detector.reverse(&mut start);
            self.current = Some(self.first_half(start, true));
        }
    }

    /// Advances the current half of the branch by at most one step; returns the reason why the half
    /// ends, if it ends.
    fn advance(&mut self, half: &mut Half) -> Option<End> {
        let points = half.points.len();
        if points == 0
            && let Some(end) = self.end_at_once(half.backward)
        {
            return Some(end);
        }
        let Settings { max_points, min_step, max_step, max_mesh_error, .. } = self.settings;
        if points >= max_points {
            return Some(End::PointLimit { points });
        }
        let curve = &mut self.curve;
        let mut step = match self.control.step(curve, &half.predictor, &half.last, half.length) {
            Ok(step) => step,
            Err(_) if self.settings.cancel.is_cancelled() => return Some(End::Interrupted),
            // After a large change of the mesh, the last point is corrected on it, unless the mesh
            // is too coarse.
            Err((_, NewtonError::Far { .. }))
                if !half.settled
                    && curve.corrector.mesh_error(&half.last.unknowns) <= max_mesh_error =>
            {
                half.settled = true;
                settle(curve, half);
                half.try_again(self.settings.initial_step.min(max_step));
                return None;
            }
            Err(_) if rescue(curve, half, &self.settings) => {
                half.try_again(self.settings.initial_step.min(max_step));
                return None;
            }
            Err((step, cause)) => {
                let jump = self.end_at_jump(half, step);
                return Some(jump.unwrap_or_else(|| self.end_of_steps(half, (step, cause))));
            }
        };
        if family_changes((curve, &mut self.log), (&mut self.start, half), &step) {
            half.try_again(step.length);
            return None;
        }
        let dynamics = curve.corrector.equations.system().dynamics();
        if ends_on_special_point(dynamics, &half.last, &step) {
            half.try_again(BESIDE * step.length);
            return None;
        }
        if self.outruns_mesh(&half.last, &step) {
            half.try_again(0.5 * step.length);
            return None;
        }
        if points == 0 {
            let change = |i: usize| step.place.tests[i].unwrap_or(0.0);
            let left = self.bounds.left(&half.start, change);
            if let Some(end) = left.and_then(|index| self.end_on_bound(index, &half.start)) {
                return Some(end);
            }
        }
        if let Some(before) = half.predictor.last()
            && let Some(shorter) = double_crossing(&mut self.curve, before, &half.last, &step)
        {
            step = shorter;
        }
        let found = self.explained(half, &step);
        // An event that was not found before the cancellation may exist.
        if self.settings.cancel.is_cancelled() {
            return Some(End::Interrupted);
        }
        let Some(found) = found else {
            half.try_again(0.5 * step.length);
            return None;
        };
        // Steps across branch points are longer than planned: one such step is enough.
        let shorter = min_step..0.9 * half.length;
        if let Some(between) = between_changes(&found).filter(|it| shorter.contains(it)) {
            half.try_again(between);
            return None;
        }
        half.length = step.next.clamp(min_step, max_step);
        self.go_on(half, step, found)
    }

    /// Whether the mesh is too coarse for the solution at the end of a step, but fine enough for
    /// the solution at its beginning. A step that ends at such a solution is shortened, because the
    /// mesh is adapted after each point and can follow the solution in shorter steps.
    fn outruns_mesh(&mut self, from: &CurvePoint, step: &Step) -> bool {
        let limit = self.settings.max_mesh_error;
        let mut error = |place: &CurvePoint| self.curve.corrector.mesh_error(&place.unknowns);
        // The error at the end of the step is known already.
        step.length > LEAST_UNEXPLAINED && error(&step.place) > limit && error(from) <= limit
    }

    /// Returns the end of a branch at which no step succeeds; its message states if the mesh is too
    /// coarse.
    fn end_of_steps(&mut self, half: &Half, (step, cause): (f64, NewtonError)) -> End {
        let error = self.curve.corrector.mesh_error(&half.last.unknowns);
        let target = mesh_check::target(&self.curve, half, &self.settings);
        // The help of the error is written for the first solution of a curve.
        let words = match &cause {
            NewtonError::Stagnation { .. } => format!("{cause}; {STAGNATION}"),
            cause => one_line(cause),
        };
        let words = match error > target {
            true => format!(
                "{words}. The mesh causes an error of {error:.1e}, more than the target of {target:.1e}: take more \
                 `intervals`"
            ),
            false => words,
        };
        End::StepTooSmall { step, cause: words, failure: Some(Box::new(cause)) }
    }

    /// Returns all events in an interval that begins at the start, except events at the start.
    fn events_before(&mut self, interval: Interval, backward: bool) -> Vec<Located> {
        let Steps { curve, log, bounds, from_branch_point, .. } = self;
        let at_start = AtStart { from_branch_point: *from_branch_point, reported: &[] };
        events_between((curve, log, bounds), interval, backward, Some(at_start))
    }

    /// Returns the events in a step if they explain the change of the number of unstable
    /// eigenvalues in the step; `None` if the step should be shortened to find an explanation. At a
    /// start on a branch point, the change from the stability beside the start must be explained.
    fn explained(&mut self, half: &Half, step: &Step) -> Option<Vec<Located>> {
        let (from, backward, at_start) = (&half.last, half.backward, half.points.is_empty());
        let after = step.place.point.unstable.filter(|_| at_start);
        let hidden = half.beside.is_some_and(|before| after.is_some_and(|after| before != after));
        let detects_all = self.settings.detect.is_empty();
        let Steps { curve, log, bounds, from_branch_point, origin, reported, .. } = self;
        let start = AtStart { from_branch_point: *from_branch_point, reported };
        let mut parts = Parts { curve, log, bounds, backward, start, origin, cuts: 0 };
        let (mut found, change) = parts.events(from, step, at_start);
        // At a start on a special point, rounding determines the number of unstable eigenvalues.
        let counts = detects_all && !at_start;
        let unseen = if counts { unseen(parts.curve, from, step, &found) } else { None };
        let is_hidden = hidden && change.is_none() && found.is_empty();
        if step.length > LEAST_UNEXPLAINED && (is_hidden || change.or(unseen).is_some()) {
            return None;
        }
        if let Some(change) = change {
            found = parts.separated(from, step, (found, change), at_start);
        } else if let Some(change) = unseen {
            let released = parts.curve.corrector.equations.parameters_at();
            parts.log.passes_unseen(&step.place.unknowns[released..], change);
        }
        let found = parts.up_to_limit(from, step, found, at_start);
        Some(parts.up_to_bound(from, step, found, at_start))
    }

    /// Records the events found in a step, and accepts the step unless an event ends this half of
    /// the branch.
    fn go_on(&mut self, half: &mut Half, mut step: Step, mut found: Vec<Located>) -> Option<End> {
        let points = half.points.len();
        for Located { special, .. } in &mut found {
            let slopes = special.slopes.take();
            special.slopes = slopes.map(|slopes| slopes.placed(half.position, half.growth));
        }
        let ending = self.ending(&mut found, half, &step);
        let special = found.iter().any(|it| divides(it.special.kind));
        for Located { mut special, shortfall, .. } in found {
            special.after = points;
            self.log.falls_short(special.kind, shortfall);
            self.log.special(&mut half.special, special);
        }
        if let Some((end, at)) = ending {
            self.record_end(half, at);
            return Some(end);
        }
        let Curve { corrector, detector, recorder, .. } = &mut self.curve;
        // A branch is followed up to a bound of the period.
        let is_free = !recorder.family && !self.bounds.are_on(PERIOD, &detector.events);
        let snakes = recorder.solutions && is_free;
        let was_small = half.early_end.small;
        let (end, crawl) = half.early_end(corrector, &self.settings, &step, snakes);
        let value = step.place.unknowns[corrector.equations.parameters_at()];
        crawl.iter().for_each(|crawl| self.log.crawls(crawl, value));
        if half.early_end.small && !was_small {
            self.log.small_from(value);
        }
        let ends = [&half.start, &step.place].map(|place| corrector.slope(&place.tangent));
        let slopes = half.slopes_at(corrector, &step.place);
        half.position = slopes.position;
        step.place.point.slopes = Some(slopes);
        half.accept(step, ends);
        let earlier = std::iter::once(&mut half.start).chain(half.predictor.places());
        let others = earlier.flat_map(|it| [&mut it.unknowns[..], &mut it.tangent[..]]).collect();
        half.growth /= corrector.accept(&mut half.last, others);
        adapt_mesh(&mut self.curve, half, &self.settings);
        half.last.point.solution = self.solution_at(&half.last);
        half.points.push(half.last.point.clone());
        half.stretches.reach(&mut self.curve, &half.last, points + 1, special);
        let every = self.settings.save_every;
        if every > 0 && (points + 1).is_multiple_of(every) {
            let event = (Kind::RG, Kind::RG.meaning());
            let Curve { corrector, recorder, .. } = &mut self.curve;
            let special = recorder.saved_point(corrector, &half.last, event, points + 1);
            self.log.special(&mut half.special, special);
        }
        self.log.point(&half.last.point);
        end
    }

    /// Returns the reason why the branch ends in this step, if it ends, and its last point, if this
    /// point lies within the step. A branch ends within a step at a terminal event, or because the
    /// curve has closed. Events beyond the end are removed.
    fn ending(
        &mut self,
        found: &mut Vec<Located>,
        half: &Half,
        step: &Step,
    ) -> Option<(End, Option<Located>)> {
        let (from, points) = (&half.last, half.points.len());
        let Curve { corrector, detector, .. } = &mut self.curve;
        if let Some(closing) = half.closing.as_ref().filter(|_| points >= 2 && half.turned)
            && let Some(along) = closing.passed(corrector, step.since(from))
        {
            found.retain(|located| located.along <= along + AT_START);
            return Some((End::Closed { points: points + 1 }, None));
        }
        if let Some(k) = returns_to_parent(&mut corrector.equations, found, from) {
            found.truncate(k + 1);
            let mut at = found.pop()?;
            let event = HALVED.to_string();
            (at.special.kind, at.special.event) = (Kind::PD, event.clone());
            return Some((End::Event { event }, Some(at)));
        }
        let (end, at) = self.bounds.end(&detector.events, found)?;
        Some((end, Some(at)))
    }

    /// Returns the solution at a point, if the settings specify that points store their solutions.
    fn solution_at(&mut self, place: &CurvePoint) -> Option<Arc<Solution>> {
        let keep = self.settings.keep_solutions;
        let condition = self.log.branch.condition;
        let corrector = &mut self.curve.corrector;
        keep.then(|| Arc::new(Solution { condition, ..corrector.solution_at(place) }))
    }

    /// Records the last point of a half of the branch.
    fn record_end(&mut self, half: &mut Half, at: Option<Located>) {
        let Some(Located { mut special, .. }) = at else {
            let mut start = half.start.clone();
            let slopes = half.slopes_at(&mut self.curve.corrector, &start);
            start.point.slopes = Some(slopes);
            self.log.point(&start.point);
            half.points.push(start.point.clone());
            half.last = start;
            return;
        };
        let equations = &mut self.curve.corrector.equations;
        // A wrong order of events at the preceding point persists.
        let admissible = half.last.point.admissible
            && is_within_at_end(
                equations.system(),
                special.kind,
                &special.parameters,
                &special.monitors,
            );
        let keep = self.settings.keep_solutions;
        let solution = keep.then(|| Arc::new(self.log.branch.solution(&special)));
        let last = Point { admissible, solution, ..special.point() };
        self.log.point(&last);
        half.points.push(last);
        special.after = half.points.len();
        self.log.special(&mut half.special, special);
    }
}
