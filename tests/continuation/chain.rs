//! Promise: a chain of intervals is solved as its dense matrix would be, at a cost linear in their
//! number.

use proptest::prelude::*;
use tangency::core::failure::Failure;
use tangency::core::linalg::{Border, BorderedLu, Chain, multipliers};

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

    fn factor(&self, chain: &mut Chain) -> Result<(), Failure> {
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
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    /// Both solutions have the residual of a backward stable method, and the sign of the
    /// determinant is that of the dense matrix.
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

/// Blocks so large that panels of columns are eliminated, the last one narrower than the others; and
/// chains so large that threads eliminate groups of intervals, the last one shorter than the others.
#[test]
fn large_blocks_are_solved_accurately() {
    for [intervals, nodes, states] in [[3, 4, 32], [3, 4, 37], [3, 2, 110], [21, 4, 16]] {
        let mut state = 1_u64;
        let mut entry = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / 2.0_f64.powi(52) - 1.0
        };
        let problem = Problem::new([intervals, nodes, states, 2], &mut entry);
        let right: Vec<f64> = (0..problem.size()).map(|_| entry()).collect();
        let mut chain = problem.chain();
        problem.factor(&mut chain).unwrap();
        let matrix = problem.dense();
        let x = solve(&problem, &mut chain, &right);
        assert!(backward_error(&matrix, &x, &right) < 1e-13);
        let w = solve_transposed(&problem, &mut chain, &right);
        assert!(backward_error(&transpose(&matrix), &w, &right) < 1e-13);
    }
}

/// A chain of transfer matrices `G_i = S_{i+1} D S_i⁻¹` with `S_N = S_0`: its multipliers are the
/// entries of `D^N`. `S_i` are rotations.
fn dichotomy(intervals: usize, multipliers: &[f64]) -> Vec<Vec<f64>> {
    let n = multipliers.len();
    let rotation = |i: usize| {
        let mut s = vec![0.0; n * n];
        (0..n).for_each(|r| s[r * n + r] = 1.0);
        for r in 0..n {
            for c in 0..r {
                let (sin, cos) =
                    ((1 + i % intervals) as f64 * (0.7 + r as f64 + 0.3 * c as f64)).sin_cos();
                for j in 0..n {
                    let (a, b) = (s[r * n + j], s[c * n + j]);
                    s[r * n + j] = cos * a - sin * b;
                    s[c * n + j] = sin * a + cos * b;
                }
            }
        }
        s
    };
    let root = |mu: f64| mu.signum() * mu.abs().powf(1.0 / intervals as f64);
    (0..intervals)
        .map(|i| {
            let (left, right) = (rotation(i), rotation(i + 1));
            let entry = |r: usize, c: usize| {
                (0..n).map(|j| right[r * n + j] * root(multipliers[j]) * left[c * n + j]).sum()
            };
            (0..n * n).map(|rc| entry(rc / n, rc % n)).collect()
        })
        .collect()
}

/// Blocks `[−G_i | I]` of shooting.
fn shooting(transfers: &[Vec<f64>], n: usize) -> Vec<f64> {
    let mut blocks = Vec::new();
    for g in transfers {
        for (r, row) in g.chunks_exact(n).enumerate() {
            blocks.extend(row.iter().map(|g| -g));
            blocks.extend((0..n).map(|c| f64::from(r == c)));
        }
    }
    blocks
}

/// `P` and `Q` of a chain without a border.
fn pencil(blocks: &[f64], intervals: usize, n: usize) -> [Vec<f64>; 2] {
    let mut chain = Chain::new(intervals, 1, n);
    chain.factor(blocks, &[], 0, &[], 0).unwrap();
    let half = |first: usize| {
        chain.reduced().chunks_exact(2 * n).flat_map(|row| row[first..first + n].to_vec()).collect()
    };
    [half(0), half(n)]
}

