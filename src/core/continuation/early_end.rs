//! Where branches end though Newton's iteration still succeeds: on meshes that are too coarse, and
//! near homoclinic orbits.

use super::corrector::{Corrector, SUPERCONVERGENCE};
use super::curve_point::CurvePoint;
use super::end::End;
use super::settings::Settings;
use crate::core::bifurcation::At;
use crate::core::system::{Approach, HOMOCLINIC_RATES, Traits};

/// (H) A branch ends after so many points in a row whose mesh is too coarse: it may lag behind the
/// solution for some steps, and then follows.
const MOST_COARSE: usize = 3;

/// (H) A branch ends after so many steps in a row towards a homoclinic orbit along which the
/// parameters change by no more than the errors of Newton's iteration and of the mesh, if they have
/// changed before: beyond, what is left is noise.
const MOST_STILL: usize = 3;

/// (H) Fewer steps are enough if the period has grown by this factor meanwhile: a tenth of the period
/// more beside the equilibrium, where the mesh soon fails.
const GROWN: f64 = 1.1;

/// (H) Near a homoclinic orbit the extents of a cycle change by less than this part of the growth
/// of the period, both relative to their sizes: all that grows is the time beside the equilibrium.
const STILL: f64 = 0.05;

/// (H) The distance from the equilibrium falls to less than this part of what it was where the
/// parameters came to a halt.
const NEARER: f64 = 0.8;

/// (H) A cycle is near a homoclinic orbit if its distance from an equilibrium is less than this part
/// of its extents. The cycles of slow–fast systems grow long beside saddles at 5e-4 and more.
const NEAR: f64 = 2e-4;

/// (H) A leading eigenvalue smaller than this part of the largest one on the half of the branch is near
/// zero: homoclinic orbits to an equilibrium that is no saddle are reached in infinite time, and steps
/// towards them become ever smaller.
const WEAK: f64 = 1e-3;

/// (H) Where no step succeeds, a leading eigenvalue smaller than this part of the largest one is the reason.
const WEAK_AT_FAILURE: f64 = 0.05;

/// What was met along a half of a branch.
#[derive(Default)]
pub(super) struct EarlyEnd {
    /// The points in a row whose mesh is too coarse.
    coarse: usize,
    /// The steps in a row towards a homoclinic orbit.
    still: usize,
    /// Whether standing still is a halt: parameters have changed, or came to a halt before the start.
    may_halt: bool,
    /// The shortest and the last period.
    periods: Option<[f64; 2]>,
    /// How near a cycle came to an equilibrium where the parameters came to a halt, and its period.
    halt: Option<(Approach, f64)>,
    /// The largest leading eigenvalues of the saddles of homoclinic orbits, and the last ones.
    rates: [[f64; 2]; 2],
    /// Whether a segment's states have become small.
    pub small: bool,
}

/// (D) States smaller than this, in units of their scales, have three digits or fewer: tolerances of
/// 1e-10 are relative to the scales.
const SMALL: f64 = 1e-7;

