//! The largest Lyapunov exponent.

use super::Strobed;
use super::error::StrobeError;
use crate::core::hybrid::HybridState;
use crate::core::linear::{BorderedLu, multipliers};
use crate::core::zero::Border;

/// A largest Lyapunov exponent, per period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponent {
    /// The exponent; `−∞` where motion forgets its past completely.
    pub value: f64,
    /// Its standard error: of the means of [`BATCHES`](Exponent::BATCHES) batches, or, of a periodic motion, what
    /// the last improvement of the orbit has changed.
    pub error: f64,
}

impl Exponent {
    /// The number of batches whose means tell the error.
    pub const BATCHES: usize = 20;

    /// The exponent of a motion, from the growth of a tangent vector over so many periods.
    ///
    /// # Errors
    /// [`StrobeError`] if the motion ends.
    pub fn of(
        motion: &mut dyn Strobed,
        state: &mut HybridState<f64>,
        p: &[f64],
        periods: usize,
    ) -> Result<Self, StrobeError> {
        let batch = periods.div_ceil(Self::BATCHES).max(1);
        let mut tangent = vec![1.0; state.x.len()];
        // The vector turns into the direction of fastest growth first.
        for _ in 0..batch {
            motion.push_forward(state, &mut tangent, p)?;
            if normalised(&mut tangent) == 0.0 {
                return Ok(Exponent { value: f64::NEG_INFINITY, error: 0.0 });
            }
        }
        let mut means = [0.0; Self::BATCHES];
        for mean in &mut means {
            for _ in 0..batch {
                motion.push_forward(state, &mut tangent, p)?;
                let growth = normalised(&mut tangent);
                if growth == 0.0 {
                    return Ok(Exponent { value: f64::NEG_INFINITY, error: 0.0 });
                }
                *mean += growth.ln() / batch as f64;
            }
        }
        let count = Self::BATCHES as f64;
        let value = means.iter().sum::<f64>() / count;
        let variance = means.iter().map(|mean| (mean - value).powi(2)).sum::<f64>() / (count - 1.0);
        Ok(Exponent { value, error: (variance / count).sqrt() })
    }
}

/// Of a smaller multiplier no digit is known.
const FORGOTTEN: f64 = 1e-12;

/// Gives a vector the length 1, and returns the length that it had.
fn normalised(vector: &mut [f64]) -> f64 {
    let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    if length > 0.0 {
        vector.iter_mut().for_each(|v| *v /= length);
    }
    length
}

/// The motion linearised over a cycle.
pub(super) struct Monodromy {
    /// The matrix `∂F^q/∂x`, one row after the other.
    pub matrix: Vec<f64>,
    /// The state `F^q(x)`.
    pub end: HybridState<f64>,
}

/// The motion linearised over `q` periods; `None` if it ends in another mode.
pub(super) fn monodromy(
    motion: &mut dyn Strobed,
    start: &HybridState<f64>,
    p: &[f64],
    q: usize,
) -> Result<Option<Monodromy>, StrobeError> {
    let n = start.x.len();
    let (mut matrix, mut end) = (vec![0.0; n * n], start.clone());
    let mut tangent = Vec::new();
    for column in 0..n {
        end.clone_from(start);
        tangent.clear();
        tangent.extend((0..n).map(|i| f64::from(u8::from(i == column))));
        for _ in 0..q {
            motion.push_forward(&mut end, &mut tangent, p)?;
        }
        if end.mode != start.mode {
            return Ok(None);
        }
        (0..n).for_each(|i| matrix[i * n + column] = tangent[i]);
    }
    Ok(Some(Monodromy { matrix, end }))
}

/// Entry `k` of the `n × n` identity, one row after the other.
fn identity(k: usize, n: usize) -> f64 {
    f64::from(u8::from(k.is_multiple_of(n + 1)))
}

/// The exponent of a periodic motion, from the matrix over `q` periods.
pub(super) fn of_matrix(matrix: &[f64], n: usize, q: usize) -> f64 {
    let minus_one: Vec<f64> = (0..n * n).map(|k| -identity(k, n)).collect();
    let largest = multipliers(matrix, &minus_one, n);
    let size = largest.first().map_or(0.0, |(re, im)| re.hypot(*im));
    if size < FORGOTTEN { f64::NEG_INFINITY } else { size.ln() / q as f64 }
}

/// The step `(1 − M)⁻¹ (F^q(x) − x)` of Newton's method; `None` if the matrix is singular.
pub(super) fn correction(matrix: &[f64], start: &[f64], end: &[f64]) -> Option<Vec<f64>> {
    let n = start.len();
    // One column after the other.
    let place = |k: usize| (k % n) * n + k / n;
    let left: Vec<f64> = (0..n * n).map(|k| identity(k, n) - matrix[place(k)]).collect();
    let mut right: Vec<f64> = end.iter().zip(start).map(|(end, start)| end - start).collect();
    let mut lu = BorderedLu::default();
    lu.factor(&left, Border::NONE).ok()?;
    lu.solve(&mut right);
    Some(right)
}
