//! A forced oscillator with a stop, `x'' + x'/10 + x = A cos ωt`, `x ≤ 1`: its impacting branch
//! from grazing.
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::Continuation;
use tangency::core::hybrid::{Guard, HybridSystem, Mode};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::problem::Forcing;
use tangency::core::scalar::Scalar;
use tangency::core::system::Kind;
use tangency::output::{Document, diagram, draw, write_atomically};

#[derive(Clone)]
struct Oscillator;

impl HybridSystem for Oscillator {
    fn modes(&self) -> Vec<Mode> {
        vec![Mode::new("flight", ["x", "v"])]
    }
    fn guards(&self) -> Vec<Guard> {
        vec![Guard::new("impact", [0])]
    }
    fn parameters(&self) -> Vec<String> {
        vec!["amplitude".into(), "frequency".into()]
    }
    fn field<T: Scalar>(&self, _mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = p[0] * (p[1] * t).cos() - x[0] - x[1] * 0.1;
    }
    fn guard<T: Scalar>(&self, _guard: usize, _mode: usize, _t: T, x: &[T], _p: &[T]) -> T {
        T::one() - x[0]
    }
    fn reset<T: Scalar>(
        &self,
        _g: usize,
        _modes: (usize, usize),
        _t: T,
        x: &[T],
        _p: &[T],
        after: &mut [T],
    ) {
        (after[0], after[1]) = (x[0], x[1] * -0.8);
    }
    fn next_mode(&self, _guard: usize, _mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        0
    }
    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: std::f64::consts::TAU }
    }
    fn period<T: Scalar>(&self, p: &[T]) -> T {
        p[1].recip() * std::f64::consts::TAU
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let orbit = HybridOrbit::of(Oscillator, Itinerary::smooth(0, 1))?;
    let mut orbits = BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)])?;
    let flight =
        Continuation::new(&mut orbits).named("flight").at("amplitude", 0.1).at("frequency", 1.2);
    let flight = flight.along("amplitude", 0.0..=1.0).trace()?;
    let grazing = flight.of_kind(Kind::G).next().ok_or("no grazing")?;
    let impacts =
        Continuation::new(&mut orbits).named("impacts").restart(&flight, grazing.label).switch();
    let impacts = impacts.along("amplitude", 0.0..=1.0).trace()?;
    let fold = impacts.of_kind(Kind::LP).next().ok_or("no fold")?;
    println!("grazing at {:.12}, fold at {:.12}", grazing.parameters[0], fold.parameters[0]);
    let document = Document::new("An oscillator with a stop", vec![flight, impacts]);
    let figure = diagram(&[("oscillator", &document)], None, Some("max_v"))?;
    Ok(write_atomically("out/impact_oscillator.svg", &draw(&[figure])?)?)
}
