//! `tangency work-precision NAME`: error of methods against CPU time.

use super::CommandError;
use super::report::{Reports, Wanted};
use crate::work_precision::{DIAGRAMS, Effort, measure};
use clap::Args;
use std::io::Write;

/// Measure error against CPU time of methods, as SVG, Markdown and RON
#[derive(Debug, Args)]
pub struct WorkPrecision {
    #[command(flatten)]
    wanted: Wanted,
    /// Run every method once: same errors, rough times
    #[arg(long)]
    quick: bool,
}

impl WorkPrecision {
    /// Measures, saves, and prints the tables.
    pub fn run(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let effort = if self.quick { Effort::Quick } else { Effort::Full };
        let diagrams = Reports {
            command: "work-precision",
            kind: "work-precision diagram",
            entries: DIAGRAMS,
            title: |entry| (entry.name, entry.shows),
        };
        diagrams.run(&self.wanted, out, |entry| Ok(measure(entry, effort)?))
    }
}
