//! What an interval of collocation costs: evaluation, linearisation, elimination and solution.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tangency::core::bvp::{BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh};
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Functional, System};

/// Lorenz' field between conditions on its three states.
#[derive(Clone)]
struct Lorenz;

impl BoundaryProblem for Lorenz {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![["x", "y", "z"].map(String::from).to_vec()]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["rho".into()]
    }
    fn field<T: Scalar>(&self, _s: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = (x[1] - x[0]) * 10.0;
        f[1] = x[0] * (q[0] - x[2]) - x[1];
        f[2] = x[0] * x[1] - x[2] * (8.0 / 3.0);
    }
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        (0..3).for_each(|i| b[i] = ends.start[i] - ends.end[i]);
    }
}

/// A parameter released, as along a branch: its column, and a border of width 1.
fn interval(c: &mut Criterion) {
    for intervals in [20, 100, 500] {
        let collocation = Collocation::new(4).unwrap();
        let mut system =
            BoundarySystem::new(Lorenz, collocation, vec![Mesh::uniform(intervals)]).unwrap();
        let wave = |_, tau: f64, x: &mut [f64]| {
            x.copy_from_slice(&[(6.0 * tau).sin(), (6.0 * tau).cos(), 1.0 + tau]);
        };
        let mut x = system.sampled(&[], wave);
        let n = x.len();
        x.push(28.0);
        let mut direction = vec![0.0; n + 1];
        direction[n] = 1.0;
        let mut column = vec![0.0; n];
        system.derivative(&x, &[&direction], &mut column).unwrap();
        let mut group = c.benchmark_group("collocation");
        group.throughput(Throughput::Elements(intervals as u64));
        let mut next = 28.0;
        group.bench_function(BenchmarkId::new("residual", intervals), |b| {
            b.iter(|| {
                next += 1e-9;
                x[n] = next;
                system.residual(&x, &mut column)
            });
        });
        group.bench_function(BenchmarkId::new("assemble", intervals), |b| {
            b.iter(|| {
                next += 1e-9;
                x[n] = next;
                system.assemble(&x)
            });
        });
        system.derivative(&x, &[&direction], &mut column).unwrap();
        let rows = vec![1.0 / n as f64; n];
        let border = Border { width: 1, columns: &column, rows: &rows, corner: &[1.0], units: &[] };
        let mut factors = Factors::default();
        group.bench_function(BenchmarkId::new("factor", intervals), |b| {
            b.iter(|| system.factor(Form::Jacobian, border, &mut factors));
        });
        let mut right = vec![1.0; n + 1];
        group.bench_function(BenchmarkId::new("solve", intervals), |b| {
            b.iter(|| {
                right.fill(1.0);
                factors.solve(&mut right);
            });
        });
        let (w, v) = (vec![1.0; n], vec![1.0; n + 1]);
        let mut out = vec![0.0; n + 1];
        group.bench_function(BenchmarkId::new("gradient", intervals), |b| {
            b.iter(|| system.gradient(&x, Functional::First(&w, &v), &[0], &mut out).unwrap());
        });
    }
}

criterion_group!(benches, interval);
criterion_main!(benches);
