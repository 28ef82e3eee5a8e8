//! Newton's iteration on the bordered system, damped, with an affine-invariant test of convergence.
//!
//! A correction `Δ = −M⁻¹G(X)` is followed by the simplified one at the new point,
//! `Δ̄ = −M⁻¹G(X + λΔ)`, with the same factorisation: the residual, measured by the correction that
//! it would cause, which is independent of the units of equations (P. Deuflhard, *Newton Methods
//! for Nonlinear Problems*, 2004, sections 2.1 and 3.3). The step is accepted if
//! `‖Δ̄‖ ≤ (1 − λ/4)‖Δ‖`, else λ is halved. Converged means that what the next correction would be,
//! by the quadratic convergence seen so far, is below the tolerance in the scaled norm of the
//! branch.
//!
//! Each point costs one assembly and one factorisation: the matrix of the last correction serves
//! the tangent as well, where it was evaluated near enough to the solution.

mod error;

use super::extended::{Closing, Extended};
use crate::core::bifurcation::At;
use crate::core::failure::Failure;
use crate::core::linalg::generic;
pub use error::NewtonError;

/// When Newton's iteration stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// The largest scaled correction, and scaled residual, of a converged point.
    pub tolerance: f64,
    /// The largest number of factorisations.
    pub max_iterations: usize,
}

/// How Newton's iteration went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Convergence {
    /// Factorisations spent.
    pub iterations: usize,
    /// The contraction of the first step, `‖Δ̄‖/‖Δ‖`: a measure of nonlinearity.
    pub contraction: f64,
    /// The scaled norm of the last correction.
    pub correction: f64,
    /// By how much the factored matrix differs from that at the solution, estimated and relative.
    pub matrix_error: f64,
}

/// Newton's iteration with its buffers: it allocates nothing after its first use at a given size.
///
/// ```
/// use tangency::core::continuation::{Extended, Newton, Tolerances};
/// use tangency::core::system::Dense;
/// use tangency::problems::classic::ParallelPlate;
/// let mut system = Dense::new(ParallelPlate);
/// // No parameter released and no closing equation: one equation for u, at this load.
/// let mut equations = Extended::new(&mut system, &[0.2, 0.140625], vec![]);
/// let mut u = [0.2];
/// let tolerances = Tolerances { tolerance: 1e-12, max_iterations: 12 };
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
    /// The curvature of the equations met last, `ω` in `‖Δ̄‖ ≈ ω‖Δ‖²/2`; 0 while it is not known.
    curvature: f64,
}

/// Damping factors below this are hopeless.
const LEAST_DAMPING: f64 = 1.0 / 256.0;
/// Corrections that contract better than this converge quadratically.
const GOOD_CONTRACTION: f64 = 0.25;
/// A correction is expected to be the last if the matrix changes by less than this over it.
const NEARLY_LINEAR: f64 = 1e-4;
/// A correction below this part of the tolerance is not made.
const NEGLIGIBLE: f64 = 1e-3;
/// Where the iteration begins, the equations may err by this part of the tolerance.
pub(in crate::core) const ROUGHLY: f64 = 2e-4;
/// The ratio of two corrections says nothing of the curvature if the first one is smaller than
/// this.
const MEASURABLE: f64 = 3e-7;
/// Corrections that shrink no more are rounding if they are at most this many times a sample of it,
const NOISE: f64 = 30.0;
/// and no larger than this: what is known so badly is no solution.
const MOST_NOISE: f64 = 1e-7;

/// The equations with what closes and measures them.
struct Problem<'p, 'a> {
    equations: &'p mut Extended<'a>,
    closing: Option<Closing<'p>>,
    weights: &'p [f64],
    tolerance: f64,
}

impl Problem<'_, '_> {
    /// Assembles first, so that systems which find the residual on the way need not look for it
    /// again.
    fn residual(&mut self, unknowns: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        self.equations.assemble(unknowns)?;
        self.equations.residual(unknowns, self.closing, out)
    }

    /// Factors the matrix where the residual was evaluated last.
    fn factor(&mut self, iteration: usize) -> Result<(), NewtonError> {
        let factored = self.equations.factor(self.closing.map(|closing| closing.row));
        factored.map_err(|cause| NewtonError::Evaluation { iteration, cause })
    }

    fn size(&self, correction: &[f64]) -> f64 {
        scaled_norm(correction, self.weights)
    }
}

