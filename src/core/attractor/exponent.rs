//! The largest Lyapunov exponent of a motion sampled stroboscopically.

use super::repetition::StateScales;
use crate::core::hybrid::{HybridState, Member};
use crate::core::linalg::{multipliers, solved, unit};
use num_dual::Dual64;

/// The largest Lyapunov exponent per period, with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponent {
    /// The value of the exponent; `−∞` if tangent vectors decay to zero.
    pub value: f64,
    /// The standard error of the exponent, from the means of 20 batches; for a periodic motion, the
    /// change of the exponent in the last Newton step.
    pub error: f64,
}

/// Heuristic: the number of batches in the method of batch means, which gives the standard error of
/// the exponent.
const BATCHES: usize = 20;

/// The logarithmic growth of a tangent vector in successive periods; the mean of the growth is the
/// Lyapunov exponent.
pub(super) struct Growth {
    /// The number of periods in a batch of the batch-means method. During a first batch, which is
    /// not included in the mean, the tangent vector aligns with the direction of fastest growth.
    batch: usize,
    periods: usize,
    means: [f64; BATCHES],
    /// Whether the tangent vector has vanished.
    forgotten: bool,
}

impl Growth {
    /// Creates the record of a tangent vector's growth over a number of periods.
    pub fn over(periods: usize) -> Self {
        let batch = periods.div_ceil(BATCHES).max(1);
        Growth { batch, periods: 0, means: [0.0; BATCHES], forgotten: false }
    }

    /// Records the growth of a tangent vector in a period and scales the vector to length 1 in
    /// units of the scales; returns false after the last period.
    pub fn push(&mut self, state: &mut HybridState<Dual64>, scales: &StateScales) -> bool {
        let tangents = state.x.iter().zip(scales.of_mode(state.mode));
        let growth = tangents.map(|(x, scale)| (x.eps / scale).powi(2)).sum::<f64>().sqrt();
        self.forgotten = growth == 0.0;
        if !self.forgotten {
            state.x.iter_mut().for_each(|x| x.eps /= growth);
        }
        if let Some(k) = self.periods.checked_sub(self.batch)
            && let Some(mean) = self.means.get_mut(k / self.batch)
        {
            *mean += growth.ln() / self.batch as f64;
        }
        self.periods += 1;
        !self.forgotten && self.periods < (BATCHES + 1) * self.batch
    }

    /// Returns the exponent with its standard error.
    pub fn exponent(&self) -> Exponent {
        if self.forgotten {
            return Exponent { value: f64::NEG_INFINITY, error: 0.0 };
        }
        let count = BATCHES as f64;
        let value = self.means.iter().sum::<f64>() / count;
        let squares = self.means.iter().map(|mean| (mean - value).powi(2));
        let variance = squares.sum::<f64>() / (count - 1.0);
        Exponent { value, error: (variance / count).sqrt() }
    }
}

/// Discretisation: the smallest multiplier that still has an accurate digit; the integration error
/// of the flow dominates smaller multipliers.
const FORGOTTEN: f64 = 1e-12;

/// Adds a tangent vector, given in units of the states' scales, to the state of a trajectory.
pub(super) fn with_tangent(
    Member { state: HybridState { mode, time, x }, p }: &Member<f64>,
    scales: &StateScales,
    tangent: impl Fn(usize) -> f64,
) -> Member<Dual64> {
    let scaled = x.iter().zip(scales.of_mode(*mode)).enumerate();
    let x = scaled.map(|(i, (x, scale))| Dual64::new(*x, tangent(i) * scale)).collect();
    let state = HybridState { mode: *mode, time: (*time).into(), x };
    Member { state, p: p.iter().map(|p| Dual64::from(*p)).collect() }
}

/// A function that advances a state with a tangent vector to the next sample; `None` if the motion
/// ends before the sample.
pub(super) type PushForward<'a> = dyn FnMut(&mut Member<Dual64>) -> Option<()> + 'a;

/// The linearised motion over several periods.
pub(super) struct Monodromy {
    /// The states `F^q(x)`.
    pub end: Vec<f64>,
    /// The indices of the states that are not neutral. A neutral state is unchanged after a period
    /// and affects no other state; an example is the state of a body at rest on a moving support.
    pub coupled: Vec<usize>,
    /// The matrix `∂F^q/∂x` of the states that are not neutral, in units of their scales, stored by
    /// rows.
    matrix: Vec<f64>,
    /// The scales of all states.
    scales: Vec<f64>,
}

impl Monodromy {
    /// Linearises the motion over `q` periods; returns `None` if the motion ends earlier, or if the
    /// modes at its beginning and end differ.
    pub fn over(
        push: &mut PushForward,
        start: &Member<f64>,
        q: usize,
        scales: &StateScales,
    ) -> Option<Self> {
        let n = start.state.x.len();
        let sizes: Vec<f64> = scales.of_mode(start.state.mode).take(n).copied().collect();
        let (mut columns, mut end) = (Vec::new(), start.state.x.clone());
        for column in 0..n {
            let mut moving = with_tangent(start, scales, |i| unit(i, column));
            for _ in 0..q {
                push(&mut moving)?;
            }
            if moving.state.mode != start.state.mode {
                return None;
            }
            end = moving.state.x.iter().map(|x| x.re).collect();
            let column = moving.state.x.iter().zip(&sizes).map(|(x, size)| x.eps / size);
            columns.push(column.collect::<Vec<f64>>());
        }
        // Exact equality: nothing has acted on the state.
        let neutral = |k: &usize| (0..n).all(|i| columns[*k][i] == unit(i, *k));
        let coupled: Vec<usize> = (0..n).filter(|k| !neutral(k)).collect();
        let row = |i: &usize| coupled.iter().map(|k| columns[*k][*i]).collect::<Vec<f64>>();
        let matrix = coupled.iter().flat_map(row).collect();
        Some(Monodromy { end, coupled, matrix, scales: sizes })
    }

    /// Returns the Lyapunov exponent per period of a periodic motion of `q` periods; `None` if its
    /// multipliers cannot be computed.
    pub fn exponent(&self, q: usize) -> Option<f64> {
        let n = self.coupled.len();
        let minus_one: Vec<f64> = (0..n * n).map(|k| -unit(k / n, k % n)).collect();
        let largest = multipliers(&self.matrix, &minus_one, n).ok()?;
        let size = largest.first().map_or(0.0, |(re, im)| re.hypot(*im));
        Some(if size < FORGOTTEN { f64::NEG_INFINITY } else { size.ln() / q as f64 })
    }

    /// Computes the Newton step `(1 − M)⁻¹ (F^q(x) − x)` of the states that are not neutral, from
    /// the vector `missed = F^q(x) − x`; returns `None` if the matrix is singular.
    pub fn correction(&self, missed: &[f64]) -> Option<Vec<f64>> {
        let n = self.coupled.len();
        let left = |i: usize, j: usize| unit(i, j) - self.matrix[i * n + j];
        let scales = &self.scales;
        let right = solved(n, left, |i| missed[self.coupled[i]] / scales[self.coupled[i]]).ok()?;
        let mut step = vec![0.0; missed.len()];
        self.coupled.iter().zip(right).for_each(|(k, right)| step[*k] = right * scales[*k]);
        Some(step)
    }
}
