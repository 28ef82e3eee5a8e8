//! The assembled `F_z` of a zero problem: dense, sparse or without a matrix.

use super::eigenvalues::all_eigenvalues;
use super::free_jacobian::FreeJacobian;
use super::sparse_jacobian::SparseJacobian;
use super::work::Work;
use crate::core::failure::Failure;
use crate::core::linalg::{
    Border, BorderedLu, Factors, Form, MassMatrix, ShiftedLu, Spectrum, SpectrumRequest,
    factors_with_mass,
};
use crate::core::problem::{Dynamics, ZeroEquations};
use crate::core::scalar::{CHUNK, Chunk, seeded};

/// A function that writes `F_z(z, p)`, column by column.
pub(super) type Tabulated = Box<dyn Fn(&[f64], &[f64], &mut [f64]) + Send>;

/// The assembled `F_z`.
pub(super) enum Jacobian {
    /// The kind of matrix is not yet known: it is chosen at the first assembly.
    Unknown,
    Dense(DenseJacobian),
    Sparse(Box<SparseJacobian>),
    /// No matrix: only products with vectors are computed.
    Free(FreeJacobian),
}

impl Jacobian {
    /// The entries of the matrix, in storage order.
    pub fn entries(&self) -> &[f64] {
        match self {
            Jacobian::Unknown | Jacobian::Free(_) => &[],
            Jacobian::Dense(dense) => &dense.entries,
            Jacobian::Sparse(sparse) => sparse.entries(),
        }
    }

    /// The mass matrix at the point of the last assembly; `None` for the identity matrix.
    pub fn mass(&self, n: usize) -> Option<MassMatrix> {
        let mass = match self {
            Jacobian::Unknown | Jacobian::Free(_) => None,
            Jacobian::Dense(dense) => dense.mass.as_deref(),
            Jacobian::Sparse(sparse) => sparse.mass(),
        };
        let entries = mass?.iter().enumerate().map(|(k, m)| (self.place(k, n), *m));
        Some(MassMatrix::new(n, entries))
    }

    /// The row and column of entry number `k` of the matrix.
    pub fn place(&self, k: usize, n: usize) -> [usize; 2] {
        match self {
            Jacobian::Sparse(sparse) => sparse.place(k),
            _ => [k % n, k / n],
        }
    }

    /// Writes the matrix, column by column.
    pub fn write(&self, out: &mut [f64]) {
        match self {
            Jacobian::Sparse(sparse) => out.copy_from_slice(&sparse.dense(sparse.entries())),
            _ => out.copy_from_slice(self.entries()),
        }
    }

    /// Factors the matrix, or the variant of it that `form` selects, bordered by additional rows
    /// and columns.
    pub fn factor(
        &mut self,
        n: usize,
        form: Form,
        border: Border,
        into: &mut Factors,
    ) -> Result<(), Failure> {
        let mass = self.mass(n);
        match (form, &mut *self) {
            (Form::Antiperiodic, _) => Err(Failure::Unsupported(
                "the unknowns of a `ZeroProblem` do not describe a periodic orbit, so orbits of \
                 twice the period are not defined"
                    .into(),
            )),
            (_, Jacobian::Free(free)) => free.factor(form, border, into),
            (_, Jacobian::Sparse(sparse)) => sparse.factor(form, border, (mass, into)),
            (Form::Oscillation(omega), Jacobian::Dense(dense)) => {
                let pencil = (&dense.entries[..], dense.mass.as_deref());
                factors_with_mass::<ShiftedLu>(into, mass).factor(pencil, omega, border)
            }
            _ => factors_with_mass::<BorderedLu>(into, mass).factor(self.entries(), border),
        }
    }

    /// Computes the eigenvalues that decide the stability of the solution, the rightmost first.
    pub fn spectrum(
        &mut self,
        dynamics: Dynamics,
        request: SpectrumRequest,
    ) -> Result<Spectrum, Failure> {
        match self {
            Jacobian::Unknown => Ok(Spectrum::new()),
            Jacobian::Dense(dense) => {
                all_eigenvalues((&dense.entries, dense.mass.as_deref()), dynamics)
            }
            Jacobian::Sparse(sparse) => sparse.spectrum(dynamics, request),
            Jacobian::Free(_) => Err(FreeJacobian::undetermined()),
        }
    }
}

/// A dense matrix `F_z`, stored column by column.
pub(super) struct DenseJacobian {
    entries: Vec<f64>,
    /// The mass matrix, stored column by column; `None` for the identity matrix.
    mass: Option<Vec<f64>>,
    tabulated: Option<Tabulated>,
}

impl DenseJacobian {
    /// Creates a dense matrix for `n` unknowns.
    pub fn new(n: usize) -> Self {
        DenseJacobian { entries: vec![0.0; n * n], mass: None, tabulated: None }
    }

    /// Creates a dense matrix for `n` unknowns, whose entries are computed by a function.
    pub fn tabulated(n: usize, function: Tabulated) -> Self {
        DenseJacobian { tabulated: Some(function), ..Self::new(n) }
    }

    /// Computes `F_z` by the problem's function, or by dual numbers if the problem has no function,
    /// and the mass matrix of a flow.
    pub fn differentiate(
        &mut self,
        chunk: &mut Work<Chunk>,
        problem: &dyn ZeroEquations,
        x: &[f64],
    ) {
        let n = self.entries.len().isqrt();
        if problem.dynamics() == Dynamics::Implicit {
            let mass = self.mass.get_or_insert_with(|| vec![0.0; n * n]);
            let argument = |i: usize| Chunk::from(x[i]);
            for start in (0..n).step_by(CHUNK) {
                let seed = |j: usize| seeded(0.0, j, start);
                let columns = chunk.products(problem, argument, seed);
                scatter(columns, start, mass);
            }
        }
        if let Some(jacobian) = &self.tabulated {
            return jacobian(&x[..n], &x[n..], &mut self.entries);
        }
        for start in (0..n).step_by(CHUNK) {
            let r = chunk.evaluate(problem, |i| seeded(x[i], i, start));
            scatter(r, start, &mut self.entries);
        }
    }
}

/// Writes the derivatives of all equations in a chunk of directions as columns of a matrix, from the
/// column `start`.
fn scatter(equations: &[Chunk], start: usize, matrix: &mut [f64]) {
    let n = equations.len();
    for (i, r) in equations.iter().enumerate() {
        for (j, part) in (start..n).zip(r.eps) {
            matrix[j * n + i] = part;
        }
    }
}
