//! Guesses of homoclinic orbits, from nearby cycles and from saved orbits.

use super::leading::Side;
use super::saddle::{Frame, Saddle};
use super::{BEFORE_PLACE, HomoclinicOrbit};
use crate::core::bvp::erased::{ErasedProblem, Number};
use crate::core::bvp::itineraries::Guess;
use crate::core::bvp::trajectory::Trajectory;
use crate::core::failure::Failure;
use crate::core::problem::{FieldIn, Pace};
use crate::core::system::HOMOCLINIC_RADIUS;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Heuristic: the distance from the equilibrium, in units of the states' ranges, beyond which a
/// nearby cycle gives the guess of the homoclinic orbit; closer to the equilibrium, the linear flow
/// gives the guess.
const NEAR: f64 = 1e-3;

/// Heuristic: the largest distance from the equilibrium, in units of the states' ranges, at which a
/// cycle counts as near a homoclinic orbit.
const FAR: f64 = 0.05;

/// Rounding: a state counts as constant if it changes by less than this fraction of the motion:
/// tolerances are relative, and changes this small would have few correct digits.
const STANDS_STILL: f64 = 1e-5;

/// Rounding: Changes of a state by less than this fraction of the motion count as rounding errors.
/// The changes of each state are measured in units of its scale.
const ROUNDING: f64 = 1e-8;

/// Discretisation: the largest intended error of the bifurcation parameter due to the truncation of
/// the homoclinic orbit at finite distances from the equilibrium.
const TRUNCATION: f64 = 1e-14;

/// Rounding: the smallest distance of an orbit's end from the equilibrium, as a multiple of the
/// rounding error of the states.
const DIGITS: f64 = 1e8;

/// Heuristic: the ratio of two distances from the equilibrium: the distance at which the part taken
/// from the cycle ends, and the distance at which the linear flow ends.
const CLEAR: f64 = 1.1;

/// Heuristic: the largest distance of an orbit's end from the equilibrium, as a multiple of the
/// smallest distance that rounding errors permit.
const WIDEST: f64 = 50.0;

/// Heuristic: the number of samples of a trajectory between two of its nodes.
const PARTS: usize = 8;

/// Heuristic: the approximate largest change of the state between two neighbouring nodes of the
/// linear flow, as a fraction of the distance from the equilibrium.
const STEP: f64 = 0.5;

/// Heuristic: the largest number of nodes of the linear flow at one end of the orbit.
const MOST_NODES: usize = 10_000;

/// Rounding: the number of bisections that locate a time to double precision.
const HALVINGS: usize = 60;

fn refused(reason: String) -> Failure {
    Failure::Mismatch(format!(
        "a branch of homoclinic orbits cannot start at this solution: \
                               {reason}"
    ))
}

/// A point of a trajectory: time and states.
type Place = (f64, Vec<f64>);

/// A cycle, given by its vector `q` of parameters and extra unknowns, by the times of its nodes,
/// and by a function that returns its states at any time within a period.
pub(in crate::core::bvp) struct Cycle<'a> {
    pub q: &'a [f64],
    pub times: Vec<f64>,
    pub states: &'a dyn Fn(f64) -> Result<Vec<f64>, Failure>,
}

/// Creates a guess of the homoclinic orbit near a cycle of an autonomous field: the cycle without its
/// slowest part, continued at both ends by the linear flow near the equilibrium.
///
/// # Errors
/// [`Failure`] unless the problem describes cycles with a free period and a saddle is near the
/// cycle.
pub(in crate::core::bvp) fn from_cycle(
    cycles: ErasedProblem,
    cycle: &Cycle,
    radius: f64,
) -> Result<Guess<ErasedProblem>, Failure> {
    let (parameters, q) = (cycles.parameters().len(), cycle.q);
    if !cycles.shape().phase() || q.len() != parameters + 1 {
        let reason = "the start must be a smooth cycle whose period is one of the unknowns, not fixed by a forcing";
        return Err(refused(reason.into()));
    }
    let field = f64::residual(&*cycles).on_segment(0, q);
    let places = places_on(cycle)?;
    let sizes = extents(places.iter().map(|it| &it.1[..]), cycles.scales(0, q));
    let slowest = slowest(&field, &places, q, &sizes);
    let saddle = Saddle::near(&field, &places[slowest].1, q, sizes)?;
    let least = places.iter().map(|it| saddle.distance(&it.1)).fold(f64::INFINITY, f64::min);
    if least > FAR {
        return Err(refused(format!(
            "the smallest distance between the cycle and the equilibrium is {least:.1e} of the \
             cycle's extent, but must be below {FAR}: continue the branch of cycles to longer \
             periods"
        )));
    }
    let ends = radii_for(&saddle, &field, q).map(|share| share.max(resolved(&saddle) / radius));
    let widest = radius * ends[0].max(ends[1]);
    let wanted = ends.map(|share| share * radius);
    let beside = (NEAR.max(3.0 * least).max(2.0 * widest), wanted);
    let [from, to] = excursion(cycle, &places, (&saddle, beside))?;
    let [first, last] = wanted;
    let lead = linear(&saddle, &saddle.outgoing, (&from.1, -first), (&field, q))?;
    let trail = linear(&saddle, &saddle.incoming, (&to.1, last), (&field, q))?;
    let middle = between(&places, [from, to], q[parameters]);
    let arrives = middle.last().map_or(0.0, |it| it.0);
    let trail = trail.into_iter().map(|(time, x)| (arrives + time, x));
    let all: Vec<Place> = lead.into_iter().rev().chain(middle).chain(trail).collect();
    let (begins, start) = &all[0];
    let (_, end) = &all[all.len() - 1];
    let pace = paced(&all, (&field, q), &saddle.sizes);
    let mut orbit = Trajectory::from(start.clone());
    all.iter().for_each(|(time, x)| {
        orbit.push(pace.duration * pace.place((time - begins) / pace.duration), x);
    });
    let radii = radii(&saddle, [start, end]);
    Ok(guess(cycles, saddle, radii, orbit, pace))
}

