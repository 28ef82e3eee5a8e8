//! Corrects points of a curve by Newton's method on hyperplanes across the curve, and computes
//! tangents from the last factored matrix.

use super::curve_point::CurvePoint;
use super::event::MakeCondition;
use super::extended::{Closing, Extended};
use super::metric::{Metric, ScaledNorm, has_shrunk, has_small_group};
use super::newton::{Convergence, Newton, NewtonError, Tolerances, scaled_norm};
use super::settings::Settings;
use crate::core::bifurcation::{At, Quantity, VERTICAL};
use crate::core::failure::Failure;
use crate::core::linalg::clear_rounding;
use crate::core::system::{Kind, Representation, Solution};

/// Heuristic: the largest relative error of the matrix from which the tangent and the number of
/// unstable eigenvalues are computed. A small error of this matrix is acceptable because the
/// tangent serves only to predict the next point.
pub(super) const MATRIX_ERROR: f64 = 1e-4;

/// Heuristic: the largest relative error of the matrix for which Newton's method keeps its factors
/// if nothing but the tangent is computed from the matrix.
const KEPT_MATRIX_ERROR: f64 = 0.05;

/// Heuristic: if the component of the tangent along the parameter is smaller than this threshold,
/// the tangent is computed more accurately, because the sign of the component detects folds. With
/// an older matrix, the error of the tangent is `MATRIX_ERROR` times the condition number of the
/// matrix.
const UNCERTAIN: f64 = 0.05;

/// The largest number of corrections of a tangent from an older matrix.
const CORRECTIONS: usize = 4;

/// Discretisation: the error of the parameters is estimated as this power of the error of the
/// solution, since collocation converges faster at the mesh nodes. The exponent is the smallest
/// ratio of the two orders of convergence, `2m` and `m + 1`, for degrees `m ≥ 3`.
pub(super) const SUPERCONVERGENCE: f64 = 1.5;

/// Heuristic: the ratio between the error of the slope of a parameter and the error of the
/// solution. In a canard explosion, parameter errors change sign within 0.01 of scaled arclength.
const WAVES: f64 = 10.0;

/// The equations of a curve with the norm that defines its arclength.
pub(super) struct Corrector<'a> {
    pub equations: Extended<'a>,
    newton: Newton,
    pub norm: ScaledNorm,
    /// The tolerances of Newton's method along the curve.
    pub tolerances: Tolerances,
    /// The tolerances of Newton's method at special points.
    pub event_tolerances: Tolerances,
    /// The relative error of the matrix from which the last tangent and the eigenvalues were
    /// computed.
    pub matrix_error: f64,
    /// Whether special points are refined on finer discretisations.
    pub refines: bool,
    /// Whether the phase response curve is computed at special points of cycles.
    pub phase_response: bool,
    /// Whether the sensitivities of special points are computed.
    pub sensitivities: bool,
}

/// Sets the units of null vectors: the scales of the unknowns and parameters, computed from the
/// given weights. For collocation, the units of the vector field are used instead of the scales of
/// the unknowns.
fn measure_null_vectors(equations: &mut Extended, weights: &[f64]) {
    let (n, first) = (equations.dimension(), equations.parameters_at());
    let At { system, x, released, null, .. } = equations.at();
    let units = null.units();
    units.clear();
    if system.representation().interpolated {
        return;
    }
    let size = |weight: &f64| weight.sqrt().recip();
    units.extend(weights[..n].iter().map(size));
    units.resize(x.len(), 0.0);
    for (&p, weight) in released.iter().zip(&weights[first..]) {
        units[n + p] = size(weight);
    }
}

impl<'a> Corrector<'a> {
    pub fn new(mut equations: Extended<'a>, metric: Metric, settings: &Settings) -> Self {
        let norm = ScaledNorm::new(metric, equations.names());
        measure_null_vectors(&mut equations, &norm.weights);
        Corrector {
            norm,
            equations,
            newton: Newton::default(),
            tolerances: settings.until(settings.tolerance),
            event_tolerances: settings.until(settings.event_tolerance),
            matrix_error: 0.0,
            refines: settings.refinement > 0.0,
            phase_response: settings.phase_response,
            sensitivities: !settings.draft,
        }
    }

    /// Changes the scales, and discards the convergence data of Newton's method, which were
    /// measured in the former scales.
    pub fn set_metric(&mut self, metric: Metric) {
        self.norm = ScaledNorm::new(metric, self.equations.names());
        measure_null_vectors(&mut self.equations, &self.norm.weights);
        self.newton = Newton::default();
    }

