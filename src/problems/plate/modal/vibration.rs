//! Small vibrations of a plate about an equilibrium, in the modes of the flat plate.

use super::model::{Modal, Projected};
use crate::core::failure::Failure;
use crate::core::problem::ZeroProblem;
use crate::core::scalar::Scalar;
use crate::core::system::Dense;
use crate::problems::plate::modes::{Eigenproblem, Modes, extreme};
use crate::problems::plate::tensor::dot;
use crate::problems::plate::vibration::{Lowest, Vibrates};
use nalgebra::DMatrix;

impl Modal {
    /// Returns the `count` lowest modes of vibration about an equilibrium, as coefficients of the
    /// flat plate's modes; each mode has the mean square 1 over the plate, and
    /// [`Modal::deflection`] evaluates it. For the equations of the multiplied projection, only the
    /// lowest mode of vibration is available.
    ///
    /// # Errors
    /// [`Failure::OutOfDomain`] if the equilibrium is outside the domain of the equations,
    /// [`Failure::Undetermined`] if the lowest eigenvalue of the equations of the multiplied
    /// projection is not real.
    pub fn modes(&self, z: &[f64], p: &[f64], count: usize) -> Result<Modes, Failure> {
        self.domain(z, p)?;
        let none = || {
            let reason = "the vibration frequencies are not finite and real: the point is not an \
                          equilibrium, or the number of modes is far too small";
            Failure::Undetermined(reason.into())
        };
        match &self.projected {
            Projected::Direct(_) => {
                let modes = Eigenproblem::new(self.mass(z)).solved(&self.stiffness(z, p));
                Ok(modes.ok_or_else(none)?.lowest(count))
            }
            Projected::Multiplied(_) => {
                let vectors = self.lowest(z, p).ok_or_else(none)?;
                let square = self.frequency_squared(z, p, &vectors);
                let norm = vectors.right.iter().map(|c| c * c).sum::<f64>().sqrt();
                let scale = extreme(vectors.right.iter().copied()).signum() / norm;
                let shape = vectors.right.iter().map(|c| scale * c).collect();
                let mut modes = Modes { squares: vec![square], shapes: vec![shape] };
                modes.squares.truncate(count);
                modes.shapes.truncate(count);
                Ok(modes)
            }
        }
    }

    /// Returns the model as a system whose matrix `F_z` is assembled from tables.
    pub fn into_system(self) -> Dense<Modal> {
        Dense::new(self).tabulated(Modal::assemble)
    }

    /// Computes `∂r/∂z`, stored column by column.
    fn assemble(&self, z: &[f64], p: &[f64], out: &mut [f64]) {
        let plate = self.parameters(p);
        match &self.projected {
            Projected::Direct(direct) => {
                direct.stiffness(&self.linear, z, &plate, self.on_grid(z).0, out);
            }
            Projected::Multiplied(multiplied) => {
                multiplied.stiffness(&self.linear, z, &plate, out);
            }
        }
    }
}

impl Vibrates for Modal {
    fn mass(&self, z: &[f64]) -> Vec<f64> {
        match &self.projected {
            Projected::Direct(_) => DMatrix::identity(z.len(), z.len()),
            Projected::Multiplied(multiplied) => multiplied.mass(z),
        }
        .as_slice()
        .into()
    }

    fn stiffness(&self, z: &[f64], p: &[f64]) -> Vec<f64> {
        let mut entries = vec![0.0; z.len() * z.len()];
        self.assemble(z, p, &mut entries);
        entries
    }

    fn inertia<T: Scalar>(&self, z: &[T], Lowest { left, right }: &Lowest) -> T {
        match &self.projected {
            Projected::Direct(_) => T::constant(dot(left, right)),
            Projected::Multiplied(multiplied) => multiplied.inertia(z, left, right),
        }
    }
}
