//! Jacobians `F_z` without a matrix: products with vectors by automatic differentiation, and linear
//! systems solved by a Krylov method.

use super::work::Work;
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factorisation, Factors, Form, Gmres, norm};
use crate::core::problem::TracedEquations;
use crate::core::scalar::Traced;
use num_dual::Dual64;
use std::sync::{Arc, Mutex, PoisonError};

/// Rounding: the relative residual at which a linear system counts as solved.
const SOLVED: f64 = 1e-12;

/// Rounding: the largest relative residual of a usable solution, if the residual no longer decreases.
const USABLE: f64 = 1e-9;

/// Heuristic: the largest relative residual of the equations before they are multiplied by the
/// preconditioner; a larger residual shows that the preconditioner is singular.
const LOST: f64 = 1e-3;

/// Heuristic: the factor by which one run of the Krylov method reduces the residual. The next run
/// begins with the true residual, which removes the rounding errors of the previous run.
const REDUCTION: f64 = 1e-8;

/// Heuristic: the largest number of runs of the Krylov method, and of iterations in each run. The
/// method stores one vector for each iteration of a run.
const RUNS: usize = 30;
const ITERATIONS: usize = 100;

/// Heuristic: no further run begins if a run does not reduce the residual below this fraction.
const PROGRESS: f64 = 0.9;

/// An approximate inverse of `F_z`, for problems whose `F_z` is not factored (see
/// [`MatrixFree`](super::MatrixFree)).
///
/// The number of iterations of the Krylov method depends on the preconditioner: few iterations
/// suffice if the product of the preconditioner and `F_z` has only few eigenvalues far from 1. For
/// example, the inverse of the Laplacian is a preconditioner of a reaction–diffusion equation.
pub trait Preconditioner: Send + Sync + 'static {
    /// Multiplies a vector by the approximate inverse of `F_z(z, p)`, in place.
    fn apply(&self, z: &[f64], p: &[f64], v: &mut [f64]);

    /// Multiplies a vector by the transpose of the approximate inverse, in place. The default
    /// implementation is valid for a symmetric approximate inverse.
    fn apply_transposed(&self, z: &[f64], p: &[f64], v: &mut [f64]) {
        self.apply(z, p, v);
    }
}

/// The error of the last linear system that was not solved. Solutions of linear systems cannot
/// return errors: the solution is not a number, and an evaluation of the residual at such a point
/// returns the error.
type Outcome = Arc<Mutex<Option<Failure>>>;

/// The matrix-free `F_z` of a zero problem.
pub(super) struct FreeJacobian {
    problem: Arc<dyn TracedEquations>,
    preconditioner: Arc<dyn Preconditioner>,
    /// The point at which `F_z` is evaluated.
    x: Vec<f64>,
    outcome: Outcome,
}

impl FreeJacobian {
    pub fn new(problem: Arc<dyn TracedEquations>, preconditioner: Arc<dyn Preconditioner>) -> Self {
        FreeJacobian { problem, preconditioner, x: Vec::new(), outcome: Outcome::default() }
    }

    /// Sets the point at which `F_z` is evaluated.
    pub fn move_to(&mut self, x: &[f64]) {
        x.clone_into(&mut self.x);
    }

    /// Returns the error of the last linear system if a point is not finite.
    pub fn check(&self, x: &[f64]) -> Result<(), Failure> {
        if x.iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        let outcome = self.outcome.lock().unwrap_or_else(PoisonError::into_inner);
        outcome.clone().map_or(Ok(()), Err)
    }

    /// Prepares the solution of linear systems with the bordered `F_z`.
    pub fn factor(&self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        if form != Form::Jacobian {
            return Err(Failure::Unsupported(
                "without a matrix, linear systems with complex matrices are not solved: use \
                 `Dense` or `Sparse` for Hopf points"
                    .into(),
            ));
        }
        let n = self.problem.names().dimension();
        let same = |solver: &KrylovSolver| {
            Arc::ptr_eq(&solver.outcome, &self.outcome) && solver.border.width == border.width
        };
        let solver = into.reuse(same, || KrylovSolver::new(self, n + border.width));
        self.x.clone_into(&mut solver.operator.x);
        solver.border.copy(border);
        *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = None;
        Ok(())
    }

