//! The local map near a grazing: an oscillator with a stop, its coefficients, and its fold order by
//! order.
use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
use tangency::core::continuation::Continuation;
use tangency::core::local_map::{GrazingPoint, LocalMap, LocalOrbit, MapSettings};
use tangency::core::orbit::{HybridOrbit, Itinerary};
use tangency::core::system::Kind;
use tangency::problems::classic::ImpactOscillator;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // x'' + x'/10 + x = A cos t, x ≤ 1, v⁺ = −0.8 v⁻, from rest to the amplitude at which it
    // touches the stop.
    let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
    let mut orbits = BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)])?;
    let names = ["amplitude", "frequency", "restitution", "damping", "clearance"];
    let known = names.iter().zip(ImpactOscillator::DEFAULTS);
    let flight = known.fold(Continuation::new(&mut orbits), |run, (name, p)| run.at(name, p));
    let flight = flight.at("amplitude", 0.0).along("amplitude", 0.0..=1.0).trace()?;
    let grazing = flight.of_kind(Kind::G).next().ok_or("no grazing")?;
    let point = GrazingPoint::at(&mut orbits, &flight.solution(grazing))?;

    // Its map to the fourth order; of the second order all coefficients.
    let settings = |order| MapSettings { order, ..MapSettings::default() };
    let map = LocalMap::of(&ImpactOscillator, &point, &["amplitude"], settings(2))?;
    println!("{map}\n{:?}\n", map.classified("amplitude")?);
    let map = LocalMap::of(&ImpactOscillator, &point, &["amplitude"], settings(4))?;

    // The fold of orbits with one impact, by maps of rising order and by the closed form.
    for order in 2..=4 {
        let mut points = LocalOrbit::of(map.clone(), &[true]).to_order(order).system()?;
        let start = points.flowed(&[0.0, 0.0], &[0.0], &[0.0])?;
        let branch =
            Continuation::new(&mut points).from(&start).along("amplitude", -1e-4..=1e-4).trace()?;
        let fold = branch.of_kind(Kind::LP).next().ok_or("no fold")?;
        println!("order {order}: fold at {:.13}", grazing.parameters[0] + fold.parameters[0]);
    }
    println!("exactly:      0.0999707536283");
    Ok(())
}
