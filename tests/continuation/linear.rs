//! Promise: bordered factorisations solve with a matrix and with its transpose.

use tangency::core::linalg::{Border, BorderedLu};

/// Both factorisations, solved both ways, against multiplication.
#[test]
fn solves_in_both_sizes() {
    for (n, m) in [(1, 0), (3, 2), (30, 2), (60, 3)] {
        let size = n + m;
        let entry = |i: usize, j: usize| {
            ((i * 7 + j * 13 + i * j) as f64).cos() * 10f64.powi((i % 5) as i32)
        };
        let matrix: Vec<f64> = (0..n * n).map(|k| entry(k % n, k / n)).collect();
        let columns: Vec<f64> = (0..n * m).map(|k| entry(k % n, n + k / n)).collect();
        let rows: Vec<f64> = (0..n * m).map(|k| entry(n + k / n, k % n)).collect();
        let corner: Vec<f64> = (0..m * m).map(|k| entry(n + k / m, n + k % m)).collect();
        let mut lu = BorderedLu::default();
        lu.factor(
            &matrix,
            Border { width: m, columns: &columns, rows: &rows, corner: &corner, units: &[] },
        )
        .unwrap();
        let x: Vec<f64> = (0..size).map(|i| 1.0 + i as f64).collect();
        let mut b: Vec<f64> =
            (0..size).map(|i| (0..size).map(|j| entry(i, j) * x[j]).sum()).collect();
        let mut c: Vec<f64> =
            (0..size).map(|j| (0..size).map(|i| entry(i, j) * x[i]).sum()).collect();
        lu.solve(&mut b);
        lu.solve_transposed(&mut c);
        for i in 0..size {
            assert!((b[i] - x[i]).abs() < 1e-9 * x[i], "{n}+{m}: {} {}", b[i], x[i]);
            assert!((c[i] - x[i]).abs() < 1e-9 * x[i], "{n}+{m}: {} {}", c[i], x[i]);
        }
    }
}
