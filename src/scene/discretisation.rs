//! The settings in the `problem` field of a scene that determine the discretisation of the
//! solutions of a vector field, a boundary-value problem or a hybrid system.

use super::error::{ProblemError, SceneError};
use super::notation::written;
use crate::core::bvp::{BoundarySystem, Collocation, Guess, IntoEquations, Mesh, Method, Shooting};
use crate::core::continuation::SettingError;
use crate::core::failure::Failure;
use crate::core::numerics::ladder;
use crate::core::ode::Scheme;
use crate::core::system::{Matrices, System};
use miette::Diagnostic;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// The settings of a problem, which can be serialized as RON and set by name.
pub(super) trait ProblemSettings:
    Clone + Default + Send + Sync + Serialize + DeserializeOwned + 'static
{
    /// Returns the setting that selects the kind of solutions to compute, for problems with several
    /// kinds of solutions.
    fn solution(&mut self) -> Option<&mut Solution> {
        None
    }

    /// Returns the discretisation of trajectories, for problems that have trajectories.
    fn discretisation(&mut self) -> Option<&mut Discretisation> {
        None
    }

    /// Checks that the settings are in their allowed ranges, for ranges that do not depend on
    /// parameters.
    fn check(&self) -> Result<(), SettingError> {
        Ok(())
    }

    /// Whether the settings determine the equations, and not only the accuracy of their solutions.
    fn define_equations() -> bool {
        false
    }

    /// Returns the setting that makes the named setting ineffective, with the value that has this
    /// effect.
    fn without_effect(&self, _name: &str) -> Option<(&'static str, String)> {
        None
    }

    /// Returns copies of the settings, one for each of the given discretisations, in the same
    /// order.
    fn with(&self, discretisations: impl IntoIterator<Item = Discretisation>) -> Vec<Self> {
        let mut all = Vec::new();
        for other in discretisations {
            let mut changed = self.clone();
            if let Some(discretisation) = changed.discretisation() {
                *discretisation = other;
                all.push(changed);
            }
        }
        all
    }

    /// Returns copies of the settings with growing accuracy and cost; the copies differ in the
    /// tolerance of the integration, or in the number of Gauss points and mesh intervals.
    fn ladder(&self) -> Vec<Self> {
        let discretisation = self.clone().discretisation().copied();
        self.with(discretisation.map_or(Vec::new(), Discretisation::ladder))
    }
}

/// The settings of a zero problem.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ZeroSettings {
    /// The type of the matrices, which is `cheaper`, `dense` or `sparse`.
    pub matrices: Matrices,
}

impl ProblemSettings for ZeroSettings {}

/// The settings of a map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MapSettings {
    /// The number of iterates of a cycle (1 to 4096), for runs that do not continue from an earlier
    /// run; the default is 1, that is, fixed points.
    pub iterates: usize,
}

impl Default for MapSettings {
    fn default() -> Self {
        MapSettings { iterates: 1 }
    }
}

impl ProblemSettings for MapSettings {
    fn check(&self) -> Result<(), SettingError> {
        let holds = (1..=4096).contains(&self.iterates);
        in_range("iterates", self.iterates as f64, holds, "between 1 and 4096")
    }
}

/// The name of the setting that selects which solutions of a vector field are traced.
pub(super) const SOLUTION: &str = "solution";

/// The name of the setting that selects the type of matrices.
const MATRICES: &str = "matrices";

/// The kind of solutions of a vector field that are computed.
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

impl Solution {
    /// Returns the other kind of solution.
    pub(super) fn other(self) -> Self {
        match self {
            Solution::Orbit => Solution::Equilibrium,
            Solution::Equilibrium => Solution::Orbit,
        }
    }
}

/// The method that discretises trajectories, with the settings of the method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Discretisation {
    /// Collocation at Gauss points on an adaptive mesh: the default for smooth vector fields and
    /// boundary-value problems, equally accurate for stable and unstable orbits.
    Collocation(CollocationSettings),
    /// Multiple shooting: the default for hybrid systems, because the smooth parts of their orbits
    /// between two events are short. For hybrid systems, shooting takes at most a third of the
    /// computing time of collocation (`tangency-reports work-precision orbit`).
    Shooting(ShootingSettings),
}

/// The settings of collocation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CollocationSettings {
    /// The number of mesh intervals in each segment of a solution (1 to 4096).
    pub intervals: usize,
    /// The number of Gauss points in a mesh interval (2 to 7).
    pub degree: usize,
}

/// The settings of multiple shooting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ShootingSettings {
    /// The number of parts into which each segment of a solution is divided (1 to 4096); each part
    /// is integrated separately.
    pub segments: usize,
    /// The integration scheme.
    pub scheme: Scheme,
    /// The absolute and relative tolerance of the integration (1e-14 to 1e-3).
    pub flow_tolerance: f64,
}

impl Default for CollocationSettings {
    fn default() -> Self {
        CollocationSettings { intervals: 20, degree: 4 }
    }
}

