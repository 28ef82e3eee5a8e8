//! The ways in which a sweep can sample the motion of a scene.

use super::error::SceneError;
use super::statement::Scene;
use crate::core::problem::{Forcing, distinct};

/// The ways in which a sweep can sample the motion of a scene, and the quantities that the sweep
/// can record.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sampling {
    /// Whether the motion has a forcing, so that a sweep samples the motion once a period.
    pub forced: bool,
    /// The events just after which a motion without forcing can be sampled.
    pub events: Vec<String>,
    /// The names of the states.
    pub states: Vec<String>,
    /// The names of the measures that can be recorded in every period.
    pub measures: Vec<String>,
}

impl Scene {
    /// Returns the ways in which a sweep can sample the motion of the scene. A motion without
    /// forcing and without events cannot be sampled.
    ///
    /// ```
    /// use tangency::scene::{BUILT_IN, Scene};
    /// let scene = Scene::parse(BUILT_IN.iter().find(|scene| scene.name == "dry-friction").unwrap().text)?;
    /// let sampling = scene.sampling()?;
    /// assert!(sampling.forced && sampling.events.is_empty());
    /// assert_eq!(sampling.states, ["x", "v"]);
    /// assert!(sampling.measures.contains(&"max_x".to_string()));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`] if the problem has no motion that can be simulated.
    pub fn sampling(&self) -> Result<Sampling, SceneError> {
        let motion = self.problem.model().motion()?;
        let forced = motion.forcing() != Forcing::None;
        let (guards, modes) = (motion.guards(), motion.modes());
        let owned = |names: Vec<&str>| names.into_iter().map(String::from).collect::<Vec<_>>();
        let events = distinct(guards.iter().map(|guard| &guard.name));
        Ok(Sampling {
            forced,
            events: if forced { Vec::new() } else { owned(events) },
            states: owned(distinct(modes.iter().flat_map(|mode| &mode.states))),
            measures: motion.measures().into_iter().map(|(name, _)| name).collect(),
        })
    }
}
