//! Newton's iteration on hyperplanes across a curve, and the tangent from the matrix factored last.

use super::curve_point::CurvePoint;
use super::event::MakeCondition;
use super::extended::{Closing, Extended};
use super::metric::{Metric, ScaledNorm, has_small_group};
use super::newton::{Convergence, Newton, NewtonError, Tolerances};
use super::settings::Settings;
use crate::core::bifurcation::{At, Quantity, VERTICAL};
use crate::core::failure::Failure;
use crate::core::linalg::clear_rounding;
use crate::core::system::{Kind, Representation, Solution};

/// (H) A matrix that is known this well, relatively, is good enough for the tangent, which only
/// predicts, and for the number of unstable eigenvalues.
pub(super) const MATRIX_ERROR: f64 = 1e-4;

/// (H) Where the tangent's component along the parameter is smaller than this its sign, which tells
/// folds, comes from the matrix of the very point: the error of the tangent is `MATRIX_ERROR` times
/// the condition of the matrix.
const UNCERTAIN: f64 = 0.05;

/// (D) The error of parameters is this power of the error of the solution, since collocation
/// converges faster at its nodes: the lowest ratio of the two orders, `2m` and `m + 1`, for degrees
/// from 3.
pub(super) const SUPERCONVERGENCE: f64 = 1.5;

/// (H) A slope of the parameter may err by the error of the solution times this: in a canard
/// explosion errors of the parameter change their sign within a hundredth of the scaled arclength.
const WAVES: f64 = 10.0;

/// The equations of a curve with the norm in which its arclength is measured.
pub(super) struct Corrector<'a> {
    pub equations: Extended<'a>,
    newton: Newton,
    pub norm: ScaledNorm,
    /// When Newton's iteration stops along the curve.
    pub tolerances: Tolerances,
    /// When it stops at special points.
    pub event_tolerances: Tolerances,
    /// The relative error of the matrix by which the last tangent was found, and eigenvalues are.
    pub matrix_error: f64,
    /// Whether special points are finished on finer discretisations.
    pub refines: bool,
    /// Whether special points have the phase response of their cycle.
    pub phase_response: bool,
}

