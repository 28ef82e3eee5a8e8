//! The contents of a text that is either a model or a scene.

use super::error::SceneError;
use super::problem::Problem;
use super::request::Request;
use super::statement::Scene;

/// The contents of a text that is either a model or a scene.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "few exist at a time")]
pub enum Stated {
    /// Equations without runs.
    Model(Problem),
    /// A scene.
    Scene(Scene),
}

impl Stated {
    /// Returns the scene with a request applied; if the text is a model, `title` becomes the title
    /// of the scene.
    ///
    /// # Errors
    /// The errors of [`Scene::of_model`] and [`Scene::requested`].
    pub fn requested(self, title: &str, request: &Request) -> Result<Scene, SceneError> {
        match self {
            Stated::Model(problem) => Scene::of_model(problem, title, request),
            Stated::Scene(scene) => scene.requested(request),
        }
    }

    /// Returns the scene as written in the text; if the text is a model, `title` becomes the title
    /// of the scene, which has no runs.
    pub fn as_written(self, title: &str, request: &Request) -> Scene {
        match self {
            Stated::Model(problem) => Scene::of_problem(problem, title, request),
            Stated::Scene(scene) => scene,
        }
    }
}
