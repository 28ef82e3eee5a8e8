//! `tangency stability NAME`: where methods fail, and what they say then.

use super::CommandError;
use super::report::{Reports, Wanted};
use clap::Args;
use std::io::Write;
use tangency::stability::{MAPS, map};

/// Draw maps of where methods work, where they fail and say so, and where they are wrong, as SVG, Markdown and RON
#[derive(Debug, Args)]
pub struct Stability {
    #[command(flatten)]
    wanted: Wanted,
}

impl Stability {
    /// Computes, saves, and prints the tables.
    pub fn run(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let maps = Reports {
            command: "stability",
            kind: "map",
            entries: MAPS,
            title: |entry| (entry.name, entry.shows),
        };
        maps.run(&self.wanted, out, |entry| Ok(map(entry)?))
    }
}
