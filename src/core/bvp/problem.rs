//! Boundary-value problems as users define them.

use super::erased::ErasedProblem;
use super::itineraries::Itineraries;
use super::terms::{Ends, Monitor, Shape};
use crate::core::failure::OutOfDomain;
use crate::core::scalar::Scalar;

/// A boundary-value problem, which consists of trajectories of vector fields on segments,
///
/// ```text
///     dx_s/dτ = L_s(q) f_s(τ L_s(q), x_s, q),    0 ≤ τ ≤ 1,    s = 1 … S
///     b(x_1(0), …, x_S(0), x_1(1), …, x_S(1), q) = 0
///     Σ_s ∫ g_s(t, x_s, q) dt = 0
/// ```
///
/// where `q = (p, e)` consists of the parameters `p` and the extra unknowns `e`, such as a period.
/// The number of boundary and integral conditions (plus a phase condition, if the
/// [`shape`](Self::shape) includes one) equals the number of states of all segments plus the number
/// of extra unknowns.
///
/// ```
/// use tangency::core::bvp::{BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh};
/// use tangency::core::scalar::Scalar;
/// /// The eigenvalues of `u'' + λu = 0`, `u(0) = u(1) = 0`, `∫u² dt = norm`: `λ` is a further unknown.
/// struct TautString;
/// impl BoundaryProblem for TautString {
///     fn segments(&self) -> Vec<Vec<String>> { vec![vec!["u".into(), "v".into()]] }
///     fn parameters(&self) -> Vec<String> { vec!["norm".into()] }
///     fn extras(&self) -> Vec<String> { vec!["lambda".into()] }
///     fn field<T: Scalar>(&self, _segment: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
///         f[0] = x[1];
///         f[1] = -q[1] * x[0];
///     }
///     fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
///         b[0] = ends.start[0];
///         b[1] = ends.end[0];
///     }
///     fn integrals(&self) -> usize { 1 }
///     fn integrand<T: Scalar>(&self, _segment: usize, _t: T, x: &[T], q: &[T], g: &mut [T]) {
///         g[0] = x[0] * x[0] - q[0];
///     }
/// }
/// // Two states and one further unknown: two boundary conditions and one integral condition.
/// let string = BoundarySystem::new(TautString, Collocation::new(4)?, vec![Mesh::uniform(10)])?;
/// assert_eq!(string.meshes()[0].intervals(), 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait BoundaryProblem: Send + Sync {
    /// The names of the states of each segment.
    fn segments(&self) -> Vec<Vec<String>>;

    /// The names of the parameters `p`.
    fn parameters(&self) -> Vec<String>;

    /// The default values of all parameters, in order; empty if the parameters do not have default
    /// values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The names of the extra unknowns `e`.
    fn extras(&self) -> Vec<String> {
        Vec::new()
    }

    /// Computes the vector field of a segment at time `t`, counted from the start of the segment,
    /// and writes it into `f` (of the same length as `x`).
    fn field<T: Scalar>(&self, segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]);

    /// Computes the duration `L_s` of a segment; by default 1.
    fn duration<T: Scalar>(&self, _segment: usize, _q: &[T]) -> T {
        T::one()
    }

    /// Computes the left-hand sides of the boundary conditions and writes them into `b`; by default
    /// `x(0) − x(1)`, the conditions of a periodic orbit.
    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        ends.close(b);
    }

    /// The number of integral conditions.
    fn integrals(&self) -> usize {
        0
    }

    /// Computes the integrands of the integral conditions and writes them into `g`.
    fn integrand<T: Scalar>(&self, _segment: usize, _t: T, _x: &[T], _q: &[T], _g: &mut [T]) {}

    /// The shape of solutions: whether they are periodic, and how one period leads to the next. By
    /// default, solutions are not periodic.
    fn shape(&self) -> Shape {
        Shape::BoundaryValues
    }

    /// Computes a function that the problem defines along segments, at time `t` from the start of a
    /// segment.
    fn watch<T: Scalar>(&self, _function: usize, _segment: usize, _t: T, _x: &[T], _q: &[T]) -> T {
        T::zero()
    }

    /// Computes a function that the problem defines for the states at the ends of segments and for
    /// the parameters and extra unknowns `q`.
    fn of_ends<T: Scalar>(&self, _function: usize, _ends: Ends<T>, _q: &[T]) -> T {
        T::zero()
    }

    /// Typical sizes of the states of a segment for the parameters and extra unknowns `q`, used as
    /// units of tolerances; empty (the default) if all sizes are 1.
    fn scales(&self, _segment: usize, _q: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// The monitors that are recorded along a branch, with their names.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        Vec::new()
    }

    /// The itineraries of solutions; `None` (the default) if all solutions follow the same
    /// itinerary.
    fn itineraries(&self) -> Option<&dyn Itineraries<ErasedProblem>> {
        None
    }

    /// Returns an error for states outside the domain of a segment's vector field.
    fn domain(&self, _segment: usize, _x: &[f64], _q: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }
}
