//! How long a flow takes: one period of Mita's stick field to 5e-12, in each scheme and scalar
//! type.

use criterion::{Criterion, criterion_group, criterion_main};
use num_dual::Dual;
use std::f64::consts::PI;
use std::hint::black_box;
use tangency::core::ode::{Flow, Scheme, Settings};
use tangency::core::problem::VectorField;
use tangency::core::scalar::{DualChunk, Scalar};
use tangency::vector_field;

vector_field! {
    /// The block of Mita's impact actuator between impacts.
    struct Stick [q, u; omega, V; t] {
        let (force, gap) = (V * (omega * t).sin(), T::one() - q);
        d/dt q = u;
        d/dt u = force * force / (gap * gap) - q - u * 0.04;
    }
}

/// On the nonimpacting periodic orbit.
const START: [f64; 2] = [-0.1193425866519154, -0.03360474279494714];
const PARAMETERS: [f64; 2] = [0.45, 0.2];

/// A number that carries a derivative in one of four directions.
trait Seed: Scalar {
    fn seed(value: f64, direction: usize) -> Self;
}

impl Seed for f64 {
    fn seed(value: f64, _direction: usize) -> Self {
        value
    }
}

impl Seed for DualChunk<f64, 4> {
    fn seed(value: f64, direction: usize) -> Self {
        Self::seeded(value, direction)
    }
}

impl Seed for Dual<DualChunk<f64, 4>> {
    fn seed(value: f64, direction: usize) -> Self {
        Dual::new(DualChunk::seed(value, direction), 1.0.into())
    }
}

fn period<T: Seed>(c: &mut Criterion, name: &str, scheme: Scheme, tolerance: f64) {
    let mut flow = Flow::<T>::new(Settings::new(scheme, tolerance)).unwrap();
    c.bench_function(&format!("flow/{scheme:?}/{name}"), |b| {
        b.iter(|| {
            let p = black_box([T::seed(PARAMETERS[0], 2), T::seed(PARAMETERS[1], 3)]);
            let mut x = [T::seed(START[0], 0), T::seed(START[1], 1)];
            flow.advance(&Stick, T::zero(), p[0].recip() * PI, &mut x, &p).unwrap();
            x
        });
    });
}

/// The field alone, as often as the method of order 8 evaluates it.
fn field(c: &mut Criterion) {
    c.bench_function("flow/277 fields", |b| {
        b.iter(|| {
            let mut f = [0.0; 2];
            for k in 0..277 {
                Stick.field(black_box(f64::from(k) * 0.025), &START, &PARAMETERS, &mut f);
                black_box(&f);
            }
        });
    });
}

fn flows(c: &mut Criterion) {
    for (scheme, tolerance) in
        [(Scheme::DormandPrince8, 1e-11), (Scheme::DormandPrince5, 3e-12), (Scheme::Rodas5P, 5e-11)]
    {
        period::<f64>(c, "f64", scheme, tolerance);
        period::<DualChunk<f64, 4>>(c, "four derivatives", scheme, tolerance);
        period::<Dual<DualChunk<f64, 4>>>(c, "nested", scheme, tolerance);
    }
}

criterion_group!(benches, field, flows);
criterion_main!(benches);
