//! From a vector field to its period doublings: Rössler's band,
//!
//! ```text
//!     x' = −y − z,    y' = x + a y,    z' = 2 + z (x − 4).
//! ```
//!
//! Its equilibrium loses stability at a Hopf point; the orbits born there double their period as
//! `a` grows, and the doubled ones do so again. `out/periodic_orbit.ron` holds everything,
//! `out/periodic_orbit.svg` the diagram and the orbits at the special points.

use std::error::Error;
use tangency::core::bvp::Collocation;
use tangency::core::continuation::{Branch, Continuation};
use tangency::core::orbit::periodic_orbits;
use tangency::core::problem::Equilibria;
use tangency::core::system::{Dense, Kind};
use tangency::output::{Document, PAGE, Plot, draw, figures, write_atomically};
use tangency::vector_field;

vector_field! {
    struct Roessler [x, y, z; a] {
        d/dt x = -y - z;
        d/dt y = x + a * y;
        d/dt z = z * (x - 4.0) + 2.0;
    }
}

/// The first special point of a kind.
fn first(branch: &Branch, kind: Kind) -> Result<usize, String> {
    let point = branch.of_kind(kind).next();
    point.map(|point| point.label).ok_or(format!("no {} on {}", kind.meaning(), branch.name))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut rest = Dense::new(Equilibria::new(Roessler));
    let equilibria = Continuation::new(&mut rest)
        .named("equilibria")
        .from(&[0.0, -0.5, 0.5])
        .along("a", 0.0..=0.4)
        .trace()?;

    let mut system = periodic_orbits(Roessler, 20, Collocation::new(4)?)?;
    let orbits = Continuation::new(&mut system)
        .named("orbits")
        .restart(&equilibria, first(&equilibria, Kind::HB)?)
        .along("a", 0.0..=0.4)
        .trace()?;
    let doubled = Continuation::new(&mut system)
        .named("doubled")
        .restart(&orbits, first(&orbits, Kind::PD)?)
        .switch()
        .along("a", 0.0..=0.4)
        .trace()?;

    let mut document = Document::new("Rössler's band", vec![equilibria, orbits, doubled]);
    for branch in &document.branches {
        for point in branch.special.iter().filter(|point| point.kind != Kind::EP) {
            let (a, error) = (point.parameters[0], point.error);
            println!("{:>10}  {}  a = {a:.10} ± {error:.0e}", branch.name, point.event);
        }
    }
    let phase_portrait = ("x".into(), "y".into());
    document.plot =
        Plot { y: Some("max_x".into()), profiles: vec![phase_portrait], ..Plot::default() };
    document.save("out/periodic_orbit.ron")?;
    let figures = figures(&[("Rössler", &document)], &[], None, &[])?;
    Ok(write_atomically("out/periodic_orbit.svg", &draw(&figures, PAGE)?)?)
}
