//! `tangency plot FILE…`: draws the diagram of documents, or writes their branches as a table.

use super::error::CommandError;
use super::results::Results;
use crate::output::{
    self, Document, Format, Render, RenderError, SizeLimit, Sweeps, write_atomically,
};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The examples shown in the help of `plot`.
const EXAMPLES: &str = "Examples:
  tangency plot out/lorenz.ron --y z,max_z --out z.svg
  tangency plot out/lorenz.ron --panel b --width 84 --out period.png
  tangency plot a/model.ron b/model.ron --out both.svg
  tangency plot out/curves.ron --regions --out regions.pdf
  tangency plot out/lorenz.ron --out lorenz.html
  tangency plot out/lorenz.ron --out lorenz.csv
  tangency plot out/lorenz.ron --points cycles/2 --out orbit.csv";

/// Draw the branches of one or several documents, or write their data
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Plot {
    /// The documents (.ron) and sweeps (.npz)
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The parameter or monitor on the horizontal axis [default: the first document's choice]
    #[arg(long, value_name = "NAME")]
    x: Option<String>,
    /// The columns on the vertical axis, such as v (the largest and smallest values of a state),
    /// max_v, or period [default: the first document's choice]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    y: Vec<String>,
    /// The columns shown on logarithmic axes, such as period
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    log: Vec<String>,
    /// Write the numbers of unstable directions on the two sides of curves in two parameters
    #[arg(long)]
    regions: bool,
    /// The special points whose profiles are drawn, or written as .csv or .npz, such as 2,5 or
    /// orbits/2, or all [default: a few points with different profiles]
    #[arg(long, value_name = "LABEL or BRANCH/LABEL or all", value_delimiter = ',')]
    points: Vec<String>,
    /// The width of the picture in millimetres, such as 84 for a journal's column [default: 170]
    #[arg(long, value_name = "MM")]
    width: Option<f64>,
    /// The letter of the only panel to draw [default: all panels]
    #[arg(long, value_name = "LETTER")]
    panel: Option<String>,
    /// The separator of a table (.csv), such as ; or tab [default: a comma]
    #[arg(long, value_name = "LETTER", value_parser = separator)]
    separator: Option<char>,
    /// The output file: .svg, .png, .pdf, .html for an interactive page, .csv for all points of
    /// branches or sweeps, .json for a document, or, with --points, .csv or .npz for profiles
    /// [default: an .svg file in the folder of the first document, named after the columns]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// The maximum number of letters that columns and points add to the name of a picture.
const LONGEST: usize = 60;

impl Plot {
    /// Draws the diagram and prints the path of its file.
    pub fn run(&self, limit: SizeLimit, out: &mut impl Write) -> Result<(), CommandError> {
        let beside = || self.files.first().map(|file| self.beside(file));
        // Clap rejects an empty list of files.
        let target = self.out.clone().or_else(beside).unwrap_or_default();
        let inputs: Vec<&Path> = self.files.iter().map(PathBuf::as_path).collect();
        let _claimed = Results::claim_file(&target, &inputs)?;
        let format = Format::of(&target)?;
        let (archives, files): (Vec<_>, Vec<_>) =
            self.files.iter().partition(|file| file.extension().is_some_and(|e| e == "npz"));
        let documents = files.iter().map(|file| Document::load_within(limit, file));
        let mut documents = documents.collect::<Result<Vec<Document>, _>>()?;
        let sweeps = archives.iter().map(|file| Sweeps::load_within(limit, file));
        let mut sweeps = sweeps.collect::<Result<Vec<Sweeps>, _>>()?;
        let plots = documents.iter_mut().map(|document| &mut document.plot);
        // The first document or sweep defines how all are drawn.
        if let Some(plot) = plots.chain(sweeps.iter_mut().map(|it| &mut it.plot)).next() {
            plot.logarithmic.extend(self.log.iter().cloned());
        }
        self.add_regions(&mut documents)?;
        if !self.points.is_empty() && documents.is_empty() {
            return Err(CommandError::NoPoints);
        }
        let names: Vec<String> = files.iter().map(|file| stem(file)).collect();
        let named: Vec<(&str, &Document)> =
            names.iter().map(String::as_str).zip(&documents).collect();
        let y: Vec<&str> = self.y.iter().map(String::as_str).collect();
        let results = output::Results {
            documents: &named,
            sweeps: &sweeps,
            x: self.x.as_deref(),
            y: &y,
            points: &self.points,
            width: self.width,
            panel: self.panel.as_deref(),
        };
        self.check(format, &sweeps)?;
        let content = results.render(format).map_err(|cause| match cause {
            RenderError::Figure(cause) => {
                CommandError::Figure { files: super::error::named(&self.files), cause }
            }
            cause => CommandError::Unrendered(cause),
        })?;
        let content = match self.separator {
            Some(separator) => {
                output::separated(&String::from_utf8_lossy(&content), separator).into_bytes()
            }
            None => content,
        };
        write_atomically(&target, content)?;
        Ok(writeln!(out, "{}", target.display())?)
    }

    /// Turns on regions if `--regions` is given.
    fn add_regions(&self, documents: &mut [Document]) -> Result<(), CommandError> {
        let mut branches = documents.iter().flat_map(|document| &document.branches);
        if self.regions && branches.all(|branch| branch.stretches.is_empty()) {
            return Err(CommandError::NoRegions);
        }
        documents.iter_mut().for_each(|document| document.plot.regions |= self.regions);
        Ok(())
    }

    /// Returns the default path of the picture, in the folder of a document: `lure.svg`, as written
    /// by `trace`, or `lure-x=alpha-min_x.svg` with other columns or points.
    fn beside(&self, file: &Path) -> PathBuf {
        let x = self.x.iter().map(|column| format!("-x={column}"));
        let others = self.y.iter().chain(&self.points).map(|column| format!("-{column}"));
        let others = others.chain(self.log.iter().map(|column| format!("-log-{column}")));
        let panel = self.panel.iter().map(|panel| format!("-panel={panel}"));
        let width = self.width.iter().map(|width| format!("-width={width}"));
        let regions = self.regions.then(|| "-regions".to_string());
        let others = others.chain(panel).chain(width).chain(regions);
        let plain = |letter: char| letter.is_alphanumeric() || "_-.=".contains(letter);
        let chosen = x.chain(others).collect::<String>().replace(|letter| !plain(letter), "_");
        let chosen: String = chosen.chars().take(LONGEST).collect();
        file.with_file_name(format!("{}{chosen}.svg", stem(file)))
    }

    /// Rejects options that would have no effect.
    fn check(&self, format: Format, sweeps: &[Sweeps]) -> Result<(), CommandError> {
        if self.separator.is_some() && format != Format::Csv {
            return Err(CommandError::NoSeparator);
        }
        if format == Format::Html && self.width.is_some() {
            return Err(CommandError::PageWidth);
        }
        if matches!(format, Format::Svg | Format::Png | Format::Pdf | Format::Html) {
            let in_columns = self.x.is_some() || !self.y.is_empty();
            return match () {
                () if in_columns && !self.points.is_empty() => Err(CommandError::PointsInColumns),
                () if self.y.len() > 1 && !sweeps.is_empty() => Err(CommandError::OneColumn),
                () => Ok(()),
            };
        }
        let chosen = [
            ("--width", self.width.is_some()),
            ("--panel", self.panel.is_some()),
            ("--x", self.x.is_some()),
            ("--y", !self.y.is_empty()),
            ("--log", !self.log.is_empty()),
            ("--regions", self.regions),
        ];
        match chosen.into_iter().find(|(_, given)| *given) {
            Some((option, _)) => Err(CommandError::Table(option)),
            None => Ok(()),
        }
    }
}

/// Parses a separator of cells: a letter that does not occur in numbers.
pub fn separator(text: &str) -> Result<char, String> {
    let mut letters = text.chars();
    match (text, letters.next(), letters.next()) {
        ("tab", _, _) => Ok('\t'),
        (_, Some(letter @ (',' | ';' | '|' | ':' | ' ' | '\t')), None) => Ok(letter),
        _ => Err("a separator is one of , ; | : a space, or tab".into()),
    }
}

fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
