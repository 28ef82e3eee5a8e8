//! The end of a branch at a discontinuity of a reset map.

use super::branch::Point;
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::end::End;
use super::half::Half;
use super::steps::Steps;
use crate::core::linalg::advanced;
use crate::core::system::{Jump, Kind};

/// Heuristic: the distance ahead within which a discontinuity is searched for, in units of the
/// failed step.
const AHEAD: f64 = 2.0;

/// Heuristic: the distance before a discontinuity at which a branch ends, as a fraction of the
/// distance within which the discontinuity was searched for. Closer to the discontinuity, rounding
/// determines on which side a solution lies.
const SHORT_OF: f64 = 1e-5;

impl Steps<'_> {
    /// Returns the end of the branch and its last point, if no step succeeds because a reset is
    /// discontinuous at a point ahead.
    pub(super) fn end_at_jump(&mut self, half: &mut Half, step: f64) -> Option<End> {
        let Curve { corrector, recorder, .. } = &mut self.curve;
        let (from, along) = (&half.last, AHEAD * step);
        let ahead = advanced(&from.unknowns, along, &from.tangent);
        let solutions = [&from.unknowns, &ahead].map(|u| corrector.equations.load(u).to_vec());
        let events = corrector.equations.system().events()?;
        let Jump { share, event, state, states: [before, beyond] } =
            events.jump_between(solutions.each_ref().map(|x| &x[..]))?;
        let end = End::ResetJumps { event, state, from: before, to: beyond };
        let share = (share - SHORT_OF).max(0.0);
        let unknowns = advanced(&from.unknowns, share * along, &from.tangent);
        corrector.equations.assemble(&unknowns).ok()?;
        let point = recorder.record(&mut corrector.equations, false).ok()?.point;
        let point = Point { unstable: from.point.unstable, ..point };
        half.last = CurvePoint { unknowns, point, ..from.clone() };
        half.points.push(half.last.point.clone());
        let (after, event) = (half.points.len(), (Kind::G, &end.to_string()[..]));
        let mut special = recorder.saved_point(corrector, &half.last, event, after);
        special.error += corrector.mesh_share(&half.last.unknowns) + SHORT_OF * along;
        self.log.point(&half.last.point);
        self.log.special(&mut half.special, special);
        Some(end)
    }
}
