//! Damped Newton's method on the bordered system, with an affine-invariant convergence test.
//!
//! After each correction `Δ = −M⁻¹G(X)`, the simplified correction at the new point,
//! `Δ̄ = −M⁻¹G(X + λΔ)`, is computed with the same factorisation. The simplified correction measures
//! the residual independently of the units of equations (P. Deuflhard, *Newton Methods for Nonlinear
//! Problems*, 2004, sections 2.1 and 3.3). The Newton step is accepted if `‖Δ̄‖ ≤ (1 − λ/4)‖Δ‖`; if not, the
//! damping factor `λ` is halved. The iteration has converged if the scaled norm of the next
//! correction, predicted from the observed quadratic convergence, is smaller than the tolerance.
//!
//! Each point of a branch typically costs one assembly and one factorisation: the matrix of the
//! last correction also gives the tangent if the matrix was evaluated close enough to the solution.
//! While the matrix changes little, its factors are kept for all corrections (the simplified Newton
//! iteration: Deuflhard, section 2.1.2).

mod error;

use super::extended::{Closing, Extended};
use crate::core::bifurcation::{At, DOUBLE_ROOT};
use crate::core::failure::Failure;
use crate::core::linalg::generic;
pub use error::NewtonError;
use std::ops::RangeInclusive;

/// The stopping criteria of Newton's method.
///
/// ```
/// use tangency::core::continuation::Tolerances;
/// let fast = Tolerances { matrix_change: 0.02, ..Tolerances::new(1e-8, 6) };
/// assert_eq!((fast.tolerance, fast.max_iterations, fast.reach), (1e-8, 6, f64::INFINITY));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// The largest scaled correction and scaled residual of a converged point.
    pub tolerance: f64,
    /// The maximal number of factorisations.
    pub max_iterations: usize,
    /// The largest scaled length of the first correction: if the first correction is longer, the
    /// solution is too far away, and the iteration fails. Infinity allows all corrections.
    pub reach: f64,
    /// The largest relative change of the matrix between the start and the solution for which the
    /// factors of the first iteration are kept. A larger value saves factorisations, and costs
    /// evaluations of the equations and the accuracy of the factors.
    pub matrix_change: f64,
    /// The smallest damping factor: if a correction requires a smaller factor, the iteration fails.
    pub least_damping: f64,
}

impl Tolerances {
    /// Returns stopping criteria that allow first corrections of any length, and keep the factors of
    /// a matrix only while the equations are nearly linear.
    pub const fn new(tolerance: f64, max_iterations: usize) -> Self {
        Tolerances {
            tolerance,
            max_iterations,
            reach: f64::INFINITY,
            matrix_change: NEARLY_LINEAR,
            least_damping: LEAST_DAMPING,
        }
    }
}

/// Convergence data of Newton's method at one point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Convergence {
    /// The number of factorisations.
    pub iterations: usize,
    /// The contraction `‖Δ̄‖/‖Δ‖` of the first Newton step, which is a measure of nonlinearity.
    pub contraction: f64,
    /// The scaled norm of the last correction.
    pub correction: f64,
    /// The estimated relative difference between the factored matrix and the matrix at the
    /// solution.
    pub matrix_error: f64,
}

/// Newton's method with its buffers; memory is allocated only when the number of unknowns changes.
///
/// ```
/// use tangency::core::continuation::{Extended, Newton, Tolerances};
/// use tangency::core::system::Dense;
/// use tangency::problems::classic::ParallelPlate;
/// let mut system = Dense::new(ParallelPlate);
/// // No parameter released and no closing equation: one equation for u, at this load.
/// let mut equations = Extended::new(&mut system, &[0.2, 0.140625], vec![]);
/// let mut u = [0.2];
/// let tolerances = Tolerances::new(1e-12, 12);
/// let report = Newton::default().solve(&mut equations, &mut u, None, &[1.0], tolerances)?;
/// assert!((u[0] - 0.25).abs() < 1e-14 && report.iterations <= 5);
/// # Ok::<(), tangency::core::continuation::NewtonError>(())
/// ```
#[derive(Default)]
pub struct Newton {
    residual: Vec<f64>,
    correction: Vec<f64>,
    next: Vec<f64>,
    trial: Vec<f64>,
    /// The last estimate of the curvature, `ω` in `‖Δ̄‖ ≈ ω‖Δ‖²/2`; 0 if unknown.
    curvature: f64,
}

