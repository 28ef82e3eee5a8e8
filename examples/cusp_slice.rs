//! One equation, two folds: `μ + x − x³/3 = 0`, followed from μ = −1 to 1.
//!
//! A problem names its unknowns and parameters and states its residual once; the branch is traced
//! by arclength, so that it turns at its folds, μ = ±2/3 at x = ∓1, without being told of them.
//!
//! ```text
//! cargo run --release --example cusp_slice
//! ```

use tangency::core::continuation::{Continuation, TraceError};
use tangency::core::system::Dense;
use tangency::zero_problem;

zero_problem! {
    struct CuspSlice [x; mu] {
        0 = mu + x - x.powi(3) / 3.0;
    }
}

fn main() -> Result<(), TraceError> {
    let mut system = Dense::new(CuspSlice);
    let branch = Continuation::new(&mut system)
        .from(&[-2.0])
        .at("mu", -1.0)
        .along("mu", -1.0..=1.0)
        .trace()?;
    println!("label kind               mu                x    error  unstable");
    for point in &branch.special {
        let (mu, x) = (point.parameters[0], point.state[0]);
        let unstable = point.unstable.unwrap_or(0);
        println!(
            "{:>5} {:>4} {mu:>16.12} {x:>16.12} {:>8.0e} {unstable:>9}",
            point.label, point.kind, point.error
        );
    }
    println!("from {} to {}", branch.ends[0], branch.ends[1]);
    Ok(())
}
