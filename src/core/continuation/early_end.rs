//! Ends of branches at points where Newton's method still converges: because the mesh is too
//! coarse, or because orbits approach a homoclinic orbit.

use super::corrector::{Corrector, SUPERCONVERGENCE};
use super::curve_point::CurvePoint;
use super::end::End;
use super::settings::Settings;
use super::standstill::Standstill;
use crate::core::bifurcation::At;
use crate::core::system::{Approach, HOMOCLINIC_RATES, Traits};

/// Heuristic: a branch ends after this number of consecutive points whose mesh is too coarse; mesh
/// adaptation may follow changes of the solution with a delay of a few steps.
const MOST_COARSE: usize = 3;

/// Heuristic: a branch ends after this number of consecutive steps towards a homoclinic orbit. When
/// a branch approaches a homoclinic orbit, the changes of the parameters per step decrease to less
/// than the errors of Newton's method and of the mesh. Farther along the branch, the parameters
/// contain only numerical noise.
const MOST_STILL: usize = 3;

/// Heuristic: a branch whose period has grown by this factor during its steps towards a homoclinic
/// orbit ends after fewer such steps. The orbit spends the additional time near the equilibrium,
/// where the mesh soon becomes too coarse.
const GROWN: f64 = 1.1;

/// Heuristic: Near a homoclinic orbit, only the time near the equilibrium grows: the relative
/// change of the extents of a cycle is smaller than this fraction of the relative change of its
/// period.
const STILL: f64 = 0.05;

/// Heuristic: the branch ends when the distance of the cycle from the equilibrium is smaller than
/// this fraction of the distance at the point where the parameters became constant.
const NEARER: f64 = 0.8;

/// Heuristic: a cycle is near a homoclinic orbit if its distance from an equilibrium is less than
/// this fraction of its extents. Cycles of slow–fast systems, which are not homoclinic, spend long
/// times at distances of 5e-4 and more from saddles.
const NEAR: f64 = 2e-4;

/// Heuristic: a leading eigenvalue counts as nearly zero if it is smaller than this fraction of its
/// largest value on the same half of the branch. Homoclinic orbits to a non-hyperbolic equilibrium
/// take infinite time in the truncated problem, and steps towards them become ever smaller.
const WEAK: f64 = 1e-3;

/// Heuristic: if no step succeeds, or if the eigenvalue stands still, a leading eigenvalue smaller
/// than this fraction of its largest value is reported as the reason.
const WEAK_AT_FAILURE: f64 = 0.05;

/// Heuristic: a curve of special points of cycles follows homoclinic orbits if the period stands
/// still on the finest allowed mesh, and if the cycles pass a saddle at a distance of less than this
/// fraction of their extents.
const NEAR_ON_CURVE: f64 = 0.05;

/// The data of the checks that can end one half of a branch at a point where Newton's method still
/// converges.
#[derive(Default)]
pub(super) struct EarlyEnd {
    /// The number of consecutive points whose mesh is too coarse.
    coarse: usize,
    /// The number of consecutive steps towards a homoclinic orbit.
    still: usize,
    /// Whether constant parameters indicate a homoclinic orbit. Constant parameters indicate a
    /// homoclinic orbit if the parameters changed earlier along the branch, or if the branch
    /// started near a homoclinic orbit.
    may_halt: bool,
    /// The shortest and the last period along this half of the branch.
    periods: Option<[f64; 2]>,
    /// The distance of the cycle from an equilibrium and its period, at the point where the
    /// parameters became constant.
    halt: Option<(Approach, f64)>,
    /// The leading eigenvalues of the saddle of homoclinic orbits.
    rates: [Rate; 2],
    /// The period on the finest allowed mesh of a curve of special points.
    standstill: Standstill,
    /// Whether the states of some segment have become small compared with their scales.
    pub small: bool,
}

/// A leading eigenvalue of the saddle of homoclinic orbits, along one half of a branch.
#[derive(Clone, Copy, Default)]
struct Rate {
    largest: f64,
    last: f64,
    /// Whether the eigenvalue stands still: only the excursion time grows then, and the parameters
    /// change by less than the errors of Newton's method.
    still: bool,
    standstill: Standstill,
}

impl Rate {
    fn note(&mut self, rate: f64) {
        self.last = rate;
        self.largest = self.largest.max(rate.abs());
        self.still = self.standstill.reached(rate);
    }

    fn below(&self, part: f64) -> bool {
        self.last.abs() < part * self.largest
    }