/// Heuristic: equations are nearly linear if the matrix changes by less than this threshold,
/// relative to the matrix.
const NEARLY_LINEAR: f64 = 1e-4;
/// The usual smallest damping factor.
const LEAST_DAMPING: f64 = 1.0 / 256.0;
/// The contraction below which the corrections are assumed to converge quadratically.
const GOOD_CONTRACTION: f64 = 0.25;
/// The ratios of two corrections near double roots: each correction halves the distance to a double
/// root, and several double roots slow down the convergence.
const HALVING: RangeInclusive<f64> = 0.45..=0.75;
/// The contractions near double roots: the residual is a quarter of the residual before.
const QUARTER: RangeInclusive<f64> = 0.2..=0.35;
/// The largest number of corrections that are computed with the factors of an earlier iteration.
const KEPT: i32 = 4;
/// The fraction of the tolerance below which a correction is not applied.
const NEGLIGIBLE: f64 = 1e-3;
/// The error allowed in evaluations of the equations at the start of Newton's iteration, as a
/// fraction of the tolerance.
pub(in crate::core) const ROUGHLY: f64 = 2e-4;
/// The smallest first correction for which the ratio of two corrections determines the curvature.
const MEASURABLE: f64 = 3e-7;
/// Corrections that no longer decrease consist only of rounding errors if they are smaller than
/// this factor times a sample of rounding errors.
const NOISE: f64 = 30.0;
/// The largest correction that may consist of rounding errors; if a correction is larger, the point
/// is not a solution.
const MOST_NOISE: f64 = 1e-7;

/// The equations to solve, with their closing equation and the weights of the scaled norm.
struct Problem<'p, 'a> {
    equations: &'p mut Extended<'a>,
    closing: Option<Closing<'p>>,
    weights: &'p [f64],
    tolerance: f64,
}

impl Problem<'_, '_> {
    /// Evaluates the residual. Evaluates the residual after assembling the matrix, because some
    /// systems compute the residual during assembly.
    fn residual(&mut self, unknowns: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        self.equations.assemble(unknowns)?;
        self.equations.residual(unknowns, self.closing, out)
    }

    /// Factors the matrix at the point at which the residual was last evaluated.
    fn factor(&mut self, iteration: usize) -> Result<(), NewtonError> {
        let factored = self.equations.factor(self.closing.map(|closing| closing.row));
        factored.map_err(|cause| NewtonError::Evaluation { iteration, cause })
    }

    fn size(&self, correction: &[f64]) -> f64 {
        scaled_norm(correction, self.weights)
    }
}

