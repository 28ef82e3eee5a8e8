//! How the solutions of a field, a boundary-value problem or a hybrid system are discretised.

use super::error::{ProblemError, SceneError};
use super::slot::{Slots, slots, written};
use crate::core::bvp::{BoundarySystem, Collocation, Guess, IntoEquations, Mesh, Method, Shooting};
use crate::core::continuation::SettingError;
use crate::core::failure::Failure;
use crate::core::numerics::ladder;
use crate::core::ode::Scheme;
use crate::core::system::System;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::error::Error;

/// The settings of a problem: written and read as RON, and set by name.
pub(super) trait ProblemSettings:
    Clone + Default + Send + Sync + Serialize + DeserializeOwned + 'static
{
    /// All settings by name.
    fn slots(&mut self) -> Slots<'_>;

    /// Checks the ranges of settings that do not depend on parameters.
    fn check(&self) -> Result<(), SettingError> {
        Ok(())
    }

    /// The setting, with its value, under which a setting of this name has no effect.
    fn without_effect(&self, _name: &str) -> Option<(&'static str, String)> {
        None
    }
}

/// The settings of a zero problem: it has none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ZeroSettings {}

impl ProblemSettings for ZeroSettings {
    fn slots(&mut self) -> Slots<'_> {
        Vec::new()
    }
}

/// The settings of a map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MapSettings {
    /// How many iterates a cycle has (1 to 4096), where a run does not start from an earlier one:
    /// fixed points by default.
    pub iterates: usize,
}

impl Default for MapSettings {
    fn default() -> Self {
        MapSettings { iterates: 1 }
    }
}

impl ProblemSettings for MapSettings {
    fn slots(&mut self) -> Slots<'_> {
        slots!(self => MapSettings { iterates: Plain })
    }

    fn check(&self) -> Result<(), SettingError> {
        let holds = (1..=4096).contains(&self.iterates);
        in_range("iterates", self.iterates as f64, holds, "between 1 and 4096")
    }
}

/// Which solutions of a field are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
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
#[non_exhaustive]
pub enum Discretised {
    /// Collocation at Gauss points, on a mesh that follows the solution: the default for smooth
    /// fields and boundary-value problems, as accurate for unstable orbits as for stable ones.
    Collocation,
    /// Multiple shooting: the default for hybrid systems, whose legs are short and smooth. It takes
    /// a third of the time or less (`tangency work-precision orbit`).
    Shooting,
}

/// The coarsest meshes of collocation, Gauss points in an interval and intervals: each has about a
/// digit more than the one before, at the lowest cost (`tangency work-precision orbit`).
const MESHES: [(usize, usize); 9] =
    [(3, 5), (4, 5), (4, 10), (4, 15), (5, 15), (5, 20), (5, 30), (7, 30), (7, 45)];

/// The coarsest tolerances of flows.
const TOLERANCES: [f64; 2] = [1e-3, 1e-4];

/// The number of discretisations to choose from.
const RUNGS: usize = 12;

/// The settings that trajectories have, and equilibria do not.
const OF_TRAJECTORIES: [&str; 6] =
    ["method", "intervals", "degree", "segments", "scheme", "flow_tolerance"];

/// How trajectories are discretised: what the settings of all problems with trajectories share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Discretisation {
    pub method: Discretised,
    pub intervals: usize,
    pub degree: usize,
    pub segments: usize,
    pub scheme: Scheme,
    pub flow_tolerance: f64,
}

