//! Diagonal scaling of sparse matrices whose unknowns have very different units.

use super::Pattern;
use crate::core::linalg::lu::inverse_power_of_two;

/// Heuristic: the matrix is scaled if the norms of a row and of the column with the same index,
/// without the diagonal, differ by more than this factor.
const UNEVEN: f64 = 1e6;

/// Heuristic: the number of sweeps. A sweep halves the remaining differences of the logarithms of
/// the norms.
const SWEEPS: usize = 30;

impl Pattern {
    /// Returns powers of two `d` for which the rows of the matrix `a_ij d_j / d_i` have norms similar
    /// to the norms of the columns (B. N. Parlett and C. Reinsch, Numer. Math. 13 (1969) 293); the
    /// scaled matrix has the same eigenvalues. Returns `None` if the norms are already similar.
    ///
    /// Krylov spaces of a matrix whose unknowns have very different units, such as volts and
    /// kilometres, contain only the unknowns with the largest values.
    pub fn balancing(&self, entries: &[f64]) -> Option<Vec<f64>> {
        let mut scales = vec![1.0; self.size()];
        for sweep in 0..SWEEPS {
            let [rows, columns] = self.norms(entries, &scales);
            let ratio = |(row, column): (&f64, &f64)| match *row > 0.0 && *column > 0.0 {
                true => row / column,
                false => 1.0,
            };
            let ratios: Vec<f64> = rows.iter().zip(&columns).map(ratio).collect();
            if sweep == 0 && ratios.iter().all(|ratio| (UNEVEN.recip()..=UNEVEN).contains(ratio)) {
                return None;
            }
            // All rows change together; the full change of each row would overshoot.
            scales.iter_mut().zip(ratios).for_each(|(scale, ratio)| *scale *= ratio.sqrt().sqrt());
        }
        let powers: Vec<f64> =
            scales.into_iter().map(|d| inverse_power_of_two(d).recip()).collect();
        powers.iter().all(|d| d.is_normal()).then_some(powers)
    }

    /// Returns the entries of the matrix `a_ij d_j / d_i`.
    pub fn scaled(&self, entries: &[f64], d: &[f64]) -> Vec<f64> {
        let places = (0..self.size()).flat_map(|j| self.column(j).iter().map(move |&i| (i, j)));
        entries.iter().zip(places).map(|(a, (i, j))| a * d[j] / d[i]).collect()
    }

    /// Returns the sums of the absolute values of the rows and of the columns of a scaled matrix,
    /// without the diagonal.
    fn norms(&self, entries: &[f64], d: &[f64]) -> [Vec<f64>; 2] {
        let mut norms = [vec![0.0; self.size()], vec![0.0; self.size()]];
        for j in 0..self.size() {
            for (k, &i) in (self.start(j)..).zip(self.column(j)).filter(|(_, i)| **i != j) {
                let size = (entries[k] * d[j] / d[i]).abs();
                norms[0][i] += size;
                norms[1][j] += size;
            }
        }
        norms
    }
}
