//! Whether the branch points that start a curve persist when another parameter changes.

use super::extended::Extended;
use crate::core::bifurcation::{At, NullVectors};
use crate::core::failure::Failure;
use crate::core::linalg::{generic, largest};

/// Rounding: the assumed error of the unknowns at a branch point, relative to their sizes.
const ERROR: f64 = 1e-7;

/// Whether the branch points of the held defining systems break up if the parameter with the index
/// `p` changes, at the point where the defining systems were evaluated last. The derivative of the
/// zero problem with respect to the parameter is given in `slope`.
///
/// # Errors
/// [`Failure`] if the second derivative cannot be evaluated.
pub(super) fn breaks_up(
    equations: &mut Extended,
    p: usize,
    slope: &[f64],
) -> Result<bool, Failure> {
    if unfolding(equations).next().is_none() {
        return Ok(false);
    }
    let change = change_of_slope(equations, p)?;
    let on_mesh = equations.system().representation().is_on_mesh();
    Ok(unfolding(equations).any(|null| null.breaks_up(slope, &change, on_mesh)))
}

/// Returns the null vectors that belong to the auxiliary unknowns that unfold the problem.
fn unfolding<'e>(equations: &'e Extended) -> impl Iterator<Item = &'e NullVectors> {
    equations.conditions.iter().flat_map(|condition| {
        (0..condition.unknowns()).filter_map(|j| condition.unfolding(j, &equations.null))
    })
}

/// Returns the change of the derivative with respect to a parameter when all unknowns change by
/// their errors.
fn change_of_slope(equations: &mut Extended, p: usize) -> Result<Vec<f64>, Failure> {
    let (n, scales) = (equations.dimension(), equations.unknown_scales());
    let At { system, x, null, .. } = equations.at();
    let mut deviation = generic(x.len(), 3);
    deviation[n..].fill(0.0);
    // For solutions on a mesh, the size of each unknown is unknown.
    let usual = largest(&scales).max(largest(&x[..n]));
    let units = null.units();
    let size = |k: usize| units.get(k).copied().unwrap_or(usual);
    deviation[..n].iter_mut().enumerate().for_each(|(k, d)| *d *= ERROR * size(k));
    let (direction, mut change) = (along(p, x.len(), n), vec![0.0; n]);
    system.derivative(x, &[&direction, &deviation], &mut change)?;
    change.iter_mut().for_each(|change| *change *= 0.5);
    Ok(change)
}

/// Returns twice the unit direction of a parameter; a discretisation caches the column of the unit
/// direction.
fn along(p: usize, length: usize, n: usize) -> Vec<f64> {
    let mut direction = vec![0.0; length];
    direction[n + p] = 2.0;
    direction
}

/// Computes the derivative of the zero problem with respect to the parameter with the index `p`.
///
/// # Errors
/// [`Failure`] if the derivative cannot be evaluated.
pub(super) fn slope(equations: &mut Extended, p: usize, out: &mut [f64]) -> Result<(), Failure> {
    let n = equations.dimension();
    let At { system, x, .. } = equations.at();
    system.derivative(x, &[&along(p, x.len(), n)], out)?;
    out.iter_mut().for_each(|slope| *slope *= 0.5);
    Ok(())
}

/// Checks that the branch points at the start of a curve persist if the released parameters change.
///
/// # Errors
/// [`Failure::Unsupported`] if a parameter breaks up the branch points; [`Failure`] if the equations
/// cannot be evaluated.
pub(super) fn check(equations: &mut Extended, unknowns: &[f64]) -> Result<(), Failure> {
    if unfolding(equations).next().is_none() {
        return Ok(());
    }
    let n = equations.dimension();
    let mut room = vec![0.0; unknowns.len()];
    equations.residual(unknowns, None, &mut room)?;
    for p in equations.released.clone() {
        slope(equations, p, &mut room[..n])?;
        if breaks_up(equations, p, &room[..n])? {
            let name = &equations.names().parameters[p];
            return Err(Failure::Unsupported(format!(
                "the branch point breaks up if `{name}` changes, so that no curve of branch points \
                 starts here: vary another parameter, or trace the curve of folds (`LP`) beside the \
                 branch point"
            )));
        }
    }
    Ok(())
}
