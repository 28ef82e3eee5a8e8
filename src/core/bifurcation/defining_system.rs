//! Defining systems: equations that hold at a special point, and at all points of a curve of
//! special points of the same kind.
//!
//! A defining system adds `k + 1` equations in `x = (z, p)` and `k` auxiliary unknowns `y`. If one
//! more parameter is released, a defining system can be held along a curve; together with the
//! equations of a branch, it defines a point on the branch. Defining systems therefore serve both
//! to locate special points and to continue curves of special points.

use super::at::At;
use super::null::{NullSpace, NullVectors};
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

    /// The names of the first auxiliary unknowns, which are recorded along a curve of special
    /// points of this kind.
    fn names(&self) -> &'static [&'static str] {
        &[]
    }

    /// Whether evaluating the left sides requires the assembled `F_z`, whose assembly also yields
    /// the residual.
    fn assembles(&self) -> bool {
        false
    }

    /// Prepares the defining system near a point: chooses borders and the auxiliary unknowns `y`.
    ///
    /// # Errors
    /// [`Failure`] if the defining system cannot be set up near the point.
    fn start(&mut self, _at: At, _y: &mut [f64]) -> Result<(), Failure> {
        Ok(())
    }

    /// Prepares the defining system at a solution of its equations whose auxiliary unknowns `y` are
    /// known, for example after the solution was interpolated to another mesh.
    ///
    /// # Errors
    /// The same errors as for [`start`](DefiningSystem::start).
    fn resume(&mut self, at: At, y: &[f64]) -> Result<(), Failure> {
        self.start(at, &mut y.to_vec())
    }

    /// Evaluates the `k + 1` left sides of the equations.
    ///
    /// # Errors
    /// [`Failure`] if the point lies outside the domain, or if the bordered matrix is singular.
    fn values(&mut self, at: At, y: &[f64], values: &mut [f64]) -> Result<(), Failure>;

    /// Computes the gradients of the left sides at the point where
    /// [`values`](DefiningSystem::values) was called last: `rows` receives the gradients with
    /// respect to `x` (`k + 1` rows of the same length as `x`, in which only the entries of the
    /// unknowns and the released parameters are used), `own` the gradients with respect to `y`
    /// (`k + 1` rows of length `k`).
    ///
    /// # Errors
    /// The same errors as for [`values`](DefiningSystem::values).
    fn gradients(&mut self, at: At, rows: &mut [f64], own: &mut [f64]) -> Result<(), Failure>;

    /// Returns the null vectors whose border is `b` if the `j`-th auxiliary unknown unfolds the
    /// problem, `F + yⱼ b = 0`; `None` if the auxiliary unknown does not unfold the problem.
    fn unfolding<'b>(&self, _j: usize, _null: &'b NullSpace) -> Option<&'b NullVectors> {
        None
    }

    /// Whether auxiliary unknowns describe the reflection of a solution, which solves the same
    /// equations: a negative frequency, whose vectors are the conjugates of the vectors of the
    /// positive frequency.
    fn is_reflected(&self, _y: &[f64]) -> bool {
        false
    }

    /// Turns the borders of this defining system towards the current null vectors, so that the
    /// bordered matrix stays well conditioned along a curve. The null vectors that all defining
    /// systems share have separate borders, which this method does not change.
    fn adapt(&mut self) {}
}
