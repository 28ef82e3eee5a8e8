//! Whether the special points that start a curve persist when another parameter changes.

use super::corrector::{Corrector, sizes};
use super::extended::Extended;
use crate::core::bifurcation::equation_sizes;
use crate::core::failure::Failure;

/// Rounding: a change of the equations is a rounding error if it is smaller than this fraction of
/// the sizes of the equations, for a change of the parameter by its size.
const ROUNDING: f64 = 1e-7;

/// Whether the special points of the held defining systems break up if a parameter changes, at the
/// point where the defining systems were evaluated last. The derivative of the zero problem with
/// respect to the parameter is given, with its error in each equation.
pub(super) fn breaks_up(equations: &Extended, slope: &[f64], noise: &[f64]) -> bool {
    let (null, on_mesh) = (&equations.null, equations.system.representation().is_on_mesh());
    let unfolding = equations.conditions.iter().flat_map(|condition| {
        (0..condition.unknowns()).filter_map(|j| condition.unfolding(j, null))
    });
    unfolding.into_iter().any(|null| null.breaks_up(slope, noise, on_mesh))
}

/// Checks that the special points at the start of a curve persist if the released parameters change.
///
/// # Errors
/// [`Failure::Unsupported`] if a parameter breaks up the special points; [`Failure`] if the
/// equations cannot be evaluated.
pub(super) fn check(corrector: &mut Corrector, unknowns: &[f64]) -> Result<(), Failure> {
    let Corrector { equations, norm, .. } = corrector;
    if equations.auxiliary.is_empty() || equations.own_sizes(unknowns).iter().all(Option::is_some) {
        return Ok(());
    }
    let n = equations.dimension();
    let units = sizes(equations, &norm.weights);
    let mut room = vec![0.0; unknowns.len()];
    equations.residual(unknowns, None, &mut room)?;
    let at = equations.at();
    let mut noise = equation_sizes(at.system, at.x, &units)?;
    if at.system.representation().interpolated {
        // The left sides are changes of states.
        noise.fill(units[..n].iter().copied().fold(f64::INFINITY, f64::min));
    }
    for p in equations.released.clone() {
        let at = equations.at();
        let mut direction = vec![0.0; at.x.len()];
        direction[n + p] = 1.0;
        at.system.derivative(at.x, &[&direction], &mut room[..n])?;
        let noise: Vec<f64> = noise.iter().map(|size| ROUNDING * size / units[n + p]).collect();
        if breaks_up(equations, &room[..n], &noise) {
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