fn product(transfers: &[Vec<f64>], n: usize) -> Vec<f64> {
    let times = |b: &Vec<f64>, a: &Vec<f64>| -> Vec<f64> {
        let entry = |rc: usize| (0..n).map(|j| a[rc / n * n + j] * b[j * n + rc % n]).sum();
        (0..n * n).map(entry).collect()
    };
    transfers[1..].iter().fold(transfers[0].clone(), |b, a| times(&b, a))
}

fn relative_error(computed: (f64, f64), exact: f64) -> f64 {
    (computed.0 / exact - 1.0).hypot(computed.1 / exact)
}

/// Multipliers over many orders of magnitude, as accurate as documented whatever the number of
/// intervals.
#[test]
fn multipliers_far_from_one_are_accurate() {
    let cases: [&[f64]; 6] = [
        &[-0.7],
        &[1e8, 1e-8],
        &[1e6, -1e-6],
        &[1e8, 1.0, 1e-8],
        &[1e12, 1e6, 1.0],
        &[1e12, 2.0, 1.0, 1e-12],
    ];
    for exact in cases {
        for intervals in [5, 21, 101] {
            let n = exact.len();
            let [p, q] = pencil(&shooting(&dichotomy(intervals, exact), n), intervals, n);
            for (computed, exact) in multipliers(&p, &q, n).unwrap().into_iter().zip(exact) {
                let error = relative_error(computed, *exact);
                let spread = exact.abs().max(1.0 / exact.abs());
                let claimed = if n <= 2 { 1e-12 } else { 1e-14 + 1e-15 * spread };
                assert!(error < claimed, "{intervals} intervals: {exact:e} ± {error:.1e}");
            }
        }
    }
}

/// Many multipliers: to 1e-11 where the quotient of the pencil has them, and as accurate as few ones
/// where a large one would hide the others.
#[test]
fn many_multipliers_are_accurate() {
    for largest in [1.2_f64, 1e9] {
        let exact: Vec<f64> = (0..20).map(|k| largest * 0.6_f64.powi(k)).collect();
        let [p, q] = pencil(&shooting(&dichotomy(21, &exact), 20), 21, 20);
        for (computed, exact) in multipliers(&p, &q, 20).unwrap().into_iter().zip(exact) {
            let distance = (computed.0 - exact).hypot(computed.1);
            assert!(distance < 1e-11 * exact.max(1.0), "{largest:e}: {exact:e} ± {distance:.1e}");
        }
    }
}

/// A few intervals: the transfer matrices themselves keep the smallest multiplier to 10⁻¹⁶ times
/// the growth.
#[test]
fn multipliers_of_few_intervals() {
    for intervals in [1, 3] {
        let exact = [1e4, 1e-4];
        let [p, q] = pencil(&shooting(&dichotomy(intervals, &exact), 2), intervals, 2);
        for (computed, exact) in multipliers(&p, &q, 2).unwrap().into_iter().zip(exact) {
            assert!(relative_error(computed, exact) < 1e-7, "{intervals}: {computed:?}");
        }
    }
    // Solved for the larger end of each solution, one interval keeps them all.
    let (s, c) = 0.7_f64.sin_cos();
    let blocks = [1e8 * c, 1e8 * s, -c, -s, -1e-8 * s, 1e-8 * c, s, -c].map(|a| a * 1e-4);
    let [p, q] = pencil(&blocks, 1, 2);
    for (computed, exact) in multipliers(&p, &q, 2).unwrap().into_iter().zip([1e8, 1e-8]) {
        assert!(relative_error(computed, exact) < 1e-14, "{computed:?}");
    }
}

