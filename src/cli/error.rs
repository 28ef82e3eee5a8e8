//! Why a command failed.

use crate::core::problem::UnknownName;
use crate::output::{FigureError, FileError, MergeError, RenderError, SaveError, UnknownPoint};
use crate::scene::SceneError;
use crate::spelling::sentence;
use std::path::PathBuf;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// A file cannot be read, understood or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The figure cannot be drawn.
    #[error("{files}: {cause}")]
    Figure {
        /// What is drawn.
        files: String,
        #[source]
        cause: FigureError,
    },
    /// The output would replace an input.
    #[error("{} is an input and is not overwritten; name another place with --out", path.display())]
    OutputIsInput { path: PathBuf },
    /// The scene, or the request, is at fault.
    #[error("{}{cause}", if cause.names_file() { String::new() } else { format!("{place}: ") })]
    Scene {
        /// Which scene or model was named.
        place: String,
        #[source]
        cause: Box<SceneError>,
    },
    /// There is no built-in scene of this name, and no such file.
    #[error("{}; a scene is one of these names (see `tangency scenes`) or the path of a RON file", sentence(.0))]
    UnknownScene(UnknownName),
    /// The point to start from does not exist.
    #[error("{}: {cause}", file.display())]
    Start {
        file: PathBuf,
        #[source]
        cause: UnknownPoint,
    },
    /// Nothing to trace.
    #[error(
        "`{scene}` has no branches to trace: `tangency sweep {scene}` does what it is made for"
    )]
    NoRun { scene: String },
    /// Two things that cannot be asked for together.
    #[error("--start FILE:LABEL goes on from one special point, and cannot be combined with {0}")]
    NotTogether(&'static str),
    /// A document differs from the reference.
    #[error("{count} differences from {}", place.display())]
    Different { place: PathBuf, count: usize },
    /// A strict command found reasons for doubt.
    #[error("--strict: {}", .0.join("; "))]
    Doubts(Vec<String>),
    /// All solutions without a box, or a box without them.
    #[error(
        "`--start all` and `--box` belong together, as in `--start all --box x=-3..3,y=0..5`: branches begin at all \
         solutions in the box"
    )]
    Everywhere,
    /// All saddles together.
    #[error(
        "manifolds belong to one saddle: start in states (`--start x=0.6,y=0.2`), or at a point (`--start FILE:LABEL`)"
    )]
    OneSaddle,
    /// Points of no document.
    #[error("--points needs a document (.ron): sweeps (.npz) have no special points")]
    NoPoints,
    /// What has no effect on a table.
    #[error(
        "data (.csv, .npz, .json) are complete, and cannot be with {0}; leave that out, or draw a picture (.svg, .png, .pdf, .html)"
    )]
    Table(&'static str),
    /// The width of a page.
    #[error(
        "a page (.html) is as wide as its window: leave --width out, or draw a picture (.svg, .png, .pdf)"
    )]
    PageWidth,
    /// Points beside columns.
    #[error(
        "--points chooses what is drawn beside the usual diagram, and cannot be with --x or --y"
    )]
    PointsInColumns,
    /// A separator of what has none.
    #[error(
        "--separator is for comma-separated values: name a file (.csv) with --out; `table` has --csv, too"
    )]
    NoSeparator,
    /// Nothing has sides.
    #[error(
        "--regions: no document has a curve of LP, HB, PD, TR or BP in two parameters with known sides; trace one with \
         --hold, with the setting stability=true, or trace it again if another version made it"
    )]
    NoRegions,
    /// Several columns of sweeps.
    #[error("sweeps (.npz) are drawn with one column on the vertical axis: name one with --y")]
    OneColumn,
    /// A grid that cannot be.
    #[error(transparent)]
    Grid(SceneError),
    /// A folder has results of another grid.
    #[error(
        "{} has designs of another scene, of other settings, or of another version: its scene.txt says which; name another \
         folder with --out, or remove that one", folder.display()
    )]
    OtherGrid { folder: PathBuf },
    /// What does not go with a grid.
    #[error("a grid traces a scene as it is stated, and cannot be combined with {0}")]
    NotInGrid(&'static str),
    /// Two designs of a grid would have one file.
    #[error(
        "two designs of the grid have the name `{name}`: values differ in their first 12 digits, and names in letters and digits"
    )]
    EqualDesigns { name: String },
    /// The name of a design is too long.
    #[error("the name of a design, `{name}`, is longer than {most} bytes, too long for a file")]
    LongDesign { name: String, most: usize },
    /// Some designs of a grid failed.
    #[error(
        "{failed} of {of} designs failed; all others are saved, and the same command tries them again"
    )]
    Designs { failed: usize, of: usize },
    /// A column that no document has.
    #[error("{}", sentence(.0))]
    NoColumn(UnknownName),
    /// Nothing to sweep.
    #[error("`{scene}` has nothing to sweep: say over which values by --over NAME=LOW..HIGH:COUNT")]
    NoSweep { scene: String },
    /// Parts that do not make a whole.
    #[error("{files}: {cause}")]
    Merge {
        /// Which parts.
        files: String,
        #[source]
        cause: MergeError,
    },
    /// Results could not be saved.
    #[error(transparent)]
    Unsaved(SaveError),
    /// Results cannot be put into a format.
    #[error(transparent)]
    Unrendered(RenderError),
    /// Ctrl-C, or another signal that asks for the end.
    #[error("interrupted; what was done until then is kept")]
    Interrupted,
    /// The standard output cannot be written to.
    #[error(
        "the standard output cannot be written to: {0}; files that were named are complete, and the output can go to a file instead"
    )]
    Output(#[from] std::io::Error),
}

impl CommandError {
    /// The exit code of the program.
    pub fn code(&self) -> u8 {
        if let CommandError::Doubts(_) = self { 3 } else { 1 }
    }
}

/// Files as messages name them: the first, and how many more there are.
pub(super) fn named(files: &[PathBuf]) -> String {
    match files {
        [] => String::new(),
        [one] => one.display().to_string(),
        [first, more @ ..] => format!("{} and {} more", first.display(), more.len()),
    }
}
