//! The list of discretisations from which a requested accuracy chooses one.

use super::error::SceneError;
use super::problem::Problem;
use super::reach::Ends;
use super::resolve::{Resolution, Resolved};
use super::statement::Scene;
use crate::core::continuation::Settings;

/// The minimum number of finer discretisations from which the error of a discretisation is
/// estimated.
pub(super) const ABOVE: usize = 2;

/// The name of the setting `accuracy` of a scene.
pub(super) const ACCURACY: &str = "accuracy";

/// Copies of a problem with discretisations of growing accuracy.
pub(super) struct Ladder(Vec<Problem>);

impl Ladder {
    /// Returns the discretisations for a scene, each suitable for all runs of the scene.
    ///
    /// # Errors
    /// [`SceneError::Idle`] if there are too few discretisations to estimate an error.
    pub fn of_scene(scene: &Scene) -> Result<Self, SceneError> {
        let values = scene.values()?;
        let reach = Ends::of(&scene.runs).reach(&scene.problem, &values);
        let all = scene.problem.ladder(&values, &reach)?;
        if all.len() <= ABOVE {
            return Err(SceneError::idle(ACCURACY, "on this problem without a discretisation"));
        }
        Ok(Ladder(all))
    }

    /// Returns the discretisations for the problem of a run, which may have its own settings.
    pub fn of_run(Resolved { problem, values, reach, .. }: &Resolved) -> Result<Self, SceneError> {
        Ok(Ladder(problem.ladder(values, reach)?))
    }

    /// Returns the names of the settings in which the discretisations differ.
    pub fn varied(&self) -> Vec<String> {
        let [Some(first), Some(last)] = [self.0.first(), self.0.last()] else { return Vec::new() };
        let pairs = first.settings().into_iter().zip(last.settings());
        pairs.filter(|(a, b)| a.1 != b.1).map(|((name, _), _)| name).collect()
    }

    /// Returns the settings of one discretisation, restricted to the settings in which the
    /// discretisations differ.
    pub fn settings(&self, rung: usize) -> Vec<(String, String)> {
        let names = self.varied();
        let settings = self.0[rung].settings().into_iter();
        settings.filter(|(name, _)| names.contains(name)).collect()
    }

    /// Returns a copy of resolved runs for each discretisation. In these copies, special points are
    /// not refined with a finer discretisation.
    pub fn resolutions(&self, resolution: &Resolution) -> Result<Vec<Resolution>, SceneError> {
        let stated = resolution.scene();
        let on = |problem: &Problem| {
            let settings = Settings { refinement: 0.0, ..stated.settings.clone() };
            let problem = problem.clone();
            let scene = Scene { problem, settings, accuracy: None, ..stated.clone() };
            scene.resolve(resolution.start())
        };
        self.0.iter().map(on).collect()
    }
}