/// Where multipliers break: in the product of the transfer matrices the smallest drowns.
#[test]
fn a_product_loses_the_smallest_multiplier() {
    let transfers = dichotomy(21, &[1e8, -1e-8]);
    let minus_one = [-1.0, 0.0, 0.0, -1.0];
    let of_product = multipliers(&product(&transfers, 2), &minus_one, 2).unwrap();
    assert!(relative_error(of_product[0], 1e8) < 1e-12);
    assert!(relative_error(of_product[1], -1e-8) > 1e-4, "{of_product:?}");
    let [p, q] = pencil(&shooting(&transfers, 2), 21, 2);
    assert!(relative_error(multipliers(&p, &q, 2).unwrap()[1], -1e-8) < 1e-13);
}

#[test]
fn complex_infinite_and_vanishing_multipliers() {
    let (re, im) = (0.6, 0.8);
    let minus_g = [-re, im, 0.0, -im, -re, 0.0, 0.0, 0.0, -3.0];
    let one = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let planar = multipliers(&[-re, im, -im, -re], &[1.0, 0.0, 0.0, 1.0], 2).unwrap();
    let spatial = multipliers(&minus_g, &one, 3).unwrap();
    assert!((spatial[0].0 - 3.0).abs() < 1e-14);
    for pair in [&planar[..], &spatial[1..]] {
        for (mu, sign) in pair.iter().zip([1.0, -1.0]) {
            assert!((mu.0 - re).hypot(mu.1 - sign * im) < 1e-15 * 8.0, "{pair:?}");
        }
    }
    assert_eq!(multipliers(&[1.0], &[0.0], 1).unwrap(), [(f64::INFINITY, 0.0)]);
    let half_singular = multipliers(&[1.0, 0.0, 0.0, 0.0], &[0.0, 0.0, 0.0, 1.0], 2).unwrap();
    assert_eq!(half_singular, [(f64::INFINITY, 0.0), (0.0, 0.0)]);
    let three = multipliers(
        &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0],
        &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0],
        3,
    )
    .unwrap();
    assert_eq!(three, [(f64::INFINITY, 0.0), (2.0, 0.0), (0.0, 0.0)]);
    let everything = multipliers(&[0.0; 4], &[0.0; 4], 2);
    assert!(matches!(everything, Err(Failure::Undetermined(_))), "{everything:?}");
    let undefined = multipliers(&[f64::NAN; 9], &[1.0; 9], 3);
    assert!(matches!(undefined, Err(Failure::NotFinite { .. })), "{undefined:?}");
}

/// Growth by 10⁶ and decay by 10⁻⁶ in each of 20 intervals, with the decaying part given at the
/// left end and the growing one at the right: exact to the last digits, and as the dense
/// factorisation has it.
#[test]
fn dichotomic_conditions_are_solved_accurately() {
    let (intervals, n) = (20, 2);
    for angle in [0.0, 0.4] {
        // Each solution as x_i / 10⁶ = x_{i+1} or its inverse; the equations, or their sum and
        // difference.
        let (s, c) = f64::sin_cos(angle);
        let (grow, decay) = (1e6, 1e-6);
        let [growing, decaying] = [[-c, -s, c / grow, s / grow], [decay * s, -decay * c, -s, c]];
        let mix = if angle == 0.0 { 0.0 } else { 1.0 };
        let first = (0..4).map(|j| growing[j] + mix * decaying[j]);
        let block: Vec<f64> = first.chain((0..4).map(|j| decaying[j] - mix * growing[j])).collect();
        let mut problem = Problem::new([intervals, 1, n, 0], || 0.0);
        problem.blocks = block.repeat(intervals);
        let second = 2 * problem.values() - n;
        problem.rows[..2].copy_from_slice(&[-s, c]);
        problem.rows[second..].copy_from_slice(&[c, s]);
        let mut right = vec![0.0; problem.size()];
        right[problem.equations()..].fill(1.0);
        let mut chain = problem.chain();
        problem.factor(&mut chain).unwrap();
        let x = solve(&problem, &mut chain, &right);
        let mut lu = BorderedLu::default();
        lu.factor(&transpose(&problem.dense()).concat(), Border::NONE).unwrap();
        lu.solve(&mut right);
        for i in 0..=intervals {
            let (growing, decaying) =
                (grow.powi(i as i32 - intervals as i32), decay.powi(i as i32));
            let exact = [c * growing - s * decaying, s * growing + c * decaying];
            for j in 0..n {
                assert!((x[i * n + j] - exact[j]).abs() < 1e-14, "node {i} at angle {angle}");
                assert!((right[i * n + j] - exact[j]).abs() < 1e-14, "dense, node {i}");
                if angle == 0.0 {
                    assert!((x[i * n + j] / exact[j] - 1.0).abs() < 1e-13, "node {i}, state {j}");
                }
            }
        }
    }
}

