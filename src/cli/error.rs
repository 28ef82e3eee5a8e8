//! Why a command failed.

use std::path::PathBuf;
use tangency::output::{FigureError, FileError};

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// A file cannot be read, understood or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The figure cannot be drawn.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The output would replace an input.
    #[error("{} is an input and is not overwritten; name another file with --out", path.display())]
    OutputIsInput {
        /// The file.
        path: PathBuf,
    },
    /// The standard output cannot be written to.
    #[error("cannot write to the standard output: {0}")]
    Output(#[from] std::io::Error),
}

impl CommandError {
    /// Whether the reader of the standard output has left, as `head` does: that is no failure.
    pub fn reader_left(&self) -> bool {
        matches!(self, CommandError::Output(error) if error.kind() == std::io::ErrorKind::BrokenPipe)
    }
}
