//! How long the condensation of a chain takes, by interval: factor, solve, solve with the
//! transposed matrix.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tangency::core::linalg::Chain;

const INTERVALS: usize = 50;

/// Two columns and two rows around collocation-like blocks: a random part on differences of nodes.
struct Case {
    states: usize,
    each: usize,
    blocks: Vec<f64>,
    columns: Vec<f64>,
    rows: Vec<f64>,
    chain: Chain,
}

impl Case {
    fn new(states: usize, nodes: usize) -> Self {
        let each = states * nodes;
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let mut fill = |count: usize| -> Vec<f64> { (0..count).map(|_| random()).collect() };
        Case {
            states,
            each,
            blocks: fill(INTERVALS * each * (each + states)),
            columns: fill(INTERVALS * each * 2),
            rows: fill(2 * (INTERVALS * each + states)),
            chain: Chain::new(INTERVALS, nodes, states),
        }
    }

    fn factor(&mut self) {
        self.chain.factor(&self.blocks, &self.columns, 2, &self.rows, 2).unwrap();
    }
}

fn chain(c: &mut Criterion) {
    let mut group = c.benchmark_group("chain");
    group.throughput(Throughput::Elements(INTERVALS as u64));
    for (states, nodes) in [(2, 4), (3, 4), (6, 4), (2, 7), (3, 7), (6, 7), (3, 1)] {
        let mut case = Case::new(states, nodes);
        let name = format!("{states} states, {nodes} nodes");
        group.bench_function(BenchmarkId::new("factor", &name), |b| b.iter(|| case.factor()));
        let (n, size) = (case.states, INTERVALS * case.each);
        let (ends, given) = (vec![1.0; n], vec![1.0; size]);
        let (mut right, mut reduced, mut out) =
            (given.clone(), vec![0.0; n + 2], vec![0.0; size + n]);
        group.bench_function(BenchmarkId::new("solve", &name), |b| {
            b.iter(|| {
                right.copy_from_slice(&given);
                case.chain.forward(&mut right, &mut reduced);
                case.chain.back(&right, &ends, &ends, &[1.0, 1.0], &mut out);
            });
        });
        let nodes = vec![1.0; size + n];
        let (mut reduced, left) = (vec![0.0; 2 * n + 2], vec![1.0; n + 2]);
        group.bench_function(BenchmarkId::new("transposed", &name), |b| {
            b.iter(|| {
                case.chain.forward_transposed(&nodes, &[1.0, 1.0], &mut reduced);
                case.chain.back_transposed(&left, &mut out[..size]);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, chain);
criterion_main!(benches);
