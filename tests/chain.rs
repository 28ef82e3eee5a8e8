//! Promise: a chain of intervals is solved as its dense matrix would be, at a cost linear in their number.

use proptest::prelude::*;
use tangency::core::linear::{BorderedLu, Chain};
use tangency::core::zero::{Border, Singular};

/// A chain with what closes it: `l = n + k` rows and a corner.
#[derive(Clone, Debug)]
struct Problem {
    intervals: usize,
    nodes: usize,
    states: usize,
    k: usize,
    blocks: Vec<f64>,
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// `l × k`, one row after the other.
    corner: Vec<f64>,
}

impl Problem {
    fn each(&self) -> usize {
        self.nodes * self.states
    }

    fn equations(&self) -> usize {
        self.intervals * self.each()
    }

    fn values(&self) -> usize {
        self.equations() + self.states
    }

    fn l(&self) -> usize {
        self.states + self.k
    }

    fn size(&self) -> usize {
        self.values() + self.k
    }

    fn new(shape: [usize; 4], mut entry: impl FnMut() -> f64) -> Self {
        let [intervals, nodes, states, k] = shape;
        let mut problem = Problem {
            intervals,
            nodes,
            states,
            k,
            blocks: Vec::new(),
            columns: Vec::new(),
            rows: Vec::new(),
            corner: Vec::new(),
        };
        let mut fill = |count: usize| -> Vec<f64> { (0..count).map(|_| entry()).collect() };
        let (each, equations) = (problem.each(), problem.equations());
        problem.blocks = fill(equations * (each + states));
        problem.columns = fill(equations * k);
        problem.rows = fill((states + k) * problem.values());
        problem.corner = fill((states + k) * k);
        problem
    }

    /// The whole matrix, one row after the other.
    fn dense(&self) -> Vec<Vec<f64>> {
        let (each, wide) = (self.each(), self.each() + self.states);
        let mut matrix = vec![vec![0.0; self.size()]; self.size()];
        for r in 0..self.equations() {
            let first = r / each * each;
            matrix[r][first..first + wide].copy_from_slice(&self.blocks[r * wide..(r + 1) * wide]);
            matrix[r][self.values()..].copy_from_slice(&self.columns[r * self.k..(r + 1) * self.k]);
        }
        for r in 0..self.l() {
            let row = &mut matrix[self.equations() + r];
            row[..self.values()].copy_from_slice(&self.rows[r * self.values()..][..self.values()]);
            row[self.values()..].copy_from_slice(&self.corner[r * self.k..][..self.k]);
        }
        matrix
    }

    fn chain(&self) -> Chain {
        Chain::new(self.intervals, self.nodes, self.states)
    }

    fn factor(&self, chain: &mut Chain) -> Result<(), Singular> {
        chain.factor(&self.blocks, &self.columns, self.k, &self.rows, self.l())
    }
}

/// The reduced matrix with the corner, factored.
fn reduced_lu(problem: &Problem, chain: &Chain) -> BorderedLu {
    let (n, k) = (problem.states, problem.k);
    let size = 2 * n + k;
    let mut matrix = vec![0.0; size * size];
    for i in 0..size {
        for j in 0..size {
            matrix[j * size + i] = chain.reduced()[i * size + j];
            if i >= n && j >= 2 * n {
                matrix[j * size + i] += problem.corner[(i - n) * k + j - 2 * n];
            }
        }
    }
    let mut lu = BorderedLu::default();
    lu.factor(&matrix, Border::NONE).unwrap();
    lu
}

fn solve(problem: &Problem, chain: &mut Chain, right: &[f64]) -> Vec<f64> {
    let n = problem.states;
    let (chain_right, border) = right.split_at(problem.equations());
    let mut chain_right = chain_right.to_vec();
    let mut reduced = vec![0.0; n];
    reduced.extend_from_slice(border);
    chain.forward(&mut chain_right, &mut reduced);
    reduced_lu(problem, chain).solve(&mut reduced);
    let mut out = vec![0.0; problem.values()];
    chain.back(&chain_right, &reduced[..n], &reduced[n..2 * n], &reduced[2 * n..], &mut out);
    out.extend_from_slice(&reduced[2 * n..]);
    out
}

fn solve_transposed(problem: &Problem, chain: &mut Chain, right: &[f64]) -> Vec<f64> {
    let (nodes, columns) = right.split_at(problem.values());
    let mut reduced = vec![0.0; 2 * problem.states + problem.k];
    chain.forward_transposed(nodes, columns, &mut reduced);
    reduced_lu(problem, chain).solve_transposed(&mut reduced);
    let mut out = vec![0.0; problem.equations()];
    chain.back_transposed(&reduced, &mut out);
    out.extend_from_slice(&reduced[problem.states..]);
    out
}

/// `‖M x − b‖ / (‖M‖ ‖x‖)` in the maximum norm.
fn backward_error(matrix: &[Vec<f64>], x: &[f64], b: &[f64]) -> f64 {
    let norm = |v: &[f64]| v.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
    let largest = matrix.iter().map(|row| row.iter().map(|a| a.abs()).sum()).fold(0.0, f64::max);
    let residual: Vec<f64> = matrix
        .iter()
        .zip(b)
        .map(|(row, b)| row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - b)
        .collect();
    norm(&residual) / (largest * norm(x))
}

fn transpose(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    (0..matrix.len()).map(|j| matrix.iter().map(|row| row[j]).collect()).collect()
}

fn shapes() -> impl Strategy<Value = (Problem, Vec<f64>)> {
    (1usize..=7, 1usize..=5, 1usize..=4, 0usize..=3).prop_flat_map(|(intervals, m, n, k)| {
        let size = intervals * m * n + n + k;
        let entries = intervals * m * n * (m * n + n + k) + (n + k) * size;
        let numbers = proptest::collection::vec(-1.0..1.0f64, entries + size);
        numbers.prop_map(move |numbers| {
            let mut next = numbers.iter().copied();
            let problem = Problem::new([intervals, m, n, k], || next.next().unwrap());
            (problem, next.collect())
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Both solutions have the residual of a backward stable method, and the sign of the determinant is that
    /// of the dense matrix.
    #[test]
    fn a_chain_is_its_dense_matrix((problem, right) in shapes()) {
        let mut chain = problem.chain();
        problem.factor(&mut chain).unwrap();
        let matrix = problem.dense();
        let x = solve(&problem, &mut chain, &right);
        prop_assert!(backward_error(&matrix, &x, &right) < 1e-13);
        let w = solve_transposed(&problem, &mut chain, &right);
        prop_assert!(backward_error(&transpose(&matrix), &w, &right) < 1e-13);
        let mut lu = BorderedLu::default();
        lu.factor(&transpose(&matrix).concat(), Border::NONE).unwrap();
        let sign = chain.determinant_sign() * reduced_lu(&problem, &chain).determinant_sign();
        prop_assert_eq!(sign, lu.determinant_sign());
    }
}