/// Returns the change of time that moves the centre of an orbit, weighted by the squared speed, to
/// the middle of the mesh.
fn paced(orbit: &[Place], (field, q): (&impl FieldIn<f64>, &[f64]), sizes: &[f64]) -> Pace<f64> {
    let [begins, ends] = [0, orbit.len() - 1].map(|k| orbit[k].0);
    let duration = ends - begins;
    let parts: Vec<[f64; 2]> = orbit
        .windows(2)
        .map(|pair| {
            let squares = [0, 1].map(|k| squared_speed(field, &pair[k].1, q, sizes));
            let middle = 0.5 * (pair[0].0 + pair[1].0) - begins;
            [middle / duration, (pair[1].0 - pair[0].0) * 0.5 * (squares[0] + squares[1])]
        })
        .collect();
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let pace = Pace { duration, share: 0.5 * (low + high) };
        let off = parts.iter().map(|[passed, weight]| weight * (pace.place(*passed) - 0.5));
        *(if off.sum::<f64>() > 0.0 { &mut low } else { &mut high }) = pace.share;
    }
    Pace { duration, share: 0.5 * (low + high) }
}

/// Returns the part of a cycle between two of its points, with times counted from the first point.
fn between(places: &[Place], [from, to]: [Place; 2], period: f64) -> Vec<Place> {
    let since = |time: f64| (time - from.0).rem_euclid(period);
    let length = since(to.0);
    let inside = places.iter().map(|(time, x)| (since(*time), x.clone()));
    let mut inside: Vec<Place> = inside.filter(|it| it.0 > 0.0 && it.0 < length).collect();
    inside.sort_by(|a, b| a.0.total_cmp(&b.0));
    let first = std::iter::once((0.0, from.1));
    first.chain(inside).chain([(length, to.1)]).collect()
}

/// Returns the distances from the equilibrium at which a homoclinic orbit can begin and end, in
/// units of the smallest distance that rounding errors permit. A homoclinic orbit that is truncated
/// at the distance `ε` from the equilibrium has an error of the order `ε^(2 + r)` in the parameter,
/// where `r` is the ratio of the leading rates. If the ratio `r` of the leading rates is large, a
/// homoclinic orbit that is truncated closer to the equilibrium gains no accuracy, and deviations
/// grow by more than double precision allows.
fn radii_for(saddle: &Saddle, field: &impl FieldIn<f64>, q: &[f64]) -> [f64; 2] {
    let (_, matrix) = super::jacobian(field, &saddle.place, q, saddle);
    let rate = |side| saddle.leading(&matrix).and_then(|leading| leading.rate(side));
    let ratio = match (rate(Side::Outgoing), rate(Side::Incoming)) {
        (Some(unstable), Some(stable)) => (stable / unstable).abs(),
        _ => f64::NAN,
    };
    [ratio, ratio.recip()].map(|r| {
        let share = TRUNCATION.powf((2.0 + r).recip()) / HOMOCLINIC_RADIUS;
        if share.is_nan() { 1.0 } else { share.clamp(1.0, WIDEST) }
    })
}

/// Returns the smallest distance from the equilibrium at which the deviations of the states have
/// enough digits despite rounding errors.
fn resolved(saddle: &Saddle) -> f64 {
    let parts = saddle.place.iter().zip(&saddle.sizes).map(|(x, size)| (x / size).abs());
    DIGITS * f64::EPSILON * parts.fold(0.0, f64::max)
}

