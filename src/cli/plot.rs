//! `tangency plot FILE…`: draws the diagram of documents, or writes the branches of the documents
//! as a table.

use super::cells::Cells;
use super::error::CommandError;
use super::request::end;
use super::results::Results;
use super::sources::Sources;
use super::warning::warn;
use crate::core::continuation::Branch;
use crate::core::problem::UnknownName;
use crate::output::{
    self, Document, Format, Render, RenderError, SweepTable, Sweeps, sort_by_number, tell_apart,
    write_atomically,
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
    /// The documents (.ron) and sweeps (.npz) to draw
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The parameter or monitor on the horizontal axis, or time or a state for a simulated history
    /// [default: as stated in the first document]
    #[arg(long, value_name = "NAME")]
    x: Option<String>,
    /// The columns on the vertical axis: for example, v draws both the largest and the smallest
    /// values of the state v, and max_v draws only the largest values [default: as stated in the
    /// first document]
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    y: Vec<String>,
    /// The range of the horizontal axis to show, in the units of the column on this axis; either
    /// end may be omitted. The range applies to panel a, or to the panel chosen with --panel, and
    /// to further panels with the same horizontal axis
    #[arg(long, value_name = "LOW..HIGH", value_parser = ends, allow_hyphen_values = true)]
    x_range: Option<Ends>,
    /// The range of the vertical axis to show, in the same form as the range of --x-range
    #[arg(long, value_name = "LOW..HIGH", value_parser = ends, allow_hyphen_values = true)]
    y_range: Option<Ends>,
    /// The columns to draw on logarithmic axes, such as period
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    log: Vec<String>,
    /// Label the two sides of each curve in two parameters with the numbers of unstable directions
    #[arg(long)]
    regions: bool,
    /// The special points whose profiles are drawn, or written as .csv or .npz; give their labels
    /// (2,5), their labels with the names of their branches (orbits/2,orbits/5), a kind instead of a
    /// label for all points of this kind (UZ,orbits/PD), or the word all [default: a few points with
    /// different profiles]
    #[arg(long, value_name = "LABEL or BRANCH/LABEL or all", value_delimiter = ',')]
    points: Vec<String>,
    /// The width of the picture in millimetres, such as 84 for a journal's column [default: 170]
    #[arg(long, value_name = "MM")]
    width: Option<f64>,
    /// The title of the picture [default: the first document's title]
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// The letter of the only panel to draw [default: all panels]
    #[arg(long, value_name = "LETTER")]
    panel: Option<String>,
    #[command(flatten)]
    cells: Cells,
    /// The output file, whose extension chooses the format: .svg, .png or .pdf for a picture, .html
    /// for an interactive page, .csv for all points of branches or sweeps, .json for a document,
    /// or, with --points, .csv or .npz for profiles [default: an .svg file in the folder of the
    /// first document, named after the columns]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// The lower and the upper end of an axis; either end may be missing.
#[derive(Clone, Copy, Debug)]
struct Ends([Option<f64>; 2]);

/// The maximum number of letters that the names of columns and points add to the file name of a
/// picture.
const LONGEST: usize = 60;

impl Plot {
    /// Draws the diagram, and prints the path of the picture file.
    pub fn run(&self, from: Sources, out: &mut impl Write) -> Result<(), CommandError> {
        let beside = || self.files.first().map(|file| self.beside(file));
        // Clap rejects an empty list of files.
        let target = self.out.clone().or_else(beside).unwrap_or_default();
        let inputs: Vec<&Path> = self.files.iter().map(PathBuf::as_path).collect();
        let _claimed = Results::claim_file(&target, &inputs)?;
        let format = Format::of(&target)?;
        let (archives, files): (Vec<_>, Vec<_>) =
            self.files.iter().partition(|file| file.extension().is_some_and(|e| e == "npz"));
        let documents = files
            .into_iter()
            .map(|file| Document::load_within(from.limit, file).map(|document| (file, document)));
        let mut documents = documents.collect::<Result<Vec<(&PathBuf, Document)>, _>>()?;
        sort_by_number(&mut documents);
        let (files, mut documents): (Vec<_>, Vec<_>) = documents.into_iter().unzip();
        let sweeps = archives.iter().map(|file| Sweeps::load_within(from.limit, file));
        let mut sweeps = sweeps.collect::<Result<Vec<Sweeps>, _>>()?;
        let scenes = scenes(from, &archives, &sweeps);
        tell_apart(&mut sweeps, &scenes);
        let plots = documents.iter_mut().map(|document| &mut document.plot);
        // The first document or sweep defines how all are drawn.
        if let Some(plot) = plots.chain(sweeps.iter_mut().map(|it| &mut it.plot)).next() {
            plot.logarithmic.extend(self.log.iter().cloned());
        }
        self.add_regions(&mut documents)?;
        if !self.points.is_empty() && documents.is_empty() {
            return Err(CommandError::NoPoints);
        }
        let names = names(&files, format);
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
            title: self.title.as_deref(),
            ends: [self.x_range, self.y_range].map(|ends| ends.map_or([None; 2], |it| it.0)),
            plotly: None,
        };
        self.check(format, &sweeps)?;
        let content = results.render(format).map_err(|cause| match cause {
            RenderError::Figure(cause) => {
                CommandError::Figure { files: super::error::named(&self.files), cause }
            }
            cause => CommandError::Unrendered(cause),
        })?;
        self.warn_of_absent(from, &named, &sweeps);
        let content = match format {
            Format::Csv => self.cells.rewrite(&String::from_utf8_lossy(&content))?.into_bytes(),
            _ => content,
        };
        write_atomically(&target, content)?;
        Ok(writeln!(out, "{}", target.display())?)
    }

    /// Warns of documents and sweeps that lack a requested column and are not drawn.
    fn warn_of_absent(&self, from: Sources, documents: &[(&str, &Document)], sweeps: &[Sweeps]) {
        for column in self.x.iter().chain(&self.y) {
            for (name, document) in documents {
                // The axes of histories may show the time and states.
                let in_profiles = |branch: &Branch| {
                    let mut profiles = branch.special.iter().flat_map(|point| &point.profiles);
                    profiles.any(|profile| [&profile.along, &profile.name].contains(&column))
                };
                let lacks = |branch: &Branch| {
                    branch.columns_showing(column).is_empty() && !in_profiles(branch)
                };
                if document.branches.iter().all(lacks) {
                    warn(&format!("`{name}` has no column `{column}` and is not drawn"));
                }
            }
        }
        // Without requested columns, the first document chooses them.
        let plot = documents.first().map(|(_, document)| &document.plot);
        let x = self.x.as_ref().or_else(|| plot.and_then(|plot| plot.x.as_ref()));
        let y = self.y.first().or_else(|| plot.and_then(|plot| plot.y.as_ref()));
        for column in x.into_iter().chain(y) {
            for sweeps in sweeps {
                let lacking = sweeps.sweeps.iter().filter(|table| !table.has_column(column));
                for table in lacking {
                    let remedy = remedy(from, sweeps, table, column);
                    let name = &table.name;
                    warn(&format!(
                        "the sweep `{name}` has no column `{column}` and is not drawn{remedy}"
                    ));
                }
            }
        }
    }

    /// Draws the regions of a two-parameter diagram if `--regions` is given.
    fn add_regions(&self, documents: &mut [Document]) -> Result<(), CommandError> {
        let mut branches = documents.iter().flat_map(|document| &document.branches);
        if self.regions && branches.all(|branch| branch.stretches.is_empty()) {
            return Err(CommandError::NoRegions);
        }
        documents.iter_mut().for_each(|document| document.plot.regions |= self.regions);
        Ok(())
    }

    /// Returns the default path of the picture, in the folder of a document. An example of a file
    /// name is `lure.svg`, which `trace` also uses; if the command line chooses columns or points,
    /// they are added to the name, as in `lure-x=alpha-min_x.svg`.
    fn beside(&self, file: &Path) -> PathBuf {
        let x = self.x.iter().map(|column| format!("-x={column}"));
        let others = self.y.iter().chain(&self.points).map(|column| format!("-{column}"));
        let others = others.chain(self.log.iter().map(|column| format!("-log-{column}")));
        let written = |end: Option<f64>| end.map_or(String::new(), |end| end.to_string());
        let ranges = [("x", self.x_range), ("y", self.y_range)].into_iter();
        let ranges =
            ranges.filter_map(|(axis, ends)| Some((axis, ends?.0))).map(|(axis, [low, high])| {
                format!("-{axis}-range={}..{}", written(low), written(high))
            });
        let title = self.title.iter().map(|_| "-title".to_string());
        let panel = self.panel.iter().map(|panel| format!("-panel={panel}"));
        let width = self.width.iter().map(|width| format!("-width={width}"));
        let regions = self.regions.then(|| "-regions".to_string());
        let others = others.chain(ranges).chain(title).chain(panel).chain(width).chain(regions);
        let plain = |letter: char| letter.is_alphanumeric() || "_-.=".contains(letter);
        let chosen = x.chain(others).collect::<String>().replace(|letter| !plain(letter), "_");
        let chosen: String = chosen.chars().take(LONGEST).collect();
        file.with_file_name(format!("{}{chosen}.svg", stem(file)))
    }

    /// Rejects options that would have no effect on the output.
    fn check(&self, format: Format, sweeps: &[Sweeps]) -> Result<(), CommandError> {
        if format != Format::Csv {
            self.cells.refuse()?;
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
            ("--x-range", self.x_range.is_some()),
            ("--y-range", self.y_range.is_some()),
            ("--log", !self.log.is_empty()),
            ("--title", self.title.is_some()),
            ("--regions", self.regions),
        ];
        match chosen.into_iter().find(|(_, given)| *given) {
            Some((option, _)) => Err(CommandError::Table(option)),
            None => Ok(()),
        }
    }
}

