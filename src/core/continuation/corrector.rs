//! Newton's iteration on hyperplanes across a curve, and the tangent from the matrix factored last.

use super::curve::CurvePoint;
use super::event::MakeCondition;
use super::metric::Metric;
use super::{Kind, Settings};
use crate::core::condition::{At, Failure, Quantity};
use crate::core::extended::{Closing, Extended};
use crate::core::newton::{
    Convergence, Newton, NewtonError, Tolerances, scale_to_one, scaled_norm,
};
use crate::core::solution::Solution;
use crate::core::vector::{difference, dot};

/// A matrix that is known this well, relatively, is good enough for the tangent and for stability.
pub(super) const MATRIX_ERROR: f64 = 1e-4;

/// The sign of a tangent's component along the parameter that is smaller than this is not left to a
/// matrix that is only nearly known.
const UNCERTAIN: f64 = 0.05;

/// The equations of a curve with the norm in which its arclength is measured.
pub(super) struct Corrector<'a> {
    pub equations: Extended<'a>,
    newton: Newton,
    metric: Metric,
    /// The weights of the scaled norm.
    pub weights: Vec<f64>,
    /// When Newton's iteration stops along the curve.
    pub tolerances: Tolerances,
    /// When it stops at special points.
    pub event_tolerances: Tolerances,
}

impl<'a> Corrector<'a> {
    pub fn new(equations: Extended<'a>, metric: Metric, settings: &Settings) -> Self {
        Corrector {
            weights: metric.weights(equations.names()),
            equations,
            newton: Newton::default(),
            metric,
            tolerances: settings.until(settings.tolerance),
            event_tolerances: settings.until(settings.event_tolerance),
        }
    }

    pub fn metric(&self) -> &Metric {
        &self.metric
    }

    /// Measures by other scales. What Newton's iteration has learned about the equations was in the
    /// former ones.
    pub fn set_metric(&mut self, metric: Metric) {
        self.weights = metric.weights(self.equations.names());
        self.metric = metric;
        self.newton = Newton::default();
    }

    /// Corrects `X` on a hyperplane.
    pub fn correct(
        &mut self,
        unknowns: &mut [f64],
        closing: Closing,
    ) -> Result<Convergence, NewtonError> {
        let Corrector { equations, weights, tolerances, .. } = self;
        self.newton.solve(equations, unknowns, Some(closing), weights, *tolerances)
    }

    /// The tangent at a corrected point, of scaled length 1. The matrix factored last, with the
    /// same `row`, differs from the one there by `matrix_error`, relatively; the one there is
    /// factored where that is not good enough.
    pub fn tangent(
        &mut self,
        unknowns: &[f64],
        row: &[f64],
        matrix_error: f64,
    ) -> Result<Vec<f64>, Failure> {
        if matrix_error <= MATRIX_ERROR {
            self.equations.load(unknowns);
            let tangent = self.factored_tangent();
            let p = self.equations.parameters_at();
            if tangent[p].abs() * self.weights[p].sqrt() > UNCERTAIN {
                return Ok(tangent);
            }
        }
        self.equations.assemble(unknowns)?;
        self.factor_at(unknowns, row)?;
        Ok(self.factored_tangent())
    }

    /// Factors the matrix of a curve closed by a row at a point that is assembled.
    pub fn factor_at(&mut self, unknowns: &[f64], row: &[f64]) -> Result<(), Failure> {
        let mut residual = vec![0.0; unknowns.len()];
        self.equations.residual(unknowns, None, &mut residual)?;
        self.equations.factor(Some(row))
    }

    /// The tangent, of scaled length 1, from the matrix factored last with the closing equation
    /// last.
    pub fn factored_tangent(&mut self) -> Vec<f64> {
        let mut tangent = vec![0.0; self.equations.length()];
        self.equations.tangent(&mut tangent);
        self.rescale(&mut tangent);
        tangent
    }

    /// The covector of a direction: `rowᵢ = wᵢ tᵢ`.
    pub fn covector(&self, direction: &[f64]) -> Vec<f64> {
        direction.iter().zip(&self.weights).map(|(t, w)| t * w).collect()
    }