/// Returns the distances of both ends of an orbit from the equilibrium, measured in the unstable
/// and in the stable subspace.
fn radii(saddle: &Saddle, [start, end]: [&[f64]; 2]) -> [f64; 2] {
    let distance = |frame: &Frame, x: &[f64]| frame.distance(&saddle.deviation(x));
    [distance(&saddle.outgoing, start), distance(&saddle.incoming, end)]
}

fn guess(
    cycles: ErasedProblem,
    saddle: Saddle,
    radii: [f64; 2],
    orbit: Trajectory,
    Pace { duration, share }: Pace<f64>,
) -> Guess<ErasedProblem> {
    let coordinates = saddle.outgoing.coordinates() + saddle.incoming.coordinates();
    let extras = [&[duration, share, 0.0], &saddle.place[..], &vec![0.0; coordinates]].concat();
    let parameters = cycles.parameters().len();
    let problem: ErasedProblem = Arc::new(HomoclinicOrbit { cycles, parameters, saddle, radii });
    Guess { problem, trajectories: vec![orbit], extras, beside: None }
}

/// Creates the problem of a saved homoclinic orbit, which is given by its nodes, one after another,
/// and by its extra unknowns; the extra unknowns are converted to the problem's new frames.
///
/// # Errors
/// [`Failure`] if the extra unknowns do not belong to a homoclinic orbit of this field.
pub(in crate::core::bvp) fn from_saved(
    cycles: ErasedProblem,
    nodes: &[Vec<f64>],
    extras: &[f64],
    p: &[f64],
) -> Result<Guess<ErasedProblem>, Failure> {
    let n = nodes.first().map_or(0, Vec::len);
    let foreign = || {
        let found = extras.len();
        refused(format!(
            "the number of extra unknowns of the saved homoclinic orbit, {found}, does not fit the \
             model: was the orbit saved with another model?"
        ))
    };
    let place = extras.get(BEFORE_PLACE..BEFORE_PLACE + n).ok_or_else(foreign)?;
    let q = [p, &extras[..1]].concat();
    let field = f64::residual(&*cycles).on_segment(0, &q);
    let sizes = extents(nodes.iter().map(|node| &node[..]), cycles.scales(0, &q));
    let saddle = Saddle::near(&field, place, &q, sizes)?;
    let orbit = Trajectory::from(nodes[0].clone());
    let radii = radii(&saddle, [&nodes[0], &nodes[nodes.len() - 1]]);
    let pace = Pace { duration: extras[0], share: extras[1] };
    let mut guess = guess(cycles, saddle, radii, orbit, pace);
    if guess.extras.len() != extras.len() {
        return Err(foreign());
    }
    guess.extras[2] = extras[2];
    Ok(guess)
}

/// Returns the nodes of a cycle, with sampled points between them.
fn places_on(Cycle { q, times, states }: &Cycle) -> Result<Vec<Place>, Failure> {
    let times: Vec<f64> = times.iter().copied().chain([q[q.len() - 1]]).collect();
    let mut places = Vec::new();
    for pair in times.windows(2) {
        for part in 0..PARTS {
            let time = pair[0] + (pair[1] - pair[0]) * part as f64 / PARTS as f64;
            places.push((time, states(time)?));
        }
    }
    Ok(places)
}

/// Returns the range of each state, but at least a fraction of the largest range; ranges are
/// compared in units of the scales.
fn extents<'x>(places: impl Iterator<Item = &'x [f64]> + Clone, scales: Vec<f64>) -> Vec<f64> {
    let n = places.clone().next().map_or(0, <[f64]>::len);
    let range = |i: usize| {
        let values = places.clone().map(|x| x[i]);
        let [low, high] = values
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        (high - low, scales.get(i).copied().unwrap_or(1.0))
    };
    let ranges: Vec<(f64, f64)> = (0..n).map(range).collect();
    let most = ranges.iter().map(|(range, scale)| range / scale).fold(0.0, f64::max);
    let size = |(range, scale): (f64, f64)| match most * scale {
        unit if range < ROUNDING * unit => unit,
        unit => range.max(STANDS_STILL * unit),
    };
    ranges.into_iter().map(size).collect()
}

/// Returns the index of the point at which the motion is slowest.
fn slowest(field: &impl FieldIn<f64>, places: &[Place], q: &[f64], sizes: &[f64]) -> usize {
    let speeds = places.iter().map(|it| squared_speed(field, &it.1, q, sizes)).enumerate();
    speeds.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |it| it.0)
}

