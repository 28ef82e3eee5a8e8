//! What can go wrong on the way out and back in.

use super::tag::FORMAT;
use super::words::{Invalid, quoted};
use crate::core::problem::UnknownName;
use crate::core::system::Kind;
use crate::misread::Place;
use crate::spelling::sentence;
use std::path::{Path, PathBuf};

/// A file that cannot be read, understood or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's message.
        source: std::io::Error,
    },
    /// The file cannot be written.
    #[error("cannot write {}: {source}; choose a folder that can be written to", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's message.
        source: std::io::Error,
    },
    /// The file is not a text file.
    #[error(
        "{} is not a text file (byte {at} is not UTF-8){}",
        path.display(), if path.extension().is_some_and(|e| e == "npz") { ": archives of sweeps are drawn by `tangency plot`" } else { "" }
    )]
    NoText {
        /// The file.
        path: PathBuf,
        /// The first byte that is no text, counted from 0.
        at: usize,
    },
    /// The place of results is not a folder.
    #[error("{} is {kind}, not a folder: name a folder with --out", path.display())]
    NoFolder {
        /// The path.
        path: PathBuf,
        /// The kind of file that is there.
        kind: &'static str,
    },
    /// The name of a result is too long.
    #[error(
        "the name of the result, `{}`, has {} bytes, and at most {most} are allowed: give the scene's file a shorter name",
        quoted(name), name.len()
    )]
    LongName {
        /// The name.
        name: String,
        /// The most bytes that it may have.
        most: usize,
    },
    /// The file was read, but is no document.
    #[error("{}: {source}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: FormatError,
    },
    /// The output is a device, a FIFO or a folder, which is not replaced.
    #[error(
        "{} is {kind}, and only regular files, and symbolic links to them, are replaced; name another place with --out",
        path.display()
    )]
    Special {
        /// The path.
        path: PathBuf,
        /// The kind of file that is there.
        kind: &'static str,
    },
    /// The file is larger than what is read.
    #[error(
        "{} is larger than {} MB, the most that is read; if it is what you mean, raise the limit with --max-size",
        path.display(), limit / 1_000_000
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// How many bytes are read at most.
        limit: u64,
    },
    /// The input is a FIFO to which no process writes.
    #[error("{} is {kind}, and for 5 s nothing has come from it; name a file", path.display())]
    Silent {
        /// The path.
        path: PathBuf,
        /// The kind of file that is there.
        kind: &'static str,
    },
    /// Another run writes the same result.
    #[error(
        "another run{} is writing {}: wait until it ends, end it, or name another folder with --out",
        process.map_or(String::new(), |id| format!(", process {id},")), path.display()
    )]
    Locked {
        /// The result, without endings.
        path: PathBuf,
        /// The id of the process, if it is known.
        process: Option<u32>,
    },
    /// The ending of a file says nothing about its format.
    #[error(
        "{} has an ending that is no format of pictures; known: {}",
        path.display(), known.join(", ")
    )]
    Ending {
        /// The file.
        path: PathBuf,
        /// The endings that are known.
        known: &'static [&'static str],
    },
    /// The name of a file cannot be that of a result.
    #[error("the name of the file {} holds control characters; rename it", quoted(&path.to_string_lossy()))]
    Name {
        /// The file.
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

/// A text that is no document, or a document that must not be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The text carries no tag of this toolkit.
    #[error(
        "not a tangency document (line {line}, column {column}: {reason}); \
         give a file that a trace saved"
    )]
    Foreign {
        /// The line where the text departs from a document, counted from 1.
        line: usize,
        /// The column, counted from 1.
        column: usize,
        /// How it departs.
        reason: String,
    },
    /// The document has another version of the format.
    #[error(
        "the document's format is `{found}`, but this program reads `{FORMAT}`; \
         trace it again, or use the program that saved it"
    )]
    Version {
        /// The tag found.
        found: String,
    },
    /// The text ends before the document does.
    #[error(
        "the document breaks off at line {line}, column {column}; \
         the file was cut short: copy or trace it again"
    )]
    Truncated {
        /// The line, counted from 1.
        line: usize,
        /// The column, counted from 1.
        column: usize,
    },
    /// The document does not have the form it must have.
    #[error(
        "line {}, column {}: {reason}; correct it or trace it again{place}",
        place.line.unwrap_or(1), place.column
    )]
    Syntax {
        /// Where, with the text of the line.
        place: Box<Place>,
        /// The reason.
        reason: String,
    },
    /// The document has the right form, but a value that makes no sense.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// The archive of a sweep is damaged, or none.
    #[error("not a file of sweeps ({reason}); give a file that a sweep saved, or sweep again")]
    Archive {
        /// The reason.
        reason: String,
    },
    /// An archive unpacks to more than what is read.
    #[error(
        "the archive unpacks to more than {} MB, the most that is read; if it is what you mean, raise the limit with \
         --max-size", limit / 1_000_000
    )]
    Unpacked {
        /// How many bytes are unpacked at most.
        limit: u64,
    },
    /// The document, or the archive, cannot be put into words.
    #[error("it cannot be written: {0}")]
    Unwritable(String),
}

