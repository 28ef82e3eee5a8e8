//! An impacting system from its statement to its diagram: a forced oscillator that hits a stop.
//!
//! `x'' + x'/10 + x = A cos ωt`, `x ≤ 1`, thrown back with 0.8 of its speed. Orbits without impacts graze where
//! `A = √((1 − ω²)² + (ω/10)²)`; those with one impact a period begin there, and fold.

use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::{Continuation, Kind};
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::scalar::Scalar;

#[derive(Clone)]
struct Oscillator;

impl HybridSystem for Oscillator {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("flight", ["x", "v"])]
    }
    fn guards(&self) -> Vec<Guard> {
        vec![Guard::new("impact", 0)]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["amplitude".into(), "frequency".into()]
    }
    fn field<T: Scalar>(&self, _mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = p[0] * (p[1] * t).cos() - x[0] - x[1] * 0.1;
    }
    fn guard<T: Scalar>(&self, _guard: usize, _t: T, x: &[T], _p: &[T]) -> T {
        T::one() - x[0]
    }
    fn reset<T: Scalar>(&self, _g: usize, _next: usize, _t: T, x: &[T], _p: &[T], after: &mut [T]) {
        (after[0], after[1]) = (x[0], x[1] * -0.8);
    }
    fn next(&self, _guard: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        0
    }
    fn period<T: Scalar>(&self, p: &[T]) -> Option<T> {
        Some(p[1].recip() * std::f64::consts::TAU)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let orbit = HybridOrbit::of(Oscillator, Itinerary::smooth(0, 1));
    let mut orbits = BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)])?;
    let nonimpacting = Continuation::of(&mut orbits)
        .named("nonimpacting")
        .at("amplitude", 0.1)
        .at("frequency", 1.2)
        .along("amplitude", 0.0..=1.0)
        .trace()?;
    let grazing = nonimpacting.of_kind(Kind::G).next().ok_or("no grazing")?;
    let impacting = Continuation::of(&mut orbits)
        .named("one impact")
        .restart(&nonimpacting, grazing.label)
        .switch()
        .along("amplitude", 0.0..=1.0)
        .trace()?;
    for branch in [&nonimpacting, &impacting] {
        println!("{} ({}): {} points", branch.name, branch.itinerary, branch.points.len());
        for special in &branch.special {
            println!("  {} amplitude = {:.12}", special.kind, special.parameters[0]);
        }
    }
    let fold = impacting.of_kind(Kind::LP).next().ok_or("no fold")?;
    // Both are known in closed form.
    let exact = (0.44_f64.powi(2) + 0.12_f64.powi(2)).sqrt();
    assert!((grazing.parameters[0] - exact).abs() < 1e-11);
    assert!((fold.parameters[0] - 0.151682351638).abs() < 1e-12);
    Ok(())
}
