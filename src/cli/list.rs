//! `tangency scenes`: lists the built-in scenes.

use super::error::CommandError;
use crate::scene::Catalogue;
use clap::Args;
use std::io::Write;

/// List the built-in scenes, one line each
#[derive(Debug, Args)]
pub struct Scenes {}

impl Scenes {
    /// Writes a line for each built-in scene.
    pub fn run(&self, catalogue: &Catalogue, out: &mut impl Write) -> Result<(), CommandError> {
        let scenes = catalogue.scenes();
        let width = scenes.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
        for scene in scenes {
            writeln!(out, "{:width$}  {}", scene.name, catalogue.summary(scene))?;
        }
        Ok(())
    }
}
