//! `tangency-reports work-precision NAME` and `tangency-reports robustness NAME`: list reports,
//! compute those chosen by name, save them, and update pages.

use clap::{Args, Parser, Subcommand};
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use tangency::core::problem::UnknownName;
use tangency::output::write_atomically;
use tangency::spelling::sentence;
use tangency_reports::robustness::{MAPS, map};
use tangency_reports::work_precision::{DIAGRAMS, Effort, measure};
use tangency_reports::{Entry, Report};

/// Measure the methods of tangency
#[derive(Debug, Parser)]
#[command(version, about, disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    WorkPrecision(WorkPrecision),
    Robustness(Robustness),
}

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
struct WorkPrecision {
    #[command(flatten)]
    wanted: Wanted,
    /// Run every method once: same errors, rough times
    #[arg(long)]
    quick: bool,
}

/// Map where methods succeed, report failures, or are silently wrong, as SVG, Markdown and RON
#[derive(Debug, Args)]
struct Robustness {
    #[command(flatten)]
    wanted: Wanted,
}

fn main() -> ExitCode {
    let mut out = std::io::stdout().lock();
    let made = match Arguments::parse().command {
        Command::WorkPrecision(WorkPrecision { wanted, quick }) => {
            let effort = if quick { Effort::Quick } else { Effort::Full };
            let names = ("work-precision", "work-precision diagram");
            wanted.make(names, DIAGRAMS, &mut out, |entry| Ok(measure(entry, effort)?))
        }
        Command::Robustness(Robustness { wanted }) => {
            let names = ("robustness", "robustness map");
            wanted.make(names, MAPS, &mut out, |entry| Ok(map(entry)))
        }
    };
    match made {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::FAILURE
        }
    }
}

impl Wanted {
    /// Computes the chosen reports, saves them, and prints the tables; lists all names if none is
    /// given.
    fn make<M, R: Report>(
        &self,
        (command, kind): (&str, &str),
        entries: &[Entry<M>],
        out: &mut impl Write,
        make: impl Fn(&Entry<M>) -> Result<R, Box<dyn Error>>,
    ) -> Result<(), Box<dyn Error>> {
        let Some(name) = &self.name else {
            for Entry { name, shows, .. } in entries {
                writeln!(out, "{name:<16} {shows}")?;
            }
            return Ok(());
        };
        let chosen = || entries.iter().filter(|entry| name == "all" || entry.name == name);
        if chosen().next().is_none() {
            let known = entries.iter().map(|entry| entry.name).chain(["all"]);
            let unknown = UnknownName::new(kind, name.as_str(), known);
            return Err(
                format!("{}; `tangency-reports {command}` lists all", sentence(&unknown)).into()
            );
        }
        std::fs::create_dir_all(&self.out)?;
        for entry in chosen() {
            let report = make(entry)?;
            report.save(&self.out)?;
            writeln!(out, "{}", report.summary())?;
            if let Some(path) = &self.page {
                let page = std::fs::read_to_string(path)?;
                write_atomically(path, report.put_into(&page))?;
            }
            writeln!(out, "{}", self.out.join(format!("{}.svg", report.name())).display())?;
        }
        Ok(())
    }
}
