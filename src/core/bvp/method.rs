//! Discretisations of trajectories: collocation and shooting with a common interface.

use super::collocation::{Collocation, CollocationWork};
use super::erased::Number;
use super::interval::{Block, Interval, MonitoredFunctions};
use super::shooting;
use super::shooting::Shooting;
use crate::core::cancel::CancelToken;
use crate::core::failure::{Failure, one_line};
use crate::core::ode::Flow;
use crate::core::scalar::Scalar;
use crate::core::system::Matrices;
use std::fmt;
use std::str::FromStr;

/// A discretisation method: each interval has `m + 1` nodes with `n` states each and `m·n`
/// equations; the last node is shared with the next interval.
#[derive(Clone)]
pub enum Method {
    /// Collocation: the trajectory on an interval is a polynomial through the nodes.
    Collocation(Box<Collocation>),
    /// Shooting: the trajectory is the flow from one node to the next (`m = 1`).
    Shooting(Box<Shooting>),
}

impl From<Collocation> for Method {
    fn from(method: Collocation) -> Self {
        Method::Collocation(Box::new(method))
    }
}

impl From<Shooting> for Method {
    fn from(method: Shooting) -> Self {
        Method::Shooting(Box::new(method))
    }
}

/// Writes the method as the text that is saved with solutions: `shooting`, or `collocation(4)` with
/// the number of Gauss points.
impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Method::Collocation(method) => write!(f, "collocation({})", method.places().len() - 1),
            Method::Shooting(_) => f.write_str("shooting"),
        }
    }
}

/// The end of the text of a saved method, if the matrices are sparse.
const SPARSE: &str = ", sparse matrices";

impl FromStr for Method {
    type Err = Failure;

    /// Parses the text of a saved method; the tolerances of the method have their default values,
    /// and the kind of matrices is chosen anew.
    fn from_str(text: &str) -> Result<Self, Failure> {
        let text = text.strip_suffix(SPARSE).unwrap_or(text);
        let degree = text.strip_prefix("collocation(").and_then(|text| text.strip_suffix(')'));
        match (text, degree.and_then(|degree| degree.parse().ok())) {
            ("shooting", _) => Ok(Shooting::default().into()),
            (_, Some(degree)) => Collocation::new(degree)
                .map(Method::from)
                .map_err(|cause| Failure::Mismatch(one_line(&cause))),
            _ => Err(Failure::Mismatch(format!(
                "unknown method `{text}` of a saved solution (known: shooting, collocation(2))"
            ))),
        }
    }
}

/// Buffers for evaluations of a discretisation method in one scalar type.
pub(super) struct MethodWork<T: Scalar> {
    collocation: CollocationWork<T>,
    flow: Flow<T>,
}

impl<T: Scalar> Default for MethodWork<T> {
    fn default() -> Self {
        MethodWork { collocation: CollocationWork::default(), flow: Flow::default() }
    }
}

impl Method {
    /// Whether the extrema of monitored functions are computed together with the residual and its
    /// derivatives, so that a single call should compute all of them.
    pub(super) fn watches_with_residual(&self) -> bool {
        matches!(self, Method::Shooting(_))
    }

    /// Returns the token that cancels evaluations.
    pub(super) fn cancel(&mut self) -> &mut CancelToken {
        match self {
            Method::Collocation(method) => &mut method.cancel,
            Method::Shooting(method) => &mut method.settings.cancel,
        }
    }

    /// The positions of the `m + 1` nodes in an interval, from 0 to 1.
    pub(super) fn places(&self) -> &[f64] {
        match self {
            Method::Collocation(method) => method.places(),
            Method::Shooting(_) => &[0.0, 1.0],
        }
    }

    /// Computes the residual of the discretised equations on an interval.
    pub(super) fn residual<T: Number>(
        &self,
        interval: Interval<T>,
        work: &mut MethodWork<T>,
        r: &mut [T],
    ) -> Result<(), Failure> {
        match self {
            Method::Collocation(method) => method.residual(interval, &mut work.collocation, r),
            Method::Shooting(method) => method.residual(interval, &mut work.flow, r),
        }
    }

