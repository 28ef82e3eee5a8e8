//! The start of a scene's first run, at the states of a request or at the attractor to which a
//! simulation converges.

use super::discretisation::{SOLUTION, Solution};
use super::error::SceneError;
use super::problem::LUMPED;
use super::request::Request;
use super::simulate::{Simulated, moved, search, searched, stated};
use super::statement::{Run, Scene, Start};
use crate::core::attractor::CycleSearchError;
use crate::core::hybrid::{HybridEquations, HybridFlow, HybridState, time_scale};
use crate::core::problem::Forcing;

/// The default duration of the simulation with which a start of a branch is searched, if no
/// equilibrium is found near the given states.
const SETTLE: f64 = 500.0;

/// The maximum duration of a simulation that precedes a branch.
const LONGEST: f64 = 1e9;

/// A state counts as an equilibrium if its rate of change, relative to the size of the states, is
/// at most this value.
const AT_REST: f64 = 1e-6;

/// Sets the start of the first run of a scene: if the request demands a simulation, the attractor
/// to which the simulation converges; otherwise the given states. If `free` is true, the kind of
/// solution found at the start decides whether equilibria or orbits are traced.
pub(super) fn begin(scene: &mut Scene, request: &Request, free: bool) -> Result<(), SceneError> {
    scene.observe_scales(&request.state);
    let start = FirstStart { scene, request, free }.find()?;
    if let [run, ..] = &mut scene.runs[..] {
        run.start = start;
    }
    Ok(())
}

/// The search for the start of the first run of a scene.
struct FirstStart<'a> {
    /// The scene; the search may change the kind of solutions that its problem traces.
    scene: &'a mut Scene,
    request: &'a Request,
    /// Whether the kind of solution found at the start decides whether equilibria or orbits are
    /// traced.
    free: bool,
}

