//! The errors of reading, writing and drawing results.

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
    /// The file is not a text file.
    #[error(
        "the file {} is not a text file: its byte {at} is not valid UTF-8", path.display()
    )]
    #[diagnostic(help("name a text file; archives of sweeps (.npz) are drawn by `tangency plot`"))]
    NoText {
        /// The path of the file.
        path: PathBuf,
        /// The first invalid byte, counted from 0.
        at: usize,
    },
    /// The output path is not a folder.
    #[error("{} is {kind}, not a folder", path.display())]
    #[diagnostic(help("choose a folder with --out"))]
    NoFolder {
        /// The path.
        path: PathBuf,
        /// The kind of the existing file.
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
        /// The maximum length in bytes.
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
    /// The output is a device, a FIFO or a folder, which is not replaced.
    #[error(
        "the output {} is {kind}, but only regular files and symbolic links to regular files can \
         be replaced", path.display(
    ))]
    #[diagnostic(help("choose another place with --out"))]
    Special {
        /// The path.
        path: PathBuf,
        /// The kind of the existing file.
        kind: &'static str,
    },
    /// The file exceeds the size limit.
    #[error(
        "the file {} is larger than the limit of {} MB", path.display(), limit / 1_000_000
    )]
    #[diagnostic(help("raise the limit with --max-size"))]
    TooLarge {
        /// The path of the file.
        path: PathBuf,
        /// The size limit in bytes.
        limit: u64,
    },
    /// The input is a FIFO to which no process writes.
    #[error("the input {} is {kind} and produced no data for 5 s", path.display())]
    #[diagnostic(help("name a file"))]
    Silent {
        /// The path.
        path: PathBuf,
        /// The kind of the existing file.
        kind: &'static str,
    },
    /// Another run writes the same result.
    #[error(
        "another run{} is writing {}", process.map_or(String::new(), |id| format!(", process {id},")), path.display()
    )]
    #[diagnostic(help(
        "wait until the other run ends, end the other run, or choose another folder with --out"
    ))]
    Locked {
        /// The path of the result, without extensions.
        path: PathBuf,
        /// The id of the process, if known.
        process: Option<u32>,
    },
    /// The extension of a file is not a known format.
    #[error("the file {} does not have an extension of a known format", path.display())]
    #[diagnostic(help("known: {}", known.join(", ")))]
    Ending {
        /// The path of the file.
        path: PathBuf,
        /// The known extensions.
        known: &'static [&'static str],
    },
    /// The name of a file is invalid as the name of a result.
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

/// The error of a text that is not a document, or of a document that cannot be written.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The text has no tag of this toolkit.
    #[error("not a tangency document (line {line}, column {column}: {reason})")]
    #[diagnostic(help("give a document saved by a trace"))]
    Foreign {
        /// The line of the first error, counted from 1.
        line: usize,
        /// The column, counted from 1.
        column: usize,
        /// The description of the error.
        reason: String,
    },
    /// The document has another version of the format.
    #[error("the document's format is `{found}`, but this program reads `{FORMAT}`")]
    #[diagnostic(help(
        "repeat the trace, or read the document with the version of the program that saved the \
         document"
    ))]
    Version {
        /// The tag of the document.
        found: String,
    },
    /// The text is truncated.
    #[error("the document ends prematurely at line {line}, column {column}; the file is truncated")]
    #[diagnostic(help("copy the file again, or repeat the trace"))]
    Truncated {
        /// The line, counted from 1.
        line: usize,
        /// The column, counted from 1.
        column: usize,
    },
    /// The document has an invalid form.
    #[error("line {}, column {}: {reason}{place}", place.line.unwrap_or(1), place.column)]
    #[diagnostic(help("correct the document, or repeat the trace"))]
    Syntax {
        /// The position, with the text of the line.
        place: Box<Place>,
        /// The reason.
        reason: String,
    },
    /// The document contains an invalid value.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Invalid(#[from] Invalid),
    /// The archive of a sweep is damaged, or is not an archive.
    #[error("not a file of sweeps ({reason})")]
    #[diagnostic(help("give a file (.npz) saved by `tangency sweep`, or repeat the sweep"))]
    Archive {
        /// The reason.
        reason: String,
    },
    /// An archive unpacks to more than the size limit.
    #[error(
        "the archive unpacks to more than the limit of {} MB", limit / 1_000_000
    )]
    #[diagnostic(help("raise the limit with --max-size"))]
    Unpacked {
        /// The size limit in bytes.
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
    /// No branch has the requested name.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Branch(#[from] UnknownName),
    /// No special point has the requested label.
    #[error("no special point has the label {label}")]
    #[diagnostic(help("known: {}", known.join(", ")))]
    Label {
        /// The requested label.
        label: usize,
        /// The existing labels, as `BRANCH/LABEL`.
        known: Vec<String>,
    },
    /// Several branches have the requested label.
    #[error("several branches have a special point with the label {label}")]
    #[diagnostic(help("name one of {}", candidates.join(", ")))]
    Ambiguous {
        /// The requested label.
        label: usize,
        /// The candidates, as `BRANCH/LABEL`.
        candidates: Vec<String>,
    },
    /// A name of an invalid form.
    #[error(
        "the special point `{0}` is not of the form LABEL or BRANCH/LABEL, for example 2 or \
         orbits/2"
    )]
    Form(String),
}

