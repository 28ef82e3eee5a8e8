//! Small vibrations about an equilibrium, in the modes of the flat plate.

use super::{Modal, Projected};
use crate::core::scalar::Scalar;
use crate::core::zero::{LeftDomain, ZeroProblem};
use crate::problems::plate::Modes;
use crate::problems::plate::sine::vibration::{self, Lowest};
use faer::{Mat, Side};
use nalgebra::{Cholesky, DMatrix, DVector, LU};

impl Modal {
    /// The `count` lowest modes of vibration about an equilibrium, as coefficients of the flat modes with
    /// mean square 1 over the plate ([`Modal::deflection`] evaluates them). The multiplied equations
    /// tell the lowest one alone.
    ///
    /// # Errors
    /// [`LeftDomain`] where the equations have no meaning, or the lowest eigenvalue of the multiplied
    /// equations is not real.
    pub fn modes(&self, z: &[f64], p: &[f64], count: usize) -> Result<Modes, LeftDomain> {
        self.domain(z, p)?;
        let none = || {
            let remedy = "it must be finite and real; the point is no equilibrium, or far too few modes \
                          describe it";
            LeftDomain::new("frequency", f64::NAN, remedy)
        };
        match &self.projected {
            Projected::Direct(_) => {
                let stiffness = self.stiffness(z, p);
                let n = z.len();
                let matrix = Mat::from_fn(n, n, |i, k| stiffness[(i, k)]);
                let eigen = matrix.self_adjoint_eigen(Side::Lower).map_err(|_| none())?;
                let lowest = 0..count.min(n);
                Ok(Modes {
                    squares: lowest.clone().map(|mode| eigen.S()[mode]).collect(),
                    shapes: lowest
                        .map(|mode| positive((0..n).map(|i| eigen.U()[(i, mode)]).collect()))
                        .collect(),
                })
            }
            Projected::Multiplied(_) => {
                let vectors = self.lowest(z, p).ok_or_else(none)?;
                let square = self.frequency_squared(z, p, &vectors);
                let norm = vectors.right.iter().map(|c| c * c).sum::<f64>().sqrt();
                let shape = positive(vectors.right.iter().map(|c| c / norm).collect());
                let mut modes = Modes { squares: vec![square], shapes: vec![shape] };
                modes.squares.truncate(count);
                modes.shapes.truncate(count);
                Ok(modes)
            }
        }
    }

    /// The lowest `ω`, `−√(−ω²)` where unstable, in the arithmetic of `z` and `p`; `reals` are their real
    /// parts. Not a number where there is none.
    pub(super) fn frequency<T: Scalar>(&self, z: &[T], p: &[T], reals: [&[f64]; 2]) -> T {
        match self.lowest(reals[0], reals[1]) {
            Some(vectors) => vibration::signed_root(self.frequency_squared(z, p, &vectors)),
            None => T::constant(f64::NAN),
        }
    }

    fn stiffness(&self, z: &[f64], p: &[f64]) -> DMatrix<f64> {
        let mut entries = vec![0.0; z.len() * z.len()];
        self.assemble(z, p, &mut entries);
        DMatrix::from_vec(z.len(), z.len(), entries)
    }

    /// `∂r/∂z`, one column after the other.
    pub(super) fn assemble(&self, z: &[f64], p: &[f64], out: &mut [f64]) {
        let plate = self.parameters(p);
        match &self.projected {
            Projected::Direct(direct) => {
                direct.stiffness(&self.linear, z, &plate, self.grid.largest(z).0, out);
            }
            Projected::Multiplied(multiplied) => {
                multiplied.stiffness(&self.linear, z, &plate, out);
            }
        }
    }

    /// The eigenvectors of the lowest eigenvalue of the linearised motion.
    fn lowest(&self, z: &[f64], p: &[f64]) -> Option<Lowest> {
        let stiffness = self.stiffness(z, p);
        match &self.projected {
            Projected::Direct(_) => {
                let mass = DMatrix::identity(z.len(), z.len());
                vibration::lowest_symmetric(&stiffness, &mass, self.linear.squares[0])
            }
            Projected::Multiplied(multiplied) => lowest_general(&stiffness, &multiplied.mass(z)),
        }
    }

    /// Rayleigh's quotient for `ω²` between two eigenvectors: stationary, so that its first derivatives
    /// are those of the eigenvalue.
    pub(super) fn frequency_squared<T: Scalar>(&self, z: &[T], p: &[T], vectors: &Lowest) -> T {
        let stiffness = vibration::product(z, vectors, |z, r| {
            let p: Vec<_> = p.iter().map(|&value| num_dual::Dual::from_re(value)).collect();
            self.residual(z, &p, r);
        });
        stiffness
            / match &self.projected {
                Projected::Direct(_) => {
                    let products = vectors.left.iter().zip(&vectors.right);
                    T::constant(products.map(|(l, r)| l * r).sum())
                }
                Projected::Multiplied(multiplied) => {
                    multiplied.inertia(z, &vectors.left, &vectors.right)
                }
            }
    }
}

/// Left and right eigenvectors of the `ω²` of smallest real part of `J v = ω² M v`, `J` any matrix. `None` if
/// the matrices are not finite or that `ω²` is not real.
fn lowest_general(stiffness: &DMatrix<f64>, mass: &DMatrix<f64>) -> Option<Lowest> {
    let n = mass.nrows();
    let reduced = Cholesky::new(mass.clone())?.solve(stiffness);
    if reduced.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let eigenvalues = Mat::from_fn(n, n, |i, k| reduced[(i, k)]).eigenvalues().ok()?;
    let lowest = eigenvalues.iter().min_by(|a, b| a.re.total_cmp(&b.re))?;
    if lowest.im.abs() > 1e-8 * lowest.re.abs() {
        return None;
    }
    // Off the eigenvalue by a little, so that the matrix of inverse iteration has an inverse.
    let shifted = stiffness - mass * (lowest.re - 1e-9 * (1.0 + lowest.re.abs()));
    let iterate = |matrix: DMatrix<f64>| -> Option<Vec<f64>> {
        let factor = LU::new(matrix);
        // No symmetry that the vector sought might lack.
        let mut vector = DVector::from_fn(n, |i, _| 1.0 / (1.0 + i as f64));
        for _ in 0..4 {
            vector = factor.solve(&(mass * vector))?.normalize();
        }
        Some(vector.as_slice().to_vec())
    };
    Some(Lowest { left: iterate(shifted.transpose())?, right: iterate(shifted)? })
}

/// The sign that makes the largest coefficient positive.
fn positive(mut shape: Vec<f64>) -> Vec<f64> {
    let largest = shape.iter().fold(0.0_f64, |m, c| if c.abs() > m.abs() { *c } else { m });
    shape.iter_mut().for_each(|c| *c *= largest.signum());
    shape
}