impl FirstStart<'_> {
    /// Finds the start.
    fn find(&mut self) -> Result<Start, SceneError> {
        check_settle(self.request.settle)?;
        let Ok(motion) = self.scene.problem.model().motion() else { return self.without_motion() };
        let smooth = motion.guards().is_empty() && motion.forcing() == Forcing::None;
        if self.request.start.is_some() {
            let stated = self.request.set.iter().any(|(name, _)| name == SOLUTION);
            if self.free && smooth && !stated {
                self.scene.problem.follow(Solution::Equilibrium);
            }
            return Ok(self.guess());
        }
        if smooth { self.of_autonomous(&*motion) } else { self.of_forced_or_hybrid(&*motion) }
    }

    /// Returns the start at the given states, or at rest if no states are given.
    fn guess(&self) -> Start {
        match self.request.state.is_empty() {
            true => Start::Rest,
            false => Start::Guess(self.request.state.clone()),
        }
    }

    /// Returns the start at the attractor of a simulation from the given states.
    fn simulated(&self, transient: f64) -> Start {
        let state = self.request.state.clone();
        Start::Simulated(Simulated { state, transient, ..Simulated::default() })
    }

    /// Returns the start at the attractor of a simulation with the requested duration, or with the
    /// default duration if the request states no duration.
    fn attractor(&self, motion: &dyn HybridEquations) -> Start {
        let usual = || Simulated::default().transient * self.unit(motion);
        self.simulated(self.request.settle.unwrap_or_else(usual))
    }

    /// Returns the time scale of a motion, in the unit of the times of simulations.
    fn unit(&self, motion: &dyn HybridEquations) -> f64 {
        match self.scene.values() {
            Ok(p) if motion.forcing() == Forcing::None => {
                time_scale(motion, &p) / motion.period(&p)
            }
            _ => 1.0,
        }
    }

    /// Returns the kind of solutions that the first run traces.
    fn solution(&self) -> Option<Solution> {
        let set = self.scene.runs.first().map_or(&[][..], |run| &run.set);
        let of_run = set.iter().rfind(|(name, _)| name == SOLUTION);
        let stated = of_run.and_then(|(_, value)| ron::from_str(value).ok());
        stated.or(self.scene.problem.solution())
    }

    /// Returns the start for a problem without a motion; among these problems, only maps can be
    /// iterated to an attractor.
    fn without_motion(&self) -> Result<Start, SceneError> {
        let model = self.scene.problem.model();
        match self.request.settle {
            Some(time) if model.kind() == "a map" => Ok(self.simulated(time)),
            Some(_) => {
                Err(model
                    .lacks("only systems with dynamics can be simulated to an attractor", LUMPED))
            }
            None => Ok(self.guess()),
        }
    }

    /// Returns the start for a motion with forcing or events: the given states if a branch of
    /// equilibria starts at these states, and otherwise the attractor of a simulation.
    fn of_forced_or_hybrid(&self, motion: &dyn HybridEquations) -> Result<Start, SceneError> {
        let (guess, attractor) = (self.guess(), self.attractor(motion));
        if self.request.settle.is_some() || self.solution() != Some(Solution::Equilibrium) {
            return Ok(attractor);
        }
        let Some(near) = self.refusal(&guess)? else { return Ok(guess) };
        match self.refusal(&attractor) {
            Ok(None) => Ok(attractor),
            Ok(Some(cause)) | Err(cause) => Err(no_start(near, cause)),
        }
    }

    /// Returns the start for a motion without forcing and events: the given states if a branch of
    /// equilibria starts at these states, and otherwise the attractor of a simulation.
    fn of_autonomous(&mut self, motion: &dyn HybridEquations) -> Result<Start, SceneError> {
        // The scene already states which kind of solutions it traces.
        if !self.free && self.solution() == Some(Solution::Orbit) {
            return Ok(self.attractor(motion));
        }
        self.scene.problem.follow(Solution::Equilibrium);
        if let Some(duration) = self.request.settle {
            return self.settled(duration, motion);
        }
        let guess = self.guess();
        match self.refusal(&guess)? {
            None => Ok(guess),
            // The first error explains possible later ones.
            Some(near) => self.settled(SETTLE, motion).map_err(|cause| no_start(near, cause)),
        }
    }

    /// Returns the equilibrium to which the motion converges; if the motion does not converge to an
    /// equilibrium, returns a start on the orbit to which a simulation will converge.
    fn settled(
        &mut self,
        duration: f64,
        motion: &dyn HybridEquations,
    ) -> Result<Start, SceneError> {
        if let Some(states) = self.equilibrium(duration, motion)? {
            let names = motion.modes().swap_remove(0).states;
            return Ok(Start::Guess(names.into_iter().zip(states).collect()));
        }
        self.scene.problem.follow(Solution::Orbit);
        Ok(self.simulated(duration))
    }

    /// Returns the states of the equilibrium to which the motion converges from the given states;
    /// `None` if the motion does not converge to an equilibrium.
    fn equilibrium(
        &self,
        duration: f64,
        motion: &dyn HybridEquations,
    ) -> Result<Option<Vec<f64>>, SceneError> {
        let (p, cancel) = (self.scene.values()?, &self.scene.settings.cancel);
        let began = Simulated { state: self.request.state.clone(), ..Simulated::default() };
        let began = began.from(&self.scene.problem.initial(&p));
        let start = stated(&motion.modes()[0], &began.state)?;
        let settle_down = |settings| {
            let mut flow = HybridFlow::new(motion, settings)?;
            let mut state = flow.initial(start.clone(), &p);
            flow.advance(&mut state, duration, &p, &mut ()).map(|_| state)
        };
        let failed = |cause| SceneError::of_run("the start", cause);
        let state = moved(cancel, settle_down).map_err(failed)?;
        let mut rates = vec![0.0; state.x.len()];
        motion.field(0, state.time, &state.x, &p, &mut rates);
        let rests = |(rate, x): (&f64, &f64)| rate.abs() <= AT_REST * (1.0 + x.abs());
        if rates.iter().zip(&state.x).all(rests) {
            return Ok(Some(state.x));
        }
        // The motion may approach an equilibrium slowly.
        let begun = HybridState { mode: 0, time: state.time, x: state.x };
        let search = search(motion, &Simulated { transient: 0.0, ..Simulated::default() }, &p);
        match searched(motion, &begun, &search, (&p, cancel)) {
            Err(CycleSearchError::Equilibrium { states, .. }) => Ok(Some(states)),
            _ => Ok(None),
        }
    }

    /// Returns the reason why no branch starts from a guess of the unknowns, or `None` if a branch
    /// starts from the guess.
    ///
    /// # Errors
    /// [`SceneError`] for an error that would also occur with every other start.
    fn refusal(&self, start: &Start) -> Result<Option<SceneError>, SceneError> {
        let Some(run) = self.scene.runs.first() else { return Ok(None) };
        let run = Run { start: start.clone(), ..run.clone() };
        match self.scene.resolved(&run)?.begins() {
            Err(cause) if cause.is_of_start(|name| run.along.iter().any(|it| it.name == name)) => {
                Ok(Some(cause))
            }
            begins => begins.map(|()| None),
        }
    }
}

/// Returns an error if the requested duration of a simulation is out of range.
fn check_settle(settle: Option<f64>) -> Result<(), SceneError> {
    match settle.filter(|time| !(0.0..=LONGEST).contains(time)) {
        None => Ok(()),
        Some(time) => Err(SceneError::invalid(format!(
            "the time of the simulation before the start (`settle`) is {time}, but must be between \
             0 and {LONGEST}"
        ))),
    }
}

/// Returns the error for a scene whose first run starts neither near the given states nor at an
/// attractor, with both reasons.
fn no_start(near: SceneError, cause: SceneError) -> SceneError {
    SceneError::NoStart { near: Box::new(near), cause: Box::new(cause) }
}
