//! `tangency scenes` and `tangency points FILE`: the scenes that have a name, and special points as
//! a table.

use super::error::CommandError;
use crate::output::{Document, SizeLimit, csv};
use crate::scene::Catalogue;
use clap::Args;
use std::io::Write;
use std::path::PathBuf;

/// List the scenes that have a name, one line each
#[derive(Debug, Args)]
pub struct Scenes {}

impl Scenes {
    /// Writes one line for each scene.
    pub fn run(&self, catalogue: &Catalogue, out: &mut impl Write) -> Result<(), CommandError> {
        let scenes = catalogue.scenes();
        let width = scenes.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
        for scene in scenes {
            writeln!(out, "{:width$}  {}", scene.name, catalogue.summary(scene))?;
        }
        Ok(())
    }
}

/// Print the special points of a document as comma-separated values
#[derive(Debug, Args)]
pub struct Points {
    /// The document (.ron)
    file: PathBuf,
}

impl Points {
    /// Writes the table.
    pub fn run(&self, limit: SizeLimit, out: &mut impl Write) -> Result<(), CommandError> {
        let document = Document::load_within(limit, &self.file)?;
        Ok(out.write_all(csv(&document.branches).as_bytes())?)
    }
}
