//! What a plate costs: a trace through pull-in, and its pieces by the number of functions.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use tangency::core::linalg::{Border, Factors, Form};
use tangency::core::system::{Functional, System};
use tangency::problems::plate::{Orders, Ritz, RitzSettings};
use tangency::scene::{BUILT_IN, Scene, execute};

/// The scene `plate-clamped` as a user runs it, and without refinement of its special points.
fn traces(criterion: &mut Criterion) {
    let text = BUILT_IN.iter().find(|scene| scene.name == "plate-clamped").unwrap().text;
    let mut group = criterion.benchmark_group("plate-clamped");
    for refinement in ["1e-8", "0"] {
        let mut scene = Scene::parse(text).unwrap();
        scene.set("refinement", refinement).unwrap();
        group.bench_function(BenchmarkId::new("refinement", refinement), |bencher| {
            bencher.iter(|| execute(black_box(&scene), None, &mut ()));
        });
    }
    group.finish();
}

/// Residual, assembly with factorisation, and gradient of `wᵀF_z v`, for so many functions each
/// way.
fn pieces(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ritz");
    for count in [4, 6, 8, 12] {
        let mut settings = RitzSettings::new("CCCC".parse().unwrap());
        settings.orders = Some(Orders { transverse: [count; 2], in_plane: [count + 2; 2] });
        let mut plate = Ritz::new(settings).unwrap();
        let mut x = plate.at_rest();
        let n = plate.names().dimension();
        (x[0], x[n]) = (0.05, 100.0);
        let mut r = vec![0.0; n];
        group.bench_function(BenchmarkId::new("residual", count), |bencher| {
            bencher.iter(|| plate.residual(black_box(&x), &mut r));
        });
        group.bench_function(BenchmarkId::new("assemble and factor", count), |bencher| {
            let mut factors = Factors::default();
            bencher.iter(|| {
                plate.assemble(black_box(&x)).unwrap();
                plate.factor(Form::Jacobian, Border::NONE, &mut factors)
            });
        });
        let mut v = vec![0.0; x.len()];
        v[..n].fill(1.0);
        let mut gradient = vec![0.0; x.len()];
        group.bench_function(BenchmarkId::new("gradient", count), |bencher| {
            bencher.iter(|| {
                plate
                    .gradient(black_box(&x), Functional::First(&v[..n], &v), &[0], &mut gradient)
                    .unwrap()
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    targets = traces, pieces
}
criterion_main!(benches);