impl Default for ShootingSettings {
    fn default() -> Self {
        ShootingSettings { segments: 1, scheme: Scheme::DormandPrince8, flow_tolerance: 1e-12 }
    }
}

impl Default for Discretisation {
    fn default() -> Self {
        Discretisation::Collocation(CollocationSettings::default())
    }
}

/// The coarsest collocation meshes, each given by the number of Gauss points per interval and the
/// number of intervals. Each mesh is about one digit more accurate than the previous mesh, at the
/// lowest possible cost (`tangency-reports work-precision orbit`).
const MESHES: [(usize, usize); 9] =
    [(3, 5), (4, 5), (4, 10), (4, 15), (5, 15), (5, 20), (5, 30), (7, 30), (7, 45)];

/// The largest integration tolerances among which an automatic choice is made.
const TOLERANCES: [f64; 2] = [1e-3, 1e-4];

/// The maximum number of discretisations among which an automatic choice is made.
const RUNGS: usize = 12;

/// The settings that apply to the periodic orbits or equilibria of a smooth vector field.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FieldSettings {
    /// The kind of solutions of the vector field that are computed.
    pub solution: Solution,
    /// The method that discretises periodic orbits; the default is collocation.
    pub method: Discretisation,
    /// The type of matrices for equilibria, and for orbits by collocation: `cheaper`, `dense` or
    /// `sparse`.
    pub matrices: Matrices,
}

/// The settings of a boundary-value problem.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BoundarySettings {
    /// The method that discretises the solutions of a boundary-value problem; the default is
    /// collocation.
    pub method: Discretisation,
}

/// The settings that apply to the periodic orbits or equilibria of a hybrid system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HybridOrbitSettings {
    /// The kind of solutions of the hybrid system that are computed.
    pub solution: Solution,
    /// The mode of the hybrid system in which equilibria are computed, for runs that do not
    /// continue from an earlier run; the default is the mode in which the motion starts.
    pub mode: String,
    /// The method that discretises orbits of a hybrid system; the default is multiple shooting.
    pub method: Discretisation,
    /// The modes and events of the orbit, for runs that do not continue from an earlier run; the
    /// default is an orbit without events in the first mode.
    pub itinerary: String,
    /// The order of local maps near grazings (1 to 7).
    pub order: usize,
    /// Whether branches record how far the orbit would penetrate the surface of an event if the
    /// event did not occur.
    pub penetration: bool,
}

impl Default for HybridOrbitSettings {
    fn default() -> Self {
        HybridOrbitSettings {
            solution: Solution::Orbit,
            mode: String::new(),
            method: Discretisation::Shooting(ShootingSettings::default()),
            itinerary: String::new(),
            order: 2,
            penetration: false,
        }
    }
}

impl ProblemSettings for FieldSettings {
    fn solution(&mut self) -> Option<&mut Solution> {
        Some(&mut self.solution)
    }

    fn discretisation(&mut self) -> Option<&mut Discretisation> {
        Some(&mut self.method)
    }

    fn check(&self) -> Result<(), SettingError> {
        self.method.check()
    }

    fn without_effect(&self, name: &str) -> Option<(&'static str, String)> {
        let idle = match self.solution {
            Solution::Equilibrium => name != SOLUTION && name != MATRICES,
            Solution::Orbit => false,
        };
        let by_shooting = matches!(self.method, Discretisation::Shooting(_));
        if name == MATRICES && self.solution == Solution::Orbit && by_shooting {
            return Some(("method", "shooting".to_string()));
        }
        idle.then(|| (SOLUTION, written(&self.solution)))
    }
}

impl ProblemSettings for BoundarySettings {
    fn discretisation(&mut self) -> Option<&mut Discretisation> {
        Some(&mut self.method)
    }

    fn check(&self) -> Result<(), SettingError> {
        self.method.check()
    }
}

impl ProblemSettings for HybridOrbitSettings {
    fn solution(&mut self) -> Option<&mut Solution> {
        Some(&mut self.solution)
    }

    fn discretisation(&mut self) -> Option<&mut Discretisation> {
        Some(&mut self.method)
    }

    fn check(&self) -> Result<(), SettingError> {
        in_range("order", self.order as f64, (1..=7).contains(&self.order), "between 1 and 7")?;
        self.method.check()
    }

