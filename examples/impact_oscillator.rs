//! A forced oscillator with a stop, `x'' + x'/10 + x = A cos ωt`, `x ≤ 1`: its impacting branch
//! from grazing.
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::Continuation;
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::Kind;
use tangency::hybrid_system;
use tangency::output::{Document, PAGE, diagram, draw, write_atomically};

hybrid_system! {
    struct Oscillator [amplitude, frequency; t] {
        period = frequency.recip() * std::f64::consts::TAU;
        mode flight [x, v] {
            d/dt x = v;
            d/dt v = amplitude * (frequency * t).cos() - x - v * 0.1;
            event impact: T::one() - x => flight { x, v: v * -0.8 };
        }
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
    let figure = diagram(&[("oscillator", &document)], None, &["max_v"])?;
    Ok(write_atomically("out/impact_oscillator.svg", &draw(&[figure], PAGE)?)?)
}
