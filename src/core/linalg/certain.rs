//! Removal of rounding errors from the components of a solution.

use super::vector::generic;
use crate::core::failure::Failure;

/// Rounding: a component counts as nonzero if it is larger than this multiple of its remaining
/// correction and of its sampled rounding error.
const KNOWN: f64 = 1e3;

/// Heuristic: the number of corrections after which only rounding errors remain: solutions are
/// already corrected on entry.
const CORRECTIONS: usize = 2;

/// Corrects a solution of `G(v) = 0` to working accuracy, and sets components that are rounding
/// errors to zero. The function `residual` evaluates `G`, and the function `solve` solves linear
/// systems with the factored matrix `M`, in place. The argument `sizes` contains typical sizes of
/// the components; it is empty if the sizes are unknown.
///
/// The error of a component is estimated by its last corrections `v − M⁻¹ G(v)`, and by samples: each
/// argument is changed by its last digit (or by `ε` times its size), and the resulting change of each
/// residual enters with a random sign.
///
/// # Errors
/// [`Failure`] of `residual`.
pub(crate) fn clear_rounding(
    v: &mut [f64],
    sizes: &[f64],
    mut residual: impl FnMut(&[f64], &mut [f64]) -> Result<(), Failure>,
    mut solve: impl FnMut(&mut [f64]),
) -> Result<(), Failure> {
    let [mut base, mut noise] = [vec![0.0; v.len()], vec![0.0; v.len()]];
    for _ in 0..CORRECTIONS {
        residual(v, &mut base)?;
        noise.copy_from_slice(&base);
        solve(&mut noise);
        v.iter_mut().zip(&noise).for_each(|(v, d)| *v -= d);
    }
    residual(v, &mut base)?;
    let mut left = base.clone();
    solve(&mut left);
    noise.iter_mut().zip(left).for_each(|(noise, d)| *noise = noise.abs().max(d.abs()));
    for sample in 0..2 {
        let (ups, signs) = (generic(v.len(), sample), generic(v.len(), sample + 7));
        let size = |k: usize| sizes.get(k).copied().unwrap_or(0.0);
        let beside = |k: usize| {
            let least = f64::EPSILON * size(k);
            match ups[k] > 0.0 {
                true => v[k].next_up().max(v[k] + least),
                false => v[k].next_down().min(v[k] - least),
            }
        };
        let beside: Vec<f64> = (0..v.len()).map(beside).collect();
        let mut change = vec![0.0; v.len()];
        residual(&beside, &mut change)?;
        for ((change, base), sign) in change.iter_mut().zip(&base).zip(signs) {
            *change = (*change - base) * sign.signum();
        }
        solve(&mut change);
        noise.iter_mut().zip(change).for_each(|(noise, d)| *noise = noise.abs().max(d.abs()));
    }
    for (v, noise) in v.iter_mut().zip(noise) {
        if v.abs() <= KNOWN * noise {
            *v = 0.0;
        }
    }
    Ok(())
}