impl EarlyEnd {
    /// The number of consecutive steps towards a homoclinic orbit, including the last one.
    pub fn still(&self) -> usize {
        self.still
    }

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
        let Traits { mesh_error: error, free_period, least_size, .. } = system.traits(x);
        self.small |= least_size < SMALL;
        let (limit, growth) = (settings.max_mesh_error, settings.max_period_growth);
        self.coarse = if error > limit { self.coarse + 1 } else { 0 };
        if self.coarse >= MOST_COARSE {
            return Some(End::MeshTooCoarse { error, limit });
        }
        self.note_rates(&system.names().monitors, &place.point.monitors);
        if let Some(end) = self.weak_saddle(WEAK) {
            return Some(end);
        }
        // A forcing's period grows as it is told to.
        let period = free_period?;
        if self.periods.is_none() {
            // A branch that starts near a homoclinic orbit has come to its halt before.
            self.may_halt = approach(corrector, before).is_some_and(|start| start.distance <= NEAR);
            corrector.equations.load(&place.unknowns);
        }
        let [shortest, last] = self.periods.unwrap_or([period; 2]);
        let change = changed(corrector, place, before);
        let least = settings.tolerance.max(error.powf(SUPERCONVERGENCE));
        let still = self.may_halt && change <= least && period > last;
        let approach = if still { approach(corrector, place) } else { None };
        let distance = self.nearer(approach, period, error);
        self.may_halt |= change > 1e3 * least;
        let shortest = shortest.min(period);
        self.periods = Some([shortest, period]);
        if period > growth * shortest {
            return Some(End::LongPeriod { period, shortest });
        }
        Some(End::Homoclinic { period, distance: distance? })
    }

    /// Notes the leading eigenvalues of the equilibrium of a homoclinic orbit.
    fn note_rates(&mut self, names: &[String], monitors: &[f64]) {
        for (name, [largest, last]) in HOMOCLINIC_RATES.into_iter().zip(&mut self.rates) {
            let Some(at) = names.iter().position(|own| own == name) else { return };
            *last = monitors[at];
            *largest = largest.max(last.abs());
        }
    }

    /// The end of a curve of homoclinic orbits where their equilibrium is hardly a saddle: a leading
    /// eigenvalue has fallen to less than a part of its largest value.
    fn weak_saddle(&self, part: f64) -> Option<End> {
        let all = HOMOCLINIC_RATES.into_iter().zip(self.rates);
        let mut weak = all.filter(|(_, [largest, rate])| rate.abs() < part * largest);
        let (name, [largest, rate]) = weak.next()?;
        Some(End::WeakSaddle { name: name.into(), largest, rate })
    }

    /// The end of a half, or the reason why no step succeeds there.
    pub fn explained(&self, end: End) -> End {
        match end {
            End::StepTooSmall { .. } | End::NoProgress { .. } | End::MeshTooCoarse { .. } => {
                self.weak_saddle(WEAK_AT_FAILURE).unwrap_or(end)
            }
            end => end,
        }
    }

    /// The distance from an equilibrium of a cycle that comes near a homoclinic orbit, if it has for
    /// some steps.
    fn nearer(&mut self, now: Option<Approach>, period: f64, error: f64) -> Option<f64> {
        let Some(now) = now else {
            (self.still, self.halt) = (0, None);
            return None;
        };
        let (from, before) = self.halt.get_or_insert_with(|| (now.clone(), period));
        let allowed = STILL * (period / *before).ln() + 2.0 * error;
        let mut extents = from.extents.iter().zip(&now.extents);
        if !extents.all(|(a, b)| (b - a).abs() <= allowed * a.max(*b)) {
            (self.still, self.halt) = (1, Some((now, period)));
            return None;
        }
        self.still += 1;
        let nearer = now.distance <= NEAR.min(NEARER * from.distance);
        let long = self.still >= MOST_STILL || period >= GROWN * *before;
        (long && nearer).then_some(now.distance)
    }
}

/// By how much the parameters change in a step, in units of their scales.
fn changed(corrector: &Corrector, place: &CurvePoint, before: &CurvePoint) -> f64 {
    let first = corrector.equations.parameters_at();
    let parameters = place.unknowns[first..].iter().zip(&before.unknowns[first..]);
    let changes =
        parameters.enumerate().map(|(k, (a, b))| corrector.norm.scaled(first + k, a - b).abs());
    changes.fold(0.0, f64::max)
}

/// How near the cycle at a place comes to an equilibrium.
fn approach(corrector: &mut Corrector, place: &CurvePoint) -> Option<Approach> {
    corrector.equations.load(&place.unknowns);
    let At { system, x, .. } = corrector.equations.at();
    system.discretised()?.approach(x)
}

/// (H) Where deviations grow by more than this over a segment, steps are short for that reason.
const STEEP: f64 = 1e5;

/// By how much deviations grow over a segment of the last point, assembled last, if that may be why
/// a half of a branch got no farther.
pub(super) fn stopping_growth(corrector: &mut Corrector, end: &End) -> Option<f64> {
    let stopped =
        matches!(end, End::StepTooSmall { .. } | End::NoProgress { .. } | End::PointLimit { .. });
    let At { system, x, .. } = corrector.equations.at();
    let growth = system.traits(x).growth;
    (stopped && growth > STEEP).then_some(growth)
}
