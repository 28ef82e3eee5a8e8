//! `tangency work-precision NAME` and `tangency robustness NAME`: reports, listed, chosen by name,
//! saved, and put into pages.

use super::error::CommandError;
use super::results::Results;
use crate::core::problem::UnknownName;
use crate::output::{Entry, Format, Report, SizeLimit, read_text, write_atomically};
use crate::robustness::{MAPS, map};
use crate::work_precision::{DIAGRAMS, Effort, measure};
use clap::Args;
use std::io::Write;
use std::path::PathBuf;

/// The choice of reports, and the target folder.
#[derive(Debug, Args)]
struct Wanted {
    /// The name, or `all`; without a name, the command lists all names
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// The folder for SVG, Markdown and RON
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// A Markdown page whose tables are replaced, each between `<!-- COMMAND-NAME -->` and
    /// `<!-- end -->`
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

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
    pub fn run(&self, limit: SizeLimit, out: &mut impl Write) -> Result<(), CommandError> {
        let effort = if self.quick { Effort::Quick } else { Effort::Full };
        let names = ("work-precision", "work-precision diagram");
        self.wanted.make(names, DIAGRAMS, (limit, out), |entry| Ok(measure(entry, effort)?))
    }
}

/// Map where methods succeed, report failures, or are silently wrong, as SVG, Markdown and RON
#[derive(Debug, Args)]
pub struct Robustness {
    #[command(flatten)]
    wanted: Wanted,
}

impl Robustness {
    /// Computes, saves, and prints the tables.
    pub fn run(&self, limit: SizeLimit, out: &mut impl Write) -> Result<(), CommandError> {
        self.wanted
            .make(("robustness", "robustness map"), MAPS, (limit, out), |entry| Ok(map(entry)))
    }
}

impl Wanted {
    /// Makes the chosen reports of a command, saves them, and prints the tables; lists all names if
    /// none is given.
    fn make<M, R: Report>(
        &self,
        (command, kind): (&'static str, &str),
        entries: &[Entry<M>],
        (limit, out): (SizeLimit, &mut impl Write),
        make: impl Fn(&Entry<M>) -> Result<R, CommandError>,
    ) -> Result<(), CommandError> {
        let Some(name) = &self.name else {
            for Entry { name, shows, .. } in entries {
                writeln!(out, "{name:<16} {shows}")?;
            }
            return Ok(());
        };
        let chosen = || entries.iter().filter(|entry| name == "all" || entry.name == name);
        if chosen().next().is_none() {
            let known = entries.iter().map(|entry| entry.name).chain(["all"]);
            let name = UnknownName::new(kind, name.as_str(), known);
            return Err(CommandError::UnknownReport { name, command });
        }
        for entry in chosen() {
            let file = format!("{command}-{}", entry.name);
            let page = self.page.as_deref();
            let formats = [Format::Ron, Format::Markdown, Format::Svg];
            let results = Results::claim(&self.out, &file, &formats, page.as_slice())?;
            let report = make(entry)?;
            results.save_report(&report)?;
            writeln!(out, "{}", report.summary())?;
            if let Some(path) = &self.page {
                let page = read_text(path, limit)?;
                write_atomically(path, report.put_into(&page))?;
            }
            writeln!(out, "{}", results.path(Format::Svg).display())?;
        }
        Ok(())
    }
}
