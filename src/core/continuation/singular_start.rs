//! Starts of curves at points where the equations are singular: at special points, and in systems
//! with a conserved quantity.

use super::corrector::Corrector;
use super::extended::Closing;
use super::newton::{Convergence, NewtonError};
use crate::core::bifurcation::{At, NullSpace};
use crate::core::failure::Failure;
use crate::core::linalg::{Form, dot, generic, largest, norm};
use crate::core::problem::Dynamics;

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
    Err(match singular.then(|| conserved(corrector, &start)).flatten() {
        Some(law) => Failure::Unsupported(format!(
            "the quantity {law} is conserved, so equilibria are not isolated: write one of the \
             unknowns in this quantity as a formula of its other unknowns and its conserved value"
        ))
        .into(),
        None => cause,
    })
}

/// Moves a start along its tangent if the parameter is stationary at the start. The start is moved
/// because events at a start, such as a fold, are not detected. If the moved start cannot be
/// corrected, the start is unchanged.
pub(super) fn off_fold(corrector: &mut Corrector, unknowns: &mut Vec<f64>, tangent: &mut Vec<f64>) {
    let size = corrector.norm.of(tangent);
    if corrector.slope(tangent).abs() > NOTHING * size {
        return;
    }
    let row = corrector.norm.covector(tangent);
    let along = |(x, t): (&f64, &f64)| x + MOVED * t / size;
    let mut moved: Vec<f64> = unknowns.iter().zip(&*tangent).map(along).collect();
    let closing = Closing { row: &row, base: unknowns, length: MOVED * size };
    let Ok(Convergence { matrix_error, .. }) = corrector.correct(&mut moved, closing) else {
        return;
    };
    if let Ok(turned) = corrector.tangent(&moved, &row, matrix_error) {
        (*unknowns, *tangent) = (moved, turned);
    }
}

/// Returns the conserved linear combination of unknowns as text; `None` if no linear combination is
/// conserved.
fn conserved(corrector: &mut Corrector, start: &[f64]) -> Option<String> {
    corrector.equations.load(start);
    let At { system, x, .. } = corrector.equations.at();
    let (names, n) = (system.names().clone(), system.names().dimension());
    if system.dynamics() != Dynamics::Flow || names.unknowns.iter().any(|group| group.length > 1) {
        return None;
    }
    let left = NullSpace::default().of(system, x, Form::Jacobian, None).ok()?.left[0].clone();
    let shift = generic(x.len(), 3);
    let there: Vec<f64> = x.iter().zip(&shift).map(|(x, s)| x * (1.0 + ELSEWHERE * s)).collect();
    let mut slope = vec![0.0; n];
    for seed in 0..3 {
        system.derivative(&there, &[&generic(x.len(), 7 + seed)], &mut slope).ok()?;
        if dot(&left, &slope).abs() > VANISHES * norm(&left) * norm(&slope) {
            return None;
        }
    }
    let most = largest(&left);
    let sign = left.iter().find(|w| w.abs() > NOTHING * most)?.signum();
    let terms = names.unknowns.iter().zip(&left).map(|(group, w)| (&group.name, sign * w / most));
    let terms: Vec<(&String, f64)> = terms.filter(|(_, w)| w.abs() > NOTHING).collect();
    // A single term means that an unknown has no equation, not that a quantity is conserved.
    if terms.len() < 2 {
        return None;
    }
    let mut sum = String::new();
    for (name, w) in terms {
        let between = match (sum.is_empty(), w < 0.0) {
            (true, false) => "",
            (true, true) => "−",
            (false, false) => " + ",
            (false, true) => " − ",
        };
        let size = format!("{:.6}", w.abs());
        let size = size.trim_end_matches('0').trim_end_matches('.');
        let factor = if size == "1" { String::new() } else { format!("{size} ") };
        sum.push_str(&format!("{between}{factor}{name}"));
    }
    Some(sum)
}
