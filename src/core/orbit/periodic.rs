//! Periodic orbits of vector fields.

use super::measures::on_segments;
use crate::core::bvp::{
    BoundaryError, BoundaryProblem, BoundarySystem, Mesh, Method, Monitor, Shape,
};
use crate::core::failure::OutOfDomain;
use crate::core::problem::{Measure, Names, Observable, VectorField};
use crate::core::scalar::Scalar;

/// The periodic orbits of a vector field, as a boundary-value problem with one segment:
///
/// ```text
///     x' = f(t, x, p),    x(0) − x(L) = 0,    L = q T(p)
/// ```
///
/// The number of forcing periods is `q`. In a system without forcing, the period `L` is an unknown,
/// determined by a phase condition.
///
/// ```
/// use tangency::core::bvp::{BoundarySystem, Collocation, Mesh};
/// use tangency::core::orbit::PeriodicOrbit;
/// use tangency::core::system::System;
/// use tangency::problems::classic::Lure;
/// let meshes = vec![Mesh::uniform(20)];
/// let orbits = BoundarySystem::new(PeriodicOrbit::new(Lure, 1), Collocation::new(4)?, meshes)?;
/// // Three states at 81 nodes, and the period.
/// assert_eq!(orbits.names().dimension(), 3 * 81 + 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PeriodicOrbit<F> {
    field: F,
    periods: usize,
    names: Names,
    forced: bool,
}

impl<F: VectorField> PeriodicOrbit<F> {
    /// Creates the problem of periodic orbits over a number of forcing periods.
    pub fn new(field: F, periods: usize) -> Self {
        let (names, forced) = (field.names(), field.forcing().is_periodic());
        PeriodicOrbit { field, periods, names, forced }
    }

    /// Returns the parameters in the vector of parameters and extra unknowns.
    fn own<'q, T>(&self, q: &'q [T]) -> &'q [T] {
        &q[..self.names.parameters.len()]
    }
}

impl<F: VectorField> BoundaryProblem for PeriodicOrbit<F> {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![self.names.elements().collect()]
    }

    fn parameters(&self) -> Vec<String> {
        self.names.parameters.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.field.defaults()
    }

    fn extras(&self) -> Vec<String> {
        if self.forced { Vec::new() } else { vec!["period".into()] }
    }

    #[inline]
    fn field<T: Scalar>(&self, _segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        self.field.field(t, x, self.own(q), f);
    }

    fn duration<T: Scalar>(&self, _segment: usize, q: &[T]) -> T {
        match self.forced {
            true => self.field.period(self.own(q)) * self.periods as f64,
            false => q[q.len() - 1],
        }
    }

    fn shape(&self) -> Shape {
        Shape::Periodic { phase: !self.forced }
    }

    fn watch<T: Scalar>(&self, monitor: usize, _segment: usize, t: T, x: &[T], q: &[T]) -> T {
        self.field.monitor(monitor, t, x, self.own(q))
    }

    fn scales(&self, _segment: usize, q: &[f64]) -> Vec<f64> {
        self.field.scales(self.own(q))
    }

    /// Returns the monitors: the period, and the measures that are defined for motion without
    /// events.
    fn monitors(&self) -> Vec<(String, Monitor)> {
        let scalar = |name: &String| {
            let monitor = || self.names.monitor(name).map(Observable::Function);
            on_segments([self.names.unknown(name).map(Observable::State).or_else(monitor)])
        };
        let measures = self.field.measures().into_iter();
        let measures = measures.filter(|(_, measure)| !matches!(measure, Measure::Ends(_)));
        let known = measures.map(|(name, measure)| (name, measure.map(scalar)));
        std::iter::once(("period".into(), Monitor::Duration)).chain(known).collect()
    }

    fn domain(&self, _segment: usize, x: &[f64], q: &[f64]) -> Result<(), OutOfDomain> {
        self.field.domain(x, self.own(q))
    }
}

/// Creates the system of equations for periodic orbits of a vector field over one forcing period,
/// with a given number of mesh intervals.
///
/// ```
/// use tangency::core::bvp::{Collocation, Shooting};
/// use tangency::core::continuation::Continuation;
/// use tangency::core::system::{Dense, Kind};
/// use tangency::core::orbit::periodic_orbits;
/// use tangency::core::problem::Equilibria;
/// use tangency::problems::{classic::Lure, mita::Block};
/// // A Hopf point of the equilibrium 0 …
/// let mut rest = Dense::new(Equilibria::new(Lure));
/// let branch = Continuation::new(&mut rest)
///     .at("alpha", 1.2)
///     .at("beta", 1.0)
///     .along("alpha", 0.5..=1.5)
///     .trace()?;
/// let hopf = branch.of_kind(Kind::HB).next().unwrap().label;
/// // … and the emanating orbits, up to their period doubling.
/// let mut orbits = periodic_orbits(Lure, 20, Collocation::new(4)?)?;
/// let branch =
///     Continuation::new(&mut orbits).restart(&branch, hopf).along("alpha", 0.6..=1.5).trace()?;
/// let doubling = branch.of_kind(Kind::PD).next().unwrap();
/// assert!((doubling.parameters[0] - 0.630302006160).abs() < 1e-9);
/// assert!((doubling.monitors[0] - 6.3640713394).abs() < 1e-9);
/// // The forced block, from near rest to the fold of its vibrations.
/// let mut orbits = periodic_orbits(Block, 1, Shooting::default())?;
/// let branch = Continuation::new(&mut orbits)
///     .at("voltage", 0.01)
///     .at("frequency", 0.45)
///     .at("damping", 0.04)
///     .along("voltage", 0.01..=0.5)
///     .bound("max_displacement", 0.0..=0.5)
///     .trace()?;
/// let fold = branch.of_kind(Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] - 0.235565433583).abs() < 1e-11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`BoundaryError`] if the vector field has no states, or if the number of mesh intervals is 0.
pub fn periodic_orbits(
    field: impl VectorField + 'static,
    intervals: usize,
    method: impl Into<Method>,
) -> Result<BoundarySystem, BoundaryError> {
    if intervals == 0 {
        return Err(BoundaryError::NoIntervals(0));
    }
    BoundarySystem::new(PeriodicOrbit::new(field, 1), method, vec![Mesh::uniform(intervals)])
}
