//! `tangency compare OLD NEW`: compares the special points of two documents.

use super::error::CommandError;
use super::request::value;
use crate::output::{Document, SizeLimit, compare_within, printable};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The examples shown in the help of `compare`.
const EXAMPLES: &str = "Examples:
  tangency compare reference.ron out/model.ron
  tangency compare reference.ron out/model.ron --allow 1e-3";

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
    /// Allow values to differ by this fraction of the largest value in their column, in addition to
    /// their errors
    #[arg(long, value_name = "FRACTION", default_value = "0", value_parser = fraction)]
    allow: f64,
}

/// Parses a fraction from 0 up to, but not including, 1.
pub fn fraction(text: &str) -> Result<f64, String> {
    let fraction = value(text)?;
    let refused = || format!("the fraction is {fraction}, but must be at least 0 and below 1");
    (0.0..1.0).contains(&fraction).then_some(fraction).ok_or_else(refused)
}

impl Compare {
    /// Compares the two documents and writes a line for each difference.
    pub fn run(&self, limit: SizeLimit, out: &mut impl Write) -> Result<(), CommandError> {
        let old = Document::load_within(limit, &self.old)?;
        let new = Document::load_within(limit, &self.new)?;
        check((&self.old, &old), &new, self.allow, out)
    }
}

/// Writes a line for each difference between a document and the reference document, and returns an
/// error if there are differences.
pub fn check(
    (place, old): (&Path, &Document),
    new: &Document,
    allowed: f64,
    out: &mut impl Write,
) -> Result<(), CommandError> {
    let found = compare_within(old, new, allowed);
    found
        .iter()
        .try_for_each(|difference| writeln!(out, "{}", printable(&difference.to_string())))?;
    match found.len() {
        0 => Ok(writeln!(out, "no differences from {}", place.display())?),
        count => Err(CommandError::Different { place: place.into(), count }),
    }
}