/// The problem on which Gaussian elimination with plain partial pivoting fails, by growth that is
/// exponential in the number of intervals (Wright, SIAM J. Sci. Comput. 14 (1993) 231):
/// `x' = [−1/6 1; 1 −1/6] x`.
#[test]
fn wrights_problem_is_solved() {
    let (intervals, h) = (400, 0.3_f64);
    let damping = (-h / 6.0).exp();
    let (same, other) = (damping * h.cosh(), damping * h.sinh());
    let mut problem = Problem::new([intervals, 1, 2, 0], || 0.0);
    problem.blocks = shooting(&vec![vec![same, other, other, same]; intervals], 2);
    let values = problem.values();
    for (r, node) in [(0, 0), (1, 0), (0, values - 2), (1, values - 2)] {
        problem.rows[r * values + node + r] = 1.0;
    }
    let x: Vec<f64> = (0..problem.size()).map(|i| 1.0 + (i as f64).sin()).collect();
    let right: Vec<f64> =
        problem.dense().iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
    let mut chain = problem.chain();
    problem.factor(&mut chain).unwrap();
    let computed = solve(&problem, &mut chain, &right);
    for (i, (computed, exact)) in computed.iter().zip(&x).enumerate() {
        assert!((computed - exact).abs() < 1e-13, "component {i}: {computed} instead of {exact}");
    }
}

/// Units of states, from nanometres to kilovolts, and of equations change neither the verdict nor
/// the digits.
#[test]
fn units_do_not_matter() {
    let mut seed = 0.3_f64;
    let plain = Problem::new([6, 3, 3, 1], || {
        seed = (seed * 97.0 + 0.1).fract();
        seed - 0.5
    });
    let (units, mut scaled) = ([1e-9, 1.0, 1e3], plain.clone());
    let wide = plain.each() + plain.states;
    for (i, entry) in scaled.blocks.iter_mut().enumerate() {
        *entry *= units[(i / wide + 1) % 3] / units[i % wide % 3];
    }
    for (i, entry) in scaled.columns.iter_mut().enumerate() {
        *entry *= units[(i + 1) % 3];
    }
    for (i, entry) in scaled.rows.iter_mut().enumerate() {
        *entry /= units[i % plain.values() % 3];
    }
    let x = |problem: &Problem, unit: &dyn Fn(usize) -> f64| {
        let mut right = vec![1.0; problem.size()];
        (0..problem.equations()).for_each(|i| right[i] = unit(i + 1));
        let mut chain = problem.chain();
        problem.factor(&mut chain).unwrap();
        solve(problem, &mut chain, &right)
    };
    let (one, other) = (x(&plain, &|_| 1.0), x(&scaled, &|i| units[i % 3]));
    for i in 0..plain.values() {
        assert!(
            (other[i] / units[i % 3] - one[i]).abs() < 1e-10 * one[i].abs().max(1.0),
            "value {i}"
        );
    }
}

