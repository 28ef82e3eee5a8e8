//! `tangency robustness NAME`: where methods succeed, report failures, or are silently wrong.

use super::CommandError;
use super::report::{Reports, Wanted};
use crate::robustness::{MAPS, map};
use clap::Args;
use std::io::Write;

/// Map where methods succeed, report failures, or are silently wrong, as SVG, Markdown and RON
#[derive(Debug, Args)]
pub struct Robustness {
    #[command(flatten)]
    wanted: Wanted,
}

impl Robustness {
    /// Computes, saves, and prints the tables.
    pub fn run(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let maps = Reports {
            command: "robustness",
            kind: "robustness map",
            entries: MAPS,
            title: |entry| (entry.name, entry.shows),
        };
        maps.run(&self.wanted, out, |entry| Ok(map(entry)?))
    }
}