impl Newton {
    /// Solves for `X`, which holds the start and, on success, the solution. `weights` are those of
    /// the scaled norm `‖Δ‖² = Σ wᵢ Δᵢ²`.
    ///
    /// # Errors
    /// [`NewtonError`]; `X` is then left where the iteration stopped.
    pub fn solve(
        &mut self,
        equations: &mut Extended,
        unknowns: &mut [f64],
        closing: Option<Closing>,
        weights: &[f64],
        tolerances: Tolerances,
    ) -> Result<Convergence, NewtonError> {
        self.resize(unknowns.len());
        let Tolerances { tolerance, max_iterations } = tolerances;
        let mut problem = Problem { equations, closing, weights, tolerance };
        let mut report = Convergence::default();
        let mut previous = f64::INFINITY;
        // What errs by less than a correction that is left to be need not be computed where Newton
        // begins.
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
            if self.curvature > 0.0 && change <= NEARLY_LINEAR {
                report.matrix_error = change;
                if self.simplified_step(&mut problem, unknowns) {
                    return Ok(report);
                }
            }
            let contraction = self.damped_step(&mut problem, unknowns, iteration)?;
            if iteration == 1 {
                // The ratio of two numbers near rounding says nothing.
                report.contraction = if size > tolerance { contraction } else { 0.0 };
                if size > MEASURABLE {
                    self.curvature = 2.0 * contraction / size;
                }
            }
        }
        let Convergence { correction, contraction, .. } = report;
        Err(NewtonError::IterationLimit { iterations: max_iterations, correction, contraction })
    }

    /// Whether the correction, by this ratio smaller than the one before, is the last. It is made
    /// only if that matters: what was found with a negligible one belongs to the point as it is.
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
        // ‖Δ̄ₖ₊₁‖ ≈ ω‖Δₖ‖²/2 with the ω of the correction before.
        let last = contracts && size * ratio * ratio <= 0.01 * tolerance;
        if last {
            unknowns.iter_mut().zip(&self.correction).for_each(|(x, d)| *x -= d);
            report.matrix_error = 2.0 * ratio * ratio;
        }
        last
    }

    /// Whether the correction is rounding, so that the point is as good as arithmetic allows.
    fn is_rounding(&mut self, problem: &mut Problem, unknowns: &[f64]) -> bool {
        let size = problem.size(&self.correction);
        let Problem { equations, closing, weights, .. } = problem;
        size <= MOST_NOISE
            && self
                .rounding(equations, *closing, unknowns, 0)
                .is_ok_and(|noise| size <= NOISE * scaled_norm(noise, weights))
    }

    /// The error of a solution that rounding causes, a sample of it: the residual changes as each
    /// unknown does in its last digit, and each equation may keep that error with either sign, so
    /// that Newton would make of it what this returns (up to signs, a sum over `|M⁻¹| |M| |X| ε`:
    /// R. D. Skeel, J. ACM 26:494, 1979). With the matrix factored last; what is assembled belongs
    /// to the point afterwards.
    pub(crate) fn rounding(
        &mut self,
        equations: &mut Extended,
        closing: Option<Closing>,
        unknowns: &[f64],
        sample: usize,
    ) -> Result<&[f64], Failure> {
        self.resize(unknowns.len());
        let (ups, signs) = (generic(unknowns.len(), sample), generic(unknowns.len(), sample + 7));
        for ((trial, x), up) in self.trial.iter_mut().zip(unknowns).zip(ups) {
            *trial = if up > 0.0 { x.next_up() } else { x.next_down() };
        }
        equations.assemble(&self.trial)?;
        equations.residual(&self.trial, closing, &mut self.next)?;
        equations.assemble(unknowns)?;
        equations.residual(unknowns, closing, &mut self.residual)?;
        for ((next, r), sign) in self.next.iter_mut().zip(&self.residual).zip(signs) {
            *next = (*next - r) * sign.signum();
        }
        equations.factors.solve(&mut self.next);
        Ok(&self.next)
    }

    /// What Newton would still change at a solution, which is the error left, rounding included:
    /// with the matrix there (`refactor`), or with the one factored last, that of a point near by.
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

    /// The point that the correction, damped, leads to.
    fn try_correction(&mut self, unknowns: &[f64], damping: f64) {
        for ((trial, x), d) in self.trial.iter_mut().zip(unknowns).zip(&self.correction) {
            *trial = x - damping * d;
        }
    }

    /// Where the equations are so nearly linear that the first correction should be the last, the
    /// residual at the new point decides: true if it is converged.
    fn simplified_step(&mut self, problem: &mut Problem, unknowns: &mut [f64]) -> bool {
        self.try_correction(unknowns, 1.0);
        let evaluated = problem.equations.residual(&self.trial, problem.closing, &mut self.next);
        if evaluated.is_err() {
            return false;
        }
        problem.equations.factors.solve(&mut self.next);
        let (left, negligible) = (problem.size(&self.next), NEGLIGIBLE * problem.tolerance);
        let contraction = left / problem.size(&self.correction);
        if left <= negligible {
            // What was found with the residual belongs to this very point.
            unknowns.copy_from_slice(&self.trial);
            return true;
        }
        let nearly_linear = contraction <= NEARLY_LINEAR && left * contraction <= negligible;
        if nearly_linear {
            let last = self.trial.iter().zip(&self.next).map(|(x, d)| x - d);
            unknowns.iter_mut().zip(last).for_each(|(x, last)| *x = last);
        }
        nearly_linear
    }

    /// Applies the correction, damped as far as needed, leaves the residual at the new point, and
    /// returns the contraction of the simplified correction there.
    fn damped_step(
        &mut self,
        problem: &mut Problem,
        unknowns: &mut [f64],
        iteration: usize,
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
            if damping < LEAST_DAMPING {
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

/// Why no damping helps.
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
            let remedy = "the equations must be finite near the solution";
            let cause = Failure::not_finite("the correction", size, remedy);
            NewtonError::Evaluation { iteration, cause }
        }
    }
}

/// `√(Σ wᵢ dᵢ²)`.
pub(crate) fn scaled_norm(d: &[f64], weights: &[f64]) -> f64 {
    d.iter().zip(weights).map(|(d, w)| w * d * d).sum::<f64>().sqrt()
}

/// Scales a vector to length 1 in the scaled norm, unless it is zero, and returns its length
/// before.
pub(crate) fn scale_to_one(v: &mut [f64], weights: &[f64]) -> f64 {
    let size = scaled_norm(v, weights);
    if size > 0.0 {
        v.iter_mut().for_each(|v| *v /= size);
    }
    size
}
