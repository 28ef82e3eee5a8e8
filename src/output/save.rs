//! Rendering of results in all file formats, and saving of several files together.

use super::axis::clip;
use super::document::Document;
use super::drawing::{PAGE, draw, letter, pdf, png};
use super::error::{FigureError, FileError, FormatError};
use super::figure::Figure;
use super::files::write_together;
use super::format::Format;
use super::histories::{arrays, arrays_of_points, histories, of_points};
use super::names::distinguished;
use super::page::page;
use super::panels::{figures, of_histories};
use super::profiles::{Shown, named};
use super::sweeps::{Sweeps, csv as of_sweeps};
use super::table::table;
use crate::core::failure::debug_is_message;
use std::path::{Path, PathBuf};

debug_is_message!(SaveError);

/// A result that can be rendered in several formats.
pub trait Render {
    /// Returns the content of the file that contains the result in the given format.
    ///
    /// # Errors
    /// [`RenderError`] if the results cannot be drawn or written, or the format is unsuitable for
    /// the results.
    fn render(&self, format: Format) -> Result<Vec<u8>, RenderError>;
}

/// The results of a command, which are rendered together.
///
/// ```
/// use tangency::output::{Document, Format, Render, Results, example_branch};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// let results = Results { documents: &[("plate", &document)], ..Results::default() };
/// assert!(results.render(Format::Svg)?.starts_with(b"<svg"));
/// assert!(results.render(Format::Csv)?.starts_with(b"branch,point,load"));
/// let error = results.render(Format::Npz).unwrap_err().to_string();
/// assert!(error.starts_with("an archive (.npz) can contain only"), "{error}");
/// # Ok::<(), tangency::output::RenderError>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Results<'a> {
    /// The documents (sets of branches), each with a name that distinguishes its branches from the
    /// branches of other documents. In pictures, if documents differ in only a few settings, each
    /// document is named by the values of these settings, such as `c = 0.8`.
    pub documents: &'a [(&'a str, &'a Document)],
    /// The sweeps.
    pub sweeps: &'a [Sweeps],
    /// The column on the horizontal axis. By default the documents determine this column; if it is
    /// given, only one diagram is drawn.
    pub x: Option<&'a str>,
    /// The columns on the vertical axis; if the list is empty, the documents determine the axis.
    pub y: &'a [&'a str],
    /// The special points whose profiles are drawn or written, as `LABEL` or `BRANCH/LABEL`; if the
    /// list is empty, pictures show the special points that the documents choose, and tables
    /// contain the points of the branches.
    pub points: &'a [String],
    /// The width of pictures in millimetres; by default [`PAGE`].
    pub width: Option<f64>,
    /// The letter of the panel, if only one panel is drawn; by default all panels are drawn.
    pub panel: Option<&'a str>,
    /// The title of pictures; by default the title of the first document.
    pub title: Option<&'a str>,
    /// The chosen lower and upper ends of the horizontal and the vertical axis, which apply to the
    /// first panel and to further panels with the same axis; by default all data are shown.
    pub ends: [[Option<f64>; 2]; 2],
    /// The address, relative to the interactive page, of a file with the text
    /// [`PLOTLY`](super::PLOTLY). The page loads Plotly from this file, and several pages can share
    /// the file. By default each page contains Plotly.
    pub plotly: Option<&'a str>,
}

/// The error of results that cannot be rendered.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The results cannot be drawn as a picture.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Figure(#[from] FigureError),
    /// The data cannot be written in the requested format.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Format(#[from] FormatError),
    /// The requested format is unsuitable for the results.
    #[error("{0}")]
    Unsuited(&'static str),
}

/// The error of results that could not be saved.
#[derive(miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// A file cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
    /// A picture cannot be drawn, but all other files are saved. Files other than pictures are
    /// saved despite this error.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Figure(#[from] FigureError),
    /// A requested format is unsuitable for the results.
    #[error("{}: {reason}", path.display())]
    Unsuited {
        /// The path of the file that was not written.
        path: PathBuf,
        /// The rule of the file format; the result violates this rule.
        reason: &'static str,
    },
}

