//! Where branches end though Newton's iteration still succeeds: on meshes that are too coarse, and
//! near homoclinic orbits.

use super::branch::End;
use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::settings::Settings;
use crate::core::bifurcation::At;
use crate::core::system::Traits;

/// (H) A branch ends after so many points in a row whose mesh is too coarse: it may lag behind the
/// solution for some steps, and then follows.
const MOST_COARSE: usize = 3;

/// (H) A branch ends after so many steps in a row along which the period grows and the parameters
/// change by no more than the errors of Newton's iteration and of the mesh, if they have changed
/// before: beyond, what is left is noise.
const MOST_STILL: usize = 3;

/// (D) The error of parameters is this power of the error of the solution, since collocation
/// converges faster at its nodes: the lowest ratio of the two orders, `2m` and `m + 1`, for degrees
/// from 3.
const SUPERCONVERGENCE: f64 = 1.5;

/// What was met along a half of a branch.
#[derive(Default)]
pub(super) struct EarlyEnd {
    /// The points in a row whose mesh is too coarse.
    coarse: usize,
    /// The steps in a row along which only the period grows.
    still: usize,
    /// Whether parameters have changed.
    moved: bool,
    /// The shortest and the last period.
    periods: Option<[f64; 2]>,
}

impl EarlyEnd {
    /// The end of the branch at a place that was accepted, after the place before it.
    pub fn reached(
        &mut self,
        corrector: &mut Corrector,
        settings: &Settings,
        place: &CurvePoint,
        before: &CurvePoint,
    ) -> Option<End> {
        corrector.equations.load(&place.unknowns);
        let At { system, x, .. } = corrector.equations.at();
        let Traits { mesh_error: error, free_period, .. } = system.traits(x);
        let (limit, growth) = (settings.max_mesh_error, settings.max_period_growth);
        self.coarse = if error > limit { self.coarse + 1 } else { 0 };
        if self.coarse >= MOST_COARSE {
            return Some(End::MeshTooCoarse { error, limit });
        }
        // A forcing's period grows as it is told to.
        let period = free_period?;
        let [shortest, last] = self.periods.unwrap_or([period; 2]);
        let first = corrector.equations.parameters_at();
        let parameters = place.unknowns[first..].iter().zip(&before.unknowns[first..]);
        let changes =
            parameters.enumerate().map(|(k, (a, b))| corrector.norm.scaled(first + k, a - b).abs());
        let change = changes.fold(0.0, f64::max);
        let least = settings.tolerance.max(error.powf(SUPERCONVERGENCE));
        let still = change <= least && period > last;
        self.still = if still && self.moved { self.still + 1 } else { 0 };
        self.moved |= change > 1e3 * least;
        let shortest = shortest.min(period);
        self.periods = Some([shortest, period]);
        let long = period > growth * shortest || self.still >= MOST_STILL;
        long.then_some(End::LongPeriod { period, shortest })
    }
}
