//! Small vibrations about an equilibrium, in the modes of the flat plate.

use super::{Modal, Projected};
use crate::core::scalar::Scalar;
use crate::core::zero::{LeftDomain, ZeroProblem};
use crate::problems::plate::modes::{Modes, extreme};
use crate::problems::plate::tensor::dot;
use crate::problems::plate::vibration::{Lowest, Vibrates, lowest_general, lowest_symmetric};
use faer::{Mat, Side};
use nalgebra::DMatrix;

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
}

impl Vibrates for Modal {
    fn lowest(&self, z: &[f64], p: &[f64]) -> Option<Lowest> {
        let stiffness = self.stiffness(z, p);
        match &self.projected {
            Projected::Direct(_) => {
                let mass = DMatrix::identity(z.len(), z.len());
                lowest_symmetric(&stiffness, &mass, self.linear.squares[0])
            }
            Projected::Multiplied(multiplied) => lowest_general(&stiffness, &multiplied.mass(z)),
        }
    }

    fn inertia<T: Scalar>(&self, z: &[T], Lowest { left, right }: &Lowest) -> T {
        match &self.projected {
            Projected::Direct(_) => T::constant(dot(left, right)),
            Projected::Multiplied(multiplied) => multiplied.inertia(z, left, right),
        }
    }
}

/// The sign that makes the largest coefficient positive.
fn positive(mut shape: Vec<f64>) -> Vec<f64> {
    let sign = extreme(shape.iter().copied()).signum();
    shape.iter_mut().for_each(|c| *c *= sign);
    shape
}