impl Newton {
    /// Solves the equations for `X`, which contains the start on entry and the solution on success.
    /// `weights` define the scaled norm `‖Δ‖² = Σ wᵢ Δᵢ²`. Without a closing equation, the iteration
    /// stops at a scaled distance of about 1e-6 from a double root if the released parameter has
    /// converged, because rounding errors dominate the corrections nearer to the root.
    ///
    /// # Errors
    /// [`NewtonError`] if the iteration fails; after an error, `X` is the point at which the
    /// iteration stopped.
    pub fn solve(
        &mut self,
        equations: &mut Extended,
        unknowns: &mut [f64],
        closing: Option<Closing>,
        weights: &[f64],
        tolerances: Tolerances,
    ) -> Result<Convergence, NewtonError> {
        self.resize(unknowns.len());
        let Tolerances { tolerance, max_iterations, reach, matrix_change, least_damping } =
            tolerances;
        let mut problem = Problem { equations, closing, weights, tolerance };
        let mut report = Convergence::default();
        let mut previous = f64::INFINITY;
        // At the start of the iteration, errors much smaller than the remaining correction are
        // allowed.
        problem.equations.set_inexactness(ROUGHLY * tolerance);
        let start = problem.residual(unknowns, &mut self.residual).map_err(NewtonError::from);
        let start = start.and_then(|()| problem.factor(1));
        problem.equations.set_inexactness(0.0);
        start?;
        for iteration in 1..=max_iterations {
            report.iterations = iteration;
            if iteration > 1 {
                problem.factor(iteration)?;
            }
            self.correction.copy_from_slice(&self.residual);
            problem.equations.factors.solve(&mut self.correction);
            let size = problem.size(&self.correction);
            report.correction = size;
            if size > reach && iteration == 1 {
                return Err(NewtonError::OutOfReach { correction: size, reach });
            }
            let ratio = size / previous;
            if iteration > 1 && self.is_last(ratio, unknowns, tolerance, &mut report) {
                return Ok(report);
            }
            if iteration > 1 && ratio > GOOD_CONTRACTION && self.is_rounding(&mut problem, unknowns)
            {
                return Ok(report);
            }
            previous = size;
            let change = self.curvature * size;
            if self.curvature > 0.0 && change <= matrix_change {
                report.matrix_error = change;
                let kept = self.keep_factors(&mut problem, unknowns, matrix_change);
                if let Some(contraction) = kept {
                    if matrix_change > NEARLY_LINEAR && size > MEASURABLE {
                        // `ω‖Δ‖`, with the curvature that this correction determines.
                        report.matrix_error = 2.0 * contraction;
                        self.measure(iteration, (contraction, size), tolerance, &mut report);
                    }
                    return Ok(report);
                }
            }
            let contraction =
                self.damped_step(&mut problem, unknowns, (iteration, least_damping))?;
            self.measure(iteration, (contraction, size), tolerance, &mut report);
            let halves = HALVING.contains(&ratio) && QUARTER.contains(&contraction);
            if closing.is_none() && halves && size <= DOUBLE_ROOT && self.is_settled(&problem) {
                // The matrix at the root is singular: the last factored matrix is kept.
                return Ok(report);
            }
        }
        let Convergence { correction, contraction, .. } = report;
        Err(NewtonError::IterationLimit { iterations: max_iterations, correction, contraction })
    }

    /// Stores the contraction of the first correction, and the curvature if the correction is long
    /// enough to determine the curvature.
    fn measure(
        &mut self,
        iteration: usize,
        (contraction, size): (f64, f64),
        tolerance: f64,
        report: &mut Convergence,
    ) {
        if iteration == 1 {
            // The ratio of two numbers near rounding is meaningless.
            report.contraction = if size > tolerance { contraction } else { 0.0 };
            if size > MEASURABLE {
                self.curvature = 2.0 * contraction / size;
            }
        }
    }

    /// Whether a correction is the last correction, given its ratio to the preceding correction. A
    /// negligible correction is not applied, so that the assembled data remain valid at the
    /// returned point.
    fn is_last(
        &self,
        ratio: f64,
        unknowns: &mut [f64],
        tolerance: f64,
        report: &mut Convergence,
    ) -> bool {
        let (size, contracts) = (report.correction, ratio <= GOOD_CONTRACTION);
        if size <= tolerance && !contracts || size <= NEGLIGIBLE * tolerance {
            return true;
        }
        // ‖Δ̄ₖ₊₁‖ ≈ ω‖Δₖ‖²/2 with the ω of the preceding correction.
        let last = contracts && size * ratio * ratio <= 0.01 * tolerance;
        if last {
            unknowns.iter_mut().zip(&self.correction).for_each(|(x, d)| *x -= d);
            report.matrix_error = 2.0 * ratio * ratio;
        }
        last
    }

    /// Whether the correction changes the first released parameter by less than the tolerance.
    fn is_settled(&self, problem: &Problem) -> bool {
        let parameter = problem.equations.parameters_at();
        let both = self.correction.get(parameter).zip(problem.weights.get(parameter));
        both.is_none_or(|(change, weight)| change.abs() * weight.sqrt() <= problem.tolerance)
    }