/// A special point that was asked for and is not in a document, or not the only one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UnknownPoint {
    /// No branch has that name.
    #[error("{}", sentence(.0))]
    Branch(#[from] UnknownName),
    /// No branch that was meant has the label.
    #[error("no special point has the label {label}; known: {}", known.join(", "))]
    Label {
        /// The label.
        label: usize,
        /// The labels that exist, as `BRANCH/LABEL`.
        known: Vec<String>,
    },
    /// Several branches have the label.
    #[error("several branches have the label {label}; name one of {}", candidates.join(", "))]
    Ambiguous {
        /// The label.
        label: usize,
        /// The candidates, as `BRANCH/LABEL`.
        candidates: Vec<String>,
    },
    /// A name that is not of the right form.
    #[error("`{0}` is not of the form LABEL or BRANCH/LABEL, for example 2 or orbits/2")]
    Form(String),
}

/// A figure that cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// A branch has no such column.
    #[error("branch `{branch}`: {}", sentence(source))]
    UnknownColumn {
        /// The branch.
        branch: String,
        /// The column and those that exist.
        source: UnknownName,
    },
    /// No branch and no sweep has such a column.
    #[error("{}", sentence(.0))]
    NoColumn(UnknownName),
    /// A logarithmic axis that no figure has.
    #[error("no axis shows {} alone: name the columns of an axis, or leave the logarithm out", names.join(", "))]
    NotLogarithmic {
        /// The columns that were named.
        names: Vec<String>,
    },
    /// Neither the document nor the user says what to draw, and the branch has no monitor.
    #[error("branch `{branch}` has no monitor to draw; name the column for y: {}", available.join(", "))]
    NoMonitor {
        /// The branch.
        branch: String,
        /// The names of its columns.
        available: Vec<String>,
    },
    /// There is no special point that a column's deviations are measured from.
    #[error(
        "`{column}` is to be shown as its deviation from the first {kind} of `{branch}`, but there is none: trace \
         as far as that point, or leave the deviation out"
    )]
    NoOrigin {
        /// The column.
        column: String,
        /// The kind of special point.
        kind: Kind,
        /// The branch.
        branch: String,
    },
    /// A point whose profiles are to be drawn does not exist.
    #[error(transparent)]
    UnknownPoint(#[from] UnknownPoint),
    /// No point has a profile that is to be drawn.
    #[error("{}", sentence(.0))]
    UnknownProfile(UnknownName),
    /// A coordinate is NaN or infinite.
    #[error("`{series}` cannot be drawn: its point {index} is ({}, {})", at[0], at[1])]
    NotFinite {
        /// The name of the series or the label of the mark.
        series: String,
        /// The point, counted from 0.
        index: usize,
        /// Its coordinates.
        at: [f64; 2],
    },
    /// A coordinate that a logarithmic axis cannot show.
    #[error("point {index} of `{series}` is at ({}, {}), which a logarithmic axis cannot show: leave the point or the logarithm out", at[0], at[1])]
    NotPositive {
        /// The curve or mark.
        series: String,
        /// The point, counted from 0.
        index: usize,
        /// Its coordinates.
        at: [f64; 2],
    },
    /// The values span more than numbers can hold.
    #[error("the values from {low:e} to {high:e} span too much for an axis")]
    TooWide {
        /// The smallest value.
        low: f64,
        /// The largest value.
        high: f64,
    },
    /// Nothing has a single point.
    #[error("there is nothing to draw in the figure `{title}`: it has no points")]
    Empty {
        /// The figure.
        title: String,
    },
    /// A picture is too narrow or too wide.
    #[error("a picture is from {} to {} mm wide, and cannot be {width} mm wide", range.start(), range.end())]
    Width {
        /// The width, in millimetres.
        width: f64,
        /// The widths that are possible.
        range: std::ops::RangeInclusive<f64>,
    },
    /// A text of a PNG has a letter that its font lacks.
    #[error(
        "the font of PNG has no letter `{letter}`, in `{text}`; draw an SVG, whose reader has fonts, or use other words"
    )]
    Letter {
        /// The letter.
        letter: char,
        /// The text.
        text: String,
    },
    /// No panel has the letter.
    #[error("the picture has no panel `{wanted}`, only {known}")]
    UnknownPanel {
        /// The letter.
        wanted: String,
        /// The letters that exist.
        known: String,
    },
    /// The drawing library failed.
    #[error("drawing failed: {0}")]
    Drawing(String),
}
