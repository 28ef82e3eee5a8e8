//! How the solutions of a field or of a boundary-value problem are discretised.

use super::simulate::initial;
use super::slot::{Plain, Slots, Usual, Words};
use super::{SceneError, Simulated};
use crate::core::bvp::{
    Birth, BoundaryProblem, BoundarySystem, Collocation, Mesh, Method, Shooting,
};
use crate::core::condition::EvaluationError;
use crate::core::continuation::SettingError;
use crate::core::dense::Dense;
use crate::core::field::{Equilibria, VectorField};
use crate::core::flow::Scheme;
use crate::core::hybrid::{HybridFlow, HybridSettings, HybridSystem, Recurrence, RecurrenceError};
use crate::core::ladder::ladder;
use crate::core::orbit::{HybridOrbit, Itinerary, Orbit};
use crate::core::zero::System;
use serde::{Deserialize, Serialize};

/// Which solutions of a field are meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Solution {
    /// Periodic orbits.
    #[default]
    Orbit,
    /// Equilibria.
    Equilibrium,
}

/// The method that discretises trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Discretised {
    /// Collocation at Gauss points, on a mesh that follows the solution.
    Collocation,
    /// Multiple shooting.
    Shooting,
}

impl Discretised {
    /// Usual for smooth fields: it does not mind how unstable an orbit is.
    pub const USUAL: Discretised = Discretised::Collocation;
    /// Usual for hybrid systems, whose legs are short and smooth: it takes a third of the time or less
    /// (`tangency chart orbit`).
    pub const USUAL_HYBRID: Discretised = Discretised::Shooting;
}

/// The coarsest meshes of collocation, Gauss points in an interval and intervals: each has about a digit more than the one
/// before, at the lowest cost (the chart `orbit`).
const MESHES: [(usize, usize); 9] =
    [(3, 5), (4, 5), (4, 10), (4, 15), (5, 15), (5, 20), (5, 30), (7, 30), (7, 45)];

/// The coarsest tolerances of flows.
const TOLERANCES: [f64; 2] = [1e-3, 1e-4];

/// How many discretisations there are to choose from.
const RUNGS: usize = 12;

/// How trajectories are discretised.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Discretisation {
    /// Which solutions of a field are meant.
    pub solution: Solution,
    /// The method; if not given, [`Discretised::USUAL`], or [`Discretised::USUAL_HYBRID`].
    pub method: Option<Discretised>,
    /// The number of intervals of collocation (1 to 4096).
    pub intervals: usize,
    /// The number of Gauss points in an interval (2 to 7).
    pub degree: usize,
    /// The number of segments of shooting (1 to 4096).
    pub segments: usize,
    /// The scheme of the flow by which is shot.
    pub scheme: Scheme,
    /// The tolerance of the flow, absolute and relative (1e-14 to 1e-3).
    pub flow_tolerance: f64,
    /// What hybrid orbits go through, where a run starts from none that exists: by default an orbit without
    /// events, in the first mode.
    pub itinerary: String,
    /// The order of local maps near grazings (1 to 7).
    pub order: usize,
    /// Whether hybrid orbits record how far they would penetrate a surface.
    pub penetration: bool,
}

impl Default for Discretisation {
    fn default() -> Self {
        Discretisation {
            solution: Solution::Orbit,
            method: None,
            intervals: 20,
            degree: 4,
            segments: 1,
            scheme: Scheme::DormandPrince8,
            flow_tolerance: 1e-12,
            itinerary: String::new(),
            order: 2,
            penetration: false,
        }
    }
}

