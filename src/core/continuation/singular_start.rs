//! Starts of curves at points where the equations are singular: at special points, and in systems
//! with a conserved quantity.

use super::corrector::Corrector;
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::extended::Closing;
use super::newton::{Convergence, NewtonError};
use crate::core::bifurcation::{At, NullSpace, nearest_to_critical};
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot, generic, largest, norm};
use crate::core::problem::{Dynamics, Group};

/// Discretisation: the distance by which a start at a special point is moved, in units of the scale
/// of the parameter. The distance by which a start is moved is larger than the distance within
/// which a special point is attributed to the start, and is too small to be visible in a diagram.
const MOVED: f64 = 1e-5;

/// Heuristic: the relative distance from the start at which a conservation law is checked a second
/// time. A left null vector that exists only at the start, without a conservation law, is not a
/// null vector at the second point.
const ELSEWHERE: f64 = 1e-2;

/// Rounding: a sum smaller than this threshold, relative to its terms, vanishes up to rounding.
const VANISHES: f64 = 1e-9;

/// Rounding: Coefficients smaller than this threshold, relative to the largest coefficient, are
/// zero up to rounding.
const NOTHING: f64 = 1e-9;

/// If the tangent at a start is undetermined, moves the start by changing the parameter slightly
/// within its range, and returns the tangent at the moved start and a warning.
///
/// # Errors
/// Returns the `cause` of the undetermined tangent, or the conservation law that explains it, if
/// the start cannot be moved.
pub(super) fn beside<T>(
    corrector: &mut Corrector,
    unknowns: &mut Vec<f64>,
    range: [f64; 2],
    cause: NewtonError,
    tangent: impl Fn(&mut Corrector, &mut Vec<f64>) -> Result<T, NewtonError>,
) -> Result<(T, String), NewtonError> {
    let singular = matches!(cause, NewtonError::Evaluation { cause: Failure::Singular { .. }, .. });
    let parameter = corrector.equations.parameters_at();
    let (start, value) = (unknowns.clone(), unknowns[parameter]);
    let step = MOVED / corrector.norm.scaled(parameter, 1.0);
    let beside = [value + step, value - step];
    for moved in beside.into_iter().filter(|p| singular && (range[0]..=range[1]).contains(p)) {
        unknowns.clone_from(&start);
        unknowns[parameter] = moved;
        if let Ok(tangent) = tangent(corrector, unknowns) {
            let p = corrector.equations.released[0];
            let name = &corrector.equations.names().parameters[p];
            let said = format!(
                "the start is a special point at which the direction of the branch is not \
                 determined, so the start was moved from {name} = {value} to {moved}"
            );
            return Ok((tangent, said));
        }
    }
    unknowns.clone_from(&start);
    let law = singular.then(|| conservation(corrector, &start)).flatten();
    Err(law.map_or(cause, NewtonError::from))
}

/// Moves a start along its tangent if the parameter is stationary at the start. The start is moved
/// because events at a start, such as a fold, are not detected. If the moved start cannot be
/// corrected, the start is unchanged.
pub(super) fn off_fold(corrector: &mut Corrector, unknowns: &mut Vec<f64>, tangent: &mut Vec<f64>) {
    if corrector.slope(tangent).abs() > NOTHING * corrector.norm.of(tangent) {
        return;
    }
    if let Some(moved) = moved_along([unknowns, tangent], corrector, MOVED) {
        [*unknowns, *tangent] = moved;
    }
}

/// Returns a start with critical eigenvalues or multipliers, such as a Hopf point, after it was moved
/// along its tangent within the range of the parameter. The start is moved because events at a start
/// are not detected. If eigenvalues are critical beside the start, too, the start is unchanged.
///
/// # Errors
/// [`Failure`] if the start cannot be evaluated, or if eigenvalues are critical everywhere because a
/// quantity is conserved.
pub(super) fn off_critical(
    curve: &mut Curve,
    start: CurvePoint,
    [low, high]: [f64; 2],
) -> Result<CurvePoint, Failure> {
    let dynamics = curve.corrector.equations.at().system.dynamics();
    let is_critical = |place: &CurvePoint| {
        let spectrum = place.spectrum.as_ref();
        spectrum.is_some_and(|all| nearest_to_critical(dynamics, all) < NOTHING)
    };
    if !is_critical(&start) {
        return Ok(start);
    }
    let parameter = curve.corrector.equations.parameters_at();
    for distance in [MOVED, -MOVED] {
        let moved = moved_along(start.on_curve(), &mut curve.corrector, distance);
        let within = |z: &[f64]| (low..=high).contains(&z[parameter]);
        let Some([moved, tangent]) = moved.filter(|[moved, _]| within(moved)) else { continue };
        match curve.arrive_first(moved, tangent, false) {
            Ok(place) if !is_critical(&place) => return Ok(place),
            _ => {}
        }
    }
    if let Some(law) = conservation(&mut curve.corrector, &start.unknowns) {
        return Err(law);
    }
    curve.arrive_first(start.unknowns, start.tangent, false)
}

