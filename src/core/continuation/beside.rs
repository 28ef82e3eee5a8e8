//! Starting points of curves that emanate from a codimension-two point at which the equations of
//! the curve are singular.

use super::builder::Continuation;
use super::event::MakeCondition;
use crate::core::bifurcation::{
    At, DoubledOrbit, NullSpace, catalogue, doubled_beside, has_pairs_beside, pairs_beside,
};
use crate::core::failure::Failure;
use crate::core::linalg::norm;
use crate::core::problem::{Dynamics, Names};
use crate::core::system::{Kind, Site, Solution, Start};

/// Heuristic: the largest angle by which the critical multipliers of the first orbit on a curve of
/// torus points may differ from their value at the resonance.
const WIDEST: f64 = 0.3;

/// Iterates over the kinds of special points whose defining systems are held along a curve;
/// user-defined defining systems are omitted.
fn held<'c>(curve: &'c Continuation) -> impl Iterator<Item = Kind> + 'c {
    let known = |(kind, make): &(Kind, Option<MakeCondition>)| make.is_none().then_some(*kind);
    curve.held.iter().filter_map(known)
}

/// Returns the amplitude of the first orbit of a curve that emanates from a codimension-two point,
/// if the curve consists of bifurcation points of cycles near an equilibrium, or of orbits with
/// twice the period; `None` for other curves.
pub(super) fn amplitude(curve: &Continuation, point: &Solution) -> Option<f64> {
    let which = point.switch.unwrap_or(0);
    let leaves = |held| match point.mesh.is_empty() {
        _ if catalogue::is_of_doubled((point.kind, point.condition), held, which) => true,
        of_equilibria => of_equilibria && catalogue::is_of_cycles(point.kind, held),
    };
    let of_orbits = curve.system.dynamics() == Dynamics::Periodic;
    (of_orbits && held(curve).any(leaves)).then_some(curve.settings.initial_step)
}

/// Computes the start of a curve near the codimension-two point from which the system has resumed,
/// if the curve consists of orbits with twice the period, or of points with a critical pair that
/// emanates at a double eigenvalue; `None` for other curves. The guess of the first point is stored
/// in `x` of `curve`.
pub(super) fn beside(
    curve: &mut Continuation,
    point: &Solution,
    resumed: &Start,
) -> Result<Option<Start>, Failure> {
    let is_fold_of_cycles = |held| held == Kind::LP && catalogue::is_of_cycles(point.kind, held);
    if curve.system.dynamics() != Dynamics::Periodic && held(curve).any(is_fold_of_cycles) {
        return Err(Failure::Unsupported(format!(
            "a curve of folds of cycles emanates from a {}, but this problem has no cycles",
            point.kind.meaning()
        )));
    }
    let pairs = held(curve).any(|kind| has_pairs_beside(point.kind, kind));
    let start = match point.beside {
        Some(part) => doubled(curve, (point.kind, part), resumed)?,
        None if pairs => critical_pairs(curve, point.kind)?,
        None => return Ok(None),
    };
    let (frequency, beside) = (start.angle, Some(curve.settings.initial_step));
    curve.origin = Some(Solution { frequency, beside, ..point.clone() });
    Ok(Some(start))
}

/// Returns the indices of the released parameters among all parameters.
pub(super) fn released_in(names: &Names, released: &[(String, [f64; 2])]) -> Vec<usize> {
    let place = |(name, _): &(String, _)| names.parameters.iter().position(|known| known == name);
    released.iter().filter_map(place).collect()
}

/// Returns the data of the point from which the system has resumed, together with the released
/// parameters of the curve.
fn at<'c>(curve: &'c mut Continuation, released: &'c [usize], null: &'c mut NullSpace) -> At<'c> {
    let Continuation { system, x, .. } = curve;
    At { system: &mut **system, x, released, held: &[], null }
}

/// Computes the first orbit of a curve of period-doubled orbits, starting from the codimension-two
/// orbit traversed twice.
fn doubled(
    curve: &mut Continuation,
    (kind, part): (Kind, f64),
    resumed: &Start,
) -> Result<Start, Failure> {
    if resumed.site != Site::BranchPoint {
        return Err(Failure::Unsupported(
            "the curve starts from an orbit of twice the period, but the system does not define \
             such orbits"
                .into(),
        ));
    }
    let released = released_in(curve.system.names(), &curve.released);
    let null = &mut NullSpace::default();
    let orbit = doubled_beside(&mut at(curve, &released, null), kind, part)?;
    let DoubledOrbit { deviation, angle } = orbit;
    curve.x.iter_mut().zip(&deviation).for_each(|(x, d)| *x += d);
    let z = curve.x[..resumed.z.len()].to_vec();
    let (direction, site, one_sided) = (Some(deviation), Site::Beside, true);
    Ok(Start { site, one_sided, angle, ..Start::point(z, direction) })
}

/// Computes the first point of a curve of bifurcations with a critical pair. The curve emanates
/// from a point with a double eigenvalue; at that point, the frequency of the pair is 0, or the
/// angle of its multipliers is 0 or π. States change by a fraction of their sizes, parameters by a
/// fraction of their ranges, and parameters stay within their ranges.
fn critical_pairs(curve: &mut Continuation, kind: Kind) -> Result<Start, Failure> {
    let released = released_in(curve.system.names(), &curve.released);
    let n = curve.system.names().dimension();
    let null = &mut NullSpace::default();
    let slope = pairs_beside(&mut at(curve, &released, null), kind)?;
    let size = Some(norm(&curve.x[..n])).filter(|size| *size > 0.0).unwrap_or(1.0);
    let (mut fastest, mut square) = (norm(&slope[..n]) / size, f64::INFINITY);
    for (&p, (_, [low, high])) in released.iter().zip(&curve.released) {
        let (from, rate) = (curve.x[n + p], slope[n + p]);
        let bound = if rate > 0.0 { *high } else { *low };
        if rate != 0.0 {
            square = square.min(0.5 * (bound - from) / rate);
            fastest = fastest.max(rate.abs() / (high - low));
        }
    }
    square = square.min(curve.settings.initial_step / fastest);
    let is_orbit = curve.system.dynamics() == Dynamics::Periodic;
    if is_orbit {
        square = square.min(WIDEST * WIDEST);
    }
    if !(square > 0.0 && square.is_finite()) {
        return Err(Failure::Mismatch(format!(
            "the curve that starts at the {} leaves the ranges of the parameters immediately: widen the ranges",
            kind.meaning()
        )));
    }
    curve.x.iter_mut().zip(&slope).for_each(|(x, slope)| *x += square * slope);
    let frequency = square.sqrt();
    let angle = if kind == Kind::R2 { std::f64::consts::PI - frequency } else { frequency };
    Ok(Start { angle: Some(angle), ..Start::point(curve.x[..n].to_vec(), None) })
}