#[test]
fn singular_chains_are_refused() {
    let mut seed = 0.3_f64;
    let problem = Problem::new([5, 3, 2, 1], || {
        seed = (seed * 97.0 + 0.1).fract();
        seed - 0.5
    });
    let wide = problem.each() + problem.states;
    // An inner value that occurs in no equation; one that occurs in none on either side of a shared
    // node.
    for (interval, column) in [(2, Some(3)), (2, None), (0, Some(2))] {
        let mut singular = problem.clone();
        for r in 0..problem.equations() {
            let row = &mut singular.blocks[r * wide..(r + 1) * wide];
            match (r / problem.each(), column) {
                (i, Some(column)) if i == interval => row[column] = 0.0,
                (i, None) if i == interval => row[problem.each()] = 0.0,
                (i, None) if i == interval + 1 => row[0] = 0.0,
                _ => {}
            }
        }
        let refused = singular.factor(&mut problem.chain()).unwrap_err();
        let Failure::Singular { pivot, .. } = refused else { panic!("{refused}") };
        assert!(pivot <= 1e-15, "{pivot}");
    }
    let mut undefined = problem.clone();
    undefined.blocks[wide * 14 + 3] = f64::NAN;
    assert!(undefined.factor(&mut problem.chain()).is_err());
    // After a refusal the same chain factors a regular matrix.
    let mut chain = problem.chain();
    undefined.factor(&mut chain).unwrap_err();
    problem.factor(&mut chain).unwrap();
}

#[test]
fn nothing_is_allocated_after_the_first_factorisation() {
    let mut seed = 0.3_f64;
    let problem = Problem::new([5, 3, 2, 1], || {
        seed = (seed * 97.0 + 0.1).fract();
        seed - 0.5
    });
    let mut chain = problem.chain();
    problem.factor(&mut chain).unwrap();
    let mut right = vec![1.0; problem.equations()];
    let nodes = vec![1.0; problem.values()];
    let (mut reduced, mut out) = (vec![1.0; 5], vec![0.0; problem.values()]);
    let counted = allocation_counter::measure(|| {
        problem.factor(&mut chain).unwrap();
        chain.forward(&mut right, &mut reduced);
        chain.back(&right, &[1.0; 2], &[1.0; 2], &[1.0], &mut out);
        chain.forward_transposed(&nodes, &[1.0], &mut reduced);
        chain.back_transposed(&[1.0; 5], &mut out[..30]);
    });
    assert_eq!(counted.count_total, 0);
}

/// Eight times the intervals are eight times the numbers of a factorisation, each of which belongs
/// to one interval.
#[test]
fn the_size_is_linear_in_the_intervals() {
    let bytes = |intervals: usize| {
        let mut seed = 0.3_f64;
        let problem = Problem::new([intervals, 4, 3, 1], || {
            seed = (seed * 97.0 + 0.1).fract();
            seed - 0.5
        });
        let factored = || problem.factor(&mut problem.chain()).unwrap();
        allocation_counter::measure(factored).bytes_max as f64
    };
    let ratio = bytes(400) / bytes(50);
    assert!((7.0..8.5).contains(&ratio), "{ratio}");
}

/// A state that vanishes has derivatives of no size: numbers below the least normal one do not keep
/// the other multipliers from being found.
#[test]
fn multipliers_beside_numbers_without_digits() {
    for k in 0..200 {
        let (t, a) = (5e-324 * f64::from(k), 0.1 + 0.013 * f64::from(k));
        let p = [
            [1.1454, -0.5666 * a, 0.0, -23.48],
            [1.116, 0.296, 0.0, 1.41],
            [-t, t, 0.0054, -t],
            [-7.1e-18, 0.0, 0.0, -2.2e-16],
        ];
        let q = [
            [0.3635, -1.4166, 0.0, -58.7],
            [2.79 * a, -1.759, 0.0, 3.53],
            [-3.0 * t, 3.0 * t, -2.5, -3.0 * t],
            [-1.8e-17, 0.0, 0.0, -2.5],
        ];
        let found = multipliers(p.as_flattened(), q.as_flattened(), 4).expect("multipliers");
        assert!(found.iter().any(|mu| (mu.0 - 0.0054 / 2.5).abs() < 1e-12), "{k}: {found:?}");
    }
}