    /// Corrects the extended unknowns `X` on a hyperplane by Newton's method.
    pub fn correct(
        &mut self,
        unknowns: &mut [f64],
        closing: Closing,
    ) -> Result<Convergence, NewtonError> {
        let Corrector { equations, norm, tolerances, .. } = self;
        self.newton.solve(equations, unknowns, Some(closing), &norm.weights, *tolerances)
    }

    /// Keeps the factors of a matrix for several corrections, if nothing but points and tangents is
    /// computed from the matrices of the curve.
    pub fn keep_factors(&mut self) {
        if self.equations.conditions.is_empty() {
            self.tolerances.matrix_change = KEPT_MATRIX_ERROR;
        }
    }

    /// Returns the tangent at a corrected point, of scaled length 1. The tangent is computed from
    /// the last factored matrix, which has the same last row `row`, and which differs from the
    /// matrix at the point by the relative error `matrix_error`. If the tangent is not accurate
    /// enough, the tangent is corrected if factors are [kept](Self::keep_factors); otherwise the matrix
    /// at the point is factored.
    pub fn tangent(
        &mut self,
        unknowns: &[f64],
        row: &[f64],
        matrix_error: f64,
    ) -> Result<Vec<f64>, Failure> {
        if matrix_error <= MATRIX_ERROR.max(self.tolerances.matrix_change) {
            self.equations.load(unknowns);
            let mut tangent = self.factored_tangent();
            let is_certain = matrix_error <= MATRIX_ERROR && self.slope(&tangent).abs() > UNCERTAIN;
            let is_kept = self.tolerances.matrix_change > MATRIX_ERROR;
            if is_certain || is_kept && self.correct_tangent(&mut tangent) {
                self.matrix_error = matrix_error;
                return Ok(tangent);
            }
        }
        self.matrix_error = 0.0;
        self.equations.assemble(unknowns)?;
        self.factor_at(unknowns, row)?;
        Ok(self.factored_tangent())
    }

    /// Corrects a tangent `t` from an older matrix `M` by iterative refinement: `t ← t − M⁻¹ F'(X) t`,
    /// where `F'(X) t` is a derivative along `t` at the loaded point. Returns whether the error of the
    /// corrected tangent is small in comparison with its component along the parameter, or smaller
    /// than the error of other tangents if this component is not small.
    fn correct_tangent(&mut self, tangent: &mut [f64]) -> bool {
        let (n, mut previous) = (self.equations.dimension(), None);
        let mut change = vec![0.0; tangent.len()];
        for _ in 0..CORRECTIONS {
            let along = self.equations.direction_of(tangent);
            change.fill(0.0);
            let At { system, x, .. } = self.equations.at();
            if system.derivative(x, &[&along], &mut change[..n]).is_err() {
                return false;
            }
            self.equations.factors.solve(&mut change);
            let size = scaled_norm(&change, &self.norm.weights);
            // Corrections shrink by a constant factor, which two corrections measure.
            let rate = previous.map_or(1.0, |previous: f64| size / previous);
            if rate.is_nan() || rate > 1.0 {
                return false;
            }
            tangent.iter_mut().zip(&change).for_each(|(t, d)| *t -= d);
            self.norm.rescale(tangent);
            if size * rate <= MATRIX_ERROR * self.slope(tangent).abs() {
                return true;
            }
            previous = Some(size);
        }
        false
    }

    /// Returns the component of a direction along the continued parameter, in units of its scale.
    pub fn slope(&self, direction: &[f64]) -> f64 {
        let parameter = self.equations.parameters_at();
        self.norm.scaled(parameter, direction[parameter])
    }

    /// Sets to zero those components of a point of the curve, and of its tangent, that consist only
    /// of rounding errors. On a mesh, or if no group of unknowns is small enough to be a rounding
    /// error, the point and the tangent are unchanged. `before` is the point before its correction.
    pub fn without_rounding(
        &mut self,
        unknowns: &[f64],
        tangent: &[f64],
        before: &[f64],
    ) -> [Vec<f64>; 2] {
        let is_exact = self.is_exact();
        let names = self.equations.names();
        let is_small = has_shrunk(names, unknowns, before)
            || [unknowns, tangent].iter().any(|v| has_small_group(names, v));
        let doubtful = is_exact && is_small;
        let cleared = doubtful.then(|| self.cleared(unknowns, tangent).ok()).flatten();
        cleared.unwrap_or_else(|| [unknowns.to_vec(), tangent.to_vec()])
    }

    /// Whether solutions are accurate to rounding, without a discretisation error.
    pub fn is_exact(&mut self) -> bool {
        !self.equations.system().representation().is_on_mesh()
    }

