//! Grazing points of periodic orbits.

use super::error::GrazingError;
use super::point::GrazingPoint;
use crate::core::bvp::{BoundarySystem, Trajectory};
use crate::core::failure::Failure;
use crate::core::orbit::{
    HybridOrbit, KnownOrbit, Leg, OrbitLegs, check_unmoved, emanating_at_touch,
};
use crate::core::system::{Solution, System};
use std::any::Any;

/// Returns the grazing point at the end of a leg (a part of an orbit between two events), if the
/// event at this end has zero approach speed.
fn ending(orbit: &KnownOrbit, leg: usize) -> Result<Option<GrazingPoint>, GrazingError> {
    let all = orbit.legs.all();
    let Leg { mode, exit: Some(guard), accumulates: false } = all[leg] else {
        return Ok(None);
    };
    // The end of the last leg is the beginning of the first one.
    let (time, p) = (orbit.begins((leg + 1) % all.len()), orbit.p());
    let (_, x) = orbit.end_of(leg)?;
    if orbit.moment(leg, time, &x).has_speed(guard) {
        return Ok(None);
    }
    let mut legs: Vec<(Leg, f64)> = (0..all.len()).map(|k| (all[k], orbit.length(k))).collect();
    legs.rotate_left(leg + 1);
    let returns = legs.iter().position(|(leg, _)| leg.mode == mode).unwrap_or(0);
    let later = |k: usize| (leg + 1 + k) % all.len();
    if (0..returns).any(|k| orbit.lasts(later(k))) {
        return Ok(None);
    }
    let states = [&x[..], orbit.known[later(returns)].start()];
    check_unmoved(orbit.legs, (mode, guard), states, p)?;
    let following = legs.drain(..returns).map(|(leg, _)| leg).collect();
    let (p, periods) = (p.to_vec(), orbit.legs.itinerary.periods);
    Ok(Some(GrazingPoint { guard, mode, time, x, p, following, legs, periods }))
}

/// Returns the point at which an orbit touches the surface of a guard without crossing it.
fn touching(orbit: &KnownOrbit) -> Result<GrazingPoint, GrazingError> {
    let guess = emanating_at_touch(orbit, 0)?;
    let q = [orbit.p(), &guess.extras].concat();
    let legs = &guess.problem;
    // The emanating orbit ends at the grazing point.
    let point =
        ending(&KnownOrbit { legs, known: &guess.trajectories, q: &q }, legs.all().len() - 1)?;
    Ok(point.ok_or_else(|| {
        let reason = "the orbit is close to a guard but does not touch the guard: locate the \
                      grazing (G) first";
        Failure::Undetermined(reason.into())
    })?)
}

impl GrazingPoint {
    /// Finds the point at which an orbit touches the surface of a guard without an event, or has an
    /// event with zero approach speed. The orbit is given by the initial states of its legs (parts
    /// between two events), its parameters and its further unknowns.
    ///
    /// # Errors
    /// [`GrazingError::Failure`] if the orbit has no such point.
    pub fn of(orbit: &HybridOrbit, starts: &[f64], q: &[f64]) -> Result<Self, GrazingError> {
        let OrbitLegs { layout, itinerary, .. } = orbit.legs();
        let states = |leg: usize| Trajectory::from(starts[layout.states(leg)].to_vec());
        let known: Vec<_> = (0..itinerary.legs.len()).map(states).collect();
        GrazingPoint::on(orbit.itineraries.known(&known, q))
    }

    /// Finds the grazing point of an orbit, given the trajectories on its legs (parts between two
    /// events).
    fn on(orbit: KnownOrbit) -> Result<Self, GrazingError> {
        for leg in 0..orbit.known.len() {
            if let Some(point) = ending(&orbit, leg)? {
                return Ok(point);
            }
        }
        touching(&orbit)
    }

    /// Finds the grazing point at a special point, labelled `G`, on a branch of orbits or on a
    /// curve of grazings. The orbits use the mesh and the itinerary of the special point. Since
    /// motion can be unstable, no leg (part of an orbit between two events) is integrated from one
    /// end to the other.
    ///
    /// ```
    /// use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
    /// use tangency::core::continuation::Continuation;
    /// use tangency::core::system::Kind;
    /// use tangency::core::hybrid::HybridSystem;
    /// use tangency::core::local_map::GrazingPoint;
    /// use tangency::core::orbit::{HybridOrbit, Itinerary};
    /// use tangency::problems::classic::ImpactOscillator;
    /// let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1))?;
    /// let mut orbits = BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)])?;
    /// let known = ImpactOscillator.parameters().into_iter().zip(ImpactOscillator::DEFAULTS);
    /// let run = known.fold(Continuation::new(&mut orbits), |run, (name, p)| run.at(&name, p));
    /// let branch = run.along("amplitude", 0.05..=1.0).trace()?;
    /// let grazing = branch.of_kind(Kind::G).next().expect("a grazing");
    /// let point = GrazingPoint::at(&mut orbits, &branch.solution(grazing))?;
    /// // At resonance the orbit grazes for A = 0.1, at t = π/2.
    /// assert!((point.p[0] - 0.1).abs() < 1e-8);
    /// assert!((point.time - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As for [`of`](Self::of).
    pub fn at(orbits: &mut BoundarySystem, solution: &Solution) -> Result<Self, GrazingError> {
        let adopted = (orbits as &mut dyn System).resume_from(solution)?;
        let known = orbits.trajectories_of(&adopted.z, &solution.parameters);
        let problem: &dyn Any = &*known.problem;
        let problem = problem.downcast_ref::<HybridOrbit>().ok_or_else(|| {
            let reason = "the solutions are not orbits of a hybrid system, so they have no grazing \
                          points";
            Failure::Unsupported(reason.into())
        })?;
        GrazingPoint::on(problem.itineraries.known(&known.trajectories, &known.q))
    }
}
