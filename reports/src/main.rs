//! The program `tangency-reports`: its commands `work-precision NAME` and `robustness NAME` list,
//! compute and save reports, and insert them into pages; its command `gallery` writes interactive
//! pages of all scenes, and its command `sentences` draws random sentences of the project's text.

use clap::{Args, Parser, Subcommand};
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use tangency::core::failure::one_line;
use tangency::core::problem::UnknownName;
use tangency::output::write_atomically;
use tangency_reports::gallery::{Entry as Shown, entries, gallery};
use tangency_reports::prose::{drawn, paragraphs};
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
    Gallery(Gallery),
    Sentences(Sentences),
}

/// The reports to make, and the folder in which they are saved.
#[derive(Debug, Args)]
struct Wanted {
    /// The name of the report, or `all` for all reports; without a name, the command lists the
    /// names of the reports
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// The folder for the SVG, Markdown and RON files of the report
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// A Markdown page in which the tables of the report are updated; each table lies between the
    /// comments `<!-- COMMAND-NAME -->` and `<!-- end -->`
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

/// Measure the error of methods against their CPU time, as SVG, Markdown and RON
#[derive(Debug, Args)]
struct WorkPrecision {
    #[command(flatten)]
    wanted: Wanted,
    /// Run every method only once: the errors are the same as in a full run, but the measured times
    /// are rough
    #[arg(long)]
    quick: bool,
}

/// Map where methods succeed, report failures, or are silently wrong, as SVG, Markdown and RON
#[derive(Debug, Args)]
struct Robustness {
    #[command(flatten)]
    wanted: Wanted,
}

/// Trace all built-in scenes and models, and write their interactive pages with an index
#[derive(Debug, Args)]
struct Gallery {
    /// The names of the scenes to trace; without a name, the command traces all scenes
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// The folder in which the gallery is written; the book includes the gallery in `docs/gallery`
    #[arg(long, value_name = "DIR", default_value = "docs/gallery")]
    out: PathBuf,
}

impl Gallery {
    /// Writes the gallery, and prints a line for each scene.
    ///
    /// # Errors
    /// An unknown name, a file that cannot be written, or scenes that could not be traced; the
    /// error names these scenes.
    fn make(&self) -> Result<(), Box<dyn Error>> {
        let mut chosen = entries();
        for name in &self.names {
            let known = chosen.iter().map(|entry| entry.name.as_str());
            if !known.clone().any(|known| known == name) {
                return Err(one_line(&UnknownName::new("scene", name.as_str(), known)).into());
            }
        }
        chosen.retain(|entry| self.names.is_empty() || self.names.contains(&entry.name));
        let begin = Instant::now();
        let made = gallery(&chosen, &self.out, &|Shown { name, .. }, time, failure| {
            let time = time.as_secs_f64();
            match failure {
                None => println!("{name:<26}{time:6.1} s"),
                Some(failure) => println!("{name:<26}{time:6.1} s  failed: {failure}"),
            }
        })?;
        println!("{} scenes, {:.1} s", chosen.len(), begin.elapsed().as_secs_f64());
        println!("{}", made.index.display());
        match &made.failures[..] {
            [] => Ok(()),
            failures => {
                let failures = failures.iter().map(|(name, cause)| format!("{name}: {cause}"));
                let failures: Vec<String> = failures.collect();
                Err(format!("not drawn: {}", failures.join("; ")).into())
            }
        }
    }
}

/// Draw sentences of documents, help, messages and doc comments, to be judged one by one
#[derive(Debug, Args)]
struct Sentences {
    /// The seed of the random draw of sentences; the same seed draws the same sentences
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The number of sentences to select at random
    #[arg(long, default_value_t = 200)]
    count: usize,
    /// The root folder of the project from which the sentences are sampled at random
    #[arg(long, value_name = "DIR", default_value = ".")]
    root: PathBuf,
}

impl Sentences {
    fn print(&self, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
        let all = paragraphs(&self.root)?;
        for (number, (paragraph, sentence)) in drawn(&all, self.count, self.seed).iter().enumerate()
        {
            let (file, line) = (paragraph.file.display(), paragraph.line);
            writeln!(
                out,
                "{:3}  {sentence}\n     ({}, {file}:{line})",
                number + 1,
                paragraph.source
            )?;
        }
        Ok(())
    }
}

fn main() -> ExitCode {
    let mut out = std::io::stdout();
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
        Command::Gallery(gallery) => gallery.make(),
        Command::Sentences(sentences) => sentences.print(&mut out),
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
    /// Computes the chosen reports, saves them, and prints their tables; lists the names of all
    /// reports if no name is given.
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
                format!("{}; `tangency-reports {command}` lists all", one_line(&unknown)).into()
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
