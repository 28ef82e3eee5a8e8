//! `tangency chart NAME`: what methods cost and what they buy.

use super::CommandError;
use super::report::{Reports, Wanted};
use clap::Args;
use std::io::Write;
use tangency::chart::{CHARTS, Effort, measure};

/// Measure what methods cost and what they buy, as SVG, Markdown and RON
#[derive(Debug, Args)]
pub struct Chart {
    #[command(flatten)]
    wanted: Wanted,
    /// Run every method once: errors are the same, times are rough
    #[arg(long)]
    quick: bool,
}

impl Chart {
    /// Measures, saves, and prints the tables.
    pub fn run(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let effort = if self.quick { Effort::Quick } else { Effort::Full };
        let charts = Reports {
            command: "chart",
            kind: "chart",
            entries: CHARTS,
            title: |entry| (entry.name, entry.shows),
        };
        charts.run(&self.wanted, out, |entry| Ok(measure(entry, effort)?))
    }
}
