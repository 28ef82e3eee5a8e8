//! `tangency points FILE`: the table of special points.

use super::CommandError;
use crate::output::{Document, csv};
use clap::Args;
use std::io::Write;
use std::path::PathBuf;

/// Print the special points of a document as comma-separated values
#[derive(Debug, Args)]
pub struct Points {
    /// The document (.ron)
    file: PathBuf,
}

impl Points {
    /// Writes the table.
    pub fn run(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let document = Document::load(&self.file)?;
        Ok(out.write_all(csv(&document.branches).as_bytes())?)
    }
}