    /// Computes the states at a point of an interval, given by its position from 0 to 1.
    pub(super) fn value<T: Number>(
        &self,
        interval: Interval<T>,
        place: f64,
        work: &mut MethodWork<T>,
        x: &mut [T],
    ) -> Result<(), Failure> {
        self.values(interval, &[place], work, x, &mut |_, _| {})
    }

    /// Visits the states at several points of an interval, given by their positions from 0 to 1 in
    /// ascending order; `x` is scratch space for the states.
    pub(super) fn values<T: Number>(
        &self,
        interval: Interval<T>,
        places: &[f64],
        work: &mut MethodWork<T>,
        x: &mut [T],
        visit: &mut dyn FnMut(usize, &[T]),
    ) -> Result<(), Failure> {
        match self {
            Method::Collocation(method) => {
                for (k, &place) in places.iter().enumerate() {
                    method.value(interval, place, x);
                    visit(k, x);
                }
                Ok(())
            }
            Method::Shooting(method) => method.values(interval, places, &mut work.flow, x, visit),
        }
    }

    /// Returns the arguments at which the vector field or flow of an interval is evaluated, as linear
    /// combinations of the states at the nodes: one row of `m + 1` coefficients for each argument.
    pub(super) fn arguments(&self) -> &[f64] {
        match self {
            Method::Collocation(method) => method.arguments(),
            Method::Shooting(_) => &[1.0, 0.0],
        }
    }

    /// Computes a weighted sum of the nonlinear part of the equations at one of the
    /// [`arguments`](Self::arguments), and of the contributions to the integral conditions. The
    /// caller must store the argument in place of the states at the interval's first node, and
    /// provide scratch space `r` that is large enough for all states and for all integrands.
    pub(super) fn nonlinear<T: Number>(
        &self,
        interval: Interval<T>,
        argument: usize,
        weights: [&[f64]; 2],
        work: &mut MethodWork<T>,
        r: &mut [T],
    ) -> Result<T, Failure> {
        match self {
            Method::Collocation(method) => method.nonlinear(interval, argument, weights, r),
            Method::Shooting(method) => method.nonlinear(interval, weights, &mut work.flow, r),
        }
    }

    /// Calls `visit` with the states at `count` evenly spaced points of an interval, beginning at
    /// its start; used for drawing.
    pub(super) fn trajectory(
        &self,
        interval: Interval<f64>,
        count: usize,
        work: &mut MethodWork<f64>,
        visit: &mut dyn FnMut(f64, &[f64]),
    ) -> Result<(), Failure> {
        match self {
            Method::Collocation(method) => {
                let mut x = vec![0.0; interval.nodes.len() / method.places().len()];
                for place in (0..count).map(|k| k as f64 / count as f64) {
                    method.value(interval, place, &mut x);
                    visit(place, &x);
                }
                Ok(())
            }
            Method::Shooting(method) => method.trajectory(interval, count, &mut work.flow, visit),
        }
    }

    /// Computes the residual on an interval, its derivatives with respect to the values at the
    /// nodes and to the active entries of `q`, and the extrema that [`extrema`](Self::extrema)
    /// visits.
    pub(super) fn linearise(
        &mut self,
        interval: Interval<f64>,
        active: &[usize],
        block: Block,
        watched: MonitoredFunctions,
        visit: &mut dyn FnMut(usize, f64, f64),
    ) -> Result<(), Failure> {
        match self {
            Method::Collocation(method) => {
                method.extrema(interval, watched, visit);
                method.linearise(interval, active, block)
            }
            Method::Shooting(method) => method.linearise(interval, active, block, watched, visit),
        }
    }

    /// Sets the error that is allowed in residuals, derivatives and extrema during a Newton
    /// iteration; 0 restores the method's own accuracy. Returns whether results that are computed
    /// with this allowed error may be used only during the Newton iteration.
    pub(super) fn allow(&mut self, error: f64) -> bool {
        match self {
            Method::Collocation(_) => false,
            Method::Shooting(method) => method.allow(error),
        }
    }

