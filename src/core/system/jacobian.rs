//! The assembled `F_z` of a zero problem, dense or sparse.

use super::sparse_jacobian::SparseJacobian;
use super::work::Work;
use crate::core::failure::Failure;
use crate::core::linalg::{
    Border, BorderedLu, Factors, Form, ShiftedLu, Spectrum, SpectrumRequest, balanced,
};
use crate::core::problem::{Dynamics, ZeroEquations};
use crate::core::scalar::{CHUNK, Chunk, seeded};
use faer::{MatRef, Side};

/// A function that writes `F_z(z, p)`, column by column.
pub(super) type Tabulated = Box<dyn Fn(&[f64], &[f64], &mut [f64]) + Send>;

/// The assembled `F_z`.
pub(super) enum Jacobian {
    /// The kind of matrix is not yet known: it is chosen at the first assembly.
    Unknown,
    Dense(DenseJacobian),
    Sparse(Box<SparseJacobian>),
}

impl Jacobian {
    /// The entries of the matrix, in storage order.
    pub fn entries(&self) -> &[f64] {
        match self {
            Jacobian::Unknown => &[],
            Jacobian::Dense(dense) => &dense.entries,
            Jacobian::Sparse(sparse) => sparse.entries(),
        }
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
            Jacobian::Sparse(sparse) => {
                let n = out.len().isqrt();
                out.fill(0.0);
                for (k, a) in sparse.entries().iter().enumerate() {
                    let [i, j] = sparse.place(k);
                    out[j * n + i] = *a;
                }
            }
            _ => out.copy_from_slice(self.entries()),
        }
    }

    /// Factors the matrix, or the variant of it that `form` selects, bordered by additional rows
    /// and columns.
    pub fn factor(&self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        match (form, self) {
            (Form::Antiperiodic, _) => Err(Failure::Unsupported(
                "the unknowns of a `ZeroProblem` do not describe a periodic orbit, so orbits of \
                 twice the period are not defined"
                    .into(),
            )),
            (_, Jacobian::Sparse(sparse)) => sparse.factor(form, border, into),
            (Form::Oscillation(omega), _) => {
                let lu = into.reuse(|_: &ShiftedLu| true, ShiftedLu::default);
                lu.factor(self.entries(), omega, border)
            }
            (Form::Jacobian, _) => {
                let lu = into.reuse(|_: &BorderedLu| true, BorderedLu::default);
                lu.factor(self.entries(), border)
            }
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
            Jacobian::Dense(dense) => dense.spectrum(dynamics),
            Jacobian::Sparse(sparse) => sparse.spectrum(dynamics, request),
        }
    }
}

/// A dense matrix `F_z`, stored column by column.
pub(super) struct DenseJacobian {
    entries: Vec<f64>,
    tabulated: Option<Tabulated>,
}

impl DenseJacobian {
    /// Creates a dense matrix for `n` unknowns.
    pub fn new(n: usize) -> Self {
        DenseJacobian { entries: vec![0.0; n * n], tabulated: None }
    }

    /// Creates a dense matrix for `n` unknowns, whose entries are computed by a function.
    pub fn tabulated(n: usize, function: Tabulated) -> Self {
        DenseJacobian { tabulated: Some(function), ..Self::new(n) }
    }

    /// Computes `F_z` by the problem's function, or by dual numbers if the problem has no function.
    pub fn differentiate(
        &mut self,
        chunk: &mut Work<Chunk>,
        problem: &dyn ZeroEquations,
        x: &[f64],
    ) {
        let n = self.entries.len().isqrt();
        if let Some(jacobian) = &self.tabulated {
            return jacobian(&x[..n], &x[n..], &mut self.entries);
        }
        for start in (0..n).step_by(CHUNK) {
            let r = chunk.evaluate(problem, |i| seeded(x[i], i, start));
            for (i, r) in r.iter().enumerate() {
                for (j, part) in (start..n).zip(r.eps) {
                    self.entries[j * n + i] = part;
                }
            }
        }
    }

    /// Computes all eigenvalues that decide the stability of the solution.
    fn spectrum(&self, dynamics: Dynamics) -> Result<Spectrum, Failure> {
        let n = self.entries.len().isqrt();
        let unknown = Failure::Eigenvalues("eigenvalues");
        let self_adjoint = match dynamics {
            Dynamics::Potential => true,
            Dynamics::Flow => symmetric(&self.entries, n),
            _ => false,
        };
        let mut eigenvalues: Spectrum = if self_adjoint {
            let matrix = MatRef::from_column_major_slice(&self.entries, n, n);
            let real = matrix.self_adjoint_eigenvalues(Side::Lower).map_err(|_| unknown)?;
            real.into_iter().map(|l| (l, 0.0)).collect()
        } else {
            let balanced = balanced(&self.entries, n);
            let matrix = MatRef::from_column_major_slice(&balanced, n, n);
            let found = matrix.eigenvalues().map_err(|_| unknown)?;
            found.into_iter().map(|l| (l.re, l.im)).collect()
        };
        if dynamics != Dynamics::Flow {
            eigenvalues.iter_mut().for_each(|l| l.0 = -l.0);
        }
        eigenvalues.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
        Ok(eigenvalues)
    }
}

/// Whether a matrix is exactly symmetric, as for a discretised self-adjoint operator; eigenvalues
/// of symmetric matrices are much cheaper.
fn symmetric(matrix: &[f64], n: usize) -> bool {
    (0..n).all(|j| (0..j).all(|i| matrix[j * n + i] == matrix[i * n + j]))
}
