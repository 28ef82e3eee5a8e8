//! Sparse matrices that a diagonal scaling makes symmetric, and bounds of the eigenvalues of others.

use super::Pattern;

/// (R) Entries of a matrix agree with the entries across its diagonal, scaled, to this relative error.
const AGREE: f64 = 1e-12;

/// (H) Scales that differ by more than this factor would cost as much of the digits.
const UNEVEN: f64 = 1e3;

impl Pattern {
    /// Each entry with the position of the entry across the diagonal, where there is one.
    fn transposed(&self) -> impl Iterator<Item = (usize, [usize; 2], Option<usize>)> + '_ {
        (0..self.size()).flat_map(move |j| {
            (self.start(j)..)
                .zip(self.column(j))
                .map(move |(k, &i)| (k, [i, j], self.across([i, j])))
        })
    }

    /// The position of the entry across the diagonal.
    fn across(&self, [i, j]: [usize; 2]) -> Option<usize> {
        self.column(i).binary_search(&j).ok().map(|at| self.start(i) + at)
    }

    /// Positive scales `d` with which `a_ij d_j / d_i` is a symmetric matrix: it has the same
    /// eigenvalues and the same signs of pivots. `None` if no such scales exist, or if they are very uneven.
    ///
    /// Differences that end at a wall without flux, and cells of different sizes, give such matrices
    /// `a`. Scales of neighbours follow from `d_i² / d_j² = a_ij / a_ji`, and all others must agree.
    pub fn symmetrising(&self, entries: &[f64]) -> Option<Vec<f64>> {
        let mut scales = vec![0.0; self.size()];
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
                    // An exact 1 keeps symmetric matrices what they are.
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

    /// Whether scales make a matrix symmetric.
    fn agree(&self, entries: &[f64], scales: &[f64]) -> bool {
        self.transposed().all(|(k, [i, j], across)| {
            let one = entries[k] * scales[j] / scales[i];
            let other = across.map_or(0.0, |across| entries[across]) * scales[i] / scales[j];
            (one - other).abs() <= AGREE * one.abs()
        })
    }

    /// The corner of the rectangle `0 ≤ Re λ ≤ a`, `|Im λ| ≤ b` in which all eigenvalues with a
    /// positive real part lie: `a` is a bound of the symmetric part's eigenvalues by Gershgorin's
    /// circles, `b` of the skew part's.
    pub fn unstable_corner(&self, entries: &[f64]) -> (f64, f64) {
        let n = self.size();
        let (mut symmetric, mut skew) = (vec![0.0; n], vec![0.0; n]);
        for (k, [i, j], across) in self.transposed() {
            let (a, other) = (entries[k], across.map_or(0.0, |across| entries[across]));
            if i == j {
                symmetric[i] += a;
                continue;
            }
            // Without a partner the entry counts on both sides.
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
