//! Defining systems: equations that hold at a special point, and all along a curve of such points.
//!
//! A defining system adds `k + 1` equations in `x = (z, p)` and `k` auxiliary unknowns `y`. With
//! one more released parameter it can be held along a curve; together with a branch it defines a
//! point. The same mechanism therefore locates every special point and follows every curve of such
//! points.

use super::at::At;
use super::null::NullSpace;
use crate::core::failure::Failure;
use crate::core::system::Kind;

/// A defining system of special points: `k + 1` equations with `k` auxiliary unknowns.
///
/// ```
/// use tangency::core::bifurcation::{At, DefiningSystem};
/// use tangency::core::failure::Failure;
/// use tangency::core::continuation::{Continuation, Event};
/// use tangency::core::system::{Dense, Kind};
/// use tangency::problems::classic::Hyperbola;
/// /// `x μ = 20`, with its gradient `(μ, x, 0)`.
/// struct Product;
/// impl DefiningSystem for Product {
///     fn kind(&self) -> Kind {
///         Kind::UZ
///     }
///     fn values(&mut self, at: At, _: &[f64], values: &mut [f64]) -> Result<(), Failure> {
///         values[0] = at.x[0] * at.x[1] - 20.0;
///         Ok(())
///     }
///     fn gradients(&mut self, at: At, rows: &mut [f64], _: &mut [f64]) -> Result<(), Failure> {
///         rows.copy_from_slice(&[at.x[1], at.x[0], 0.0]);
///         Ok(())
///     }
/// }
/// // x² = μ² + 9 has the solution x = 5, μ = 4.
/// let mut hyperbola = Dense::new(Hyperbola);
/// let curve = Continuation::new(&mut hyperbola).from(&[3.0]).at("epsilon", 3.0);
/// let branch = curve.along("mu", 0.0..=9.0).event(Event::new("x μ = 20", || Product)).trace()?;
/// let found = branch.of_kind(Kind::UZ).next().unwrap();
/// assert!((found.parameters[0] - 4.0).abs() < 1e-13);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
pub trait DefiningSystem: Send {
    /// The kind of special point that the equations define.
    fn kind(&self) -> Kind;

    /// The number `k` of auxiliary unknowns.
    fn unknowns(&self) -> usize {
        0
    }

    /// The names of the first auxiliary unknowns, which are recorded along a curve of such points.
    fn names(&self) -> &'static [&'static str] {
        &[]
    }

    /// Whether the values need the assembled `F_z`; the assembly then also yields the residual.
    fn assembles(&self) -> bool {
        false
    }

    /// Prepares the defining system near a point: chooses borders and the auxiliary unknowns `y`.
    ///
    /// # Errors
    /// [`Failure`] if the equations cannot be stated there.
    fn start(&mut self, _at: At, _y: &mut [f64]) -> Result<(), Failure> {
        Ok(())
    }

    /// Evaluates the `k + 1` left sides of the equations.
    ///
    /// # Errors
    /// [`Failure`] outside the domain, or where the bordered matrix is singular.
    fn values(&mut self, at: At, y: &[f64], values: &mut [f64]) -> Result<(), Failure>;

    /// Computes the gradients of the left sides at the point where
    /// [`values`](DefiningSystem::values) was called last: `rows` with respect to `x` (`k + 1` rows
    /// of the same length as `x`; only released parameters count), `own` with respect to `y` (`k +
    /// 1` rows of `k`).
    ///
    /// # Errors
    /// As for the values.
    fn gradients(&mut self, at: At, rows: &mut [f64], own: &mut [f64]) -> Result<(), Failure>;

    /// Returns the vector `b` if the `j`-th auxiliary unknown unfolds the problem: `F + yⱼ b = 0`.
    fn unfolding<'b>(&'b self, _j: usize, _null: &'b NullSpace) -> Option<&'b [f64]> {
        None
    }

    /// Turns the borders of this defining system towards the current null vectors, so that the
    /// bordered matrix stays well conditioned along a curve. The borders of the shared null vectors
    /// are always turned.
    fn adapt(&mut self) {}
}
