//! Periodic orbits as boundary-value problems.

use crate::core::bvp::{
    BoundaryError, BoundaryProblem, BoundarySystem, Collocation, Ends, Mesh, Method, Monitor,
    Return, Shooting,
};
use crate::core::field::{VectorField, extremes};
use crate::core::scalar::Scalar;
use crate::core::zero::LeftDomain;

/// The periodic orbits of a vector field. Monitors: `period`, and `max_x` and `min_x` of each state `x`, the
/// extremes of the orbit and not of a mesh.
///
/// ```
/// use tangency::core::bvp::BoundaryProblem;
/// use tangency::core::orbit::Orbit;
/// use tangency::problems::{classic::Lure, mita::Block};
/// // The period of an autonomous field is an unknown, and a phase condition goes with it.
/// assert_eq!(Orbit::of(Lure).extras(), ["period"]);
/// assert!(Orbit::of(Lure).phase() && !Orbit::of(Block).phase());
/// ```
#[derive(Clone, Debug)]
pub struct Orbit<F> {
    field: F,
    states: Vec<String>,
    parameters: Vec<String>,
    forced: bool,
}

impl<F: VectorField> Orbit<F> {
    /// The periodic orbits of a field.
    pub fn of(field: F) -> Self {
        let names = field.names();
        let forced = field.forcing().is_periodic();
        let states = names.unknowns.into_iter().map(|state| state.name).collect();
        Orbit { field, states, parameters: names.parameters, forced }
    }

    /// The field itself.
    pub fn vector_field(&self) -> &F {
        &self.field
    }
}

impl<F: VectorField> BoundaryProblem for Orbit<F> {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![self.states.clone()]
    }

    fn parameters(&self) -> Vec<String> {
        self.parameters.clone()
    }

    fn extras(&self) -> Vec<String> {
        if self.forced { Vec::new() } else { vec!["period".into()] }
    }

    fn field<T: Scalar>(&self, _segment: usize, t: T, x: &[T], q: &[T], f: &mut [T]) {
        self.field.field(t, x, &q[..self.parameters.len()], f);
    }

    fn duration<T: Scalar>(&self, _segment: usize, q: &[T]) -> T {
        let (p, extras) = q.split_at(self.parameters.len());
        match extras {
            [period] => *period,
            _ => self.field.period(p),
        }
    }

    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        for (b, (start, end)) in b.iter_mut().zip(ends.start.iter().zip(ends.end)) {
            *b = *start - *end;
        }
    }

    fn phase(&self) -> bool {
        !self.forced
    }

    fn returns(&self) -> Vec<Return> {
        Return::of_states(self.states.len())
    }

    fn monitors(&self) -> Vec<(String, Monitor)> {
        let extreme = |(k, name): (usize, String)| match k % 2 {
            0 => (name, Monitor::maximum(0, k / 2)),
            _ => (name, Monitor::minimum(0, k / 2)),
        };
        let period = ("period".to_string(), Monitor::Duration);
        std::iter::once(period)
            .chain(extremes(&self.states).into_iter().enumerate().map(extreme))
            .collect()
    }

    fn scales(&self, _segment: usize, q: &[f64]) -> Vec<f64> {
        self.field.scales(&q[..self.parameters.len()])
    }

    fn domain(&self, _segment: usize, x: &[f64], q: &[f64]) -> Result<(), LeftDomain> {
        self.field.domain(x, &q[..self.parameters.len()])
    }
}

/// Periodic orbits by collocation on a number of intervals.
///
/// ```
/// use tangency::core::bvp::Collocation;
/// use tangency::core::continuation::{Continuation, Kind};
/// use tangency::core::{dense::Dense, field::Equilibria, orbit::by_collocation};
/// use tangency::problems::classic::Lure;
/// // A Hopf point of the equilibrium 0 …
/// let mut rest = Dense::new(Equilibria(Lure));
/// let branch = Continuation::of(&mut rest)
///     .at("alpha", 1.2)
///     .at("beta", 1.0)
///     .along("alpha", 0.5..=1.5)
///     .trace()?;
/// let hopf = branch.of_kind(Kind::HB).next().unwrap().label;
/// // … and the orbits that are born there, until they double their period.
/// let mut orbits = by_collocation(Lure, 20, Collocation::new(4)?)?;
/// let branch =
///     Continuation::of(&mut orbits).restart(&branch, hopf).along("alpha", 0.6..=1.5).trace()?;
/// let doubling = branch.of_kind(Kind::PD).next().unwrap();
/// assert!((doubling.parameters[0] - 0.630302006160).abs() < 1e-9);
/// assert!((doubling.monitors[0] - 6.3640713394).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`BoundaryError`] if the field has no states, or there is no interval.
pub fn by_collocation<F: VectorField + 'static>(
    field: F,
    intervals: usize,
    method: Collocation,
) -> Result<BoundarySystem<Collocation>, BoundaryError> {
    discretised(field, intervals, method)
}

/// Periodic orbits by multiple shooting over a number of segments.
///
/// ```
/// use tangency::core::bvp::Shooting;
/// use tangency::core::continuation::{Continuation, Kind};
/// use tangency::core::orbit::by_shooting;
/// use tangency::problems::mita::Block;
/// // The forced block, from near rest to the fold of its vibrations.
/// let mut orbits = by_shooting(Block, 1, Shooting::default())?;
/// let branch = Continuation::of(&mut orbits)
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
/// [`BoundaryError`] if the field has no states, or there is no segment.
pub fn by_shooting<F: VectorField + 'static>(
    field: F,
    segments: usize,
    method: Shooting,
) -> Result<BoundarySystem<Shooting>, BoundaryError> {
    discretised(field, segments, method)
}

fn discretised<F: VectorField + 'static, M: Method>(
    field: F,
    intervals: usize,
    method: M,
) -> Result<BoundarySystem<M>, BoundaryError> {
    if intervals == 0 {
        return Err(BoundaryError::NoIntervals { segment: 0 });
    }
    BoundarySystem::new(Orbit::of(field), method, vec![Mesh::uniform(intervals)])
}
