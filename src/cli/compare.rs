//! `tangency compare OLD NEW`: compares the special points of two documents.

use super::error::CommandError;
use crate::output::{Document, SizeLimit, compare, printable};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The examples shown in the help of `compare`.
const EXAMPLES: &str = "Examples:
  tangency compare reference.ron out/model.ron";

/// List special points that appeared, disappeared, or moved by more than their errors
///
/// The exit code is 1 if the documents differ.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Compare {
    /// The reference document (.ron)
    old: PathBuf,
    /// The document to compare with the reference (.ron)
    new: PathBuf,
}

impl Compare {
    /// Compares the two documents and writes a line for each difference.
    pub fn run(&self, limit: SizeLimit, out: &mut impl Write) -> Result<(), CommandError> {
        let old = Document::load_within(limit, &self.old)?;
        let new = Document::load_within(limit, &self.new)?;
        check(&self.old, &old, &new, out)
    }
}

/// Writes a line for each difference between a document and the reference document, and returns an
/// error if there are differences.
pub fn check(
    place: &Path,
    old: &Document,
    new: &Document,
    out: &mut impl Write,
) -> Result<(), CommandError> {
    let found = compare(old, new);
    found
        .iter()
        .try_for_each(|difference| writeln!(out, "{}", printable(&difference.to_string())))?;
    match found.len() {
        0 => Ok(writeln!(out, "no differences from {}", place.display())?),
        count => Err(CommandError::Different { place: place.into(), count }),
    }
}