    fn cleared(&mut self, unknowns: &[f64], tangent: &[f64]) -> Result<[Vec<f64>; 2], Failure> {
        let row = self.norm.covector(tangent);
        self.equations.assemble(unknowns)?;
        self.factor_at(unknowns, &row)?;
        let equations = &mut self.equations;
        let (length, n) = (unknowns.len(), equations.dimension());
        let mut factors = std::mem::take(&mut equations.factors);
        // Point and tangent are cleared together: results computed from a component that is
        // rounding are rounding, too.
        let mut both = [unknowns, tangent].concat();
        let closing = Closing { row: &row, base: unknowns, length: 0.0 };
        let residual = |v: &[f64], out: &mut [f64]| {
            let (point, direction) = v.split_at(length);
            let (of_point, of_direction) = out.split_at_mut(length);
            equations.residual(point, Some(closing), of_point)?;
            of_direction.fill(0.0);
            let (x, along) = (equations.load(point).to_vec(), equations.direction_of(direction));
            equations.system().derivative(&x, &[&along], &mut of_direction[..n])
        };
        let solve = |right: &mut [f64]| right.chunks_mut(length).for_each(|r| factors.solve(r));
        clear_rounding(&mut both, &[], residual, solve)?;
        self.equations.load(unknowns);
        let direction = both.split_off(length);
        Ok([both, direction])
    }

    /// Factors the matrix of a curve, whose last row is the closing equation, at a point where the
    /// matrix has been assembled.
    pub fn factor_at(&mut self, unknowns: &[f64], row: &[f64]) -> Result<(), Failure> {
        let mut residual = vec![0.0; unknowns.len()];
        self.equations.residual(unknowns, None, &mut residual)?;
        self.equations.factor(Some(row))
    }

    /// Returns the tangent, of scaled length 1, from the last factored matrix, whose last row is
    /// the closing equation.
    pub fn factored_tangent(&mut self) -> Vec<f64> {
        let mut tangent = vec![0.0; self.equations.length()];
        self.equations.tangent(&mut tangent);
        self.norm.rescale(&mut tangent);
        tangent
    }

    /// Returns the derivative of a parameter or a monitor along the curve; `None` if the monitor is
    /// not differentiable.
    pub fn slope_of(
        &mut self,
        quantity: Quantity,
        [unknowns, tangent]: [&[f64]; 2],
    ) -> Option<f64> {
        let direction = self.equations.direction_of(tangent);
        self.equations.load(unknowns);
        let At { system, x, .. } = self.equations.at();
        match quantity {
            Quantity::Parameter(p) => Some(direction[system.names().dimension() + p]),
            Quantity::Monitor(m) if m >= system.names().monitors.len() => None,
            Quantity::Monitor(m) => {
                let mut slope = [f64::NAN];
                system.slopes(x, m, &direction, &mut slope);
                Some(slope[0]).filter(|slope| slope.is_finite())
            }
        }
    }

    /// Returns the derivatives of all parameters and monitors along the curve; the derivative of a
    /// monitor that is not differentiable is `None`.
    pub fn slopes(
        &mut self,
        [unknowns, tangent]: [&[f64]; 2],
        monitors: usize,
    ) -> Vec<Option<f64>> {
        let direction = self.equations.direction_of(tangent);
        self.equations.load(unknowns);
        let At { system, x, .. } = self.equations.at();
        let first = system.names().dimension();
        let mut own = vec![f64::NAN; system.names().monitors.len()];
        system.slopes(x, 0, &direction, &mut own);
        let mut all: Vec<_> = direction[first..].iter().copied().map(Some).collect();
        all.extend(own.into_iter().map(|slope| Some(slope).filter(|slope| slope.is_finite())));
        all.resize(direction.len() - first + monitors, None);
        all
    }

    /// Returns the error that the tolerance of Newton's method causes in the continued parameter at
    /// a regular point.
    pub fn parameter_error(&self) -> f64 {
        self.tolerances.tolerance / self.norm.scaled(self.equations.parameters_at(), 1.0)
    }

    /// Estimates the relative discretisation error of a solution on its mesh.
    pub fn mesh_error(&mut self, unknowns: &[f64]) -> f64 {
        self.equations.load(unknowns);
        let At { system, x, .. } = self.equations.at();
        system.traits(x).mesh_error
    }

    /// Returns the largest slope of the continued parameter that may be due to discretisation
    /// errors.
    pub fn vertical(&mut self, unknowns: &[f64]) -> f64 {
        VERTICAL.max(WAVES * self.mesh_error(unknowns))
    }

