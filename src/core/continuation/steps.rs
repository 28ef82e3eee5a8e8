//! A branch point by point, while it is traced.

use super::branch::{Half, Traced};
use super::metric::Metric;
use super::run::{Tracer, Walk};
use super::{Branch, End, Point, Settings, SpecialPoint};
use crate::core::solution::Solution;
use std::mem::replace;

/// Sees a branch while it is traced: to print, to show progress, to cancel.
pub trait Observer {
    /// A branch begins; its names are known, its points are not.
    fn begin(&mut self, _branch: &Branch) {}

    /// A point was reached, the start first. An observer that has a clone of
    /// [`Settings::cancel`] can end the trace there.
    fn point(&mut self, _point: &Point) {}

    /// A special point was found. Labels are final only when the branch is complete.
    fn special(&mut self, _branch: &Branch, _special: &SpecialPoint) {}
}

/// An observer that sees nothing.
impl Observer for () {}

/// A branch while it is traced: an iterator over its points and special points as they are found,
/// the start first, then one half from there, then the other one. What is not asked for is not
/// computed.
///
/// ```
/// use tangency::core::continuation::{Continuation, End, Kind, Traced};
/// use tangency::core::dense::Dense;
/// use tangency::problems::classic::ParallelPlate;
/// // Up to the fold at u = 1/3, and not farther.
/// let mut plate = Dense::new(ParallelPlate);
/// let mut steps = Continuation::of(&mut plate).along("load", 0.0..=1.0).steps()?;
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
    tracer: Tracer<'a>,
    stage: Stage,
    /// The start on its mesh, and the scales there, to which the second half returns.
    home: (Solution, Metric),
    /// Marks that the start lies on.
    marked: Vec<SpecialPoint>,
    behind: Option<Half>,
    ahead: Option<Half>,
}

/// A long branch goes as far as this from its start, in units of scaled arclength.
const FAR: f64 = 10.0;

/// How far a trace is.
enum Stage {
    Start,
    Under(Box<Walk>),
    Done,
}

impl Iterator for Steps<'_> {
    type Item = Traced;

    fn next(&mut self) -> Option<Traced> {
        loop {
            if let Some(item) = self.tracer.shown.pop_front() {
                return Some(item);
            }
            if self.tracer.is_cancelled() && !matches!(self.stage, Stage::Done) {
                self.interrupt();
                continue;
            }
            match replace(&mut self.stage, Stage::Done) {
                Stage::Start => self.begin(),
                Stage::Under(mut walk) => match self.tracer.advance(&mut walk) {
                    None => self.stage = Stage::Under(walk),
                    Some(end) => self.arrive(*walk, end),
                },
                Stage::Done => return None,
            }
        }
    }
}

impl<'a> Steps<'a> {
    pub(super) fn new(mut tracer: Tracer<'a>) -> Self {
        let start = tracer.stepper.solution_at(&tracer.start);
        let home = (start, tracer.stepper.metric.clone());
        Steps { tracer, stage: Stage::Start, home, marked: Vec::new(), behind: None, ahead: None }
    }

    /// The branch's names and settings, without its points.
    pub fn branch(&self) -> &Branch {
        &self.tracer.branch
    }

    /// How many points a long branch has from here: one that goes ten times as far as its scales
    /// each way, in steps as long as they may be, unless fewer points are allowed.
    ///
    /// ```
    /// use tangency::core::continuation::{Continuation, Settings};
    /// use tangency::core::dense::Dense;
    /// let mut plate = Dense::new(tangency::problems::classic::ParallelPlate);
    /// let settings = Settings { max_step: 0.05, ..Settings::default() };
    /// let steps = Continuation::of(&mut plate).along("load", 0.0..=1.0).settings(settings).steps()?;
    /// assert_eq!(steps.many_points(), 401);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn many_points(&self) -> usize {
        let Settings { max_step, max_points, .. } = self.tracer.stepper.settings;
        let halves = self.tracer.directions.iter().filter(|traced| **traced).count();
        max_points.min((FAR / max_step).ceil() as usize).saturating_mul(halves).saturating_add(1)
    }

    /// The branch as far as it has been traced; both ends of one that is not complete are
    /// [`End::Interrupted`].
    pub fn finish(mut self) -> Branch {
        self.interrupt();
        let start = self.tracer.start.point.clone();
        let known = |half: Option<Half>| half.unwrap_or_else(|| Half::new(End::Interrupted));
        let [behind, ahead] = [self.behind, self.ahead].map(known);
        let ahead = Half { special: [self.marked, ahead.special].concat(), ..ahead };
        behind.join(start, ahead, self.tracer.branch)
    }

    /// Traces the whole branch, and shows an observer what is found.
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

    /// Goes no farther.
    fn interrupt(&mut self) {
        if matches!(self.stage, Stage::Start) {
            self.begin();
        }
        while let Stage::Under(walk) = replace(&mut self.stage, Stage::Done) {
            self.arrive(*walk, End::Interrupted);
        }
    }

    /// Records the start, and sets out.
    fn begin(&mut self) {
        let start = self.tracer.start.clone();
        self.tracer.show(&start.point);
        self.marked = self.tracer.marked_start();
        let [backward, forward] = self.tracer.directions;
        // A start that is an end is found, and labelled, first.
        self.behind = match (self.tracer.leaves_at_once(true), backward) {
            (Some(end), true) => Some(self.tracer.no_half(end)),
            (_, false) => Some(self.tracer.no_half(End::Start)),
            (None, true) => None,
        };
        if forward {
            self.stage = Stage::Under(Box::new(self.tracer.set_out(start, false)));
        } else {
            let ahead = self.tracer.no_half(End::Start);
            self.turn_back(ahead);
        }
    }

    /// Ends a half.
    fn arrive(&mut self, walk: Walk, end: End) {
        let backward = walk.backward;
        let nowhere = end == End::Interrupted && walk.half.points.is_empty();
        let half = match nowhere {
            true => self.tracer.no_half(end),
            false => self.tracer.arrived(walk, end),
        };
        if backward {
            self.behind = Some(half);
        } else {
            self.turn_back(half);
        }
    }

    /// Returns to the start for the other half, unless there is none.
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
        let mut start = self.tracer.start.clone();
        let (home, metric) = &self.home;
        self.tracer.return_to(&start, home, metric.clone());
        if closed || end == End::Interrupted {
            self.behind = Some(self.tracer.no_half(end));
        } else {
            self.tracer.stepper.turn(&mut start);
            self.stage = Stage::Under(Box::new(self.tracer.set_out(start, true)));
        }
    }
}
