//! Mixed derivatives along two and three directions.
//!
//! The dual numbers with which gradients are computed also yield the mixed derivatives: `F_xx[v,
//! w]` is the derivative of `F_x[v]` along `w`, and `F_xxx[v, v, w]` is the derivative of `F_xx[v,
//! v]` along `w`. A chunk (a dual number with several directions) carries `w` in its first
//! direction.

use crate::core::failure::Failure;
use crate::core::scalar::{Chunk, Directional};

/// Creates a component of the argument as a dual number, given the components of two directions `v`
/// and `w`; all derivatives except the last are taken along `v`, and the last derivative is taken
/// along `w`.
#[inline]
pub(in crate::core) fn moving<T: Directional>(x: f64, v: f64, w: f64) -> T {
    let mut seeded = Chunk::of(x);
    seeded.eps[0] = w;
    T::along(seeded, v)
}

/// Extracts the mixed derivative from a dual number.
#[inline]
pub(in crate::core) fn mixed<T: Directional>(number: &T) -> f64 {
    number.derivative().eps[0]
}

/// Computes `F_xxx[d, e, f]` into `out`, from evaluations of `F_xxx[v, v, w]`: one evaluation if
/// two of the directions are equal, otherwise two evaluations, since `4 F_xxx[d, e, f] = F_xxx[d+e,
/// d+e, f] − F_xxx[d−e, d−e, f]`. If all directions differ, `d` and `e` are scaled to the same
/// size.
///
/// # Errors
/// Returns the errors of the closure `derivative(v, w, out)`.
pub(in crate::core) fn third(
    [d, e, f]: [&[f64]; 3],
    out: &mut [f64],
    mut derivative: impl FnMut(&[f64], &[f64], &mut [f64]) -> Result<(), Failure>,
) -> Result<(), Failure> {
    for [v, other, w] in [[d, e, f], [e, f, d], [f, d, e]] {
        if v == other {
            return derivative(v, w, out);
        }
    }
    let size = |v: &[f64]| v.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let scale = match size(d) / size(e) {
        scale if scale.is_finite() && scale > 0.0 => scale,
        _ => 1.0,
    };
    let combined =
        |sign: f64| -> Vec<f64> { d.iter().zip(e).map(|(d, e)| d + sign * scale * e).collect() };
    let mut difference = vec![0.0; out.len()];
    derivative(&combined(1.0), f, out)?;
    derivative(&combined(-1.0), f, &mut difference)?;
    let mixed = |(out, other): (&mut f64, f64)| *out = (*out - other) / (4.0 * scale);
    out.iter_mut().zip(difference).for_each(mixed);
    Ok(())
}
