//! The errors that occur when results are read, written or drawn.

use super::tag::FORMAT;
use super::words::{Invalid, quoted};
use crate::core::failure::debug_is_message;
use crate::core::problem::UnknownName;
use crate::core::system::Kind;
use crate::misread::Place;
use std::path::{Path, PathBuf};

debug_is_message!(FileError, FigureError);

/// The error of a file that cannot be read, parsed or written.
#[derive(miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    #[diagnostic(help("check the path and its permissions"))]
    Read {
        /// The path of the file.
        path: PathBuf,
        /// The message of the operating system.
        source: std::io::Error,
    },
    /// The file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    #[diagnostic(help("choose a writable folder"))]
    Write {
        /// The path of the file.
        path: PathBuf,
        /// The message of the operating system.
        source: std::io::Error,
    },
    /// The content of the file is not text.
    #[error(
        "the file {} is not a text file: its byte {at} is not valid UTF-8", path.display()
    )]
    #[diagnostic(help("name a text file; archives of sweeps (.npz) are drawn by `tangency plot`"))]
    NoText {
        /// The path of the file that is not text.
        path: PathBuf,
        /// The position of the first invalid byte, counted from 0.
        at: usize,
    },
    /// The output path exists, but is not a folder.
    #[error("{} is {kind}, not a folder", path.display())]
    #[diagnostic(help("choose a folder with --out"))]
    NoFolder {
        /// The path.
        path: PathBuf,
        /// The kind of the existing file at the output path.
        kind: &'static str,
    },
    /// The name of a result is too long.
    #[error(
        "the name of the result, `{}`, has {} bytes, but at most {most} bytes are allowed", quoted(name), name.len(
    ))]
    #[diagnostic(help("give the scene's file a shorter name"))]
    LongName {
        /// The name of the result.
        name: String,
        /// The maximum length of the name in bytes.
        most: usize,
    },
    /// The file was read, but is not a document.
    #[error("{}: {source}", path.display())]
    #[diagnostic(forward(source))]
    Format {
        /// The path of the file.
        path: PathBuf,
        /// The reason.
        source: FormatError,
    },
    /// The output path is a device, a FIFO or a folder, which is never replaced.
    #[error(
        "the output {} is {kind}, but only regular files and symbolic links to regular files can \
         be replaced", path.display(
    ))]
    #[diagnostic(help("choose another place with --out"))]
    Special {
        /// The path.
        path: PathBuf,
        /// The kind of the existing file at the output path.
        kind: &'static str,
    },
    /// The file is larger than the size limit.
    #[error(
        "the file {} is larger than the limit of {} MB", path.display(), limit / 1_000_000
    )]
    #[diagnostic(help("raise the limit with --max-size"))]
    TooLarge {
        /// The path of the file.
        path: PathBuf,
        /// The size limit of the file in bytes.
        limit: u64,
    },
    /// The input is a FIFO to which no process writes.
    #[error("the input {} is {kind} and produced no data for 5 s", path.display())]
    #[diagnostic(help("name a file"))]
    Silent {
        /// The path.
        path: PathBuf,
        /// The kind of the existing input file.
        kind: &'static str,
    },
    /// Another process is writing the same result.
    #[error(
        "another run{} is writing {}", process.map_or(String::new(), |id| format!(", process {id},")), path.display()
    )]
    #[diagnostic(help(
        "wait until the other run ends, end the other run, or choose another folder with --out"
    ))]
    Locked {
        /// The path of the result, without extensions.
        path: PathBuf,
        /// The id of the writing process, if known.
        process: Option<u32>,
    },
    /// The extension of a file does not belong to a known format.
    #[error("the file {} does not have an extension of a known format", path.display())]
    #[diagnostic(help("known: {}", known.join(", ")))]
    Ending {
        /// The path of the file with the unknown extension.
        path: PathBuf,
        /// The known extensions.
        known: &'static [&'static str],
    },
    /// The name of a file cannot be the name of a result because it contains control characters.
    #[error("the name of the file {} contains control characters", quoted(&path.to_string_lossy()))]
    #[diagnostic(help("rename the file"))]
    Name {
        /// The path of the file.
        path: PathBuf,
    },
}

