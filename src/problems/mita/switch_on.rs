//! Classifies the switch-on of the actuator: the transition from motion without impacts to motion
//! with impacts as a parameter is varied.

use super::actuator::Actuator;
use crate::core::continuation::{Branch, SpecialPoint};
use crate::core::local_map::{Classification, GrazingError, GrazingPoint, LocalMap, MapSettings};
use crate::core::orbit::{HybridOrbit, Itinerary, ItineraryError};
use crate::core::system::Kind;

/// The reason why the type of a switch-on is not determined.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum SwitchOnError {
    /// The branch does not contain a grazing.
    #[error("branch `{0}` has no grazing (G)")]
    #[diagnostic(help(
        "trace the motion without impacts until the motion touches the front stopper"
    ))]
    NoGrazing(String),
    /// The solutions of the branch have impacts.
    #[error(
        "branch `{branch}` has the itinerary `{itinerary}`, but must consist of motion without \
         impacts"
    )]
    #[diagnostic(help("trace the motion without impacts, whose itinerary is `stick`"))]
    Impacts {
        /// The name of the branch whose solutions have impacts.
        branch: String,
        /// The itinerary (the sequence of modes and events) of the branch's solutions.
        itinerary: String,
    },
    /// The itinerary (the sequence of modes and events) of the branch's solutions is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Itinerary(#[from] ItineraryError),
    /// The local map at the grazing cannot be computed, or does not determine the type of the
    /// switch-on.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Grazing(#[from] GrazingError),
}

/// The switch-on of the actuator: a parameter, usually the voltage or the frequency, reaches the
/// value at which motion without impacts touches the front stopper (X. Zhao, *Modeling and
/// Simulation of MEMS Devices*, 2004, section 4.3).
#[derive(Clone, Debug, PartialEq)]
pub struct SwitchOn {
    /// The type of the switch-on, with its coefficients: types I, II and III are the scenarios
    /// [`Jump`](crate::core::local_map::Scenario::Jump),
    /// [`Continuous`](crate::core::local_map::Scenario::Continuous) and
    /// [`Unstable`](crate::core::local_map::Scenario::Unstable).
    pub classification: Classification,
    /// The parameter value at which motion without impacts touches the stopper.
    pub grazing: f64,
    /// The parameter value at which stable motion without impacts ends: the grazing for types I and
    /// II, the fold that precedes the grazing for type III. `None` if the branch begins beyond that
    /// fold.
    pub at: Option<f64>,
}

impl SwitchOn {
    /// Classifies the switch-on at the first grazing of a branch of motion without impacts; the
    /// classification uses the first-order local map.
    ///
    /// ```
    /// use tangency::core::local_map::Scenario;
    /// use tangency::problems::mita::SwitchOn;
    /// use tangency::scene::{BUILT_IN, Scene, execute};
    /// let text = BUILT_IN.iter().find(|scene| scene.name == "mita-type-3").unwrap().text;
    /// let mut scene = Scene::parse(text)?;
    /// scene.runs.truncate(1);
    /// let outcome = execute(&scene, None, &mut ());
    /// let switch_on = SwitchOn::of(&outcome.document.branches[0])?;
    /// assert_eq!(switch_on.classification.scenario, Scenario::Unstable);
    /// // Stable motion ends at a fold, beyond the voltage of the grazing.
    /// assert!(switch_on.at > Some(switch_on.grazing));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SwitchOnError`] for a branch without a grazing or with impacts, and at points of
    /// codimension two, where the type of the switch-on changes.
    pub fn of(branch: &Branch) -> Result<Self, SwitchOnError> {
        let is_grazing = |point: &SpecialPoint| point.kind == Kind::G;
        let Some(place) = branch.special.iter().position(is_grazing) else {
            return Err(SwitchOnError::NoGrazing(branch.name.clone()));
        };
        let itinerary = Itinerary::smooth(Actuator::STICK, 1);
        if itinerary.written(&Actuator) != branch.itinerary {
            let (branch, itinerary) = (branch.name.clone(), branch.itinerary.clone());
            return Err(SwitchOnError::Impacts { branch, itinerary });
        }
        let grazing = &branch.special[place];
        let parameter = &branch.released[0];
        let value = |point: &SpecialPoint| branch.column(parameter).and_then(|k| point.value(k));
        // States are stored node by node, one state after another.
        let velocity = branch.unknowns[0].length;
        let x = [grazing.state[0], grazing.state[velocity]];
        let orbit = HybridOrbit::of(Actuator, itinerary)?;
        let point = GrazingPoint::of(&orbit, &x, &grazing.parameters)?;
        let point = point.located(&Actuator, parameter)?;
        let settings = MapSettings { order: 1, ..MapSettings::default() };
        let map = LocalMap::of(&Actuator, &point, &[parameter], settings)?;
        let classification = map.classified(parameter)?;
        let stable = !classification.multipliers.iter().any(|mu| mu.0.hypot(mu.1) > 1.0);
        let lost = |point: &&SpecialPoint| [Kind::LP, Kind::PD, Kind::TR].contains(&point.kind);
        let at = match stable {
            true => Some(grazing),
            // The grazing is where the branch ends, or begins.
            false if place + 1 == branch.special.len() => {
                branch.special[..place].iter().rev().find(lost)
            }
            false => branch.special[place..].iter().find(lost),
        };
        let grazing = value(grazing).unwrap_or(f64::NAN);
        Ok(SwitchOn { classification, grazing, at: at.and_then(value) })
    }
}
