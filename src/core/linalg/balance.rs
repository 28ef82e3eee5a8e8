//! Balancing: scaling a matrix so that the accuracy of its eigenvalues does not depend on the
//! units.

/// Heuristic: another balancing sweep follows if, for some index, the row and the column of the
/// matrix together shrink by more than a twentieth.
const SHRINKS: f64 = 0.95;

/// Heuristic: the largest number of balancing sweeps. In each sweep, the scale of each index
/// adjusts to the scales of its neighbours.
const MOST_SWEEPS: usize = 40;

/// Computes `D⁻¹ A D` with a diagonal matrix `D` of powers of two, without rounding, so that the row
/// and the column of each index have nearly the same sum (E. E. Osborne, J. ACM 7:338, 1960; B. N.
/// Parlett and C. Reinsch, Numer. Math. 13:293, 1969). The matrix `A` is given column by column.
pub(crate) fn balanced(matrix: &[f64], n: usize) -> Vec<f64> {
    let mut balanced = matrix.to_vec();
    balance(&mut balanced, n);
    balanced
}

/// Balances a matrix in place and returns the diagonal of `D`.
pub(crate) fn balance(a: &mut [f64], n: usize) -> Vec<f64> {
    let mut units = vec![1.0; n];
    for _ in 0..MOST_SWEEPS {
        let mut changed = false;
        for k in 0..n {
            let others = || (0..n).filter(|i| *i != k);
            let column: f64 = others().map(|i| a[k * n + i].abs()).sum();
            let row: f64 = others().map(|j| a[j * n + k].abs()).sum();
            if !(column > 0.0 && row > 0.0 && (column + row).is_finite()) {
                continue;
            }
            // The column times f and the row divided by f are equal for f² = row/column.
            let factor = (0.5 * (row / column).log2()).round().exp2();
            if column * factor + row / factor < SHRINKS * (column + row) {
                changed = true;
                units[k] *= factor;
                others().for_each(|i| a[k * n + i] *= factor);
                others().for_each(|j| a[j * n + k] /= factor);
            }
        }
        if !changed {
            break;
        }
    }
    units
}