/// Returns the end of a warning of a missing column: the option that records the column, if a sweep
/// of the scene can record it, and otherwise the columns that the sweep has.
fn remedy(from: Sources, sweeps: &Sweeps, table: &SweepTable, column: &str) -> String {
    let scene = from.catalogue.parse_alone(&sweeps.scene).ok();
    let sampling = scene.and_then(|scene| scene.sampling().ok()).unwrap_or_default();
    if sampling.measures.iter().any(|measure| measure == column) {
        return format!(": repeat the sweep with `--measure {column}`");
    }
    let known = table.run_columns.iter().chain(&table.point_columns).map(String::as_str);
    format!(" ({})", UnknownName::new("column", column, known).remedy())
}

/// Returns the name of each archive of sweeps, and the settings of its scene. An archive whose scene
/// cannot be parsed has no settings.
fn scenes(
    from: Sources,
    archives: &[&PathBuf],
    sweeps: &[Sweeps],
) -> Vec<(String, Vec<(String, String)>)> {
    let settings = |sweeps: &Sweeps| {
        let scene = from.catalogue.parse_alone(&sweeps.scene).ok();
        scene.map_or(Vec::new(), |scene| scene.record())
    };
    let names = names(archives, Format::Svg).into_iter();
    names.zip(sweeps.iter().map(settings)).collect()
}

