//! Boundary-value problems as a user states them.

use super::erased::{Equations, IntoEquations};
use crate::core::condition::Failure;
use crate::core::measure::Integral;
use crate::core::scalar::Scalar;
use crate::core::watch::Observable;
use crate::core::zero::LeftDomain;
use std::sync::Arc;

/// States at the two ends of all segments, one segment after the other.
#[derive(Clone, Copy, Debug)]
pub struct Ends<'a, T> {
    /// States where the segments begin.
    pub start: &'a [T],
    /// States where they end: where their meshes do, at 1 or at the number of periods.
    pub end: &'a [T],
}

/// A scalar that is watched along a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watched {
    /// The segment.
    pub segment: usize,
    /// The scalar; functions are those of [`BoundaryProblem::watch`].
    pub observable: Observable,
}

impl Watched {
    /// A state on a segment.
    pub fn state(segment: usize, state: usize) -> Self {
        Watched { segment, observable: Observable::State(state) }
    }

    /// A function of the problem's own on a segment.
    pub fn function(segment: usize, function: usize) -> Self {
        Watched { segment, observable: Observable::Function(function) }
    }
}

/// A scalar of a solution that is recorded along a branch. Extremes are those of the solution, not of the mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Monitor {
    /// The duration of all segments together, in time.
    Duration,
    /// The largest value.
    Maximum(Vec<Watched>),
    /// The smallest value.
    Minimum(Vec<Watched>),
    /// The difference between the largest and the smallest value.
    Range(Vec<Watched>),
    /// The least local minimum inside segments, or at a segment's end: a distance that vanishes where a
    /// trajectory touches. Without any, the largest value. It is said of each scalar whether it vanishes in
    /// the events that begin and end the segment. Then neither that end counts, nor a minimum to which the
    /// scalar falls from the beginning, or from which it rises to the end, at once: that is one with the
    /// event.
    Distance(Vec<(Watched, [bool; 2])>),
    /// Less the same: how far a trajectory would penetrate a surface that is not there.
    Penetration(Vec<(Watched, [bool; 2])>),
    /// The largest value of a scalar where another one rises through zero; 0 where none does.
    Rising {
        /// Which scalar rises, on each segment.
        through: Vec<Watched>,
        /// Which one is taken, on the same segments.
        value: Vec<Observable>,
    },
    /// An integral over time of several scalars together, on all segments that have any of them.
    Integral(Integral, Vec<Watched>),
    /// A function of the states at the ends and the numbers ([`BoundaryProblem::of_ends`]), by number.
    Ends(usize),
}

impl Monitor {
    /// The largest value of a state on a segment.
    pub fn maximum(segment: usize, state: usize) -> Self {
        Monitor::Maximum(vec![Watched::state(segment, state)])
    }

    /// The smallest value of a state on a segment.
    pub fn minimum(segment: usize, state: usize) -> Self {
        Monitor::Minimum(vec![Watched::state(segment, state)])
    }

    /// All scalars that have to be watched for it.
    pub fn watched(&self) -> Vec<Watched> {
        match self {
            Monitor::Duration | Monitor::Ends(_) => Vec::new(),
            Monitor::Maximum(watched)
            | Monitor::Minimum(watched)
            | Monitor::Range(watched)
            | Monitor::Integral(_, watched) => watched.clone(),
            Monitor::Distance(watched) | Monitor::Penetration(watched) => {
                watched.iter().map(|(watched, _)| *watched).collect()
            }
            Monitor::Rising { through, .. } => through.clone(),
        }
    }
}

/// A condition by which a period leads to the next, `y − Y = 0`: an unknown `y` of the period's start must be
/// what the period leads to, `Y`. About the solution, perturbations `μ y = Y` belong to the multiplier `μ`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Return {
    /// Which boundary condition it is.
    pub condition: usize,
    /// The unknown `y`, which the condition contains with the coefficient 1 (less what is in `Y`).
    pub unknown: Unknown,
}

impl Return {
    /// Those of one segment of `n` states with the conditions `x(0) − x(1) = 0`.
    pub fn of_states(n: usize) -> Vec<Return> {
        (0..n).map(|i| Return { condition: i, unknown: Unknown::Start(i) }).collect()
    }
}

/// An unknown of a boundary-value problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// A state where its segment begins, counted over all segments as in [`Ends::start`].
    Start(usize),
    /// A further unknown number, as in [`BoundaryProblem::extras`].
    Extra(usize),
}

