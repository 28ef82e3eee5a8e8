//! The problems, examples and files that all pages of a server share.

use crate::output::SizeLimit;
use crate::scene::{Catalogue, Files, Scene, SceneError};
use serde::Serialize;
use std::path::PathBuf;

/// The problems and examples that a server offers.
#[derive(Clone, Debug)]
pub struct Library {
    /// The catalogue of problems, and of the scenes that serve as examples.
    pub catalogue: Catalogue,
    /// The folder that contains the files to which scenes may refer; `None` if scenes must not
    /// refer to files.
    pub folder: Option<PathBuf>,
    /// The maximum size of the files to which scenes refer.
    pub limit: SizeLimit,
}

/// An example in the list that the page shows.
#[derive(Serialize)]
pub(super) struct Example<'a> {
    name: &'a str,
    summary: String,
}

impl Library {
    /// Parses a scene.
    pub(super) fn parse(&self, text: &str) -> Result<Scene, SceneError> {
        match self.folder.as_deref() {
            Some(folder) => self.catalogue.parse_in(Files { folder, limit: self.limit }, text),
            None => self.catalogue.parse_alone(text),
        }
    }

    /// Returns the examples, which are all scenes that contain branches.
    pub(super) fn examples(&self) -> Vec<Example<'_>> {
        let scenes = self.catalogue.scenes().iter();
        let parsed =
            scenes.filter_map(|named| Some((named, self.catalogue.parse(&named.text).ok()?)));
        let traced = parsed.filter(|(_, scene)| scene.runs.iter().any(|run| run.shown));
        let example = traced.map(|(named, scene)| Example {
            name: &named.name,
            summary: scene.summary.unwrap_or(scene.title),
        });
        example.collect()
    }
}