/// Returns the squared speed at a point of the trajectory, with each state in units of its range.
fn squared_speed(field: &impl FieldIn<f64>, x: &[f64], q: &[f64], sizes: &[f64]) -> f64 {
    let mut slope = vec![0.0; x.len()];
    field.slope(0.0, x, q, &mut slope);
    slope.iter().zip(sizes).map(|(f, size)| (f / size).powi(2)).sum()
}

/// Returns the points at which a cycle leaves and re-enters the ball of a given radius about the
/// equilibrium. Each point is farther from the equilibrium than the corresponding end of the
/// homoclinic orbit; distances are measured in the unstable subspace for the first point, and in
/// the stable subspace for the second point.
fn excursion(
    Cycle { q, states, .. }: &Cycle,
    places: &[Place],
    (saddle, (radius, ends)): (&Saddle, (f64, [f64; 2])),
) -> Result<[Place; 2], Failure> {
    let (count, period) = (places.len(), q[q.len() - 1]);
    let distance = |k: usize| saddle.distance(&places[k % count].1);
    let nearest = (0..count).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0);
    let frames = [(&saddle.outgoing, ends[0]), (&saddle.incoming, ends[1])];
    let [leaving, arriving] = frames.map(|(frame, end)| {
        move |x: &[f64]| {
            let within = frame.distance(&saddle.deviation(x)).abs();
            saddle.distance(x) < radius || within <= CLEAR * end
        }
    });
    let out = (nearest..nearest + count).find(|k| !leaving(&places[k % count].1));
    let back = (nearest..nearest + count).rev().find(|k| !arriving(&places[k % count].1));
    let (Some(out), Some(back)) = (out, back) else {
        return Err(refused("the cycle stays close to the equilibrium".into()));
    };
    let time = |k: usize| places[k % count].0 + if k >= count { period } else { 0.0 };
    let at = |time: f64| states(time.rem_euclid(period));
    let crossing = |mut near: f64, mut far: f64, inside: &dyn Fn(&[f64]) -> bool| {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            let beside = inside(&at(middle)?);
            *(if beside { &mut near } else { &mut far }) = middle;
        }
        Ok::<Place, Failure>((far, at(far)?))
    };
    let leaves = crossing(time(out - 1), time(out), &leaving)?;
    Ok([leaves, crossing(time(back + 1), time(back), &arriving)?])
}

/// Computes the linear flow in an invariant subspace of the equilibrium, from a state near this
/// subspace: forwards in time until the given distance is reached, or backwards if the given
/// distance is negative. Returns the times relative to the initial state of the linear flow, with
/// the states at these times.
///
/// # Errors
/// [`Failure::Mismatch`] if the linear flow needs too many nodes to reach the distance.
fn linear(
    saddle: &Saddle,
    frame: &Frame,
    (from, until): (&[f64], f64),
    (field, q): (&impl FieldIn<f64>, &[f64]),
) -> Result<Vec<Place>, Failure> {
    let (n, k) = (from.len(), frame.basis.len());
    let (_, matrix) = super::jacobian(field, &saddle.place, q, saddle);
    let basis = DMatrix::from_fn(n, k, |i, j| frame.basis[j][i]);
    let (direction, radius) = (until.signum(), until.abs());
    let within = frame.within(&matrix) * direction;
    let start = basis.transpose() * DVector::from_vec(saddle.deviation(from));
    let after = |time: f64| &basis * ((&within * time).exp() * &start);
    let state = |time: f64, y: &DVector<f64>| -> Place {
        let parts = saddle.place.iter().zip(&saddle.sizes).zip(y.iter());
        (direction * time / saddle.rate, parts.map(|((x, size), y)| x + size * y).collect())
    };
    let is_far = |y: &DVector<f64>| frame.distance(y.as_slice()).abs() > radius;
    let (mut places, mut far, mut y) = (Vec::new(), 0.0, &basis * &start);
    while is_far(&y) && places.len() < MOST_NODES {
        // Fast components of the motion decay first, and steps grow.
        let time = far + STEP * y.norm() / (&within * basis.tr_mul(&y)).norm();
        let next = after(time);
        if is_far(&next) {
            places.push(state(time, &next));
            (far, y) = (time, next);
            continue;
        }
        let mut near = time;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (far + near);
            *(if is_far(&after(middle)) { &mut far } else { &mut near }) = middle;
        }
        places.push(state(near, &after(near)));
        return Ok(places);
    }
    Err(refused(format!(
        "the linear flow near the equilibrium spirals too much, or its eigenvalues differ too much \
         in size: {MOST_NODES} mesh nodes do not suffice to reach a distance of {radius:.0e} from \
         the equilibrium"
    )))
}