    /// Whether the correction consists only of rounding errors, so that the point is as accurate as
    /// the arithmetic allows.
    fn is_rounding(&mut self, problem: &mut Problem, unknowns: &[f64]) -> bool {
        let size = problem.size(&self.correction);
        let Problem { equations, closing, weights, .. } = problem;
        size <= MOST_NOISE
            && self
                .rounding(equations, *closing, unknowns, 1)
                .is_ok_and(|noise| size <= NOISE * scaled_norm(&noise[0], weights))
    }

    /// Returns samples of the rounding error of a solution. For each sample, a sampled residual is the
    /// change of the equations when the last digit of each unknown changes, with a random sign in each
    /// equation. The sample is Newton's correction for this residual (up to signs, a sum over
    /// `|M⁻¹| |M| |X| ε`: R. D. Skeel, J. ACM 26:494, 1979). The last factored matrix is used. On
    /// return, the assembled data of the equations belong to the point whose rounding error was
    /// sampled.
    pub(crate) fn rounding(
        &mut self,
        equations: &mut Extended,
        closing: Option<Closing>,
        unknowns: &[f64],
        samples: usize,
    ) -> Result<Vec<Vec<f64>>, Failure> {
        self.resize(unknowns.len());
        let mut all = vec![vec![0.0; unknowns.len()]; samples];
        for (sample, noise) in all.iter_mut().enumerate() {
            let ups = generic(unknowns.len(), sample);
            for ((trial, x), up) in self.trial.iter_mut().zip(unknowns).zip(ups) {
                *trial = if up > 0.0 { x.next_up() } else { x.next_down() };
            }
            equations.assemble(&self.trial)?;
            equations.residual(&self.trial, closing, noise)?;
        }
        equations.assemble(unknowns)?;
        equations.residual(unknowns, closing, &mut self.residual)?;
        for (sample, noise) in all.iter_mut().enumerate() {
            let signs = generic(unknowns.len(), sample + 7);
            for ((change, r), sign) in noise.iter_mut().zip(&self.residual).zip(signs) {
                *change = (*change - r) * sign.signum();
            }
            equations.factors.solve(noise);
        }
        Ok(all)
    }

    /// Returns Newton's next correction at a solution, which estimates the remaining error
    /// including rounding errors. If `refactor` is set, the matrix at the solution is factored; if
    /// not, the last factored matrix, which belongs to a nearby point, is used.
    pub(crate) fn residual_correction(
        &mut self,
        equations: &mut Extended,
        unknowns: &[f64],
        refactor: bool,
    ) -> Result<&[f64], NewtonError> {
        self.resize(unknowns.len());
        if refactor {
            equations.assemble(unknowns)?;
        }
        equations.residual(unknowns, None, &mut self.correction)?;
        if refactor {
            equations
                .factor(None)
                .map_err(|cause| NewtonError::Evaluation { iteration: 1, cause })?;
        }
        equations.factors.solve(&mut self.correction);
        Ok(&self.correction)
    }

    /// Computes the point that results from the damped Newton correction.
    fn try_correction(&mut self, unknowns: &[f64], damping: f64) {
        for ((trial, x), d) in self.trial.iter_mut().zip(unknowns).zip(&self.correction) {
            *trial = x - damping * d;
        }
    }