impl Discretisation {
    /// The settings by name, but for some that have no meaning for a problem.
    pub(super) fn slots_but(&mut self, without: &str) -> Slots<'_> {
        let mut slots = self.slots();
        slots.retain(|(name, _)| without.split(' ').all(|other| other != *name));
        slots
    }

    fn slots(&mut self) -> Slots<'_> {
        vec![
            ("solution", Box::new(Plain(&mut self.solution))),
            ("method", Box::new(Usual(&mut self.method))),
            ("intervals", Box::new(Plain(&mut self.intervals))),
            ("degree", Box::new(Plain(&mut self.degree))),
            ("segments", Box::new(Plain(&mut self.segments))),
            ("scheme", Box::new(Plain(&mut self.scheme))),
            ("flow_tolerance", Box::new(Plain(&mut self.flow_tolerance))),
            ("itinerary", Box::new(Words(&mut self.itinerary))),
            ("order", Box::new(Plain(&mut self.order))),
            ("penetration", Box::new(Plain(&mut self.penetration))),
        ]
    }

    /// Discretisations of growing accuracy and cost: tolerances of flows, a tenth each, or Gauss points and intervals. None
    /// for equilibria, which are exact.
    pub(super) fn ladder(&self, usual: Discretised) -> Vec<Discretisation> {
        let method = self.method.unwrap_or(usual);
        let shot = |flow_tolerance| Discretisation { flow_tolerance, ..self.clone() };
        let collocated = |(degree, intervals)| Discretisation { degree, intervals, ..self.clone() };
        let coarse = match (self.solution, method) {
            (Solution::Equilibrium, _) => Vec::new(),
            (_, Discretised::Shooting) => TOLERANCES.map(shot).into(),
            (_, Discretised::Collocation) => MESHES.map(collocated).into(),
        };
        ladder(coarse, RUNGS, |rung| rung.finer(method))
    }

    /// The finer discretisation, as that of a special point on uniform meshes.
    fn finer(&self, method: Discretised) -> Option<Discretisation> {
        let mut finer = self.clone();
        match method {
            Discretised::Collocation => {
                let (method, parts) = Collocation::new(self.degree).ok()?.finer()?;
                (finer.degree, finer.intervals) = (method.points(), self.intervals * parts);
            }
            Discretised::Shooting => {
                let shooting = Shooting::new(self.scheme, self.flow_tolerance).ok()?;
                let (method, parts) = shooting.finer()?;
                finer.flow_tolerance = method.settings().relative;
                finer.segments *= parts;
            }
        }
        Some(finer)
    }

    /// Checks every range.
    pub(super) fn check(&self) -> Result<(), SettingError> {
        let count = |number: usize| (1..=4096).contains(&number);
        let tolerance = self.flow_tolerance;
        let rules = [
            ("intervals", self.intervals as f64, count(self.intervals), "between 1 and 4096"),
            ("degree", self.degree as f64, (2..=7).contains(&self.degree), "between 2 and 7"),
            ("segments", self.segments as f64, count(self.segments), "between 1 and 4096"),
            ("order", self.order as f64, (1..=7).contains(&self.order), "between 1 and 7"),
            (
                "flow_tolerance",
                tolerance,
                (1e-14..=1e-3).contains(&tolerance),
                "between 1e-14 and 1e-3",
            ),
        ];
        match rules.into_iter().find(|rule| !rule.2) {
            Some((name, value, _, range)) => Err(SettingError { name, value, range }),
            None => Ok(()),
        }
    }

    /// The equilibria or the periodic orbits of a field.
    pub(super) fn of_field<F>(&self, field: F) -> Result<Box<dyn System>, SceneError>
    where
        F: VectorField + Clone + 'static,
    {
        let parameters = vec![1.0; field.names().parameters.len()];
        match self.solution {
            Solution::Orbit => self.discretise(Orbit::of(field), Discretised::USUAL),
            Solution::Equilibrium if field.period(&parameters).is_some() => {
                Err(self.no_equilibria("a field that is forced in time has none; take `orbit`"))
            }
            Solution::Equilibrium => Ok(Box::new(Dense::new(Equilibria(field)))),
        }
    }

    /// The solutions of a boundary-value problem.
    pub(super) fn of_problem<P>(&self, problem: P) -> Result<Box<dyn System>, SceneError>
    where
        P: BoundaryProblem + Clone + 'static,
    {
        match self.solution {
            Solution::Orbit => self.discretise(problem, Discretised::USUAL),
            Solution::Equilibrium => {
                Err(self.no_equilibria("a boundary-value problem has none; leave `solution` out"))
            }
        }
    }

    /// The periodic orbits of a hybrid system.
    pub(super) fn of_hybrid<H>(&self, system: H) -> Result<Box<dyn System>, SceneError>
    where
        H: HybridSystem + Clone + 'static,
    {
        let itinerary = match self.itinerary.as_str() {
            "" => Itinerary::smooth(0, 1),
            words => Itinerary::read(words, &system).map_err(|cause| SceneError::Value {
                name: "itinerary".into(),
                value: words.into(),
                reason: cause.to_string(),
            })?,
        };
        self.discretise(self.watched(HybridOrbit::of(system, itinerary)), Discretised::USUAL_HYBRID)
    }

    fn no_equilibria(&self, reason: &str) -> SceneError {
        let (name, value) = ("solution".into(), "equilibrium".into());
        SceneError::Value { name, value, reason: reason.into() }
    }

    /// The orbits like the one on which a simulation settles, and that orbit.
    pub(super) fn settled<H>(
        &self,
        system: H,
        run: &str,
        simulated: &Simulated,
        p: &[f64],
    ) -> Result<Started, SceneError>
    where
        H: HybridSystem + Clone + 'static,
    {
        let unsettled = |cause: RecurrenceError| SceneError::Unsettled {
            run: run.into(),
            cause: Box::new(cause),
        };
        let start = initial(&system, simulated)?;
        let unit = system.period(p).unwrap_or(1.0);
        let recurrence =
            Recurrence { transient: simulated.transient * unit, ..Recurrence::default() };
        let mut flow = HybridFlow::new(&system, HybridSettings::default())
            .map_err(|cause| unsettled(cause.into()))?;
        let cycle = recurrence.find(&mut flow, start, p).map_err(unsettled)?;
        let Birth { problem, starts, extras } =
            HybridOrbit::of_cycle(system.clone(), &cycle).map_err(no_start)?;
        let start = Some([&*starts, &*extras, p]);
        self.started(self.watched(problem), Discretised::USUAL_HYBRID, start)
    }

    /// Orbits with all monitors asked for.
    fn watched<H: HybridSystem>(&self, orbit: HybridOrbit<H>) -> HybridOrbit<H> {
        if self.penetration { orbit.with_penetration() } else { orbit }
    }

    fn discretise<P>(&self, problem: P, usual: Discretised) -> Result<Box<dyn System>, SceneError>
    where
        P: BoundaryProblem + Clone + 'static,
    {
        self.started(problem, usual, None).map(|(system, _)| system)
    }

    /// The system of a problem, and a start: flowed from states, extras and parameters, or at rest.
    fn started<P>(
        &self,
        problem: P,
        usual: Discretised,
        start: Option<[&[f64]; 3]>,
    ) -> Result<Started, SceneError>
    where
        P: BoundaryProblem + Clone + 'static,
    {
        match self.method.unwrap_or(usual) {
            Discretised::Collocation => {
                started(problem, Collocation::new(self.degree)?, self.intervals, start)
            }
            Discretised::Shooting => {
                let method = Shooting::new(self.scheme, self.flow_tolerance)?;
                started(problem, method, self.segments, start)
            }
        }
    }
}

/// A system, and unknowns to start from.
type Started = (Box<dyn System>, Vec<f64>);

fn started<P, M>(
    problem: P,
    method: M,
    intervals: usize,
    start: Option<[&[f64]; 3]>,
) -> Result<Started, SceneError>
where
    P: BoundaryProblem + Clone + 'static,
    M: Method + Clone + 'static,
{
    let meshes = vec![Mesh::uniform(intervals); problem.segments().len()];
    let system = BoundarySystem::new(problem, method, meshes)?;
    let z = match start {
        Some([starts, extras, p]) => system.flowed(starts, extras, p).map_err(no_start)?,
        None => vec![0.0; system.names().dimension()],
    };
    Ok((Box::new(system), z))
}

/// A simulated motion from which no branch can start.
fn no_start(cause: EvaluationError) -> SceneError {
    SceneError::Value { name: "start".into(), value: "Simulated".into(), reason: cause.to_string() }
}