/// The error of a figure that cannot be drawn.
#[derive(Clone, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// A branch lacks a column.
    #[error("branch `{branch}`: {source}")]
    #[diagnostic(forward(source))]
    UnknownColumn {
        /// The name of the branch.
        branch: String,
        /// The requested column and the existing ones.
        source: UnknownName,
    },
    /// No branch and no sweep has a column.
    #[error(transparent)]
    #[diagnostic(transparent)]
    NoColumn(UnknownName),
    /// No figure has an axis for a column that should be logarithmic.
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
        /// The name of the branch.
        branch: String,
        /// The names of the existing columns.
        available: Vec<String>,
    },
    /// The special point is missing from which a column's deviations are measured.
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
        /// The kind of special point.
        kind: Kind,
        /// The name of the branch.
        branch: String,
    },
    /// A point whose profiles should be drawn does not exist.
    #[error(transparent)]
    #[diagnostic(transparent)]
    UnknownPoint(#[from] UnknownPoint),
    /// No point has a profile that should be drawn.
    #[error(transparent)]
    #[diagnostic(transparent)]
    UnknownProfile(UnknownName),
    /// A coordinate is NaN or infinite.
    #[error(
        "the curve `{series}` cannot be drawn: its point {index}, ({}, {}), is not finite", at[0], at[1]
    )]
    NotFinite {
        /// The name of the series or the label of the mark.
        series: String,
        /// The index of the point, counted from 0.
        index: usize,
        /// The coordinates of the point.
        at: [f64; 2],
    },
    /// A coordinate that a logarithmic axis cannot show.
    #[error(
        "point {index} of the curve `{series}` is at ({}, {}), which a logarithmic axis cannot show", at[0], at[1]
    )]
    #[diagnostic(help("remove the point, or use a linear axis"))]
    NotPositive {
        /// The name of the curve or mark.
        series: String,
        /// The index of the point, counted from 0.
        index: usize,
        /// The coordinates of the point.
        at: [f64; 2],
    },
    /// The range of values exceeds the range of numbers.
    #[error("the values from {low:e} to {high:e} span too wide a range for an axis")]
    TooWide {
        /// The smallest value.
        low: f64,
        /// The largest value.
        high: f64,
    },
    /// The figure has no points.
    #[error("the figure `{title}` has no points to draw")]
    Empty {
        /// The title of the figure.
        title: String,
    },
    /// The width of a picture is out of range.
    #[error("the width of a picture must be between {} and {} mm, but is {width} \
             mm", range.start(), range.end())]
    Width {
        /// The width, in millimetres.
        width: f64,
        /// The allowed widths.
        range: std::ops::RangeInclusive<f64>,
    },
    /// The font of a picture lacks a letter.
    #[error("the font of PNG lacks the letter `{letter}` in `{text}`")]
    #[diagnostic(help("draw an SVG, which uses the viewer's fonts, or change the text"))]
    Letter {
        /// The missing letter.
        letter: char,
        /// The text with the missing letter.
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
    /// The drawing library failed.
    #[error("drawing failed: {0}")]
    Drawing(String),
}
