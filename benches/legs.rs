//! What a Newton step and the gradient of a condition cost on orbits of many legs, by leg.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tangency::core::bvp::{BoundarySystem, Collocation, Mesh};
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::{Functional, System};
use tangency::problems::classic::ImpactOscillator;

fn legs(c: &mut Criterion) {
    let mut group = c.benchmark_group("legs");
    for legs in [1, 7, 14, 28, 56] {
        let words = ["flight:impact"].repeat(legs).join(" ");
        let itinerary = Itinerary::read(&words, &ImpactOscillator).unwrap();
        let orbit = HybridOrbit::of(ImpactOscillator, itinerary).expect("an itinerary");
        let meshes = vec![Mesh::uniform(4); legs];
        let mut orbits = BoundarySystem::new(orbit, Collocation::new(4).unwrap(), meshes).unwrap();
        let n = orbits.names().dimension();
        let mut x: Vec<f64> = (0..n).map(|i| 1.0 + 0.3 * (1.3 * i as f64).sin()).collect();
        x.extend([0.3, 1.7, 0.8, 0.1, 0.9]);
        let mut unit = vec![0.0; x.len()];
        unit[n] = 1.0;
        let mut column = vec![0.0; n];
        orbits.derivative(&x, &[&unit], &mut column).unwrap();
        let (rows, amplitude) = (vec![1.0 / n as f64; n], x[n]);
        let border = Border { width: 1, columns: &column, rows: &rows, corner: &[1.0], units: &[] };
        let mut factors = Factors::default();
        let (mut right, mut count) = (vec![1.0; n + 1], 0.0);
        group.throughput(Throughput::Elements(legs as u64));
        group.bench_function(BenchmarkId::new("assemble", legs), |b| {
            b.iter(|| {
                count += 1.0;
                x[n] = amplitude + 1e-9 * count;
                orbits.assemble(&x)
            });
        });
        group.bench_function(BenchmarkId::new("factor and solve", legs), |b| {
            b.iter(|| {
                orbits.factor(Form::Jacobian, border, &mut factors).unwrap();
                right.fill(1.0);
                factors.solve(&mut right);
            });
        });
        let mut out = vec![0.0; x.len()];
        group.bench_function(BenchmarkId::new("gradient", legs), |b| {
            b.iter(|| orbits.gradient(&x, Functional::First(&rows, &unit), &[0], &mut out));
        });
    }
    group.finish();
}

criterion_group!(benches, legs);
criterion_main!(benches);