    /// Scales a direction to length 1; the length that it had.
    pub fn rescale(&self, direction: &mut [f64]) -> f64 {
        scale_to_one(direction, &self.weights)
    }

    /// The scaled distance of two points.
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        scaled_norm(&difference(a, b), &self.weights)
    }

    /// How fast a parameter or a monitor grows along the curve; `None` where it is not
    /// differentiable.
    pub fn slope_of(&mut self, quantity: Quantity, place: &CurvePoint) -> Option<f64> {
        let direction = self.equations.direction_of(&place.tangent);
        self.equations.load(&place.unknowns);
        let At { system, x, released } = self.equations.at();
        match quantity {
            Quantity::Parameter(p) => Some(direction[system.names().dimension() + p]),
            Quantity::Monitor(m) if m >= system.names().monitors.len() => None,
            Quantity::Monitor(m) => {
                let mut gradient = vec![0.0; x.len()];
                system.monitor_gradient(m, x, released, &mut gradient).ok()?;
                Some(dot(&gradient, &direction))
            }
        }
    }

    /// How well Newton's tolerance determines the continued parameter of an ordinary point.
    pub fn parameter_error(&self) -> f64 {
        self.tolerances.tolerance / self.weights[self.equations.parameters_at()].sqrt()
    }

    /// The estimated relative error of a solution that its mesh causes.
    pub fn mesh_error(&mut self, unknowns: &[f64]) -> f64 {
        self.equations.load(unknowns);
        let At { system, x, .. } = self.equations.at();
        system.discretised().map_or(0.0, |discretised| discretised.mesh_error(x))
    }

    /// The relative error of the mesh, in units of the continued parameter.
    pub fn mesh_share(&mut self, unknowns: &[f64]) -> f64 {
        self.mesh_error(unknowns) * unknowns[self.equations.parameters_at()].abs()
    }

    /// Lets the mesh, scales and borders follow the branch after a point was accepted. `others` are
    /// carried over to a new mesh.
    pub fn accept(&mut self, place: &mut CurvePoint, mut others: Vec<&mut [f64]>) {
        let n = self.equations.dimension();
        let mut directions: Vec<&mut [f64]> =
            others.iter_mut().map(|other| &mut **other).chain([&mut place.tangent[..]]).collect();
        self.equations.on_accepted(&mut place.unknowns, &mut directions);
        let p = &place.unknowns[self.equations.parameters_at()..];
        self.metric.grow(self.equations.names(), &place.unknowns[..n], p);
        self.weights = self.metric.weights(self.equations.names());
        self.equations.adapt();
        // Where scales have grown, the same way is shorter.
        place.quiet *= self.rescale(&mut place.tangent);
    }

    /// Forgets what has been learned along the curve: scales, the curvature of the equations, the
    /// borders of the conditions held.
    pub fn restore(&mut self, unknowns: &[f64], metric: Metric, held: &[MakeCondition]) {
        self.set_metric(metric);
        let conditions = self.equations.suspend();
        let (n, own) = (self.equations.dimension(), unknowns.len() - self.equations.length());
        let mut bare = unknowns.to_vec();
        bare.drain(n..n + own);
        let held = held.iter().try_fold(bare, |x, make| self.equations.hold(make(), &x));
        if held.is_err() {
            // They could be stated there once; the borders that they have now serve as well.
            self.equations.resume(conditions);
        }
    }

    /// The solution at a point, on the present mesh.
    pub fn solution_at(&mut self, unknowns: &[f64]) -> Solution {
        let n = self.equations.dimension();
        let x = self.equations.load(unknowns);
        let [state, parameters] = [&x[..n], &x[n..]].map(<[f64]>::to_vec);
        let system = self.equations.system();
        let (itinerary, method, mesh) = (system.words(), system.method(), system.mesh());
        let (kind, tangent, switch) = (Kind::EP, None, None);
        Solution { kind, itinerary, method, mesh, state, parameters, tangent, switch }
    }
}