/// A boundary-value problem: trajectories of vector fields on segments,
///
/// ```text
///     dx_s/dτ = L_s(q) f_s(τ L_s(q), x_s, q),    0 ≤ τ ≤ 1,    s = 1 … S
///     b(x_1(0), …, x_S(0), x_1(1), …, x_S(1), q) = 0
///     Σ_s ∫ g_s(t, x_s, q) dt = 0
/// ```
///
/// with `q = (p, e)`: the parameters, and further unknown numbers `e` such as a period. There are as
/// many boundary and integral conditions (and a phase condition, where [`phase`](Self::phase) is free)
/// as states of all segments and further unknowns.
///
/// ```
/// use tangency::core::bvp::{BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh};
/// use tangency::core::scalar::Scalar;
/// /// The eigenvalues of `u'' + λu = 0`, `u(0) = u(1) = 0`, `∫u² dt = norm`: `λ` is a further unknown.
/// struct TautString;
/// impl BoundaryProblem for TautString {
///     fn segments(&self) -> Vec<Vec<String>> {
///         vec![vec!["u".into(), "v".into()]]
///     }
///     fn parameters(&self) -> Vec<String> {
///         vec!["norm".into()]
///     }
///     fn extras(&self) -> Vec<String> {
///         vec!["lambda".into()]
///     }
///     fn field<T: Scalar>(&self, _segment: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
///         f[0] = x[1];
///         f[1] = -q[1] * x[0];
///     }
///     fn duration<T: Scalar>(&self, _segment: usize, _q: &[T]) -> T {
///         T::one()
///     }
///     fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
///         b[0] = ends.start[0];
///         b[1] = ends.end[0];
///     }
///     fn integrals(&self) -> usize {
///         1
///     }
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

    /// The conditions by which a period leads to the next, if solutions are periodic: they have multipliers
    /// then. Empty by default.
    fn returns(&self) -> Vec<Return> {
        Vec::new()
    }

    /// A function of the problem's own, at time `t` from the beginning of a segment.
    fn watch<T: Scalar>(&self, _function: usize, _segment: usize, _t: T, _x: &[T], _q: &[T]) -> T {
        T::zero()
    }

    /// A scalar at time `t` from the beginning of a segment.
    fn observe<T: Scalar>(
        &self,
        observable: Observable,
        segment: usize,
        t: T,
        x: &[T],
        q: &[T],
    ) -> T {
        match observable {
            Observable::State(i) => x[i],
            Observable::Function(k) => self.watch(k, segment, t, x, q),
        }
    }

    /// A function of the problem's own, of the states at the ends and the numbers.
    fn of_ends<T: Scalar>(&self, _function: usize, _ends: Ends<T>, _q: &[T]) -> T {
        T::zero()
    }

    /// Which monitors, by position, are positive on admissible solutions: where one vanishes, a solution
    /// grazes.
    fn grazings(&self) -> Vec<usize> {
        Vec::new()
    }

    /// The typical size of such a monitor, which tolerances are relative to.
    fn grazing_scale(&self, _monitor: usize, _p: &[f64]) -> f64 {
        1.0
    }

    /// What is recorded along a branch, by name.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        Vec::new()
    }

    /// What solutions go through, in words that are saved with branches; empty if all solutions go through
    /// the same.
    fn itinerary(&self) -> String {
        String::new()
    }

    /// The problem whose solutions go through a saved itinerary.
    ///
    /// # Errors
    /// [`Failure`] if it has no meaning for this problem.
    fn with_itinerary(&self, words: &str) -> Result<Arc<dyn Equations>, Failure> {
        Err(Failure::NotApplicable(format!("the problem has no itinerary `{words}`")))
    }

    /// The problem whose solutions go through everything twice, segments and their extras one time after the
    /// other (the extras before those of the segments only once); `None` if a solution of two periods is one
    /// on a mesh twice as long.
    fn doubled(&self) -> Option<Arc<dyn Equations>> {
        None
    }

    /// What is born where a solution touches a surface, given the states where its segments begin and the
    /// numbers `q`.
    ///
    /// # Errors
    /// [`Failure`] if nothing can be told.
    fn born_at_grazing(&self, _starts: &[f64], _q: &[f64]) -> Result<Option<Birth>, Failure> {
        Ok(None)
    }

    /// Refuses a solution whose segments do not lead from one to the next as the problem has it.
    ///
    /// # Errors
    /// [`LeftDomain`] with the segment's end, its time, and where it leads.
    fn check_ends(&self, _ends: Ends<f64>, _q: &[f64]) -> Result<(), LeftDomain> {
        Ok(())
    }

    /// Typical sizes of the states of a segment, which the absolute tolerance of flows is relative to; all 1 by default.
    fn scales(&self, _segment: usize, _q: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Refuses states at which a segment's field has no meaning.
    ///
    /// # Errors
    /// [`LeftDomain`] with the quantity, its value and the domain.
    fn domain(&self, _segment: usize, _x: &[f64], _q: &[f64]) -> Result<(), LeftDomain> {
        Ok(())
    }
}

/// Solutions of a problem that emanate from a known one, such as a grazing solution or a simulated cycle: that one by
/// the states where its segments begin.
pub struct Birth<P = Arc<dyn Equations>> {
    /// The problem that they solve.
    pub problem: P,
    /// The states where segments begin.
    pub starts: Vec<f64>,
    /// The extras.
    pub extras: Vec<f64>,
}

impl<P: IntoEquations> Birth<P> {
    /// The same with the problem behind its object-safe face.
    pub fn erased(self) -> Birth {
        let Birth { problem, starts, extras } = self;
        Birth { problem: problem.into_equations(), starts, extras }
    }
}