/// Saves results as `STEM.EXTENSION` in the given formats, writing all files together, and returns
/// the paths. If a picture cannot be drawn, the other files are saved, and an outdated picture is
/// removed.
///
/// # Errors
/// [`SaveError`]; after [`SaveError::Figure`] all files except pictures have been saved, after any
/// other error no file has been saved.
///
/// ```no_run
/// use std::path::Path;
/// use tangency::output::{Document, Format, Results, example_branch, save};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// let results = Results { documents: &[("plate", &document)], ..Results::default() };
/// let files = save(&results, Path::new("out/plate"), &[Format::Ron, Format::Svg])?;
/// assert_eq!(files, [Path::new("out/plate.ron"), Path::new("out/plate.svg")]);
/// # Ok::<(), tangency::output::SaveError>(())
/// ```
pub fn save(
    results: &impl Render,
    stem: &Path,
    formats: &[Format],
) -> Result<Vec<PathBuf>, SaveError> {
    let (mut files, mut undrawn) = (Vec::new(), None);
    for format in formats {
        let path = format.file(stem);
        match results.render(*format) {
            Ok(content) => files.push((path, content)),
            Err(RenderError::Figure(cause)) if format.is_picture() => undrawn = Some((path, cause)),
            Err(RenderError::Figure(cause)) => return Err(cause.into()),
            Err(RenderError::Format(source)) => return Err(FileError::format(&path, source).into()),
            Err(RenderError::Unsuited(reason)) => return Err(SaveError::Unsuited { path, reason }),
        }
    }
    write_together(&files)?;
    if let Some((earlier, cause)) = undrawn {
        let _ = std::fs::remove_file(earlier);
        return Err(cause.into());
    }
    Ok(files.into_iter().map(|(path, _)| path).collect())
}

impl Results<'_> {
    /// Returns the names of the documents that pictures show.
    fn names(&self) -> Vec<String> {
        distinguished(self.documents)
    }

    /// Returns the figures that the picture contains.
    fn figures(&self) -> Result<Vec<Figure>, FigureError> {
        let names = self.names();
        let first = self.documents.first().filter(|_| !self.points.is_empty());
        let chosen = first.map(|(_, document)| {
            let mut document = (*document).clone();
            document.plot.points = self.points.to_vec();
            document
        });
        let documents = names.iter().zip(self.documents);
        let mut documents: Vec<_> = documents.map(|(name, (_, it))| (name.as_str(), *it)).collect();
        if let (Some(chosen), Some(first)) = (&chosen, documents.first_mut()) {
            first.1 = chosen;
        }
        let mut figures = figures(&documents, self.sweeps, self.x, self.y)?;
        if let Some(wanted) = self.panel {
            let known = || (0..figures.len()).map(letter);
            let Some(index) = known().position(|letter| letter == wanted) else {
                let known = known().collect::<Vec<_>>().join(", ");
                return Err(FigureError::UnknownPanel { wanted: wanted.into(), known });
            };
            figures = vec![figures.swap_remove(index)];
        }
        self.set_ends(&mut figures);
        if let (Some(title), Some(first)) = (self.title, figures.first_mut()) {
            first.title = title.into();
        }
        Ok(figures)
    }

    /// Restricts the axes of panels to the chosen ends: in the first panel, and in further panels
    /// with the same axis, except for enlargements.
    fn set_ends(&self, figures: &mut [Figure]) {
        let plots = self.documents.iter().map(|(_, document)| &document.plot);
        let plot = plots.chain(self.sweeps.iter().map(|sweeps| &sweeps.plot)).next();
        let enlarged = plot.map_or(0, |plot| plot.enlargements.len());
        let label = |figure: &Figure, axis: usize| [&figure.x_label, &figure.y_label][axis].clone();
        for axis in (0..2).filter(|axis| self.ends[*axis] != [None; 2]) {
            let first = figures.first().map(|first| label(first, axis));
            for (k, figure) in figures.iter_mut().enumerate() {
                if (1..=enlarged).contains(&k) || Some(label(figure, axis)) != first {
                    continue;
                }
                let mut ranges = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
                let [low, high] = self.ends[axis];
                ranges[axis] = [low.unwrap_or(ranges[axis][0]), high.unwrap_or(ranges[axis][1])];
                let mut cut = figure.clone();
                clip(&mut cut, ranges);
                // A further panel without data in the range is left as it is.
                if k == 0 || cut.extent().is_ok() {
                    cut.ends[axis] = self.ends[axis];
                    *figure = cut;
                }
            }
        }
    }

    /// Returns the reason for which the results cannot be written as JSON.
    fn not_json(&self) -> &'static str {
        match (self.documents, self.sweeps) {
            ([_], []) => {
                "a JSON file (.json) contains one whole document and cannot be combined with \
                 --points"
            }
            (_, []) => "a JSON file (.json) contains one whole document, not several documents",
            _ => {
                "a JSON file (.json) contains one whole document of branches (.ron): the data of \
                 sweeps are in the archive (.npz), and can be written as a table (.csv)"
            }
        }
    }

    /// Returns the special points whose profiles are written to a table.
    fn shown(&self) -> Result<Vec<Shown<'_>>, RenderError> {
        let shown = named(self.documents, self.points)?;
        match shown.iter().any(|shown| !shown.point.profiles.is_empty()) {
            true => Ok(shown),
            false => Err(RenderError::Unsuited(
                "the requested special points have no profiles: their states are in the table of \
                 all points",
            )),
        }
    }

    /// Returns the table of the profiles of the named special points. If no special points are
    /// named, returns the table of all points of the branches, or the histories if the document
    /// contains only histories.
    fn csv(&self) -> Result<String, RenderError> {
        match self.documents {
            [] if !self.sweeps.is_empty() => Ok(of_sweeps(self.sweeps)),
            _ if !self.sweeps.is_empty() => Err(RenderError::Unsuited(
                "a table (.csv) can contain branches of documents or runs of sweeps, but not both",
            )),
            _ if !self.points.is_empty() => Ok(of_points(&self.shown()?)),
            [(_, document)] if of_histories(document) => Ok(histories(document)),
            documents => Ok(table(documents)),
        }
    }
}