impl FileError {
    pub(crate) fn read(path: &Path, source: std::io::Error) -> Self {
        FileError::Read { path: path.into(), source }
    }

    pub(crate) fn format(path: &Path, source: FormatError) -> Self {
        FileError::Format { path: path.into(), source }
    }
}

/// The error of a text that should be a document (a file of results) but is not, or of a document
/// that cannot be written.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The text does not begin with a format tag of this toolkit.
    #[error("not a tangency document (line {line}, column {column}: {reason})")]
    #[diagnostic(help("give a document saved by a trace"))]
    Foreign {
        /// The line of the first syntax error, counted from 1.
        line: usize,
        /// The column of the first syntax error, counted from 1.
        column: usize,
        /// The description of the first syntax error.
        reason: String,
    },
    /// The document was written in another version of the format.
    #[error("the document's format is `{found}`, but this program reads `{FORMAT}`")]
    #[diagnostic(help(
        "repeat the trace, or read the document with the version of the program that saved the \
         document"
    ))]
    Version {
        /// The format tag of the document.
        found: String,
    },
    /// The text ends before the document is complete.
    #[error("the document ends prematurely at line {line}, column {column}; the file is truncated")]
    #[diagnostic(help("copy the file again, or repeat the trace"))]
    Truncated {
        /// The line at which the text ends, counted from 1.
        line: usize,
        /// The column at which the text ends, counted from 1.
        column: usize,
    },
    /// The text of the document cannot be parsed.
    #[error("line {}, column {}: {reason}{place}", place.line.unwrap_or(1), place.column)]
    #[diagnostic(help("correct the document, or repeat the trace"))]
    Syntax {
        /// The position of the error, with the text of the line.
        place: Box<Place>,
        /// The reason.
        reason: String,
    },
    /// The document contains an invalid value.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Invalid(#[from] Invalid),
    /// The file of a sweep is damaged, or is not a NumPy archive.
    #[error("not a file of sweeps ({reason})")]
    #[diagnostic(help("give a file (.npz) saved by `tangency sweep`, or repeat the sweep"))]
    Archive {
        /// The reason.
        reason: String,
    },
    /// The unpacked content of an archive exceeds the size limit.
    #[error(
        "the archive unpacks to more than the limit of {} MB", limit / 1_000_000
    )]
    #[diagnostic(help("raise the limit with --max-size"))]
    Unpacked {
        /// The size limit of the unpacked content in bytes.
        limit: u64,
    },
    /// The document or the archive cannot be serialized.
    #[error("the file cannot be written: {0}")]
    Unwritable(String),
}

/// The error of a requested special point that is missing or ambiguous.
#[derive(Clone, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum UnknownPoint {
    /// No branch has the name that was requested.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Branch(#[from] UnknownName),
    /// No special point has the requested label.
    #[error("no special point has the label {label}")]
    #[diagnostic(help("known: {}", known.join(", ")))]
    Label {
        /// The requested label.
        label: usize,
        /// The existing labels of special points, as `BRANCH/LABEL`.
        known: Vec<String>,
    },
    /// Several branches have the requested label.
    #[error("several branches have a special point with the label {label}")]
    #[diagnostic(help("name one of {}", candidates.join(", ")))]
    Ambiguous {
        /// The requested label.
        label: usize,
        /// The points with the requested label, as `BRANCH/LABEL`.
        candidates: Vec<String>,
    },
    /// The name of special points is neither a label nor the kind of an existing special point.
    #[error(
        "the special point `{0}` is not of the form LABEL or BRANCH/LABEL, for example 2 or \
         orbits/2, and no special point is of such a kind"
    )]
    Form(String),
}

