//! How long the core takes: one Newton solution, a branch of a discretised field, a curve of folds.

#[allow(dead_code)] // Tests solve more of them.
#[path = "../tests/common/problems.rs"]
mod problems;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use problems::{Bratu, Oxidation};
use tangency::core::continuation::{Continuation, Extended, Newton, Tolerances};
use tangency::core::system::{Dense, Kind};

/// Bratu's problem at λ = 2, from zero, for growing numbers of unknowns.
fn newton(c: &mut Criterion) {
    let mut group = c.benchmark_group("newton");
    for n in [10, 30, 100] {
        let mut system = Dense::new(Bratu(n));
        let mut x = vec![0.0; n + 1];
        x[n] = 2.0;
        let mut equations = Extended::new(&mut system, &x, vec![]);
        let (mut solver, weights) = (Newton::default(), vec![1.0; n]);
        let tolerances = Tolerances::new(1e-12, 12);
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                let mut z = vec![0.0; n];
                solver.solve(&mut equations, &mut z, None, &weights, tolerances).unwrap();
                z
            });
        });
    }
    group.finish();
}

/// Bratu's branch through its fold, with stability at every point.
fn bratu(c: &mut Criterion) {
    let mut group = c.benchmark_group("bratu");
    group.sample_size(10);
    for n in [10, 30, 100] {
        let mut system = Dense::new(Bratu(n));
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                Continuation::new(&mut system)
                    .along("lambda", 0.0..=10.0)
                    .bound("middle", 0.0..=5.0)
                    .trace()
                    .unwrap()
            });
        });
    }
    group.finish();
}

/// The CO problem's fold curve with its cusp and both Bogdanov–Takens points.
fn folds(c: &mut Criterion) {
    let mut system = Dense::new(Oxidation);
    let branch = Continuation::new(&mut system)
        .from(&[0.001137, 0.891483, 0.062345])
        .at("q2", 2.0)
        .at("k", 0.4)
        .along("q2", 0.5..=2.0)
        .trace()
        .unwrap();
    let label = branch.of_kind(Kind::LP).next().unwrap().label;
    c.bench_function("fold curve", |b| {
        b.iter(|| {
            Continuation::new(&mut system)
                .restart(&branch, label)
                .hold(Kind::LP)
                .along("q2", 0.5..=2.0)
                .along("k", 0.1..=2.0)
                .trace()
                .unwrap()
        });
    });
}

criterion_group!(benches, newton, bratu, folds);
criterion_main!(benches);