/// Returns a complete document as JSON.
fn json(document: &Document) -> Result<Vec<u8>, FormatError> {
    serde_json::to_vec(document).map_err(|error| FormatError::Unwritable(error.to_string()))
}

impl Render for Results<'_> {
    fn render(&self, format: Format) -> Result<Vec<u8>, RenderError> {
        Ok(match format {
            Format::Ron => match self.documents {
                [(_, document)] => document.to_ron()?.into_bytes(),
                _ => {
                    return Err(RenderError::Unsuited(
                        "a document (.ron) must contain exactly one \
                                                       result",
                    ));
                }
            },
            Format::Npz => match (self.sweeps, self.documents) {
                ([sweeps], _) => sweeps.to_bytes()?,
                ([], _) if !self.points.is_empty() => {
                    arrays_of_points(&self.shown()?).map_err(FormatError::Unwritable)?
                }
                ([], [(_, document)]) if of_histories(document) => {
                    arrays(document).map_err(FormatError::Unwritable)?
                }
                _ => {
                    let rule = "an archive (.npz) can contain only the sweeps of one scene, \
                                simulated histories, or the profiles of special points (--points)";
                    return Err(RenderError::Unsuited(rule));
                }
            },
            Format::Svg => draw(&self.figures()?, self.width.unwrap_or(PAGE))?.into_bytes(),
            Format::Png => png(&self.figures()?, self.width.unwrap_or(PAGE))?,
            Format::Pdf => pdf(&self.figures()?, self.width.unwrap_or(PAGE))?,
            Format::Html => {
                let names = self.names();
                let documents = names.iter().map(String::as_str).zip(self.documents);
                let documents: Vec<_> = documents.map(|(name, (_, it))| (name, *it)).collect();
                page(&documents, &self.figures()?, self.plotly)?.into_bytes()
            }
            Format::Csv => self.csv()?.into_bytes(),
            Format::Json => match (self.documents, self.sweeps) {
                ([(_, document)], []) if self.points.is_empty() => json(document)?,
                _ => return Err(RenderError::Unsuited(self.not_json())),
            },
            Format::Markdown => {
                return Err(RenderError::Unsuited("Markdown (.md) is a format for reports only"));
            }
        })
    }
}
