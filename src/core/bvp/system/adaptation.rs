//! Meshes that follow the solution.

use super::carry::remesh;
use super::mesh_error::intervals_for;
use super::{BoundarySystem, MOST_INTERVALS};
use crate::core::bvp::{BoundaryError, Mesh};
use crate::core::failure::Failure;

impl BoundarySystem {
    /// The estimated error of a solution that its mesh causes: the largest of any state anywhere,
    /// in units of the state's largest value; 0 for a method without one. It is the monitor
    /// `mesh_error` as well.
    ///
    /// At the nodes, and the more so at the ends of intervals, a solution is more accurate than
    /// that.
    pub fn mesh_error(&mut self, x: &[f64]) -> f64 {
        self.plain.load(&self.equations.layout, |i| x[i]);
        self.monitors.mesh_error(&self.equations, &self.plain)
    }

    /// Redistributes the mesh so that every interval has the same share of the error, with as many
    /// intervals as before. The solution `x = (z, p)`, directions at it and the reference of the
    /// phase condition are carried over by interpolation: `x` then needs to be corrected. Of
    /// directions what follows the values at nodes is left as it is. A method whose mesh causes no
    /// error keeps it.
    ///
    /// # Errors
    /// [`Failure::OutOfDomain`] where the trajectory leaves the domain of the field; nothing is
    /// changed then.
    ///
    /// ```
    /// # use tangency::core::{bvp::*, zero::System};
    /// # use tangency::problems::classic::Decay;
    /// // x' = −rate·x, x(0) = 1.
    /// let mut system = BoundarySystem::new(Decay, Collocation::new(3)?, vec![Mesh::uniform(4)])?;
    /// // A solution that decays within a tenth.
    /// let mut x = system.sampled(&[], |_, tau, x| x[0] = (-10.0 * tau).exp());
    /// x.push(10.0);
    /// system.adapt(&mut x, &mut [])?;
    /// let points = system.meshes()[0].points();
    /// assert!(points.len() == 5 && points[1] < 0.2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn adapt(&mut self, x: &mut [f64], directions: &mut [&mut [f64]]) -> Result<(), Failure> {
        let (equations, errors) = (&self.equations, &self.monitors.mesh_error);
        if equations.method.error_constant().is_none() {
            return Ok(());
        }
        self.plain.load(&equations.layout, |i| x[i]);
        let mesh_of = |(segment, mesh): (usize, &Mesh)| {
            let density = errors.density(equations, segment, &self.plain.nodes);
            mesh.equidistributed(&density, mesh.intervals())
        };
        let meshes: Vec<Mesh> = equations.meshes.iter().enumerate().map(mesh_of).collect();
        let given = std::iter::once(&*x).chain(directions.iter().map(|d| &**d));
        let mut vectors: Vec<Vec<f64>> = given.map(<[f64]>::to_vec).collect();
        let refers = !self.phase.reference.is_empty();
        vectors.extend(refers.then(|| self.phase.reference.clone()));
        remesh(equations, &meshes, &mut vectors);
        let before = std::mem::replace(&mut self.equations.meshes, meshes);
        if refers
            && let Some(reference) = vectors.pop()
            && let Err(cause) = self.set_reference(&reference)
        {
            self.equations.meshes = before;
            self.forget();
            return Err(cause);
        }
        self.forget();
        let given = std::iter::once(x).chain(directions.iter_mut().map(|d| &mut **d));
        given.zip(&vectors).for_each(|(vector, new)| vector.copy_from_slice(new));
        Ok(())
    }

    /// The system on a mesh on which the estimated error is below a tolerance, with `x` carried
    /// over to it, which then needs to be corrected. Each segment gets as many intervals as it
    /// takes, of evenly spread error; an estimate from a coarse mesh may be too small, so the new
    /// solution's is to be looked at again.
    ///
    /// # Errors
    /// [`BoundaryError::TooFine`] if it takes more than 4096 intervals, and
    /// [`BoundaryError::Evaluation`].
    ///
    /// ```
    /// # use tangency::core::{bvp::*, zero::System};
    /// # use tangency::problems::classic::Decay;
    /// // x' = −rate·x, x(0) = 1.
    /// let mut system = BoundarySystem::new(Decay, Collocation::new(3)?, vec![Mesh::uniform(4)])?;
    /// let mut x = system.sampled(&[], |_, tau, x| x[0] = (-tau).exp());
    /// x.push(1.0);
    /// // A cubic on each of four intervals.
    /// let error = system.mesh_error(&x);
    /// assert!(error > 1e-6 && error < 1e-4);
    /// let (mut fine, x) = system.with_error(&x, 1e-6)?;
    /// assert!(fine.meshes()[0].intervals() > 4);
    /// assert!(fine.mesh_error(&x) < 1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_error(self, x: &[f64], tolerance: f64) -> Result<(Self, Vec<f64>), BoundaryError> {
        if self.equations.method.error_constant().is_none() {
            return Ok((self, x.to_vec()));
        }
        let mut before = self;
        before.plain.load(&before.equations.layout, |i| x[i]);
        let (equations, nodes) = (&before.equations, &before.plain.nodes);
        let mut meshes = Vec::new();
        for (segment, mesh) in equations.meshes.iter().enumerate() {
            let density = before.monitors.mesh_error.density(equations, segment, nodes);
            let needed = intervals_for(equations, segment, &density, tolerance).ceil();
            let most = MOST_INTERVALS;
            if needed.is_nan() || needed > most as f64 {
                return Err(BoundaryError::TooFine { segment, tolerance, needed, most });
            }
            meshes.push(mesh.equidistributed(&density, (needed as usize).max(2)));
        }
        let mut system = before.on(meshes)?;
        let carried = equations.carried(&system.equations, x)?;
        if !before.phase.reference.is_empty() {
            let reference = equations.carried(&system.equations, &before.phase.reference)?;
            system.set_reference(&reference)?;
        }
        Ok((system, carried))
    }
}
