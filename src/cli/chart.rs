//! `tangency chart NAME`: what methods cost and what they buy.

use super::CommandError;
use clap::Args;
use std::io::Write;
use std::path::PathBuf;
use tangency::chart::{CHARTS, Effort, Entry, measure};
use tangency::output::{FileError, UnknownName, write_atomically};

/// Measure what methods cost and what they buy, as SVG, Markdown and RON
#[derive(Debug, Args)]
pub struct Chart {
    /// The chart, or `all`; without a name, the charts are listed
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// The folder for the charts
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Run every method once: errors are the same, times are rough
    #[arg(long)]
    quick: bool,
    /// A Markdown page into which summaries are put anew, each between `<!-- chart-NAME -->` and `<!-- end -->`
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

impl Chart {
    /// Measures, saves, and prints the tables.
    pub fn run(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let Some(name) = &self.name else {
            for Entry { name, shows, .. } in CHARTS {
                writeln!(out, "{name:<16} {shows}")?;
            }
            return Ok(());
        };
        let effort = if self.quick { Effort::Quick } else { Effort::Full };
        let chosen: Vec<&Entry> =
            CHARTS.iter().filter(|entry| name == "all" || entry.name == name).collect();
        if chosen.is_empty() {
            let known = CHARTS.iter().map(|entry| entry.name).chain(["all"]);
            return Err(CommandError::UnknownChart(UnknownName::new(
                "chart",
                name.as_str(),
                known,
            )));
        }
        for entry in chosen {
            let chart = measure(entry, effort)?;
            chart.save(&self.out)?;
            writeln!(out, "{}", chart.summary())?;
            if let Some(path) = &self.page {
                let read = |source| FileError::Read { path: path.clone(), source };
                let page = std::fs::read_to_string(path).map_err(read)?;
                write_atomically(path, chart.put_into(&page))?;
            }
            writeln!(out, "{}", self.out.join(format!("{}.svg", chart.name)).display())?;
        }
        Ok(())
    }
}
