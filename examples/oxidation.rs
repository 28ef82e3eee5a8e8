//! Any event is the start of a curve: folds of the CO oxidation (Bykov) followed in two parameters.
//!
//! At k = 0.4 the equilibria have two folds in q₂. Holding the fold's condition and releasing k as
//! well gives one curve through both, with a cusp, where they meet, and two Bogdanov–Takens points,
//! where the two curves of Hopf points end.

use tangency::core::continuation::{Branch, Continuation, TraceError};
use tangency::core::system::{Dense, Kind};
use tangency::zero_problem;

zero_problem! {
    struct Oxidation [x, y, s; q2, k] {
        let z = T::one() - x - y - s;
        0 = z * z * 5.0 - x * x * 2.0 - x * y * 10.0;
        0 = q2 * z - y * 0.1 - x * y * 10.0;
        0 = (z - k * s) * 0.0675;
    }
}

fn main() -> Result<(), TraceError> {
    let mut system = Dense::new(Oxidation);
    let branch = Continuation::new(&mut system)
        .named("equilibria at k = 0.4")
        .from(&[0.001137, 0.891483, 0.062345])
        .at("q2", 2.0)
        .at("k", 0.4)
        .along("q2", 0.5..=2.0)
        .trace()?;
    show(&branch);
    for (kind, name) in [(Kind::LP, "folds"), (Kind::HB, "Hopf points")] {
        let Some(start) = branch.of_kind(kind).next() else { continue };
        let curve = Continuation::new(&mut system)
            .named(name)
            .restart(&branch, start.label)
            .hold(kind)
            .along("q2", 0.5..=2.0)
            .along("k", 0.1..=2.0)
            .trace()?;
        show(&curve);
    }
    Ok(())
}

fn show(branch: &Branch) {
    println!("{}: {} points", branch.name, branch.points.len());
    for point in &branch.special {
        println!(
            "{:>3} {}  q2 = {:.12}  k = {:.12}  ±{:.0e}  {}",
            point.label,
            point.kind,
            point.parameters[0],
            point.parameters[1],
            point.error,
            point.event
        );
    }
}