/// The error of a figure that cannot be drawn.
#[derive(Clone, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// A branch does not contain a column that was requested.
    #[error("branch `{branch}`: {source}")]
    #[diagnostic(forward(source))]
    UnknownColumn {
        /// The name of the branch.
        branch: String,
        /// The name of the requested column, with the names of the existing columns.
        source: UnknownName,
    },
    /// No branch and no sweep contains a column that was requested.
    #[error(transparent)]
    #[diagnostic(transparent)]
    NoColumn(UnknownName),
    /// No figure has an axis that shows the columns for which a logarithmic axis was requested.
    #[error("no axis shows only {}", names.join(", "))]
    #[diagnostic(help("name all columns that share the axis, or use a linear axis"))]
    NotLogarithmic {
        /// The named columns.
        names: Vec<String>,
    },
    /// No column is chosen for the vertical axis, and the branch has no monitor.
    #[error("branch `{branch}` has no monitor that can be drawn")]
    #[diagnostic(help("choose the column for y: {}", available.join(", ")))]
    NoMonitor {
        /// The name of the branch that has no monitor.
        branch: String,
        /// The names of the columns that exist.
        available: Vec<String>,
    },
    /// The special point from which the deviations of a column are measured does not exist.
    #[error(
        "the column `{column}` should be drawn as its deviation from the first special point \
         {kind} of branch `{branch}`, but the branch has no {kind}"
    )]
    #[diagnostic(help(
        "trace the branch as far as the special point, or draw the column without the deviation"
    ))]
    NoOrigin {
        /// The column.
        column: String,
        /// The kind of the missing special point.
        kind: Kind,
        /// The name of the branch that does not contain the special point.
        branch: String,
    },
    /// A special point whose profiles should be drawn does not exist.
    #[error(transparent)]
    #[diagnostic(transparent)]
    UnknownPoint(#[from] UnknownPoint),
    /// No special point has a profile of a requested kind.
    #[error(transparent)]
    #[diagnostic(transparent)]
    UnknownProfile(UnknownName),
    /// A coordinate is NaN or infinite.
    #[error(
        "the curve `{series}` cannot be drawn: its point {index}, ({}, {}), is not finite", at[0], at[1]
    )]
    NotFinite {
        /// The name of the series, or the label of the mark, that contains the coordinate that
        /// cannot be drawn.
        series: String,
        /// The index of the point that cannot be drawn, counted from 0.
        index: usize,
        /// The coordinates of the point that cannot be drawn.
        at: [f64; 2],
    },
    /// A coordinate is zero or negative, but its axis is logarithmic.
    #[error(
        "point {index} of the curve `{series}` is at ({}, {}), which a logarithmic axis cannot show", at[0], at[1]
    )]
    #[diagnostic(help("remove the point, or use a linear axis"))]
    NotPositive {
        /// The name of the curve or mark that contains the coordinate that cannot be drawn.
        series: String,
        /// The index of the point that cannot be drawn, counted from 0.
        index: usize,
        /// The coordinates of the point that cannot be drawn.
        at: [f64; 2],
    },
    /// The width of the range of values on an axis exceeds the range of floating-point numbers.
    #[error("the values from {low:e} to {high:e} span too wide a range for an axis")]
    TooWide {
        /// The smallest value.
        low: f64,
        /// The largest value.
        high: f64,
    },
    /// The figure contains no points.
    #[error("the figure `{title}` has no points to draw")]
    Empty {
        /// The title of the figure without points.
        title: String,
    },
    /// The width of a picture is not between the smallest and the largest allowed width.
    #[error("the width of a picture must be between {} and {} mm, but is {width} \
             mm", range.start(), range.end())]
    Width {
        /// The requested width of the picture, in millimetres.
        width: f64,
        /// The allowed widths.
        range: std::ops::RangeInclusive<f64>,
    },
    /// The font of a picture does not contain a character.
    #[error("the font of PNG lacks the letter `{letter}` in `{text}`")]
    #[diagnostic(help("draw an SVG, which uses the viewer's fonts, or change the text"))]
    Letter {
        /// The missing letter.
        letter: char,
        /// The text that contains the missing character.
        text: String,
    },
    /// No panel has the requested letter.
    #[error("the picture has no panel `{wanted}`; its panels are {known}")]
    UnknownPanel {
        /// The requested letter.
        wanted: String,
        /// The existing letters.
        known: String,
    },
    /// The drawing library reported an error.
    #[error("drawing failed: {0}")]
    Drawing(String),
}
