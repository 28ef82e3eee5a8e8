//! The problems, examples and the opened file that all pages of a server share.

use super::setup::Setup;
use crate::output::SizeLimit;
use crate::scene::{Catalogue, Files, Range, Scene, SceneError};
use serde::Serialize;
use std::path::PathBuf;

/// The problems and examples of a server, and the setup with which pages begin.
#[derive(Clone, Debug)]
pub struct Shop {
    /// The problems, and the scenes that are examples.
    pub catalogue: Catalogue,
    /// The scene or model with which pages begin.
    pub opened: Option<Opened>,
    /// The maximum size of files that the opened scene refers to.
    pub limit: SizeLimit,
}

/// The scene or model with which pages begin.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// The name on the command line: of a built-in scene, or a path.
    pub place: String,
    /// The folder of the file, whose files the scene may refer to; `None` for a built-in scene.
    pub folder: Option<PathBuf>,
    /// The text and the request.
    pub setup: Setup,
}

/// An example in the list.
#[derive(Serialize)]
pub(super) struct Example<'a> {
    name: &'a str,
    summary: String,
}

impl Shop {
    /// Parses a scene. Only scenes of a server with an opened file may refer to other files.
    pub(super) fn parse(&self, text: &str) -> Result<Scene, SceneError> {
        match self.opened.as_ref().and_then(|opened| opened.folder.as_deref()) {
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

    /// Returns the setup of an example.
    pub(super) fn example(&self, name: &str) -> Option<Setup> {
        let scene = self.catalogue.scenes().iter().find(|scene| scene.name == name)?;
        Some(Setup { name: scene.name.clone(), text: scene.text.clone(), ..Setup::default() })
    }

    /// Returns the setup with which a page begins: the opened one, or a fold.
    pub(super) fn beginning(&self) -> Setup {
        let simple = || Setup {
            name: "fold".into(),
            text: SIMPLE.into(),
            along: vec![Range { name: "load".into(), low: Some(0.0), high: Some(0.3) }],
            ..Setup::default()
        };
        self.opened.as_ref().map_or_else(simple, |opened| opened.setup.clone())
    }
}

/// The model of pages without an opened scene.
const SIMPLE: &str = "# Parallel-plate actuator: pull-in at u = 1/3, load = 4/27.
u' = load/(1 - u)^2 - k*u
par load=0, k=1
init u=0
";