/// Returns the point of the curve at a distance from a given point along its tangent, with the tangent
/// there; `None` if the point cannot be corrected.
fn moved_along(
    [unknowns, tangent]: [&[f64]; 2],
    corrector: &mut Corrector,
    distance: f64,
) -> Option<[Vec<f64>; 2]> {
    let size = corrector.norm.of(tangent);
    let row = corrector.norm.covector(tangent);
    let along = |(x, t): (&f64, &f64)| x + distance * t / size;
    let mut moved: Vec<f64> = unknowns.iter().zip(tangent).map(along).collect();
    let closing = Closing { row: &row, base: unknowns, length: distance * size };
    let Convergence { matrix_error, .. } = corrector.correct(&mut moved, closing).ok()?;
    let turned = corrector.tangent(&moved, &row, matrix_error).ok()?;
    Some([moved, turned])
}

/// Returns an error that names the conserved linear combination of unknowns; `None` if no linear
/// combination is conserved.
fn conservation(corrector: &mut Corrector, start: &[f64]) -> Option<Failure> {
    corrector.equations.load(start);
    let At { system, x, released, .. } = corrector.equations.at();
    let (names, n) = (system.names().clone(), system.names().dimension());
    if system.dynamics() != Dynamics::Flow {
        return None;
    }
    let left = NullSpace::default().of(system, x, Form::Jacobian, None).ok()?.left[0].clone();
    // The quantity need not be conserved at other values of the parameters that are constant.
    let direction = |seed| -> Vec<f64> {
        let varies = |k: usize| k < n || released.contains(&(k - n));
        let all = generic(x.len(), seed).into_iter().enumerate();
        all.map(|(k, d)| if varies(k) { d } else { 0.0 }).collect()
    };
    let moved = |(x, d): (&f64, f64)| x + ELSEWHERE * d * if *x == 0.0 { 1.0 } else { *x };
    let there: Vec<f64> = x.iter().zip(direction(3)).map(moved).collect();
    let mut slope = vec![0.0; n];
    for seed in 0..3 {
        system.derivative(&there, &[&direction(7 + seed)], &mut slope).ok()?;
        if dot(&left, &slope).abs() > VANISHES * norm(&left) * norm(&slope) {
            return None;
        }
    }
    let law = law(&names.unknowns, &left)?;
    let remedy = match names.unknowns.iter().any(|group| group.length > 1) {
        false => {
            "write one of the unknowns in this quantity as a formula of its other unknowns and its conserved value"
        }
        true => {
            "add `m − (this quantity)` to one of the equations, with a new parameter `m` for the conserved value"
        }
    };
    Some(Failure::Unsupported(format!(
        "the quantity {law} is conserved, so equilibria are not isolated: {remedy}"
    )))
}

/// Returns a linear combination of unknowns as text: `x + 2 y`, and `Σ u` for the sum of an array.
/// Returns `None` if the combination consists of a single unknown: the unknown then has no equation,
/// and no quantity is conserved.
fn law(groups: &[Group], weights: &[f64]) -> Option<String> {
    let most = largest(weights);
    let sign = weights.iter().find(|w| w.abs() > NOTHING * most)?.signum();
    let mut rest = weights;
    let (mut sum, mut count) = (String::new(), 0);
    for group in groups {
        let (own, others) = rest.split_at(group.length);
        rest = others;
        let size = largest(own);
        if size <= NOTHING * most {
            continue;
        }
        count += own.iter().filter(|w| w.abs() > NOTHING * most).count();
        let w = sign * own[0] / most;
        let is_even = own.iter().all(|other| (other - own[0]).abs() <= NOTHING * most);
        let (w, name) = match (group.length, is_even) {
            (1, _) => (w, group.name.clone()),
            (_, true) => (w, format!("Σ {}", group.name)),
            // The weights are not listed.
            (_, false) => (1.0, format!("Σ w·{} with unequal weights w", group.name)),
        };
        let between = match (sum.is_empty(), w < 0.0) {
            (true, false) => "",
            (true, true) => "−",
            (false, false) => " + ",
            (false, true) => " − ",
        };
        let factor = format!("{:.6}", w.abs());
        let factor = factor.trim_end_matches('0').trim_end_matches('.');
        let factor = if factor == "1" { String::new() } else { format!("{factor} ") };
        sum.push_str(&format!("{between}{factor}{name}"));
    }
    (count > 1).then_some(sum)
}
