//! Results as files: rendered in one place, written together.

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
use std::path::{Path, PathBuf};

/// What has a file in several formats.
pub trait Render {
    /// The content of the file in one format.
    ///
    /// # Errors
    /// [`RenderError`] for what cannot be drawn or written, and for a format that does not suit.
    fn render(&self, format: Format) -> Result<Vec<u8>, RenderError>;
}

/// The results of a command, seen together.
///
/// ```
/// use tangency::output::{Document, Format, Render, Results, example_branch};
/// let document = Document::new("Pull-in", vec![example_branch()]);
/// let results = Results { documents: &[("plate", &document)], ..Results::default() };
/// assert!(results.render(Format::Svg)?.starts_with(b"<svg"));
/// assert!(results.render(Format::Csv)?.starts_with(b"branch,point,load"));
/// let error = results.render(Format::Npz).unwrap_err().to_string();
/// assert!(error.starts_with("an archive (.npz) holds"), "{error}");
/// # Ok::<(), tangency::output::RenderError>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Results<'a> {
    /// Documents, each with a name that tells its branches from the others. In pictures they are
    /// named by the settings in which they differ, such as `c = 0.8`, if these are few.
    pub documents: &'a [(&'a str, &'a Document)],
    /// Sweeps.
    pub sweeps: &'a [Sweeps],
    /// The column on the horizontal axis of the only diagram, if it is not the documents' choice.
    pub x: Option<&'a str>,
    /// The columns on its vertical axis; none for the documents' choice.
    pub y: &'a [&'a str],
    /// The special points whose profiles are drawn, or written, as `LABEL` or `BRANCH/LABEL`; none
    /// for the documents' choice, and for tables of branches.
    pub points: &'a [String],
    /// The width of pictures in millimetres; [`PAGE`] by default.
    pub width: Option<f64>,
    /// The letter of the only panel that is drawn; all by default.
    pub panel: Option<&'a str>,
}

/// Why results cannot be rendered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The picture.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The data.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A format does not suit.
    #[error("{0}")]
    Unsuited(&'static str),
}

/// Why results could not be saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The picture cannot be drawn. All other files are saved.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A format does not suit.
    #[error("{}: {reason}", path.display())]
    Unsuited {
        /// The file.
        path: PathBuf,
        /// The rule.
        reason: &'static str,
    },
}

/// Saves results as `STEM.ENDING` in some formats, together, and gives the files. A picture that
/// cannot be drawn keeps nothing else from being saved; an earlier one, which shows something else,
/// is removed.
///
/// # Errors
/// [`SaveError`]; all files but pictures are there after [`SaveError::Figure`], and none of them is
/// after any other error.
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
    /// The documents with the names that pictures show.
    fn names(&self) -> Vec<String> {
        distinguished(self.documents)
    }

    /// The figures that are drawn.
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
        Ok(figures)
    }

    /// The special points whose profiles are written.
    fn shown(&self) -> Result<Vec<Shown<'_>>, RenderError> {
        let shown = named(self.documents, self.points)?;
        match shown.iter().any(|shown| !shown.point.profiles.is_empty()) {
            true => Ok(shown),
            false => Err(RenderError::Unsuited(
                "these special points have no profiles: their states are in the table of all points",
            )),
        }
    }

    /// The profiles of the points that are named; or all points of the branches, or the histories
    /// where there is nothing else.
    fn csv(&self) -> Result<String, RenderError> {
        match self.documents {
            [] if !self.sweeps.is_empty() => Ok(of_sweeps(self.sweeps)),
            _ if !self.sweeps.is_empty() => Err(RenderError::Unsuited(
                "a table (.csv) has the branches of documents, or sweeps, not both",
            )),
            _ if !self.points.is_empty() => Ok(of_points(&self.shown()?)),
            [(_, document)] if of_histories(document) => Ok(histories(document)),
            documents => Ok(table(documents)),
        }
    }
}

/// A whole document.
fn json(document: &Document) -> Result<Vec<u8>, FormatError> {
    serde_json::to_vec(document).map_err(|error| FormatError::Unwritable(error.to_string()))
}

impl Render for Results<'_> {
    fn render(&self, format: Format) -> Result<Vec<u8>, RenderError> {
        Ok(match format {
            Format::Ron => match self.documents {
                [(_, document)] => document.to_ron()?.into_bytes(),
                _ => return Err(RenderError::Unsuited("a document (.ron) holds one result")),
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
                    let rule = "an archive (.npz) holds the sweeps of one scene, histories, or the profiles of points (--points)";
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
                page(&documents, &self.figures()?)?.into_bytes()
            }
            Format::Csv => self.csv()?.into_bytes(),
            Format::Json => match (self.documents, self.sweeps) {
                ([(_, document)], []) if self.points.is_empty() => json(document)?,
                _ => {
                    return Err(RenderError::Unsuited(
                        "JSON (.json) holds one whole document, without --points",
                    ));
                }
            },
            Format::Markdown => return Err(RenderError::Unsuited("Markdown (.md) has reports")),
        })
    }
}
