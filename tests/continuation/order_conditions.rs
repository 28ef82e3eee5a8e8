//! The order conditions of the tableaux, tree by tree (Butcher; Hairer, Nørsett and Wanner 1993,
//! theorem II.2.13, and for Rosenbrock methods Hairer and Wanner 1996, theorem IV.7.4).

#[path = "../../src/core/ode/rodas.rs"]
mod rodas;
#[path = "../../src/core/ode/tableau.rs"]
mod tableau;

use rodas::{COUPLING, DENSE, ERROR, GAMMA, NODES, ROWS, STAGES, TIME};
use tableau::{ORDER_EIGHT, ORDER_FIVE, Row, Tableau};

/// Coefficients of up to 43 are rounded to 16 digits.
const ROUNDING: f64 = 1e-14;

/// A rooted tree by the trees on its root.
#[derive(Clone)]
struct Tree(Vec<Tree>);

impl Tree {
    fn order(&self) -> usize {
        1 + self.0.iter().map(Tree::order).sum::<usize>()
    }

    /// `γ(t)`.
    fn density(&self) -> f64 {
        self.order() as f64 * self.0.iter().map(Tree::density).product::<f64>()
    }

    /// `Φ_i(t)` of all stages; a vertex with one branch uses the matrix `chain`, one with more
    /// `fork`.
    fn weights(&self, fork: &[Vec<f64>], chain: &[Vec<f64>]) -> Vec<f64> {
        let matrix = if self.0.len() == 1 { chain } else { fork };
        let mut product = vec![1.0; matrix.len()];
        for branch in &self.0 {
            let weights = branch.weights(fork, chain);
            for (product, row) in product.iter_mut().zip(matrix) {
                *product *= row.iter().zip(&weights).map(|(a, w)| a * w).sum::<f64>();
            }
        }
        product
    }
}

/// All trees with up to `most` vertices.
fn trees(most: usize) -> Vec<Tree> {
    let mut all: Vec<Tree> = vec![Tree(vec![])];
    for order in 2..=most {
        let mut new = Vec::new();
        branches(&all, 0, order - 1, &mut Vec::new(), &mut new);
        all.extend(new);
    }
    all
}

/// All multisets of trees from `first` on with `rest` vertices together.
fn branches(all: &[Tree], first: usize, rest: usize, chosen: &mut Vec<Tree>, out: &mut Vec<Tree>) {
    if rest == 0 {
        out.push(Tree(chosen.clone()));
    }
    for (i, tree) in all.iter().enumerate().skip(first).filter(|(_, t)| t.order() <= rest) {
        chosen.push(tree.clone());
        branches(all, i, rest - tree.order(), chosen, out);
        chosen.pop();
    }
}

fn dense(row: Row, n: usize) -> Vec<f64> {
    let mut out = vec![0.0; n];
    row.iter().for_each(|(j, a)| out[*j] = *a);
    out
}

/// The largest violation of a condition of this order: `Σ_i b_i Φ_i(t) = 1/γ(t)`, or 0 for a
/// `difference` of two methods.
fn violation(
    order: usize,
    weights: &[f64],
    matrices: (&[Vec<f64>], &[Vec<f64>]),
    difference: bool,
) -> f64 {
    let mut largest: f64 = 0.0;
    for tree in trees(order).iter().filter(|tree| tree.order() == order) {
        let phi = tree.weights(matrices.0, matrices.1);
        let sum: f64 = phi.iter().zip(weights).map(|(phi, b)| phi * b).sum();
        let exact = if difference { 0.0 } else { 1.0 / tree.density() };
        largest = largest.max((sum - exact).abs());
    }
    largest
}

#[test]
fn trees_are_counted_as_in_the_literature() {
    let counts: Vec<usize> =
        (1..=8).map(|n| trees(8).iter().filter(|t| t.order() == n).count()).collect();
    assert_eq!(counts, [1, 1, 2, 4, 9, 20, 48, 115]);
}

/// The matrix of an explicit tableau, with the stages of dense output.
fn matrix(tableau: &Tableau) -> Vec<Vec<f64>> {
    let rows = [&[] as Row].into_iter().chain(tableau.rows.iter().copied());
    let rows: Vec<Row> =
        rows.chain([tableau.weights]).chain(tableau.extra_rows.iter().copied()).collect();
    rows.iter().map(|row| dense(row, rows.len())).collect()
}

#[test]
fn explicit_methods_have_their_orders() {
    for (tableau, estimates) in [
        (&ORDER_EIGHT, [(5, ORDER_EIGHT.error), (3, ORDER_EIGHT.rough_error)]),
        (&ORDER_FIVE, [(4, ORDER_FIVE.error), (4, ORDER_FIVE.error)]),
    ] {
        let a = matrix(tableau);
        let weights = dense(tableau.weights, a.len());
        for order in 1..=tableau.order {
            assert!(violation(order, &weights, (&a, &a), false) < ROUNDING, "order {order}");
        }
        assert!(violation(tableau.order + 1, &weights, (&a, &a), false) > 1e-8);
        for (order, row) in estimates {
            let error = dense(row, a.len());
            for order in 1..=order {
                assert!(violation(order, &error, (&a, &a), true) < ROUNDING, "estimate {order}");
            }
            assert!(violation(order + 1, &error, (&a, &a), true) > 1e-6);
        }
    }
}

