//! Branches that cross: predators that live on prey that is harvested (AUTO's demo pp2).
//!
//! ```text
//! x' = 3x(1 − x) − xy − p(1 − e^{−5x})
//! y' = −y + 3xy
//! ```
//!
//! From the trivial state one switches at its branch point, p = 3/5, to prey without predators, and
//! there at p = 0.8219 to the state where both live, which loses its stability in a Hopf point.

use tangency::core::continuation::{Branch, Continuation, TraceError};
use tangency::core::system::{Dense, Kind};
use tangency::zero_problem;

zero_problem! {
    struct PredatorPrey [x, y; p] {
        0 = x * 3.0 * (T::one() - x) - x * y - p * (T::one() - (x * -5.0).exp());
        0 = x * y * 3.0 - y;
    }
}

fn main() -> Result<(), TraceError> {
    let mut system = Dense::new(PredatorPrey);
    let mut branch =
        Continuation::new(&mut system).named("nobody").along("p", 0.0..=1.0).trace()?;
    show(&branch);
    for name in ["prey", "both"] {
        let Some(crossing) = branch.of_kind(Kind::BP).next() else { break };
        branch = Continuation::new(&mut system)
            .named(name)
            .restart(&branch, crossing.label)
            .switch()
            .along("p", 0.0..=1.0)
            .trace()?;
        show(&branch);
    }
    Ok(())
}

fn show(branch: &Branch) {
    println!("{}: {} points", branch.name, branch.points.len());
    for point in branch.special.iter().filter(|point| point.kind != Kind::EP) {
        println!(
            "{:>3} {}  p = {:.12}  x = {:.12}  y = {:.12}  ±{:.0e}",
            point.label,
            point.kind,
            point.parameters[0],
            point.state[0],
            point.state[1],
            point.error
        );
    }
}