    /// Calls `visit` with the number, position (from 0 to 1) and value of each monitored function:
    /// at every local extremum inside an interval, at the interval's ends, and at every upward
    /// crossing. With [`Shooting`], the same call also computes the residual if `residual` is
    /// given.
    pub(super) fn extrema(
        &mut self,
        interval: Interval<f64>,
        watched: MonitoredFunctions,
        residual: Option<&mut [f64]>,
        visit: &mut dyn FnMut(usize, f64, f64),
    ) -> Result<(), Failure> {
        match self {
            Method::Collocation(method) => {
                method.extrema(interval, watched, visit);
                Ok(())
            }
            Method::Shooting(method) => method.extrema(interval, watched, residual, visit),
        }
    }

    /// Calls `visit` for each node of a quadrature over an interval, with the weight (in time), the
    /// time since the segment's start, and the states; the quadrature is as accurate as the
    /// trajectory.
    pub(super) fn quadrature<T: Number>(
        &self,
        interval: Interval<T>,
        work: &mut MethodWork<T>,
        visit: &mut dyn FnMut(T, T, &[T]),
    ) -> Result<(), Failure> {
        match self {
            Method::Collocation(method) => {
                method.quadrature(interval, &mut work.collocation, visit);
                Ok(())
            }
            Method::Shooting(method) => method.quadrature(interval, &mut work.flow, visit),
        }
    }

    /// Returns the integrals over time, on one interval, of the trace of the vector field's
    /// Jacobian and of the trace's absolute value; `None` for shooting, whose assembled equations
    /// do not contain the trace.
    pub(super) fn trace_integrals(&self, block: &[f64], n: usize) -> Option<[f64; 2]> {
        match self {
            Method::Collocation(method) => Some(method.trace_integrals(block, n)),
            Method::Shooting(_) => None,
        }
    }

    /// Returns the error constant `C` of a method that replaces the trajectory by the polynomial of
    /// degree `m` through the nodes: the error on an interval of length `h` is `C hᵐ⁺¹ |x⁽ᵐ⁺¹⁾|`.
    /// Returns `None` for a method without mesh error.
    pub(super) fn error_constant(&self) -> Option<f64> {
        match self {
            Method::Collocation(method) => Some(method.error_constant()),
            Method::Shooting(_) => None,
        }
    }

    /// Returns the error of a flow as an equivalent deviation at the start of an interval, which
    /// the flow amplifies; 0 for collocation.
    pub(super) fn flow_error(&self) -> f64 {
        match self {
            Method::Collocation(_) => 0.0,
            Method::Shooting(method) => method.settings().relative,
        }
    }

    /// Returns the factor by which deviations grow over an interval of shooting, from the
    /// derivatives of its equations with respect to the values at its nodes; 1 for collocation.
    pub(super) fn growth(&self, nodes: &[f64], n: usize) -> f64 {
        match self {
            Method::Collocation(_) => 1.0,
            Method::Shooting(_) => shooting::growth(nodes, n),
        }
    }

    /// Returns a more accurate variant of the method, and the number of parts into which each
    /// interval is divided; `None` if no more accurate variant exists.
    pub(super) fn finer(&self) -> Option<(Self, usize)> {
        match self {
            Method::Collocation(method) => {
                let (finer, parts) = method.finer();
                Some((finer.into(), parts))
            }
            Method::Shooting(method) => Some((method.finer()?.into(), 1)),
        }
    }

    /// Returns the text with which the method is saved.
    pub(super) fn written(&self, sparse: bool) -> String {
        format!("{self}{}", if sparse { SPARSE } else { "" })
    }

    /// Returns the method with a choice of the kind of matrices, which has no effect on shooting.
    pub fn with_matrices(self, matrices: Matrices) -> Self {
        match self {
            Method::Collocation(method) => method.with_matrices(matrices).into(),
            Method::Shooting(_) => self,
        }
    }

    /// Returns a variant of the method with the same accuracy but different errors, which is used
    /// if no more accurate variant exists; `None` for collocation.
    pub(super) fn other(&self) -> Option<(Self, usize)> {
        match self {
            Method::Collocation(_) => None,
            Method::Shooting(method) => Some((method.by_other_steps().into(), 1)),
        }
    }
}
