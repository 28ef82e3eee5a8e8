//! The errors of commands.

use crate::core::problem::UnknownName;
use crate::core::system::Kind;
use crate::output::{FigureError, FileError, MergeError, RenderError, SaveError, UnknownPoint};
use crate::scene::SceneError;
use miette::Diagnostic;
use std::path::PathBuf;

/// The error with which a command failed.
#[derive(Debug, miette::Diagnostic, thiserror::Error)]
pub enum CommandError {
    /// A file cannot be read, parsed or written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
    /// The figure cannot be drawn.
    #[error("{files}: {cause}")]
    #[diagnostic(forward(cause))]
    Figure {
        /// The documents whose contents would have been drawn.
        files: String,
        #[source]
        cause: FigureError,
    },
    /// The output file is also an input file.
    #[error(
        "the output file {} is also an input file, and input files are not overwritten", path.display(
    ))]
    #[diagnostic(help("choose another place with --out"))]
    OutputIsInput { path: PathBuf },
    /// The scene or the request is invalid, or its computation failed.
    #[error("{}{cause}", if cause.names_file() { String::new() } else { format!("{place}: ") })]
    #[diagnostic(forward(cause))]
    Scene {
        /// The scene or the model, as named on the command line.
        place: String,
        #[source]
        cause: Box<SceneError>,
    },
    /// The name on the command line denotes neither a built-in scene nor an existing file.
    #[error("{unknown}")]
    #[diagnostic(help("{}", of_scene(unknown)))]
    UnknownScene { unknown: UnknownName },
    /// The special point given by `--start` does not exist in its document.
    #[error("{}: {cause}", file.display())]
    #[diagnostic(forward(cause))]
    Start {
        file: PathBuf,
        #[source]
        cause: UnknownPoint,
    },
    /// The special point given by `--start` is not of the kind given by `--switch`.
    #[error(
        "{}: the special point {label} is of the kind {kind}, but --switch names other kinds of \
         special points", file.display(
    ))]
    #[diagnostic(help("omit --switch, or start at a special point of a kind that --switch names"))]
    OtherKind { file: PathBuf, label: usize, kind: Kind },
    /// The command needs branches, but the scene has only sweeps.
    #[error("the scene `{scene}` has no branches to trace")]
    #[diagnostic(help("run the sweeps of the scene with `tangency sweep {scene}`"))]
    NoRun { scene: String },
    /// The command line gives `--start FILE:LABEL` together with an option that cannot be combined
    /// with it.
    #[error(
        "the option --start FILE:LABEL starts a branch at one special point and cannot be combined \
         with {0}"
    )]
    NotTogether(&'static str),
    /// A document differs from the reference.
    #[error("{count} differences from {}", place.display())]
    Different { place: PathBuf, count: usize },
    /// A command with `--strict` found unreliable results.
    #[error("--strict: {}", .0.join("; "))]
    Doubts(Vec<String>),
    /// Only one of the options `--start all` and `--box` is given, but each requires the other.
    #[error(
        "the options `--start all` and `--box` must be given together: a branch starts at each \
         solution found in the box"
    )]
    #[diagnostic(help("give the two options together, as in `--start all --box x=-3..3,y=0..5`"))]
    Everywhere,
    /// The option `--start all` is given to `tangency manifolds`, which does not support it.
    #[error("manifolds belong to one saddle")]
    #[diagnostic(help(
        "start the search for the saddle at given states (`--start x=0.6,y=0.2`) or at a saved \
         special point (`--start FILE:LABEL`)"
    ))]
    OneSaddle,
    /// The option `--points` is given without a document of branches.
    #[error(
        "the option --points needs a document of branches (.ron): sweeps (.npz) contain no special \
         points"
    )]
    NoPoints,
    /// The command line gives an option that has no effect on data files.
    #[error(
        "data files (.csv, .npz, .json) always contain all data and cannot be combined with {0}"
    )]
    #[diagnostic(help("omit {0}, or draw a picture (.svg, .png, .pdf, .html)"))]
    Table(&'static str),
    /// A width in letters is given for an HTML page, whose width is not counted in letters.
    #[error(
        "the option --width does not apply to a page (.html), which is always as wide as its window"
    )]
    #[diagnostic(help("omit --width, or draw a picture (.svg, .png, .pdf)"))]
    PageWidth,
    /// The option `--points` is combined with `--x` or `--y`.
    #[error(
        "the option --points adds the profiles of special points to the default diagram and cannot \
         be combined with --x or --y"
    )]
    #[diagnostic(help(
        "omit --x and --y; to draw one panel of profiles, such as a phase portrait, give its letter \
         with --panel, as in `--panel c`"
    ))]
    PointsInColumns,
    /// A separator of cells or decimals is given for an output that is not comma-separated.
    #[error("the options --separator and --decimal apply to comma-separated values")]
    #[diagnostic(help(
        "name a .csv file with --out; the command `tangency table` also has the option --csv"
    ))]
    NoSeparator,
    /// The comma is chosen as the separator of both columns and decimals.
    #[error("a comma cannot be both the separator of columns and the decimal sign")]
    #[diagnostic(help(
        "omit --separator, which is a semicolon with `--decimal comma`, or give another separator"
    ))]
    OneSeparator,
    /// `--regions` is given, but no curve in two parameters has known numbers of unstable
    /// directions.
    #[error(
        "the option --regions needs a curve of LP, HB, PD, TR or BP points in two parameters, and \
         the numbers of unstable directions on both sides of this curve, but no document contains \
         such a curve with these numbers"
    )]
    #[diagnostic(help(
        "trace a curve of special points with --hold and `stability=true`; if another version of \
         the program wrote the document, repeat the trace"
    ))]
    NoRegions,
    /// For the vertical axis of a sweep, several columns are given instead of one.
    #[error("a picture of sweeps (.npz) must have exactly one column on the vertical axis")]
    #[diagnostic(help("name one column with --y"))]
    OneColumn,
    /// The grid of settings is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Grid(SceneError),
    /// The output folder already contains the results of another grid of settings.
    #[error(
        "the folder {} contains the results of another grid: its file scene.txt names another \
         scene, other settings or another version of the program", folder.display()
    )]
    #[diagnostic(help("choose another folder with --out, or remove the existing folder"))]
    OtherGrid { folder: PathBuf },
    /// The command line gives an option that cannot be combined with `--grid`.
    #[error("the option --grid cannot be combined with {0}")]
    NotInGrid(&'static str),
    /// The options `--set` and `--grid` give the same setting.
    #[error("the options `--set {0}` and `--grid {0}` give the same setting")]
    #[diagnostic(help("omit one of the two options"))]
    SetInGrid(String),
    /// Two designs (points of a grid of settings) would be saved in files of the same name.
    #[error("two designs (combinations of settings) of the grid have the same name `{name}`")]
    #[diagnostic(help(
        "choose values that differ in their first 12 digits, and names of settings that differ in \
         their letters and digits"
    ))]
    EqualDesigns { name: String },
    /// The name of a design is longer than a file name may be.
    #[error(
        "the design `{name}` of the grid cannot be saved: its name is longer than {most} bytes, \
         too long for a file name"
    )]
    LongDesign { name: String, most: usize },
    /// The computation of some designs (points of a grid of settings) failed.
    #[error(
        "{failed} of {of} designs of the grid failed; the results of the other designs are saved"
    )]
    #[diagnostic(help("repeat the command to trace the failed designs again"))]
    Designs { failed: usize, of: usize },
    /// No document has the requested column.
    #[error(transparent)]
    #[diagnostic(transparent)]
    NoColumn(UnknownName),
    /// The command needs a scene with sweeps, but the scene has no sweeps.
    #[error("`{scene}` has no sweeps")]
    #[diagnostic(help("give the values to sweep over with --over NAME=LOW..HIGH:COUNT"))]
    NoSweep { scene: String },
    /// The given parts of a sweep do not add up to the complete sweep.
    #[error("{files}: {cause}")]
    #[diagnostic(forward(cause))]
    Merge {
        /// The files of the parts of the sweep.
        files: String,
        #[source]
        cause: MergeError,
    },
    /// The results could not be saved.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Unsaved(SaveError),
    /// The results cannot be converted to the format of an output file.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Unrendered(RenderError),
    /// The command was interrupted by Ctrl-C, SIGTERM or SIGHUP.
    #[error("the command was interrupted; all results computed before the interruption are saved")]
    Interrupted,
    /// The server of `tangency live` cannot start.
    #[cfg(feature = "live")]
    #[error("the server cannot start: {0}")]
    #[diagnostic(help("omit --port to let the program choose a free port"))]
    Server(#[source] std::io::Error),
    /// The standard output cannot be written to.
    #[error(
        "cannot write to the standard output: {0}; all files listed before this error are complete"
    )]
    #[diagnostic(help("redirect the output to a file instead"))]
    Output(#[from] std::io::Error),
}

/// Returns the help text of the error that reports an unknown scene name.
fn of_scene(unknown: &UnknownName) -> String {
    let help = unknown.help().map_or(String::new(), |help| format!("{help}; "));
    format!("{help}or give the path of a RON file (`tangency scenes` lists all scenes)")
}

impl CommandError {
    /// Returns the exit code of the program for this error.
    pub fn code(&self) -> u8 {
        if let CommandError::Doubts(_) = self { 3 } else { 1 }
    }
}

/// Returns how a message names several files: the first file, and the number of further files.
pub(super) fn named(files: &[PathBuf]) -> String {
    match files {
        [] => String::new(),
        [one] => one.display().to_string(),
        [first, more @ ..] => format!("{} and {} more", first.display(), more.len()),
    }
}
