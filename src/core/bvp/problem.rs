//! Boundary-value problems as a user states them.

use super::erased::{Birth, Equations};
use super::terms::{Ends, Monitor, Return, Watched};
use super::trajectory::Trajectory;
use crate::core::condition::Failure;
use crate::core::failure::OutOfDomain;
use crate::core::scalar::Scalar;
use std::sync::Arc;

/// A boundary-value problem: trajectories of vector fields on segments,
///
/// ```text
///     dx_s/dτ = L_s(q) f_s(τ L_s(q), x_s, q),    0 ≤ τ ≤ 1,    s = 1 … S
///     b(x_1(0), …, x_S(0), x_1(1), …, x_S(1), q) = 0
///     Σ_s ∫ g_s(t, x_s, q) dt = 0
/// ```
///
/// with `q = (p, e)`: the parameters, and further unknown numbers `e` such as a period. There are
/// as many boundary and integral conditions (and a phase condition, where [`phase`](Self::phase) is
/// free) as states of all segments and further unknowns.
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
///     fn duration<T: Scalar>(&self, _segment: usize, _q: &[T]) -> T { T::one() }
///     fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
///         b[0] = ends.start[0];
///         b[1] = ends.end[0];
///     }
///     fn integrals(&self) -> usize { 1 }
///     fn integrand<T: Scalar>(&self, _segment: usize, _t: T, x: &[T], q: &[T], g: &mut [T]) {
///         g[0] = x[0] * x[0] - q[0];
///     }
/// }
/// // Two states and one further unknown: two boundary conditions and an integral one.
/// let string = BoundarySystem::new(TautString, Collocation::new(4)?, vec![Mesh::uniform(10)])?;
/// assert_eq!(string.meshes()[0].intervals(), 10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait BoundaryProblem: Send + Sync {
    /// The names of the states of each segment.
    fn segments(&self) -> Vec<Vec<String>>;

    /// The names of the parameters `p`.
    fn parameters(&self) -> Vec<String>;

    /// The default values of all parameters, in order; empty if there are none.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The names of the further unknown numbers `e`.
    fn extras(&self) -> Vec<String> {
        Vec::new()
    }

    /// The field of a segment at time `t` from its beginning, written into `f` (as long as `x`).
    fn field<T: Scalar>(&self, segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]);

    /// The duration `L_s` of a segment.
    fn duration<T: Scalar>(&self, segment: usize, q: &[T]) -> T;

    /// The left sides of the boundary conditions, written into `b`.
    fn boundary<T: Scalar>(&self, ends: Ends<T>, q: &[T], b: &mut [T]);

    /// The number of integral conditions.
    fn integrals(&self) -> usize {
        0
    }

    /// The integrands of the integral conditions, written into `g`.
    fn integrand<T: Scalar>(&self, _segment: usize, _t: T, _x: &[T], _q: &[T], _g: &mut [T]) {}

    /// Whether anything moves along segments: time histories are drawn then.
    fn moves(&self) -> bool {
        true
    }

    /// Whether a shift of time leaves the problem as it is, so that a phase condition is needed.
    fn phase(&self) -> bool {
        false
    }

    /// The conditions by which a period leads to the next, if solutions are periodic: they have
    /// multipliers then. Empty by default.
    fn returns(&self) -> Vec<Return> {
        Vec::new()
    }

    /// A function of the problem's own, at time `t` from the beginning of a segment.
    fn watch<T: Scalar>(&self, _function: usize, _segment: usize, _t: T, _x: &[T], _q: &[T]) -> T {
        T::zero()
    }

    /// A function of the problem's own, of the states at the ends and the numbers.
    fn of_ends<T: Scalar>(&self, _function: usize, _ends: Ends<T>, _q: &[T]) -> T {
        T::zero()
    }

    /// Which monitors, by position, are positive on admissible solutions: where one vanishes, a
    /// solution grazes.
    fn grazings(&self) -> Vec<usize> {
        Vec::new()
    }

    /// The typical size of such a monitor, which tolerances are relative to.
    fn grazing_scale(&self, _monitor: usize, _p: &[f64]) -> f64 {
        1.0
    }

    /// The typical size of a scalar along a segment, which tolerances are relative to: by default
    /// that of a state, and 1 for functions.
    fn watch_scale(&self, watched: Watched, q: &[f64]) -> f64 {
        let scale = |i: usize| self.scales(watched.segment, q).get(i).copied();
        watched.observable.state().and_then(scale).unwrap_or(1.0)
    }

    /// The typical size of the further unknowns, which tolerances are relative to.
    fn extra_scale(&self, _p: &[f64]) -> f64 {
        1.0
    }

    /// What is recorded along a branch, by name.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        Vec::new()
    }

    /// What solutions go through, in words that are saved with branches; empty if all solutions go
    /// through the same.
    fn itinerary(&self) -> String {
        String::new()
    }

    /// The problem whose solutions go through a saved itinerary.
    ///
    /// # Errors
    /// [`Failure`] if it has no meaning for this problem.
    fn with_itinerary(&self, words: &str) -> Result<Arc<dyn Equations>, Failure> {
        Err(Failure::Unsupported(format!("the problem has no itinerary `{words}`")))
    }

    /// The problem whose solutions go through everything twice, segments and their extras one time
    /// after the other (the extras before those of the segments only once); `None` if a solution of
    /// two periods is one on a mesh twice as long.
    fn doubled(&self) -> Option<Arc<dyn Equations>> {
        None
    }

    /// One of the branches that emanate where a solution touches a surface, counted from 0, given
    /// its trajectory on each segment and the numbers `q`.
    ///
    /// # Errors
    /// [`Failure`] if nothing can be told, and [`Failure::no_branch`] for a number that there is
    /// not.
    fn born_at_grazing(
        &self,
        _known: &[Trajectory],
        _q: &[f64],
        _which: usize,
    ) -> Result<Option<Birth>, Failure> {
        Ok(None)
    }

    /// The solutions with an event, where one that does not pass it touches a surface; `None` where
    /// none are known. A branch of them begins there ([`born_at_grazing`](Self::born_at_grazing)).
    ///
    /// # Errors
    /// [`Failure`] if they cannot be found.
    fn with_touched(&self, _known: &[Trajectory], _q: &[f64]) -> Result<Option<Birth>, Failure> {
        Ok(None)
    }

    /// The solutions without an event, where one that passes it touches a surface there; `None`
    /// where none does.
    ///
    /// # Errors
    /// [`Failure`] if they cannot be found.
    fn without_touched(&self, _known: &[Trajectory], _q: &[f64]) -> Result<Option<Birth>, Failure> {
        Ok(None)
    }

    /// Whether a monitor of [`grazings`](Self::grazings) belongs to an event that solutions pass,
    /// as the speed of an impact does; others are distances to what they do not pass.
    fn is_of_event(&self, _monitor: usize) -> bool {
        false
    }

    /// Refuses a solution whose segments do not lead from one to the next as the problem has it.
    ///
    /// # Errors
    /// [`OutOfDomain`] with the segment's end, its time, and where it leads.
    fn check_ends(&self, _ends: Ends<f64>, _q: &[f64]) -> Result<(), Failure> {
        Ok(())
    }

    /// Typical sizes of the states of a segment, which the absolute tolerance of flows is relative
    /// to; all 1 by default.
    fn scales(&self, _segment: usize, _q: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Refuses states at which a segment's field has no meaning.
    ///
    /// # Errors
    /// [`OutOfDomain`] with the quantity, its value and the domain.
    fn domain(&self, _segment: usize, _x: &[f64], _q: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }
}
