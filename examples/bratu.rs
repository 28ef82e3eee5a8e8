//! A field: Bratu's `u'' + λeᵘ = 0`, `u(0) = u(1) = 0`, by central differences, and how its fold
//! converges to 8θ²/cosh²θ, θ tanh θ = 1, as the grid is refined.
//!
//! The unknowns are one group of n values; a monitor gives the diagram its ordinate and bounds the
//! branch. The error that is printed is that of the discrete equations; Richardson's extrapolation
//! of two grids shows the discretisation's own.

use tangency::core::continuation::{Continuation, TraceError};
use tangency::core::problem::{Dynamics, Names, ZeroProblem};
use tangency::core::scalar::Scalar;
use tangency::core::system::{Dense, Kind};

struct Bratu(usize);

impl ZeroProblem for Bratu {
    fn names(&self) -> Names {
        Names::new([("u", self.0)], ["lambda"]).with_monitors(["middle"])
    }
    fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
        let n = self.0;
        let inverse = ((n + 1) * (n + 1)) as f64;
        let at = |i: usize| if i == 0 || i > n { T::zero() } else { u[i - 1] };
        for i in 1..=n {
            r[i - 1] = (at(i - 1) - at(i) * 2.0 + at(i + 1)) * inverse + p[0] * at(i).exp();
        }
    }
    fn monitors<T: Scalar>(&self, u: &[T], _p: &[T], values: &mut [T]) {
        values[0] = u[self.0 / 2];
    }
    fn dynamics(&self) -> Dynamics {
        Dynamics::None
    }
}

fn main() -> Result<(), TraceError> {
    println!("   n  points    lambda at the fold      middle there    extrapolated");
    let mut coarser: Option<f64> = None;
    for n in [9, 19, 39, 79] {
        let mut system = Dense::new(Bratu(n));
        let branch = Continuation::new(&mut system)
            .along("lambda", 0.0..=10.0)
            .bound("middle", 0.0..=5.0)
            .trace()?;
        let Some(fold) = branch.of_kind(Kind::LP).next() else { continue };
        let (lambda, middle) = (fold.parameters[0], fold.monitors[0]);
        let extrapolated = coarser.map_or(f64::NAN, |c| (4.0 * lambda - c) / 3.0);
        println!(
            "{n:>4} {:>7} {lambda:>21.12} {middle:>17.12} {extrapolated:>15.10}",
            branch.points.len()
        );
        coarser = Some(lambda);
    }
    println!("   ∞         3.513830719125 (exact)");
    Ok(())
}
