//! The text of a scene.

use super::catalogue::Catalogue;
use super::error::SceneError;
use super::notation::options;
use super::problem::Problem;
use super::statement::Scene;
use ron::ser::PrettyConfig;

impl Scene {
    /// Parses a scene whose problem is [built in](Catalogue::built_in).
    ///
    /// # Errors
    /// As [`Catalogue::parse`].
    ///
    /// ```
    /// use tangency::scene::Scene;
    /// let error = Scene::parse("Scene(title: \"t\", problem: Plate(), runs: [], colour: 3)");
    /// assert!(error.unwrap_err().to_string().contains("`colour`"));
    /// ```
    pub fn parse(text: &str) -> Result<Scene, SceneError> {
        Catalogue::built_in().parse(text)
    }

    /// Returns the scene as the text of a file that [`Catalogue::parse`] can read; the text
    /// contains all settings of the problem, but other values only if they differ from their
    /// defaults.
    ///
    /// ```
    /// use tangency::scene::Scene;
    /// let text = "Scene(title: \"t\", problem: Equations(states: [(\"x\", \"a - x^2\")]), parameters: [(\"a\", 1)],
    ///     runs: [Run(name: \"r\", along: [(name: \"a\", low: 0, high: 1)])])";
    /// let scene = Scene::parse(text)?;
    /// assert_eq!(Scene::parse(&scene.to_ron())?, scene);
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn to_ron(&self) -> String {
        let pretty = PrettyConfig::new().struct_names(true).depth_limit(3);
        // Scenes are plain lists, numbers and names, so serialization cannot fail.
        let text = options().to_string_pretty(self, pretty).unwrap_or_default();
        readable(&text, &self.problem)
    }

    /// Returns the scene as one line of text that contains all values and identifies the results of
    /// the scene.
    pub fn in_words(&self) -> String {
        readable(&options().to_string(self).unwrap_or_default(), &self.problem)
    }
}

/// Converts the problem in a serialized scene to the notation of scenes.
fn readable(text: &str, problem: &Problem) -> String {
    let (name, written) = (problem.name(), problem.written());
    text.replacen(&format!("{name}({written})"), &format!("{name}{written}"), 1)
}