#[test]
fn nodes_are_sums_of_rows() {
    for tableau in [&ORDER_EIGHT, &ORDER_FIVE] {
        let rows = tableau.rows.iter().chain(tableau.extra_rows);
        for (row, node) in rows.zip(tableau.nodes.iter().chain(tableau.extra_nodes)) {
            let sum: f64 = row.iter().map(|(_, a)| a).sum();
            assert!((sum - node).abs() < 1e-14, "{sum} {node}");
        }
    }
}

/// `x' = λ x` over one step with `z = hλ`.
fn growth(tableau: &Tableau, z: f64) -> f64 {
    let mut slopes = vec![z];
    let state =
        |row: Row, slopes: &[f64]| 1.0 + row.iter().map(|(j, a)| a * slopes[*j]).sum::<f64>();
    for row in tableau.rows {
        slopes.push(z * state(row, &slopes));
    }
    state(tableau.weights, &slopes)
}

#[test]
fn stability_ends_where_the_tableaux_say() {
    for tableau in [&ORDER_EIGHT, &ORDER_FIVE] {
        let [inside, outside] =
            [0.97, 1.1].map(|part| growth(tableau, -part * tableau.stability).abs());
        assert!(inside < 1.0 && outside > 1.0, "{}: {inside} {outside}", tableau.order);
    }
}

/// Where the slope is constant, nothing but the Hermite part of dense output is left; the slope at
/// the end of the step is in the error of the pair of order 5 only; and the step control is stable.
#[test]
fn what_follows_the_weights_is_consistent() {
    for (tableau, end_in_error) in [(&ORDER_EIGHT, false), (&ORDER_FIVE, true)] {
        for row in tableau.dense {
            let sum: f64 = row.iter().map(|(_, d)| d).sum();
            let size = row.iter().fold(1.0, |size: f64, (_, d)| size.max(d.abs()));
            assert!(sum.abs() < 1e-13 * size, "{sum}");
            assert!(
                row.iter().all(|(stage, _)| *stage <= tableau.end() + tableau.extra_rows.len())
            );
        }
        assert_eq!(tableau.end_in_error(), end_in_error);
        let (least, most) = tableau.ratios;
        assert!(0.0 < least && least < 1.0 && 1.0 < most);
        assert!((0.0..1.0 / tableau.order as f64).contains(&tableau.memory));
    }
}

/// `α = A Γ`, `β = α + Γ` and `b = m Γ` with `Γ⁻¹ = I/γ − C`.
#[test]
fn the_rosenbrock_method_has_its_order() {
    let coupling: Vec<Vec<f64>> = COUPLING.iter().map(|row| dense(row, STAGES)).collect();
    // Γ by forward substitution: row i of (I/γ − C) Γ = I.
    let mut gamma = vec![vec![0.0; STAGES]; STAGES];
    for i in 0..STAGES {
        for j in 0..=i {
            let known: f64 = (0..i).map(|k| coupling[i][k] * gamma[k][j]).sum();
            gamma[i][j] = GAMMA * (known + if i == j { 1.0 } else { 0.0 });
        }
    }
    let times = |row: Vec<f64>| -> Vec<f64> {
        (0..STAGES).map(|j| (0..STAGES).map(|k| row[k] * gamma[k][j]).sum()).collect()
    };
    let alpha: Vec<Vec<f64>> = ROWS[..STAGES].iter().map(|row| times(dense(row, STAGES))).collect();
    let beta: Vec<Vec<f64>> =
        (0..STAGES).map(|i| (0..STAGES).map(|j| alpha[i][j] + gamma[i][j]).collect()).collect();
    let (weights, error) = (times(dense(ROWS[STAGES], STAGES)), times(dense(ERROR, STAGES)));
    for order in 1..=5 {
        assert!(violation(order, &weights, (&alpha, &beta), false) < 1e-12, "order {order}");
    }
    assert!(violation(6, &weights, (&alpha, &beta), false) > 1e-5);
    for order in 1..=4 {
        assert!(violation(order, &error, (&alpha, &beta), true) < 1e-12, "estimate {order}");
    }
    assert!(violation(5, &error, (&alpha, &beta), true) > 1e-5);
    for row in &DENSE {
        let sum: f64 = row.iter().zip(&gamma).map(|(h, row)| h * row.iter().sum::<f64>()).sum();
        assert!(sum.abs() < 1e-12, "{sum}");
    }
    for i in 0..STAGES {
        assert!((alpha[i].iter().sum::<f64>() - NODES[i]).abs() < 1e-13, "node {i}");
        assert!((gamma[i].iter().sum::<f64>() - TIME[i]).abs() < 1e-12, "time {i}");
    }
}
