//! Discretisations of trajectories: collocation and shooting with one interface.

use super::collocation::{Collocation, CollocationWork};
use super::erased::Number;
use super::interval::{Block, Interval, MonitoredFunctions};
use super::shooting;
use super::shooting::Shooting;
use crate::core::cancel::CancelToken;
use crate::core::failure::{Failure, one_line};
use crate::core::ode::Flow;
use crate::core::scalar::Scalar;
use std::fmt;
use std::str::FromStr;

/// A discretisation: each interval has values of the `n` states at `m + 1` nodes, the last one
/// shared with the next interval, and `m·n` equations.
#[derive(Clone)]
pub enum Method {
    /// Collocation: polynomials through the nodes.
    Collocation(Box<Collocation>),
    /// Shooting: flows from one node to the next, `m = 1`.
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

/// Writes the method as saved with solutions: `shooting`, or `collocation(4)` with the degree.
impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Method::Collocation(method) => write!(f, "collocation({})", method.places().len() - 1),
            Method::Shooting(_) => f.write_str("shooting"),
        }
    }
}

impl FromStr for Method {
    type Err = Failure;

    /// Parses the method of a saved solution, with default tolerances.
    fn from_str(text: &str) -> Result<Self, Failure> {
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

/// Buffers for evaluations in one scalar type.
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
    /// Whether extrema come from the same computation as the residual and its derivatives, so that
    /// all of them should be computed together.
    pub(super) fn watches_with_residual(&self) -> bool {
        matches!(self, Method::Shooting(_))
    }

    /// The token that cancels evaluations.
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

    /// Computes the residual of an interval.
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

    /// Computes the states at a place in an interval (from 0 to 1).
    pub(super) fn value<T: Number>(
        &self,
        interval: Interval<T>,
        place: f64,
        work: &mut MethodWork<T>,
        x: &mut [T],
    ) -> Result<(), Failure> {
        match self {
            Method::Collocation(method) => {
                method.value(interval, place, x);
                Ok(())
            }
            Method::Shooting(method) => method.value(interval, place, &mut work.flow, x),
        }
    }

    /// The arguments of the nonlinear parts of an interval's equations, as combinations of the values
    /// at its nodes: one row of `m + 1` coefficients for each.
    pub(super) fn arguments(&self) -> &[f64] {
        match self {
            Method::Collocation(method) => method.arguments(),
            Method::Shooting(_) => &[1.0, 0.0],
        }
    }

    /// Computes a weighted sum of the nonlinear part of the equations for one of the
    /// [`arguments`](Self::arguments), and of the contributions to the integral conditions. The
    /// interval has the argument's value at its first node; `r` has space for all states, and for all
    /// integrands.
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

    /// Calls `visit` with the states at `count` places in an interval, evenly spaced from its start,
    /// for drawing.
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

    /// Computes the residual of an interval with its derivatives with respect to the nodes and to
    /// the active components of `q`, and the extrema that [`extrema`](Self::extrema) visits.
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

    /// Sets the error allowed in residuals, their derivatives and extrema during an iteration towards
    /// a solution; 0 restores the method's own accuracy. Returns whether results with this error are
    /// valid only during the iteration.
    pub(super) fn allow(&mut self, error: f64) -> bool {
        match self {
            Method::Collocation(_) => false,
            Method::Shooting(method) => method.allow(error),
        }
    }

    /// Calls `visit` with number, place (from 0 to 1) and value of each monitored function: at every
    /// local extremum inside an interval, at the interval's ends, and at every upward crossing.
    /// Shooting also computes the residual if requested.
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

    /// Calls `visit` with weight (in time), time since the segment's start and states at the nodes of
    /// a quadrature over an interval that is as accurate as the trajectory.
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

    /// The integrals over an interval, in time, of the trace of the field's Jacobian and of its
    /// absolute value, from the assembled equations of `n` states, if these contain it.
    pub(super) fn trace_integrals(&self, block: &[f64], n: usize) -> Option<[f64; 2]> {
        match self {
            Method::Collocation(method) => Some(method.trace_integrals(block, n)),
            Method::Shooting(_) => None,
        }
    }

    /// The constant `C` of a method that replaces the trajectory by the polynomial of degree `m`
    /// through the nodes: its error in an interval of length `h` is `C hᵐ⁺¹ |x⁽ᵐ⁺¹⁾|`. `None` for a
    /// method without mesh error.
    pub(super) fn error_constant(&self) -> Option<f64> {
        match self {
            Method::Collocation(method) => Some(method.error_constant()),
            Method::Shooting(_) => None,
        }
    }

    /// The error of a flow at the start of an interval, which grows like deviations; 0 without flows.
    pub(super) fn flow_error(&self) -> f64 {
        match self {
            Method::Collocation(_) => 0.0,
            Method::Shooting(method) => method.settings().relative,
        }
    }

    /// The growth of deviations over an interval, from its derivatives with respect to the nodes of
    /// `n` states; 1 for a method with equations inside intervals.
    pub(super) fn growth(&self, nodes: &[f64], n: usize) -> f64 {
        match self {
            Method::Collocation(_) => 1.0,
            Method::Shooting(_) => shooting::growth(nodes, n),
        }
    }

    /// A more accurate variant of the method, and the number of parts into which intervals are
    /// divided; `None` if there is no more accurate one.
    pub(super) fn finer(&self) -> Option<(Self, usize)> {
        match self {
            Method::Collocation(method) => {
                let (finer, parts) = method.finer();
                Some((finer.into(), parts))
            }
            Method::Shooting(method) => Some((method.finer()?.into(), 1)),
        }
    }

    /// A variant of the same accuracy with different errors, used if there is no more accurate one.
    pub(super) fn other(&self) -> Option<(Self, usize)> {
        match self {
            Method::Collocation(_) => None,
            Method::Shooting(method) => Some((method.by_other_steps().into(), 1)),
        }
    }
}
