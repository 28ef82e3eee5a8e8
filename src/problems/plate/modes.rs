//! Computes natural modes about an equilibrium: all solutions of `K v = ω² M v` with symmetric
//! matrices `K` and `M`.
//!
//! In a polynomial basis of high order the mass matrix is singular to working precision (its
//! condition number is 1e11 for 10 functions, 6e14 for 18), but `K + σM` is regular. Therefore the
//! equivalent problem `M v = μ (K + σM) v` with `ω² = 1/μ − σ` is solved.

use crate::core::scalar::Scalar;
use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::{MatMut, MatRef, Par};

/// The natural frequencies and modes of a plate, the lowest frequency first.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// The squares `ω²` of the dimensionless frequencies `ω a²√(ρh/D)`; a square is negative if the
    /// equilibrium is unstable.
    pub squares: Vec<f64>,
    /// The coefficients of the modes of vibration; each mode has the mean square 1 over the plate.
    pub shapes: Vec<Vec<f64>>,
}

impl Modes {
    /// Returns the frequencies `ω` of the modes, with the value `−√(−ω²)` for unstable modes.
    pub fn frequencies(&self) -> Vec<f64> {
        self.squares.iter().map(|square| signed_root(*square)).collect()
    }
}

/// Returns `ω` if `ω² ≥ 0`, otherwise `−√(−ω²)`, which is the negative of the growth rate of an
/// unstable plate.
pub(super) fn signed_root<T: Scalar>(square: T) -> T {
    if square.real() < 0.0 { -(-square).sqrt() } else { square.sqrt() }
}

/// Returns the entry of largest modulus; 0 if the list is empty.
pub(super) fn extreme(entries: impl Iterator<Item = f64>) -> f64 {
    entries.fold(0.0, |most, entry| if entry.abs() > most.abs() { entry } else { most })
}

/// The mass matrix, and the workspace of the eigenproblem `K v = ω² M v`.
pub(super) struct Eigenproblem {
    mass: Vec<f64>,
    factor: Vec<f64>,
    reduced: Vec<f64>,
    /// `μ`, ascending.
    values: Vec<f64>,
    /// The eigenvectors of all modes, stored column by column, in the order of the eigenvalues in
    /// `values`.
    vectors: Vec<f64>,
    shift: f64,
    scratch: MemBuffer,
}

impl Eigenproblem {
    /// Creates the workspace for the eigenproblem with a given symmetric mass matrix, which is
    /// stored column by column.
    pub fn new(mass: Vec<f64>) -> Eigenproblem {
        let n = mass.len().isqrt();
        let need = StackReq::any_of(&[
            cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default()),
            self_adjoint_evd_scratch::<f64>(
                n,
                ComputeEigenvectors::Yes,
                Par::Seq,
                Default::default(),
            ),
        ]);
        Eigenproblem {
            mass,
            factor: vec![0.0; n * n],
            reduced: vec![0.0; n * n],
            values: vec![0.0; n],
            vectors: vec![0.0; n * n],
            shift: 1.0,
            scratch: MemBuffer::new(need),
        }
    }

    /// Solves the eigenproblem for all modes with a given stiffness matrix; returns `None` if the
    /// matrix is not finite.
    pub fn solved(mut self, stiffness: &[f64]) -> Option<Eigenproblem> {
        self.solve(stiffness).then_some(self)
    }

    /// Solves the eigenproblem for all modes with a given stiffness matrix, which is stored column
    /// by column; returns `false` if the matrix is not finite.
    #[must_use]
    pub fn solve(&mut self, stiffness: &[f64]) -> bool {
        let n = self.values.len();
        if !self.factor_shifted(stiffness) {
            return false;
        }
        let lower = MatRef::from_column_major_slice(&self.factor, n, n);
        self.reduced.copy_from_slice(&self.mass);
        let mut reduced = MatMut::from_column_major_slice_mut(&mut self.reduced, n, n);
        solve_lower_triangular_in_place(lower, reduced.as_mut(), Par::Seq);
        solve_lower_triangular_in_place(lower, reduced.as_mut().transpose_mut(), Par::Seq);
        let done = self_adjoint_evd(
            reduced.as_ref(),
            DiagMut::from_slice_mut(&mut self.values),
            Some(MatMut::from_column_major_slice_mut(&mut self.vectors, n, n)),
            Par::Seq,
            MemStack::new(&mut self.scratch),
            Default::default(),
        );
        let vectors = MatMut::from_column_major_slice_mut(&mut self.vectors, n, n);
        solve_upper_triangular_in_place(lower.transpose(), vectors, Par::Seq);
        done.is_ok()
    }

    /// Returns the squared frequency `ω²` of a mode; mode 0 has the lowest frequency.
    pub fn square(&self, mode: usize) -> f64 {
        1.0 / self.values[self.values.len() - 1 - mode] - self.shift
    }

    /// Writes the coefficients of a mode, with mean square 1 over the plate, into `out`. The sign
    /// of the mode is chosen such that its coefficient of largest modulus is positive.
    pub fn shape(&self, mode: usize, out: &mut [f64]) {
        let n = self.values.len();
        let column = n - 1 - mode;
        out.copy_from_slice(&self.vectors[column * n..(column + 1) * n]);
        let scale = extreme(out.iter().copied()).signum() / self.values[column].sqrt();
        out.iter_mut().for_each(|entry| *entry *= scale);
    }

    /// Returns the `count` modes of vibration with the lowest frequencies.
    pub fn lowest(&self, count: usize) -> Modes {
        let n = self.values.len();
        let modes = 0..count.min(n);
        let shape = |mode| {
            let mut shape = vec![0.0; n];
            self.shape(mode, &mut shape);
            shape
        };
        Modes {
            squares: modes.clone().map(|mode| self.square(mode)).collect(),
            shapes: modes.map(shape).collect(),
        }
    }

    /// Factors `K + σM` with the smallest shift `σ`, among a list of increasing shifts, for which
    /// the matrix is positive definite.
    fn factor_shifted(&mut self, stiffness: &[f64]) -> bool {
        let n = self.values.len();
        self.shift = 100.0;
        while self.shift < 1e12 {
            for ((out, k), m) in self.factor.iter_mut().zip(stiffness).zip(&self.mass) {
                *out = k + self.shift * m;
            }
            let matrix = MatMut::from_column_major_slice_mut(&mut self.factor, n, n);
            let stack = MemStack::new(&mut self.scratch);
            let params = Default::default();
            if cholesky_in_place(matrix, Default::default(), Par::Seq, stack, params).is_ok() {
                return true;
            }
            self.shift *= 8.0;
        }
        false
    }
}
