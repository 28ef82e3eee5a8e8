//! The two halves of a branch, from its start to its ends.

use super::branch::{Branch, Point, SpecialPoint};
use super::closing::Reference;
use super::corrector::Corrector;
use super::curve_error::arclength;
use super::curve_point::CurvePoint;
use super::early_end::EarlyEnd;
use super::end::End;
use super::mesh_target::MeshTarget;
use super::predictor::Predictor;
use super::progress::{Crawl, Progress};
use super::settings::Settings;
use super::slopes::Slopes;
use super::snaking::Snaking;
use super::step_control::Step;
use super::stretches::Stretches;
use crate::core::bifurcation::VERTICAL;
use crate::core::system::Kind;

/// One of the two halves of a branch, from its start to one end. The field `after` of the special
/// points on the half counts points from the start of the branch, which has the index 0.
pub(super) struct Half {
    pub backward: bool,
    pub points: Vec<Point>,
    pub special: Vec<SpecialPoint>,
    pub stretches: Stretches,
    pub end: End,
    /// The last point.
    pub last: CurvePoint,
    /// The start of the branch, interpolated to the current mesh.
    pub start: CurvePoint,
    /// The predictor, which stores the points before the last point.
    pub predictor: Predictor,
    /// The length of the next step.
    pub length: f64,
    /// The position of the last point: the arclength from the start, measured in the scales at the
    /// start.
    pub position: f64,
    /// The factor that converts arclength in the current scales to arclength in the scales at the
    /// start; it grows as the scales increase.
    pub growth: f64,
    /// The number of unstable eigenvalues beside a start on a branch point.
    pub beside: Option<usize>,
    /// The reference point that a closed curve passes again.
    pub closing: Option<Reference>,
    pub early_end: EarlyEnd,
    pub progress: Progress,
    pub snaking: Snaking,
    /// Whether the last point was corrected again after its interpolation to a new mesh.
    pub settled: bool,
    /// The number of points up to which the number of mesh intervals is kept if the mesh is fine
    /// enough.
    pub keeps_mesh: usize,
    pub mesh: MeshTarget,
    /// Whether the continued parameter has changed direction; on a closed curve it always does.
    pub turned: bool,
}

impl Half {
    /// Creates one half of a branch, which contains no points yet.
    pub fn new(start: CurvePoint, backward: bool, length: f64) -> Self {
        Half {
            backward,
            points: Vec::new(),
            special: Vec::new(),
            stretches: Stretches::default(),
            end: End::Start,
            last: start.clone(),
            start,
            predictor: Predictor::default(),
            length,
            position: 0.0,
            growth: 1.0,
            beside: None,
            closing: None,
            early_end: EarlyEnd::default(),
            progress: Progress::default(),
            snaking: Snaking::default(),
            settled: false,
            keeps_mesh: 0,
            mesh: MeshTarget::default(),
            turned: false,
        }
    }

    /// Rejects a step, and sets the length of the next attempt.
    pub fn try_again(&mut self, length: f64) {
        self.length = length;
        self.last.quiet = 0.0;
    }

    /// Returns the arclength position of a point beyond the last point, and the derivatives of its
    /// parameters and monitors with respect to this position.
    pub fn slopes_at(&self, corrector: &mut Corrector, place: &CurvePoint) -> Slopes {
        let position = arclength(&corrector.norm, self.last.on_curve(), place.on_curve());
        let columns = corrector.slopes(place.on_curve(), place.point.monitors.len());
        Slopes { position, columns }.placed(self.position, self.growth)
    }

    /// Checks, after a successful step without a terminal event, whether this half of the branch
    /// ends. Returns the reason for the end if this half ends, or data on the lack of progress
    /// (`Crawl`) if this half makes hardly any progress. `snakes` specifies whether snaking ends
    /// the half.
    pub fn early_end(
        &mut self,
        corrector: &mut Corrector,
        settings: &Settings,
        step: &Step,
        snakes: bool,
    ) -> (Option<End>, Option<Crawl>) {
        let end = self.early_end.reached(
            corrector,
            settings,
            &step.place,
            &self.last,
            self.mesh.is_least(),
        );
        if matches!(end, Some(End::Homoclinic { .. })) {
            self.drop_noise();
        }
        let lengths = (step.length, settings.max_step);
        let (end, crawl) = match end {
            None => self.progress.end(corrector, &step.place, lengths),
            end => (end, None),
        };
        if !snakes {
            return (end, crawl);
        }
        (end.or_else(|| self.snaking.reached(corrector, step.since(&self.last))), crawl)
    }

    /// Accepts a step, given the slopes of the continued parameter at the start and at the end of
    /// the step.
    pub fn accept(&mut self, step: Step, [first, last]: [f64; 2]) {
        self.turned |= first.abs().min(last.abs()) < VERTICAL || first * last < 0.0;
        let left = std::mem::replace(&mut self.last, step.place);
        // If a test function is unknown at a point, a change of sign is detected at the next point
        // where it is known.
        for (test, before) in self.last.tests.iter_mut().zip(&left.tests) {
            *test = test.or(*before);
        }
        self.last.stability = self.last.stability.or(left.stability);
        self.predictor.push(left, step.length);
        self.settled = false;
    }

    /// Removes unconverged special points found close to a homoclinic orbit, where the parameters
    /// are constant and the signs of test functions are random.
    pub fn drop_noise(&mut self) {
        let moving = (self.points.len() + 1).saturating_sub(self.early_end.still());
        self.special.retain(|special| special.converged || special.after < moving);
    }

    /// Marks stability as undetermined at an end close to a homoclinic orbit if the number of unstable
    /// multipliers differs from the number at the last point before the parameters became constant:
    /// large multipliers hide small multipliers.
    pub fn doubt_stability(&self, end: &mut SpecialPoint) {
        let moving = self.points.len().saturating_sub(self.early_end.still());
        let before = self.points[..moving].last().and_then(|point| point.unstable);
        if before.zip(end.unstable).is_some_and(|(before, count)| before != count) {
            end.unstable = None;
            end.eigenvalues.clear();
            end.undetermined = Some(
                "close to a homoclinic orbit, errors change the number of unstable multipliers"
                    .into(),
            );
        }
    }

    /// Joins the items of this half, the start and the other half into one list, in order from one
    /// end of the branch to the other.
    pub fn join(mut self, start: Point, ahead: Half, branch: Branch) -> Branch {
        let before = self.points.len();
        self.points.reverse();
        self.special.reverse();
        for special in &mut self.special {
            // A special point after point k from the start lies before it from the end; an end
            // stays at its point.
            let on_point = special.after == before || special.kind == Kind::RG;
            special.after = before - special.after - usize::from(!on_point);
            special.bracket.reverse();
            special.tangent.iter_mut().for_each(|t| *t = -*t);
            // A special point at the start itself is stored in the direction of the branch.
            if before > 0 {
                special.slopes = special.slopes.take().map(Slopes::reversed);
            }
        }
        for point in &mut self.points {
            point.slopes = point.slopes.take().map(Slopes::reversed);
        }
        let moved =
            |special: SpecialPoint| SpecialPoint { after: special.after + before, ..special };
        let further = ahead.special.into_iter().map(moved);
        let special: Vec<SpecialPoint> = self.special.into_iter().chain(further).collect();
        Branch {
            points: self.points.into_iter().chain([start]).chain(ahead.points).collect(),
            stretches: self.stretches.join(ahead.stretches, before, &special),
            special,
            ends: [self.end, ahead.end],
            ..branch
        }
    }
}