    /// The reason why eigenvalues are not computed.
    pub fn undetermined() -> Failure {
        Failure::Undetermined(
            "without a matrix, eigenvalues are not computed: use `Dense` or `Sparse` to determine \
             stability"
                .into(),
        )
    }

    /// The results that are missing without a matrix.
    pub fn doubts() -> String {
        "without a matrix, neither the number of unstable eigenvalues nor the sign of the \
         determinant is computed: branch points and Hopf points are not detected (use `Dense` or \
         `Sparse` to detect them)"
            .into()
    }
}

/// A copy of a border.
#[derive(Default)]
struct Edge {
    width: usize,
    columns: Vec<f64>,
    rows: Vec<f64>,
    corner: Vec<f64>,
}

impl Edge {
    fn copy(&mut self, border: Border) {
        self.width = border.width;
        border.columns.clone_into(&mut self.columns);
        border.rows.clone_into(&mut self.rows);
        border.corner.clone_into(&mut self.corner);
    }

    /// Adds the products of the border with a vector, or of the transposed border.
    fn add_products(&self, transposed: bool, v: &[f64], out: &mut [f64]) {
        let (n, m) = (v.len() - self.width, self.width);
        let (columns, rows) =
            if transposed { (&self.rows, &self.columns) } else { (&self.columns, &self.rows) };
        let ((v, y), (out, below)) = (v.split_at(n), out.split_at_mut(n));
        for k in 0..m {
            let (column, row) = (&columns[k * n..][..n], &rows[k * n..][..n]);
            out.iter_mut().zip(column).for_each(|(out, b)| *out += b * y[k]);
            below[k] = row.iter().zip(v).map(|(c, v)| c * v).sum();
            for (j, y) in y.iter().enumerate() {
                let at = if transposed { j * m + k } else { k * m + j };
                below[k] += self.corner[at] * y;
            }
        }
    }
}

/// `F_z` at a point, with its preconditioner.
struct Operator {
    problem: Arc<dyn TracedEquations>,
    preconditioner: Arc<dyn Preconditioner>,
    x: Vec<f64>,
    work: Mutex<Work<Dual64>>,
}

impl Operator {
    /// Computes the product of `F_z`, or its transpose, with a vector.
    fn product(&self, transposed: bool, v: &[f64], out: &mut [f64]) {
        let (n, x) = (out.len(), &self.x);
        if !transposed {
            let mut work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
            let argument = |i: usize| Dual64::new(x[i], v.get(i).copied().unwrap_or(0.0));
            let r = work.evaluate(&*self.problem, argument);
            out.iter_mut().zip(r).for_each(|(out, r)| *out = r.eps);
            return;
        }
        // A backward pass through the recorded computation of the residual.
        Traced::begin();
        let z: Vec<Traced> = x[..n].iter().map(|x| Traced::input(*x)).collect();
        let p: Vec<Traced> = x[n..].iter().map(|p| Traced::from(*p)).collect();
        let mut residual = vec![Traced::from(0.0); n];
        self.problem.traced_residual(&z, &p, &mut residual);
        Traced::gradient(residual.into_iter().zip(v.iter().copied()), out);
    }

    fn precondition(&self, transposed: bool, v: &mut [f64]) {
        let (z, p) = self.x.split_at(v.len());
        match transposed {
            true => self.preconditioner.apply_transposed(z, p, v),
            false => self.preconditioner.apply(z, p, v),
        }
    }
}

/// Solves linear systems with a bordered `F_z`, or with its transpose, by the restarted generalised
/// minimal residual method. The bordered matrix is regular at folds, where `F_z` is singular. Both
/// sides of the equations are multiplied by the preconditioner, so that residuals measure the error
/// of the solution.
struct KrylovSolver {
    operator: Operator,
    border: Edge,
    outcome: Outcome,
    /// The solution, the residual, and a correction.
    solution: Vec<f64>,
    residual: Vec<f64>,
    correction: Vec<f64>,
    /// The right-hand side before it is multiplied by the preconditioner.
    given: Vec<f64>,
    gmres: Gmres,
}