    /// Applies the correction and further corrections with the same factors, as long as these
    /// corrections are expected to converge. Returns the contraction of the first of them; `None`,
    /// with the unknowns unchanged, if a new matrix is needed.
    fn keep_factors(
        &mut self,
        problem: &mut Problem,
        unknowns: &mut [f64],
        matrix_change: f64,
    ) -> Option<f64> {
        let negligible = NEGLIGIBLE * problem.tolerance;
        let (mut size, mut first) = (problem.size(&self.correction), None);
        // If the equations are nearly linear, the next correction is expected to be the last.
        let (most, factor) = if matrix_change > NEARLY_LINEAR { (KEPT, 2.0) } else { (1, 1.0) };
        self.try_correction(unknowns, 1.0);
        for remaining in (0..most).rev() {
            problem.equations.residual(&self.trial, problem.closing, &mut self.next).ok()?;
            problem.equations.factors.solve(&mut self.next);
            let left = problem.size(&self.next);
            let contraction = left / size;
            // After a correction `Δ`, the matrix has changed by `ω‖Δ‖`, twice the first contraction.
            let rate = if first.is_none() { factor * contraction } else { contraction };
            let first = *first.get_or_insert(contraction);
            if left <= negligible {
                // The data computed with the residual belong to this point.
                unknowns.copy_from_slice(&self.trial);
                return Some(first);
            }
            let converges = rate <= matrix_change && left * rate.powi(remaining + 1) <= negligible;
            if !converges {
                return None;
            }
            self.trial.iter_mut().zip(&self.next).for_each(|(x, d)| *x -= d);
            if left * rate <= negligible {
                unknowns.copy_from_slice(&self.trial);
                return Some(first);
            }
            size = left;
        }
        None
    }

    /// Applies the correction with the necessary damping, evaluates the residual at the new point,
    /// and returns the contraction of the simplified correction at the new point.
    fn damped_step(
        &mut self,
        problem: &mut Problem,
        unknowns: &mut [f64],
        (iteration, least_damping): (usize, f64),
    ) -> Result<f64, NewtonError> {
        let size = problem.size(&self.correction);
        let mut damping = 1.0;
        loop {
            self.try_correction(unknowns, damping);
            let outcome = problem.residual(&self.trial, &mut self.residual);
            if outcome.is_ok() {
                self.next.copy_from_slice(&self.residual);
                problem.equations.factors.solve(&mut self.next);
                let contraction = problem.size(&self.next) / size.max(f64::MIN_POSITIVE);
                if size <= problem.tolerance || contraction <= 1.0 - damping / 4.0 {
                    unknowns.copy_from_slice(&self.trial);
                    return Ok(contraction);
                }
            }
            if damping == 1.0 && self.is_rounding(problem, unknowns) {
                return Ok(0.0);
            }
            damping *= 0.5;
            if damping < least_damping {
                let At { system, x, .. } = problem.equations.at();
                let growth = system.traits(x).growth;
                return Err(hopeless(outcome, iteration, (size, growth), damping));
            }
        }
    }

    fn resize(&mut self, length: usize) {
        for buffer in [&mut self.residual, &mut self.correction, &mut self.next, &mut self.trial] {
            buffer.resize(length, 0.0);
        }
    }
}

/// Returns the error to report if damping does not lead to convergence.
fn hopeless(
    outcome: Result<(), Failure>,
    iteration: usize,
    (size, growth): (f64, f64),
    damping: f64,
) -> NewtonError {
    match outcome {
        Err(cause) => NewtonError::Evaluation { iteration, cause },
        Ok(()) if size <= NOISE * f64::EPSILON * growth => {
            NewtonError::Evaluation { iteration, cause: Failure::Growth(growth) }
        }
        Ok(()) if size.is_finite() => {
            NewtonError::Stagnation { iterations: iteration, correction: size, damping }
        }
        Ok(()) => {
            let remedy = "the equations must have finite values near the solution";
            let cause = Failure::not_finite("the correction", size, remedy);
            NewtonError::Evaluation { iteration, cause }
        }
    }
}

/// Returns the scaled norm `√(Σ wᵢ dᵢ²)` of a vector `d`.
pub(crate) fn scaled_norm(d: &[f64], weights: &[f64]) -> f64 {
    d.iter().zip(weights).map(|(d, w)| w * d * d).sum::<f64>().sqrt()
}

/// Scales a vector to length 1 in the scaled norm, unless it is zero, and returns its former
/// length.
pub(crate) fn scale_to_one(v: &mut [f64], weights: &[f64]) -> f64 {
    let size = scaled_norm(v, weights);
    if size > 0.0 {
        v.iter_mut().for_each(|v| *v /= size);
    }
    size
}
