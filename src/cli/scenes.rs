//! `tangency scenes`: the built-in scenes.

use super::CommandError;
use clap::Args;
use std::io::Write;
use tangency::scene::BUILT_IN;

/// List the built-in scenes, one line each
#[derive(Debug, Args)]
pub struct Scenes {}

impl Scenes {
    /// Writes one line for each scene.
    pub fn run(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let width = BUILT_IN.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
        for scene in BUILT_IN {
            writeln!(out, "{:width$}  {}", scene.name, scene.summary)?;
        }
        Ok(())
    }
}