/// Returns the names by which a picture refers to the documents: their file names if these are
/// different, and otherwise their paths.
fn names(files: &[&PathBuf], format: Format) -> Vec<String> {
    let stems: Vec<String> = files.iter().map(|file| stem(file)).collect();
    let repeated = (1..stems.len()).any(|k| stems[..k].contains(&stems[k]));
    let paths = |path: fn(&Path) -> PathBuf| -> Vec<String> {
        files.iter().map(|file| path(file).display().to_string()).collect()
    };
    match format {
        Format::Csv | Format::Npz if files.len() > 1 => paths(Path::to_path_buf),
        _ if repeated => paths(|file| file.with_extension("")),
        _ => stems,
    }
}

/// Parses the range `LOW..HIGH` of an axis; either end may be omitted.
fn ends(text: &str) -> Result<Ends, String> {
    match text.split_once("..").map(|(low, high)| (low.trim(), high.trim())) {
        Some((low, high)) if !(low.is_empty() && high.is_empty()) => {
            let ends = [end(low)?, end(high)?];
            match ends {
                [Some(low), Some(high)] if low >= high => Err(format!(
                    "the lower end {low} of the range must be below the upper end \
                                 {high}"
                )),
                _ => Ok(Ends(ends)),
            }
        }
        _ => Err(format!("`{text}` is not of the form LOW..HIGH, for example 0..30")),
    }
}

fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