/// Measures null vectors by the scales with these weights. Collocation measures them in the units of
/// the field.
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
        }
    }

    /// Measures by other scales. What Newton's iteration has learned about the equations was in the
    /// former ones.
    pub fn set_metric(&mut self, metric: Metric) {
        self.norm = ScaledNorm::new(metric, self.equations.names());
        measure_null_vectors(&mut self.equations, &self.norm.weights);
        self.newton = Newton::default();
    }

    /// Corrects `X` on a hyperplane.
    pub fn correct(
        &mut self,
        unknowns: &mut [f64],
        closing: Closing,
    ) -> Result<Convergence, NewtonError> {
        let Corrector { equations, norm, tolerances, .. } = self;
        self.newton.solve(equations, unknowns, Some(closing), &norm.weights, *tolerances)
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
            if self.slope(&tangent).abs() > UNCERTAIN {
                self.matrix_error = matrix_error;
                return Ok(tangent);
            }
        }
        self.matrix_error = 0.0;
        self.equations.assemble(unknowns)?;
        self.factor_at(unknowns, row)?;
        Ok(self.factored_tangent())
    }

    /// The scaled component of a direction along the continued parameter.
    pub fn slope(&self, direction: &[f64]) -> f64 {
        let parameter = self.equations.parameters_at();
        self.norm.scaled(parameter, direction[parameter])
    }

    /// A point of the curve and its tangent with rounding errors set to zero. Both are unchanged on a
    /// mesh, or if no group is small enough to be a rounding error.
    pub fn without_rounding(&mut self, unknowns: &[f64], tangent: &[f64]) -> [Vec<f64>; 2] {
        let is_exact = self.is_exact();
        let names = self.equations.names();
        let doubtful = is_exact && [unknowns, tangent].iter().any(|v| has_small_group(names, v));
        let cleared = doubtful.then(|| self.cleared(unknowns, tangent).ok()).flatten();
        cleared.unwrap_or_else(|| [unknowns.to_vec(), tangent.to_vec()])
    }

    /// Whether solutions are known to rounding, and not to the error of a mesh.
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
        // Point and tangent together: where a component of one is rounding, what is computed from it
        // is rounding, too.
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
        self.norm.rescale(&mut tangent);
        tangent
    }

    /// How fast a parameter or a monitor grows along the curve; `None` where it is not
    /// differentiable.
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
            Quantity::Monitor(m) => system.slope(x, m, &direction).ok(),
        }
    }

    /// How fast all parameters and monitors grow along the curve; `None` for one that is not
    /// differentiable.
    pub fn slopes(
        &mut self,
        [unknowns, tangent]: [&[f64]; 2],
        monitors: usize,
    ) -> Vec<Option<f64>> {
        let parameters = self.equations.names().parameters.len();
        let parameters = (0..parameters).map(Quantity::Parameter);
        let all = parameters.chain((0..monitors).map(Quantity::Monitor));
        all.map(|quantity| {
            let slope = self.slope_of(quantity, [unknowns, tangent]);
            slope.filter(|slope| slope.is_finite())
        })
        .collect()
    }

    /// How well Newton's tolerance determines the continued parameter of an ordinary point.
    pub fn parameter_error(&self) -> f64 {
        self.tolerances.tolerance / self.norm.scaled(self.equations.parameters_at(), 1.0)
    }

    /// The estimated relative error of a solution that its mesh causes.
    pub fn mesh_error(&mut self, unknowns: &[f64]) -> f64 {
        self.equations.load(unknowns);
        let At { system, x, .. } = self.equations.at();
        system.traits(x).mesh_error
    }

    /// How large slopes of the continued parameter may be that are errors of the mesh.
    pub fn vertical(&mut self, unknowns: &[f64]) -> f64 {
        VERTICAL.max(WAVES * self.mesh_error(unknowns))
    }

    /// The relative error of the mesh, in units of the continued parameter.
    pub fn mesh_share(&mut self, unknowns: &[f64]) -> f64 {
        self.mesh_error(unknowns) * unknowns[self.equations.parameters_at()].abs()
    }

    /// Whether a solution needs another number of intervals.
    pub fn needs_fit(&mut self, unknowns: &[f64], target: f64) -> bool {
        self.equations.load(unknowns);
        let At { system, x, .. } = self.equations.at();
        system.discretised().is_some_and(|system| system.needs_fit(x, target))
    }

    /// Lets the number of intervals follow the branch to a place, and carries `others` over to it;
    /// whether it changed. The place then needs to be corrected, and what is held stated anew.
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

    /// Lets the mesh, scales and borders follow the branch after a point was accepted. `others` are
    /// carried over to a new mesh. Returns the length that the tangent had in the scales that have grown.
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
        // Where scales have grown, the same way is shorter.
        let length = self.norm.rescale(&mut place.tangent);
        place.quiet *= length;
        length
    }

    /// Forgets what has been learned along the curve: scales, the curvature of the equations, the
    /// borders of the conditions held.
    ///
    /// # Errors
    /// [`Failure`] if the conditions cannot be stated there: the former ones stay, whose borders serve as
    /// well unless the number of unknowns has changed.
    pub fn restore(
        &mut self,
        unknowns: &[f64],
        metric: Metric,
        held: &[MakeCondition],
    ) -> Result<(), Failure> {
        self.set_metric(metric);
        let conditions = self.equations.exchange(Vec::new());
        let (n, own) = (self.equations.dimension(), unknowns.len() - self.equations.length());
        let mut bare = unknowns.to_vec();
        bare.drain(n..n + own);
        let held = held.iter().try_fold(bare, |x, make| self.equations.hold(make(), &x));
        held.map(|_| ()).inspect_err(|_| {
            self.equations.exchange(conditions);
        })
    }

    /// The solution at a point of a branch of solutions, on the present mesh.
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
            multiplicity: 0,
            frequency: None,
            error,
            switch: None,
            beside: None,
        }
    }
}
