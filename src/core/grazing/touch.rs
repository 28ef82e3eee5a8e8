//! Grazing points from the orbits that touch.

use super::error::GrazingError;
use super::point::GrazingPoint;
use crate::core::bvp::{BoundarySystem, Trajectory};
use crate::core::condition::Failure;
use crate::core::hybrid::Moment;
use crate::core::orbit::{HybridOrbit, KnownOrbit, Leg};
use crate::core::solution::Solution;
use crate::core::zero::Discretised;
use std::any::Any;

impl KnownOrbit<'_> {
    /// The point at which a leg ends by an event without a speed, if it does.
    fn ending(&self, leg: usize) -> Result<Option<GrazingPoint>, GrazingError> {
        let Leg { mode, exit: Some(guard), accumulates: false } = self.legs()[leg] else {
            return Ok(None);
        };
        let (begins, durations, p) = (self.begins(0), self.lengths(), self.p());
        let last = leg + 1 == durations.len();
        // The end of the last leg is the beginning of the first one.
        let time = if last { begins } else { begins + durations[..=leg].iter().sum::<f64>() };
        let (_, x) = self.end_of(leg)?;
        if (Moment { system: self.system(), mode, t: time, x: &x, p }).has_speed(guard) {
            return Ok(None);
        }
        let mut legs: Vec<(Leg, f64)> =
            self.legs().iter().copied().zip(durations.iter().copied()).collect();
        legs.rotate_left(leg + 1);
        let returns = legs.iter().position(|(leg, _)| leg.mode == mode).unwrap_or(0);
        let later = |k: usize| (leg + 1 + k) % self.known.len();
        if (0..returns).any(|k| self.lasts(later(k))) {
            return Ok(None);
        }
        self.unmoved((mode, guard), [&x, self.known[later(returns)].start()], p)?;
        let following = legs.drain(..returns).map(|(leg, _)| leg).collect();
        let (p, periods) = (p.to_vec(), self.itinerary().periods);
        Ok(Some(GrazingPoint { guard, mode, time, x, p, following, legs, periods }))
    }

    /// The point at which the orbit touches a guard that it does not pass.
    fn touching(&self) -> Result<GrazingPoint, GrazingError> {
        let birth = self.born(0)?;
        let q = [self.p(), &birth.extras].concat();
        let born = birth.problem.known(&birth.trajectories, &q);
        // The orbit that is born ends with the touch.
        let last = born.legs().len() - 1;
        let point = born.ending(last)?.ok_or_else(|| {
            let reason =
                "the orbit comes near to a guard but does not touch it: locate the grazing (G)";
            Failure::Undetermined(reason.into())
        })?;
        Ok(point)
    }
}

impl GrazingPoint {
    /// Where an orbit touches a guard that it does not pass, or passes one without a speed: from
    /// the states at which its legs begin, and its parameters and further unknowns.
    ///
    /// # Errors
    /// [`GrazingError::Failure`] if it does neither.
    pub fn of(orbit: &HybridOrbit, starts: &[f64], q: &[f64]) -> Result<Self, GrazingError> {
        let states = |leg: usize| Trajectory::from(starts[orbit.of_leg(leg)].to_vec());
        let legs: Vec<_> = (0..orbit.legs().len()).map(states).collect();
        GrazingPoint::on(orbit.known(&legs, q))
    }

    /// The same from the motion on each leg.
    fn on(orbit: KnownOrbit) -> Result<Self, GrazingError> {
        for leg in 0..orbit.legs().len() {
            if let Some(point) = orbit.ending(leg)? {
                return Ok(point);
            }
        }
        orbit.touching()
    }

    /// The same at a special point, found by these orbits on a branch (`G`) or on a curve of
    /// grazings. The orbits take over its mesh and itinerary, and where motion is unstable, no leg
    /// is flowed from one end to the other.
    ///
    /// ```
    /// use tangency::core::bvp::{BoundarySystem, Mesh, Shooting};
    /// use tangency::core::continuation::{Continuation, Kind};
    /// use tangency::core::{grazing::GrazingPoint, hybrid::HybridSystem};
    /// use tangency::core::orbit::{HybridOrbit, Itinerary};
    /// use tangency::problems::classic::ImpactOscillator;
    /// let orbit = HybridOrbit::of(ImpactOscillator, Itinerary::smooth(ImpactOscillator::FLIGHT, 1));
    /// let mut orbits = BoundarySystem::new(orbit, Shooting::default(), vec![Mesh::uniform(1)])?;
    /// let known = ImpactOscillator.parameters().into_iter().zip(ImpactOscillator::DEFAULTS);
    /// let run = known.fold(Continuation::of(&mut orbits), |run, (name, p)| run.at(&name, p));
    /// let branch = run.along("amplitude", 0.05..=1.0).trace()?;
    /// let grazing = branch.of_kind(Kind::G).next().expect("a grazing");
    /// let point = GrazingPoint::at(&mut orbits, &branch.solution(grazing))?;
    /// // At resonance it grazes for A = 0.1, at t = π/2.
    /// assert!((point.p[0] - 0.1).abs() < 1e-8);
    /// assert!((point.time - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn at(orbits: &mut BoundarySystem, solution: &Solution) -> Result<Self, GrazingError> {
        let adopted = orbits.resume_from(solution)?;
        let z = adopted.map_or_else(|| solution.state.clone(), |adopted| adopted.z);
        let known = orbits.trajectories_of(&z, &solution.parameters);
        let problem: &dyn Any = &*known.problem;
        let problem = problem.downcast_ref::<HybridOrbit>().ok_or_else(|| {
            let reason = "the solutions are no orbits of a hybrid system";
            Failure::Unsupported(reason.into())
        })?;
        GrazingPoint::on(problem.known(&known.trajectories, &known.q))
    }
}
