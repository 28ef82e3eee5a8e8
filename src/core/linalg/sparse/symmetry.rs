//! Sparse matrices that a diagonal scaling makes symmetric, and eigenvalue bounds for other matrices.

use super::Pattern;

/// Rounding: Scaled entries of a matrix count as symmetric if they agree to this relative error.
const AGREE: f64 = 1e-12;

/// Heuristic: Scales are rejected if they differ by more than this factor, because scaling would
/// lose too many digits.
const UNEVEN: f64 = 1e3;

impl Pattern {
    /// Iterates over the entries of a matrix: their positions, their rows and columns, and the positions
    /// of the transposed entries (with row and column exchanged), if the transposed entries exist.
    fn transposed(&self) -> impl Iterator<Item = (usize, [usize; 2], Option<usize>)> + '_ {
        let entries = (0..self.size()).flat_map(move |j| {
            (self.start(j)..).zip(self.column(j)).map(move |(k, &i)| (k, [i, j]))
        });
        // While `j` increases, the transposed entries in a column follow each other.
        let mut next = vec![0; self.size()];
        entries.map(move |(k, [i, j])| {
            let (at, rows) = (&mut next[i], self.column(i));
            while rows.get(*at).is_some_and(|row| *row < j) {
                *at += 1;
            }
            (k, [i, j], (rows.get(*at) == Some(&j)).then(|| self.start(i) + *at))
        })
    }

    /// Returns the position of the transposed entry, whose row and column are exchanged.
    fn across(&self, [i, j]: [usize; 2]) -> Option<usize> {
        self.column(i).binary_search(&j).ok().map(|at| self.start(i) + at)
    }

    /// Returns positive scales `d` for which `a_ij d_j / d_i` is symmetric; the scaled matrix has the
    /// same eigenvalues and the same signs of pivots. Returns `None` if no such scales exist, or if they
    /// differ too much.
    ///
    /// For example, finite differences with no-flux boundaries, or with cells of different sizes,
    /// lead to matrices `a` that a diagonal scaling makes symmetric. The scales of two coupled
    /// unknowns `i` and `j` satisfy `d_i² / d_j² = a_ij / a_ji`; scales are computed from some of
    /// the entries, and must be consistent with all other entries.
    pub fn symmetrising(&self, entries: &[f64]) -> Option<Vec<f64>> {
        let mut scales = vec![1.0; self.size()];
        if self.agree(entries, &scales) {
            return Some(scales);
        }
        scales.fill(0.0);
        let mut open = Vec::new();
        for first in 0..self.size() {
            if scales[first] > 0.0 {
                continue;
            }
            scales[first] = 1.0;
            open.push(first);
            while let Some(j) = open.pop() {
                for (k, &i) in (self.start(j)..).zip(self.column(j)) {
                    if scales[i] > 0.0 || entries[k] == 0.0 {
                        continue;
                    }
                    let ratio = entries[k] / entries[self.across([i, j])?];
                    if !(ratio > 0.0 && ratio.is_finite()) {
                        return None;
                    }
                    // A ratio of exactly 1 leaves symmetric matrices unchanged.
                    let ratio = if (ratio - 1.0).abs() <= AGREE { 1.0 } else { ratio };
                    scales[i] = scales[j] * ratio.sqrt();
                    open.push(i);
                }
            }
        }
        let least = scales.iter().fold(f64::INFINITY, |least, d| d.min(least));
        let even = scales.iter().all(|d| *d <= UNEVEN * least);
        (even && self.agree(entries, &scales)).then_some(scales)
    }

    /// Whether given scales make a matrix symmetric.
    fn agree(&self, entries: &[f64], scales: &[f64]) -> bool {
        self.transposed().all(|(k, [i, j], across)| {
            let one = entries[k] * scales[j] / scales[i];
            let other = across.map_or(0.0, |across| entries[across]) * scales[i] / scales[j];
            (one - other).abs() <= AGREE * one.abs()
        })
    }

    /// Returns the corner `(a, b)` of the rectangle `0 ≤ Re λ ≤ a`, `|Im λ| ≤ b` that contains all
    /// eigenvalues with a positive real part: Gershgorin's circles bound the eigenvalues of the
    /// symmetric part by `a` and the eigenvalues of the skew-symmetric part by `b`.
    pub fn unstable_corner(&self, entries: &[f64]) -> (f64, f64) {
        let n = self.size();
        let (mut symmetric, mut skew) = (vec![0.0; n], vec![0.0; n]);
        for (k, [i, j], across) in self.transposed() {
            let (a, other) = (entries[k], across.map_or(0.0, |across| entries[across]));
            if i == j {
                symmetric[i] += a;
                continue;
            }
            // An entry without a partner across the diagonal counts for both rows.
            let rows: &[usize] = if across.is_some() { &[i] } else { &[i, j] };
            for &row in rows {
                symmetric[row] += 0.5 * (a + other).abs();
                skew[row] += 0.5 * (a - other).abs();
            }
        }
        let most = |all: Vec<f64>| all.into_iter().fold(0.0, f64::max);
        (most(symmetric), most(skew))
    }
}
