//! The problems, examples and files that all pages of a server share.

use crate::output::SizeLimit;
use crate::scene::{Catalogue, Files, Scene, SceneError};
use serde::Serialize;
use std::path::PathBuf;

/// The problems and examples of a server.
#[derive(Clone, Debug)]
pub struct Library {
    /// The problems, and the scenes that are examples.
    pub catalogue: Catalogue,
    /// The folder whose files scenes may refer to; `None` if scenes must not refer to files.
    pub folder: Option<PathBuf>,
    /// The maximum size of these files.
    pub limit: SizeLimit,
}

/// An example in the list.
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

    /// Returns the examples: all scenes with branches.
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