    /// Returns the discretisation error of the continued parameter.
    pub fn mesh_share(&mut self, unknowns: &[f64]) -> f64 {
        self.mesh_error(unknowns) * unknowns[self.equations.parameters_at()].abs()
    }

    /// Whether the number of mesh intervals must be changed for a solution.
    pub fn needs_fit(&mut self, unknowns: &[f64], target: f64) -> bool {
        self.equations.load(unknowns);
        let At { system, x, .. } = self.equations.at();
        system.discretised().is_some_and(|system| system.needs_fit(x, target))
    }

    /// Adapts the number of mesh intervals to the solution at a point, and interpolates the vectors
    /// `directions` to the new mesh. Returns whether the mesh changed; after a change, the point
    /// must be corrected and the held defining systems must be restarted.
    pub fn fit(
        &mut self,
        unknowns: &mut Vec<f64>,
        directions: &mut [&mut Vec<f64>],
        target: f64,
    ) -> bool {
        let (before, n) = (self.group_lengths(), self.equations.dimension());
        let mut x = self.equations.load(unknowns).to_vec();
        let system = self.equations.system().discretised();
        let fitted = system.is_some_and(|system| system.fit(&mut x, directions, target));
        if fitted {
            let dimension = self.equations.names().dimension();
            unknowns.splice(..n, x[..dimension].iter().copied());
            self.equations.adopt(unknowns);
            let mut metric = self.norm.metric.clone();
            metric.resample(&before, &self.group_lengths());
            self.set_metric(metric);
        }
        fitted
    }

    fn group_lengths(&self) -> Vec<usize> {
        self.equations.names().unknowns.iter().map(|group| group.length).collect()
    }

    /// Adapts the mesh, scales and borders after a point was accepted, and interpolates the
    /// solutions and directions `others` to the new mesh. Returns the length of the old tangent,
    /// measured in the new scales, which may be larger than the old scales.
    pub fn accept(&mut self, place: &mut CurvePoint, mut others: Vec<&mut [f64]>) -> f64 {
        let n = self.equations.dimension();
        let mut directions: Vec<&mut [f64]> =
            others.iter_mut().map(|other| &mut **other).chain([&mut place.tangent[..]]).collect();
        self.equations.on_accepted(&mut place.unknowns, &mut directions);
        let p = &place.unknowns[self.equations.parameters_at()..];
        let names = self.equations.names();
        self.norm.metric.grow(names, &place.unknowns[..n], p);
        self.norm.weights = self.norm.metric.weights(names);
        measure_null_vectors(&mut self.equations, &self.norm.weights);
        self.equations.adapt();
        // Larger scales shorten the same distance.
        let length = self.norm.rescale(&mut place.tangent);
        place.quiet *= length;
        length
    }

    /// Resets the data that are adapted along the curve: scales, the curvature of the equations,
    /// and the borders of the held defining systems, whose auxiliary unknowns are known.
    ///
    /// # Errors
    /// [`Failure`] if the defining systems cannot be set up at the point. After an error, the
    /// former defining systems are kept; their borders remain usable unless the number of unknowns
    /// has changed.
    pub fn restore(
        &mut self,
        unknowns: &[f64],
        metric: Metric,
        held: &[MakeCondition],
    ) -> Result<(), Failure> {
        self.set_metric(metric);
        let former = self.equations.exchange(held.iter().map(|make| make()).collect());
        self.equations.load(unknowns);
        let mut conditions = std::mem::take(&mut self.equations.conditions);
        let known = self.equations.auxiliary.clone();
        let mut left = &known[..];
        let resumed = conditions.iter_mut().try_for_each(|condition| {
            let (y, others) = left.split_at(condition.unknowns());
            left = others;
            condition.resume(self.equations.at(), y)
        });
        self.equations.conditions = conditions;
        resumed.inspect_err(|_| {
            self.equations.exchange(former);
        })
    }

    /// Returns the solution at a point of a branch, on the current mesh.
    pub fn solution_at(&mut self, place: &CurvePoint) -> Solution {
        let (n, error) = (self.equations.dimension(), self.parameter_error());
        let mut direction = self.equations.direction_of(&place.tangent);
        let mut state = self.equations.load(&place.unknowns).to_vec();
        let (slopes, parameters) = (direction.split_off(n), state.split_off(n));
        let Representation { itinerary, method, mesh, .. } =
            self.equations.system().representation();
        Solution {
            kind: Kind::RG,
            condition: None,
            itinerary,
            method,
            mesh,
            state,
            parameters,
            tangent: Some((direction, slopes)),
            mesh_shift: None,
            multiplicity: 0,
            frequency: None,
            error,
            switch: None,
            beside: None,
        }
    }
}