    fn without_effect(&self, name: &str) -> Option<(&'static str, String)> {
        let idle = match self.solution {
            Solution::Orbit => name == "mode",
            Solution::Equilibrium => ![SOLUTION, "mode"].contains(&name),
        };
        idle.then(|| (SOLUTION, written(&self.solution)))
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
    /// Returns the two methods of discretisation, collocation and shooting, with their default
    /// settings.
    pub(super) fn methods() -> [Self; 2] {
        use Discretisation::{Collocation, Shooting};
        [Collocation(CollocationSettings::default()), Shooting(ShootingSettings::default())]
    }

    /// Returns discretisations with growing accuracy and cost.
    fn ladder(self) -> Vec<Self> {
        let coarse = match self {
            Discretisation::Shooting(own) => TOLERANCES
                .map(|flow_tolerance| {
                    Discretisation::Shooting(ShootingSettings { flow_tolerance, ..own })
                })
                .into(),
            Discretisation::Collocation(_) => MESHES
                .map(|(degree, intervals)| {
                    Discretisation::Collocation(CollocationSettings { degree, intervals })
                })
                .into(),
        };
        ladder(coarse, RUNGS, Discretisation::finer)
    }

    /// Returns the next finer discretisation according to [`Method::finer`], which is used to
    /// refine special points.
    fn finer(&self) -> Option<Self> {
        let mut finer = *self;
        match &mut finer {
            Discretisation::Collocation(own) => {
                let (method, parts) = Collocation::new(own.degree).ok()?.finer();
                (own.degree, own.intervals) = (method.points(), own.intervals * parts);
            }
            Discretisation::Shooting(own) => {
                let method = Shooting::new(own.scheme, own.flow_tolerance).ok()?.finer()?;
                own.flow_tolerance = method.settings().relative;
            }
        }
        Some(finer)
    }

    fn check(&self) -> Result<(), SettingError> {
        let count = |name, number: usize| {
            in_range(name, number as f64, (1..=4096).contains(&number), "between 1 and 4096")
        };
        match *self {
            Discretisation::Collocation(CollocationSettings { intervals, degree }) => {
                count("intervals", intervals)?;
                in_range("degree", degree as f64, (2..=7).contains(&degree), "between 2 and 7")
            }
            Discretisation::Shooting(ShootingSettings { segments, flow_tolerance, .. }) => {
                count("segments", segments)?;
                let holds = (1e-14..=1e-3).contains(&flow_tolerance);
                in_range("flow_tolerance", flow_tolerance, holds, "between 1e-14 and 1e-3")
            }
        }
    }

    /// Returns the method of discretisation, and the number of mesh intervals on each segment of a
    /// solution.
    pub(super) fn method(&self) -> Result<OnIntervals, SceneError> {
        Ok(match *self {
            Discretisation::Collocation(CollocationSettings { intervals, degree }) => {
                OnIntervals { method: built(Collocation::new(degree))?.into(), intervals }
            }
            Discretisation::Shooting(ShootingSettings { segments, scheme, flow_tolerance }) => {
                let method = built(Shooting::new(scheme, flow_tolerance))?.into();
                OnIntervals { method, intervals: segments }
            }
        })
    }
}

impl FieldSettings {
    /// Returns the method of discretisation of orbits, and the number of mesh intervals.
    pub(super) fn orbits(&self) -> Result<OnIntervals, SceneError> {
        let OnIntervals { method, intervals } = self.method.method()?;
        Ok(OnIntervals { method: method.with_matrices(self.matrices), intervals })
    }

    /// Whether the settings select sparse matrices for orbits.
    pub(super) fn has_sparse_orbits(&self) -> bool {
        let collocation = matches!(self.method, Discretisation::Collocation(_));
        collocation && self.matrices == Matrices::Sparse
    }
}

/// A method of discretisation, and the number of mesh intervals on each segment of a solution.
pub(super) struct OnIntervals {
    pub method: Method,
    pub intervals: usize,
}

impl OnIntervals {
    /// Builds the system of equations whose solutions a problem traces.
    pub fn system(self, problem: impl IntoEquations) -> Result<Box<dyn System>, SceneError> {
        Ok(Box::new(self.boundary(problem)?))
    }

    /// Discretises the equations of a boundary-value problem.
    pub fn boundary(self, problem: impl IntoEquations) -> Result<BoundarySystem, SceneError> {
        let problem = problem.into_equations();
        let meshes = vec![Mesh::uniform(self.intervals); problem.segments().len()];
        built(BoundarySystem::new(problem, self.method, meshes))
    }

    /// Builds the system of equations for orbits that have the same sequence of modes and events as
    /// a simulated orbit; returns the system and the simulated orbit as its unknowns.
    pub fn start(
        self,
        simulated: Guess<impl IntoEquations>,
        p: &[f64],
    ) -> Result<Started, SceneError> {
        let OnIntervals { method, intervals } = self;
        let (system, z) = simulated.discretised(p, method, intervals).map_err(no_start)?;
        Ok((Box::new(system), z))
    }
}

fn built<S, E: Diagnostic + Send + Sync + 'static>(found: Result<S, E>) -> Result<S, SceneError> {
    Ok(found.map_err(ProblemError::new)?)
}

/// A system of equations and the initial values of its unknowns.
pub(super) type Started = (Box<dyn System>, Vec<f64>);

/// The start of a branch to which a simulated motion converges, and a warning if the motion is
/// probably not the expected one.
pub(super) type Settled = (Started, Option<String>);

/// Returns the error for a simulated motion from which no branch can start.
pub(super) fn no_start(cause: Failure) -> SceneError {
    SceneError::value("start", "Simulated", cause.to_string()).with_help_of(&cause)
}