    fn is_weak(&self) -> bool {
        self.below(WEAK) || self.still && self.below(WEAK_AT_FAILURE)
    }
}

/// Discretisation: States smaller than this threshold, in units of their scales, have at most three
/// significant digits, because tolerances of 1e-10 are relative to the scales.
const SMALL: f64 = 1e-7;

impl EarlyEnd {
    /// Returns the number of consecutive steps towards a homoclinic orbit, including the last step.
    pub fn still(&self) -> usize {
        self.still
    }

    /// Returns the reason why the branch ends at an accepted point, if one of the checks requires
    /// its end; `before` is the preceding point. `is_finest` states whether the curve has the finest
    /// mesh that is allowed on curves of special points.
    pub fn reached(
        &mut self,
        corrector: &mut Corrector,
        settings: &Settings,
        place: &CurvePoint,
        before: &CurvePoint,
        is_finest: bool,
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
        if let Some(end) = self.weak_saddle(Rate::is_weak) {
            return Some(end);
        }
        // The period of a forcing depends on parameters only.
        let period = free_period?;
        if is_finest
            && self.standstill.reached(period)
            && let Some(Approach { distance, is_saddle: true, .. }) = approach(corrector, place)
            && distance < NEAR_ON_CURVE
        {
            return Some(End::Homoclinic { period, distance });
        }
        if self.periods.is_none() {
            // A branch that starts near a homoclinic orbit begins with constant parameters.
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

    /// Records the leading eigenvalues of the equilibrium of a homoclinic orbit.
    fn note_rates(&mut self, names: &[String], monitors: &[f64]) {
        for (name, rate) in HOMOCLINIC_RATES.into_iter().zip(&mut self.rates) {
            let Some(at) = names.iter().position(|own| own == name) else { return };
            rate.note(monitors[at]);
        }
    }

    /// Returns the end of a curve of homoclinic orbits whose equilibrium has become nearly
    /// non-hyperbolic: a leading eigenvalue is nearly zero.
    fn weak_saddle(&self, is_weak: impl Fn(&Rate) -> bool) -> Option<End> {
        let mut all = HOMOCLINIC_RATES.into_iter().zip(&self.rates);
        let (name, &Rate { largest, last: rate, .. }) = all.find(|(_, rate)| is_weak(rate))?;
        Some(End::WeakSaddle { name: name.into(), largest, rate })
    }

    /// Replaces the end of one half of a branch by the reason why no step succeeds at that end, if
    /// the reason is known.
    pub fn explained(&self, end: End) -> End {
        match end {
            End::StepTooSmall { .. } | End::NoProgress { .. } | End::MeshTooCoarse { .. } => {
                self.weak_saddle(|rate| rate.below(WEAK_AT_FAILURE)).unwrap_or(end)
            }
            end => end,
        }
    }

    /// Returns the distance of a cycle from an equilibrium, if several consecutive steps have
    /// approached a homoclinic orbit.
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

/// Returns the change of the parameters in a step, in units of their scales.
fn changed(corrector: &Corrector, place: &CurvePoint, before: &CurvePoint) -> f64 {
    let first = corrector.equations.parameters_at();
    let parameters = place.unknowns[first..].iter().zip(&before.unknowns[first..]);
    let changes =
        parameters.enumerate().map(|(k, (a, b))| corrector.norm.scaled(first + k, a - b).abs());
    changes.fold(0.0, f64::max)
}

/// Computes the smallest distance of a cycle from an equilibrium.
fn approach(corrector: &mut Corrector, place: &CurvePoint) -> Option<Approach> {
    corrector.equations.load(&place.unknowns);
    let At { system, x, .. } = corrector.equations.at();
    system.discretised()?.approach(x)
}

/// Heuristic: if deviations grow by more than the first factor over a segment, the growth is reported
/// as the reason why no step succeeds; by more than the second factor, as the reason why steps are short.
const STEEP: [f64; 2] = [1e3, 1e5];

/// Returns the factor by which deviations grow over a segment of the last assembled orbit, if the
/// growth may be the reason why one half of a branch ended.
pub(super) fn stopping_growth(corrector: &mut Corrector, end: &End) -> Option<f64> {
    let steep = match end {
        End::StepTooSmall { .. } => STEEP[0],
        End::NoProgress { .. } | End::PointLimit { .. } => STEEP[1],
        _ => return None,
    };
    let At { system, x, .. } = corrector.equations.at();
    let growth = system.traits(x).growth;
    (growth > steep).then_some(growth)
}