/// The preconditioned bordered matrix, or its transpose.
struct Preconditioned<'s> {
    operator: &'s Operator,
    border: &'s Edge,
    transposed: bool,
    size: usize,
}

impl Preconditioned<'_> {
    /// Computes the product of the bordered matrix, without the preconditioner, with a vector.
    fn bordered(&self, v: &[f64], out: &mut [f64]) {
        let n = self.size - self.border.width;
        self.operator.product(self.transposed, &v[..n], &mut out[..n]);
        self.border.add_products(self.transposed, v, out);
    }

    fn product(&self, v: &[f64], out: &mut [f64]) {
        self.bordered(v, out);
        let n = self.size - self.border.width;
        self.operator.precondition(self.transposed, &mut out[..n]);
    }
}

impl KrylovSolver {
    fn new(jacobian: &FreeJacobian, size: usize) -> Self {
        let FreeJacobian { problem, preconditioner, x, outcome } = jacobian;
        let operator = Operator {
            x: x.clone(),
            work: Mutex::new(Work::new(&problem.names())),
            problem: problem.clone(),
            preconditioner: preconditioner.clone(),
        };
        let vector = || vec![0.0; size];
        KrylovSolver {
            operator,
            border: Edge::default(),
            outcome: outcome.clone(),
            solution: vector(),
            residual: vector(),
            correction: vector(),
            given: vector(),
            gmres: Gmres::default(),
        }
    }

    /// Solves in place; the solution is not a number if the iteration does not converge.
    fn solve_either(&mut self, transposed: bool, right: &mut [f64]) {
        let KrylovSolver { operator, border, solution, residual, correction, gmres, .. } = self;
        let size = right.len();
        self.given.copy_from_slice(right);
        let matrix = Preconditioned { operator, border, transposed, size };
        operator.precondition(transposed, &mut right[..size - border.width]);
        let whole = norm(right);
        solution.fill(0.0);
        residual.copy_from_slice(right);
        let (mut left, mut iterations) = (1.0, 0);
        for _ in 0..RUNS {
            if left <= SOLVED || whole == 0.0 {
                break;
            }
            let product = |v: &[f64], out: &mut [f64]| matrix.product(v, out);
            iterations += gmres.run(product, residual, correction, (REDUCTION, ITERATIONS));
            solution.iter_mut().zip(&*correction).for_each(|(x, d)| *x += d);
            matrix.product(solution, residual);
            residual.iter_mut().zip(&*right).for_each(|(r, b)| *r = b - *r);
            let now = norm(residual) / whole;
            // False for NaN.
            let falls = now < PROGRESS * left;
            if !falls {
                solution.iter_mut().zip(&*correction).for_each(|(x, d)| *x -= d);
                break;
            }
            left = now;
        }
        right.copy_from_slice(solution);
        matrix.bordered(solution, residual);
        residual.iter_mut().zip(&self.given).for_each(|(r, b)| *r -= b);
        let lost = norm(residual) / norm(&self.given).max(f64::MIN_POSITIVE);
        let (least, allowed) =
            if whole == 0.0 || lost > LOST { (lost, LOST) } else { (left, USABLE) };
        // False for NaN.
        let usable = least <= allowed;
        if !usable {
            right.fill(f64::NAN);
            let failure = Failure::Unsolved { iterations, residual: least, allowed };
            *self.outcome.lock().unwrap_or_else(PoisonError::into_inner) = Some(failure);
        }
    }
}

impl Factorisation for KrylovSolver {
    fn solve(&mut self, right: &mut [f64]) {
        self.solve_either(false, right);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.solve_either(true, right);
    }

    /// The sign is unknown without factors; 1 at all points, so that no change of the sign is
    /// detected.
    fn determinant_sign(&self) -> f64 {
        1.0
    }
}
