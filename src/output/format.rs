//! The formats of result files.

use super::error::FileError;
use std::path::{Path, PathBuf};

/// A file format.
///
/// ```
/// use std::path::Path;
/// use tangency::output::Format;
/// assert_eq!(Format::of(Path::new("a.svg"))?, Format::Svg);
/// let error = format!("{:?}", Format::of(Path::new("a.jpg")).unwrap_err());
/// assert!(error.contains("known: .svg, .png"), "{error}");
/// # Ok::<(), tangency::output::FileError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// A RON file with all data of branches, or with the data of a report.
    Ron,
    /// An archive of NumPy arrays with sweeps or histories.
    Npz,
    /// A vector picture.
    Svg,
    /// A pixel picture.
    Png,
    /// Comma-separated values with all points of branches, the points of sweeps, or histories.
    Csv,
    /// A vector picture in PDF, for printing.
    Pdf,
    /// An interactive page.
    Html,
    /// A JSON file with a complete document.
    Json,
    /// A Markdown file with the tables of a report.
    Markdown,
}

/// Formats of data with their file extensions: first the formats in which results are saved, then
/// the formats to which files can be converted.
const DATA: [(Format, &str); 3] =
    [(Format::Ron, "ron"), (Format::Npz, "npz"), (Format::Markdown, "md")];
const VIEWS: &[(Format, &str)] = &[
    (Format::Svg, "svg"),
    (Format::Png, "png"),
    (Format::Pdf, "pdf"),
    (Format::Html, "html"),
    (Format::Csv, "csv"),
    (Format::Npz, "npz"),
    (Format::Json, "json"),
];

/// The file extensions of pictures and tables, in the form in which messages list them.
const ENDINGS: &[&str] = &[".svg", ".png", ".pdf", ".html", ".csv", ".npz", ".json"];

impl Format {
    /// Returns the format of a picture or a table from the extension of its file name.
    ///
    /// # Errors
    /// [`FileError::Ending`] for unknown or missing extensions.
    pub fn of(path: &Path) -> Result<Self, FileError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let known = VIEWS.iter().find(|(_, known)| *known == ending);
        known
            .map(|(format, _)| *format)
            .ok_or_else(|| FileError::Ending { path: path.into(), known: ENDINGS })
    }

    /// Returns the file extension of the format.
    ///
    /// ```
    /// use tangency::output::Format;
    /// assert_eq!([Format::Ron, Format::Npz, Format::Svg].map(Format::ending), ["ron", "npz", "svg"]);
    /// ```
    pub fn ending(self) -> &'static str {
        let known = DATA.iter().chain(VIEWS).find(|(format, _)| *format == self);
        known.map_or("", |(_, ending)| ending)
    }

    /// Returns the path of a result in this format: `out/lorenz` becomes `out/lorenz.ron`, and
    /// `out/a=0.5` becomes `out/a=0.5.ron`.
    pub fn file(self, stem: &Path) -> PathBuf {
        let mut name = stem.as_os_str().to_os_string();
        name.push(format!(".{}", self.ending()));
        name.into()
    }

    /// Returns whether files of this format are pictures.
    pub(super) fn is_picture(self) -> bool {
        match self {
            Format::Svg | Format::Png | Format::Pdf | Format::Html => true,
            Format::Ron | Format::Npz | Format::Csv | Format::Json | Format::Markdown => false,
        }
    }
}
