//! Reading files up to a size limit.

use super::target::kind;
use crate::output::error::FileError;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::time::Duration;

/// The size limits of input files. Files above the limits are rejected before they fill the memory.
///
/// ```
/// use tangency::output::SizeLimit;
/// assert_eq!(SizeLimit::default(), SizeLimit::megabytes(256));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeLimit {
    /// The maximum size of a file, in bytes.
    pub file: u64,
    /// The maximum total size of the files in an archive after unpacking, in bytes.
    pub unpacked: u64,
}

impl SizeLimit {
    /// Allows files of `megabytes` MB, and archives that unpack to four times that size.
    pub const fn megabytes(count: u64) -> Self {
        let file = count.saturating_mul(1_000_000);
        SizeLimit { file, unpacked: file.saturating_mul(4) }
    }
}

impl Default for SizeLimit {
    /// Returns the default limits: 256 MB for a file, and about 1 GB for an unpacked archive.
    fn default() -> Self {
        SizeLimit::megabytes(256)
    }
}

/// The time to wait until another process writes to the FIFO that should be read.
const PATIENCE: Duration = Duration::from_secs(5);

/// Reads a file.
pub(crate) fn read(path: &Path, limit: SizeLimit) -> Result<Vec<u8>, FileError> {
    let failed = |source| FileError::read(path, source);
    let too_large = || FileError::TooLarge { path: path.into(), limit: limit.file };
    let there = path.metadata().map_err(failed)?;
    if there.is_file() && there.len() > limit.file {
        return Err(too_large());
    }
    let file = if there.is_file() { File::open(path) } else { open_patiently(path) };
    let mut bytes = Vec::new();
    // A device has no length, and a file may grow.
    let more = limit.file.saturating_add(1);
    let length = file.and_then(|file| file.take(more).read_to_end(&mut bytes)).map_err(
        |cause| match cause.kind() {
            ErrorKind::TimedOut => {
                FileError::Silent { path: path.into(), kind: kind(there.file_type()) }
            }
            _ => failed(cause),
        },
    )?;
    if length as u64 > limit.file { Err(too_large()) } else { Ok(bytes) }
}

/// Reads a text file.
pub(crate) fn read_text(path: &Path, limit: SizeLimit) -> Result<String, FileError> {
    text_of(path, read(path, limit)?)
}

/// Converts the content of a file to text, if it is valid UTF-8.
pub(crate) fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String, FileError> {
    String::from_utf8(bytes).map_err(|cause| FileError::NoText {
        path: path.into(),
        at: cause.utf8_error().valid_up_to(),
    })
}

/// Opens a path that is not a regular file, with a time limit, since opening a FIFO blocks until a
/// process writes to it.
fn open_patiently(path: &Path) -> std::io::Result<File> {
    let (sender, receiver) = channel();
    let path = PathBuf::from(path);
    std::thread::spawn(move || sender.send(File::open(path)));
    receiver.recv_timeout(PATIENCE).unwrap_or(Err(ErrorKind::TimedOut.into()))
}
