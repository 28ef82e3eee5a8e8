//! `tangency plot FILE…`: the diagram of one or several documents, or their branches as a table.

use super::error::CommandError;
use super::results::Results;
use crate::output::{
    self, Document, Format, Render, RenderError, SizeLimit, Sweeps, write_atomically,
};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Draw the branches of one or several documents as SVG, or list all their points as CSV
#[derive(Debug, Args)]
pub struct Plot {
    /// The documents (.ron), and sweeps (.npz)
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The parameter or monitor on the horizontal axis [default: as the first document says]
    #[arg(long, value_name = "NAME")]
    x: Option<String>,
    /// The parameter or monitor on the vertical axis [default: as the first document says]
    #[arg(long, value_name = "NAME")]
    y: Option<String>,
    /// The special points whose profiles are drawn, such as 2,5 or orbits/2
    /// [default: those of interest]
    #[arg(long, value_name = "LABEL or BRANCH/LABEL", value_delimiter = ',')]
    points: Vec<String>,
    /// Where it goes: .svg, .png (in builds with the feature `png`), or .csv for all points of the
    /// branches [default: beside the first document, with the ending .svg]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Plot {
    /// Draws the diagram and says where it is.
    pub fn run(&self, limit: SizeLimit, out: &mut impl Write) -> Result<(), CommandError> {
        let beside = || self.files.first().map(|file| file.with_extension("svg"));
        // Clap refuses an empty list.
        let target = self.out.clone().or_else(beside).unwrap_or_default();
        let inputs: Vec<&Path> = self.files.iter().map(PathBuf::as_path).collect();
        let _claimed = Results::claim_file(&target, &inputs)?;
        let format = Format::of(&target)?;
        let (archives, files): (Vec<_>, Vec<_>) =
            self.files.iter().partition(|file| file.extension().is_some_and(|e| e == "npz"));
        let documents = files.iter().map(|file| Document::load_within(limit, file));
        let mut documents = documents.collect::<Result<Vec<Document>, _>>()?;
        let sweeps = archives.iter().map(|file| Sweeps::load_within(limit, file));
        let sweeps = sweeps.collect::<Result<Vec<Sweeps>, _>>()?;
        if !self.points.is_empty() {
            let first = documents.first_mut().ok_or(CommandError::NoPoints)?;
            first.plot.points = self.points.clone();
        }
        let names: Vec<String> = files.iter().map(|file| stem(file)).collect();
        let named: Vec<(&str, &Document)> =
            names.iter().map(String::as_str).zip(&documents).collect();
        let results = output::Results {
            documents: &named,
            sweeps: &sweeps,
            x: self.x.as_deref(),
            y: self.y.as_deref(),
        };
        if format == Format::Csv {
            self.check_table(&sweeps)?;
        }
        let content = results.render(format).map_err(|cause| match cause {
            RenderError::Figure(cause) => {
                CommandError::Figure { files: super::error::named(&self.files), cause }
            }
            cause => CommandError::Unrendered(cause),
        })?;
        write_atomically(&target, content)?;
        Ok(writeln!(out, "{}", target.display())?)
    }

    /// Refuses options that choose what a figure shows, and sweeps: they have no effect on a table.
    fn check_table(&self, sweeps: &[Sweeps]) -> Result<(), CommandError> {
        let chosen = [
            ("--x", self.x.is_some()),
            ("--y", self.y.is_some()),
            ("--points", !self.points.is_empty()),
            ("sweeps (.npz)", !sweeps.is_empty()),
        ];
        match chosen.into_iter().find(|(_, given)| *given) {
            Some((option, _)) => Err(CommandError::Table(option)),
            None => Ok(()),
        }
    }
}

fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