/// Declares settings that discretise trajectories by a default method: those of their own, and
/// those that all share.
macro_rules! trajectory_settings {
    (
        $(#[$docs:meta])* $name:ident by $default:ident,
        { $($(#[$before_docs:meta])* $before:ident: $before_type:ty = $before_value:expr, $before_slot:ident;)* }
        { $($(#[$after_docs:meta])* $after:ident: $after_type:ty = $after_value:expr, $after_slot:ident;)* }
        $check:expr, $idle:expr
    ) => {
        $(#[$docs])*
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            $($(#[$before_docs])* pub $before: $before_type,)*
            #[doc = concat!("The method; if not given, [`", stringify!($default), "`](Discretised::", stringify!($default), ").")]
            pub method: Option<Discretised>,
            /// The number of intervals of collocation (1 to 4096).
            pub intervals: usize,
            /// The number of Gauss points in an interval (2 to 7).
            pub degree: usize,
            /// The number of segments of shooting (1 to 4096).
            pub segments: usize,
            /// The integration scheme of shooting.
            pub scheme: Scheme,
            /// The tolerance of the flow, absolute and relative (1e-14 to 1e-3).
            pub flow_tolerance: f64,
            $($(#[$after_docs])* pub $after: $after_type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                $name {
                    $($before: $before_value,)*
                    method: None,
                    intervals: 20,
                    degree: 4,
                    segments: 1,
                    scheme: Scheme::DormandPrince8,
                    flow_tolerance: 1e-12,
                    $($after: $after_value,)*
                }
            }
        }

        impl ProblemSettings for $name {
            fn slots(&mut self) -> Slots<'_> {
                slots!(self => $name {
                    $($before: $before_slot,)*
                    method: Usual,
                    intervals: Plain,
                    degree: Plain,
                    segments: Plain,
                    scheme: Plain,
                    flow_tolerance: Plain,
                    $($after: $after_slot,)*
                })
            }

            fn without_effect(&self, name: &str) -> Option<(&'static str, String)> {
                let own: fn(&Self, &str) -> Option<(&'static str, String)> = $idle;
                own(self, name).or_else(|| self.discretisation().without_effect(name))
            }

            fn check(&self) -> Result<(), SettingError> {
                let own: fn(&Self) -> Result<(), SettingError> = $check;
                own(self)?;
                self.discretisation().check()
            }
        }

        impl $name {
            pub(super) fn discretisation(&self) -> Discretisation {
                let &$name { method, intervals, degree, segments, scheme, flow_tolerance, .. } = self;
                let method = method.unwrap_or(Discretised::$default);
                Discretisation { method, intervals, degree, segments, scheme, flow_tolerance }
            }

            fn with(&self, discretisation: Discretisation) -> Self {
                let Discretisation { intervals, degree, segments, flow_tolerance, .. } = discretisation;
                $name { intervals, degree, segments, flow_tolerance, ..self.clone() }
            }

            /// Settings of growing accuracy and cost: tolerances of flows, or Gauss points and
            /// intervals.
            pub(super) fn ladder(&self) -> Vec<Self> {
                let rungs = self.discretisation().ladder();
                rungs.into_iter().map(|rung| self.with(rung)).collect()
            }
        }
    };
}

trajectory_settings! {
    /// How the periodic orbits or equilibria of a smooth field are computed.
    FieldSettings by Collocation,
    {
        /// Which solutions of the field are computed.
        solution: Solution = Solution::Orbit, Plain;
    }
    {}
    |_| Ok(()),
    |own, name| {
        let idle = own.solution == Solution::Equilibrium && OF_TRAJECTORIES.contains(&name);
        idle.then(|| ("solution", written(&own.solution)))
    }
}

trajectory_settings! {
    /// How a boundary-value problem is discretised.
    BoundarySettings by Collocation, {} {} |_| Ok(()), |_, _| None
}

trajectory_settings! {
    /// How the periodic orbits or equilibria of a hybrid system are computed.
    HybridOrbitSettings by Shooting,
    {
        /// Which solutions of the system are computed.
        solution: Solution = Solution::Orbit, Plain;
        /// The mode in which equilibria are, where a run does not start from an earlier one: by
        /// default the one in which motion begins.
        mode: String = String::new(), Words;
    }
    {
        /// The modes and events of the orbit, where a run does not start from an earlier one: by
        /// default an orbit without events, in the first mode.
        itinerary: String = String::new(), Words;
        /// The order of local maps near grazings (1 to 7).
        order: usize = 2, Plain;
        /// Whether branches record how far orbits would penetrate a surface.
        penetration: bool = false, Plain;
    }
    |own| in_range("order", own.order as f64, (1..=7).contains(&own.order), "between 1 and 7"),
    |own, name| {
        let of_others: &[&str] = match own.solution {
            Solution::Orbit => &["mode"],
            Solution::Equilibrium => &["itinerary", "penetration", "order"],
        };
        let idle = own.solution == Solution::Equilibrium && OF_TRAJECTORIES.contains(&name);
        (idle || of_others.contains(&name)).then(|| ("solution", written(&own.solution)))
    }
}

fn in_range(
    name: &'static str,
    value: f64,
    holds: bool,
    range: &'static str,
) -> Result<(), SettingError> {
    if holds { Ok(()) } else { Err(SettingError { name, value, range }) }
}

impl Discretisation {
    /// Discretisations of growing accuracy and cost.
    fn ladder(self) -> Vec<Self> {
        let coarse = match self.method {
            Discretised::Shooting => {
                TOLERANCES.map(|flow_tolerance| Discretisation { flow_tolerance, ..self }).into()
            }
            Discretised::Collocation => MESHES
                .map(|(degree, intervals)| Discretisation { degree, intervals, ..self })
                .into(),
        };
        ladder(coarse, RUNGS, Discretisation::finer)
    }

    /// The finer discretisation by [`Method::finer`], which special points climb.
    fn finer(&self) -> Option<Self> {
        let mut finer = *self;
        match self.method {
            Discretised::Collocation => {
                let (method, parts) = Collocation::new(self.degree).ok()?.finer();
                (finer.degree, finer.intervals) = (method.points(), self.intervals * parts);
            }
            Discretised::Shooting => {
                let method = Shooting::new(self.scheme, self.flow_tolerance).ok()?.finer()?;
                finer.flow_tolerance = method.settings().relative;
            }
        }
        Some(finer)
    }

    fn check(&self) -> Result<(), SettingError> {
        let count = |name, number: usize| {
            in_range(name, number as f64, (1..=4096).contains(&number), "between 1 and 4096")
        };
        count("intervals", self.intervals)?;
        let degree = self.degree;
        in_range("degree", degree as f64, (2..=7).contains(&degree), "between 2 and 7")?;
        count("segments", self.segments)?;
        let (tolerance, range) = (self.flow_tolerance, "between 1e-14 and 1e-3");
        in_range("flow_tolerance", tolerance, (1e-14..=1e-3).contains(&tolerance), range)
    }

    /// The method, if it knows nothing of a setting of this name.
    fn without_effect(&self, name: &str) -> Option<(&'static str, String)> {
        let others: &[&str] = match self.method {
            Discretised::Collocation => &["segments", "scheme", "flow_tolerance"],
            Discretised::Shooting => {
                &["intervals", "degree", "target_mesh_error", "max_mesh_error"]
            }
        };
        others.contains(&name).then(|| ("method", written(&self.method)))
    }

    /// The system of a problem.
    pub fn system(&self, problem: impl IntoEquations) -> Result<Box<dyn System>, SceneError> {
        Ok(Box::new(self.boundary(problem)?))
    }

    /// The discretised problem.
    pub(super) fn boundary(
        &self,
        problem: impl IntoEquations,
    ) -> Result<BoundarySystem, SceneError> {
        let problem = problem.into_equations();
        let (method, intervals) = self.method()?;
        let meshes = vec![Mesh::uniform(intervals); problem.segments().len()];
        built(BoundarySystem::new(problem, method, meshes))
    }

    /// The system of the orbits like a simulated one, and the unknowns of that one.
    pub fn start(
        &self,
        simulated: Guess<impl IntoEquations>,
        p: &[f64],
    ) -> Result<Started, SceneError> {
        let (method, intervals) = self.method()?;
        let (system, z) = simulated.discretised(p, method, intervals).map_err(no_start)?;
        Ok((Box::new(system), z))
    }

    /// The method, and the number of its intervals on each segment.
    pub(super) fn method(&self) -> Result<(Method, usize), SceneError> {
        Ok(match self.method {
            Discretised::Collocation => {
                (built(Collocation::new(self.degree))?.into(), self.intervals)
            }
            Discretised::Shooting => {
                (built(Shooting::new(self.scheme, self.flow_tolerance))?.into(), self.segments)
            }
        })
    }
}

fn built<S, E: Error + Send + Sync + 'static>(found: Result<S, E>) -> Result<S, SceneError> {
    Ok(found.map_err(ProblemError::new)?)
}

/// A system, and unknowns to start from.
pub(super) type Started = (Box<dyn System>, Vec<f64>);

/// A simulated motion from which no branch can start.
pub(super) fn no_start(cause: Failure) -> SceneError {
    SceneError::value("start", "Simulated", cause.to_string())
}
