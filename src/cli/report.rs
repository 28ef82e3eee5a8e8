//! The common part of commands that make reports: listing, choosing by name, saving, updating a page.

use super::CommandError;
use crate::core::names::UnknownName;
use crate::output::{FileError, Report, write_atomically};
use clap::Args;
use std::io::Write;
use std::path::PathBuf;

/// The choice of reports, and the target folder.
#[derive(Debug, Args)]
pub struct Wanted {
    /// The name, or `all`; without a name, the command lists all names
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// The folder for SVG, Markdown and RON
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// A Markdown page whose tables are replaced, each between `<!-- COMMAND-NAME -->` and `<!-- end -->`
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

/// The reports of a command: work-precision diagrams or robustness maps.
pub struct Reports<'a, E> {
    /// The command.
    pub command: &'static str,
    /// The noun in error messages.
    pub kind: &'static str,
    /// All reports.
    pub entries: &'a [E],
    /// The name, and one line about the contents.
    pub title: fn(&E) -> (&'static str, &'static str),
}

impl<E> Reports<'_, E> {
    /// Makes the chosen reports, saves them, and prints the tables; lists all names if none is given.
    pub fn run<R: Report>(
        &self,
        wanted: &Wanted,
        out: &mut impl Write,
        make: impl Fn(&E) -> Result<R, CommandError>,
    ) -> Result<(), CommandError> {
        let Some(name) = &wanted.name else {
            for (name, shows) in self.entries.iter().map(self.title) {
                writeln!(out, "{name:<16} {shows}")?;
            }
            return Ok(());
        };
        let known = |entry: &E| (self.title)(entry).0;
        let chosen: Vec<&E> =
            self.entries.iter().filter(|entry| name == "all" || known(entry) == name).collect();
        if chosen.is_empty() {
            let known = self.entries.iter().map(known).chain(["all"]);
            let name = UnknownName::new(self.kind, name.as_str(), known);
            return Err(CommandError::UnknownReport { name, command: self.command });
        }
        for entry in chosen {
            let report = make(entry)?;
            report.save(&wanted.out)?;
            writeln!(out, "{}", report.summary())?;
            if let Some(path) = &wanted.page {
                let read = |source| FileError::Read { path: path.clone(), source };
                let page = std::fs::read_to_string(path).map_err(read)?;
                write_atomically(path, report.put_into(&page))?;
            }
            writeln!(out, "{}", wanted.out.join(format!("{}.svg", report.name())).display())?;
        }
        Ok(())
    }
}
