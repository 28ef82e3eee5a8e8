//! `tangency plot FILE…`: the diagram of one or several documents.

use super::error::CommandError;
use crate::output::{Document, Sweeps, draw, figures, write_atomically};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Draw the branches of one or several documents as SVG
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
    /// The special points whose profiles are drawn, such as 2,5 or orbits/2 [default: those of interest]
    #[arg(long, value_name = "LABEL or BRANCH/LABEL", value_delimiter = ',')]
    points: Vec<String>,
    /// Where the diagram goes [default: beside the first document, with the ending .svg]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Plot {
    /// Draws the diagram and says where it is.
    pub fn run(&self, out: &mut impl Write) -> Result<(), CommandError> {
        let target = self.target()?;
        let (archives, files): (Vec<_>, Vec<_>) =
            self.files.iter().partition(|file| file.extension().is_some_and(|e| e == "npz"));
        let mut documents =
            files.iter().map(Document::load).collect::<Result<Vec<Document>, _>>()?;
        let sweeps = archives.iter().map(Sweeps::load).collect::<Result<Vec<Sweeps>, _>>()?;
        if let (Some(first), false) = (documents.first_mut(), self.points.is_empty()) {
            first.plot.points = self.points.clone();
        }
        let names: Vec<String> = files.iter().map(|file| stem(file)).collect();
        let named: Vec<(&str, &Document)> =
            names.iter().map(String::as_str).zip(&documents).collect();
        let figures = figures(&named, &sweeps, self.x.as_deref(), self.y.as_deref())?;
        write_atomically(&target, &draw(&figures)?)?;
        Ok(writeln!(out, "{}", target.display())?)
    }

    fn target(&self) -> Result<PathBuf, CommandError> {
        // Clap refuses an empty list.
        let beside = self.files.first().map(|file| file.with_extension("svg"));
        let target = self.out.clone().or(beside).unwrap_or_default();
        match self.files.iter().any(|file| same_file(file, &target)) {
            true => Err(CommandError::OutputIsInput { path: target }),
            false => Ok(target),
        }
    }
}

/// Whether two paths lead to one file, also by way of links.
pub(super) fn same_file(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    a == b || real(a).is_some_and(|a| Some(a) == real(b))
}

fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
