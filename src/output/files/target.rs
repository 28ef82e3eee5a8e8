//! Which file is replaced where a path leads.

use crate::output::error::FileError;
use std::fs::FileType;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The file that writing to a path creates or replaces: the path, or the regular file that a
/// symbolic link leads to.
///
/// # Errors
/// [`FileError::Special`] for anything else that is there: a rename would put a regular file in
/// place of a device.
pub(crate) fn target(path: &Path) -> Result<PathBuf, FileError> {
    let failed = |source| FileError::Write { path: path.into(), source };
    let special = |kind| FileError::Special { path: path.into(), kind };
    let there = match path.symlink_metadata() {
        Ok(there) => there.file_type(),
        // What else is wrong with the path shows where it is written to.
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(path.into()),
        Err(error) => return Err(failed(error)),
    };
    if there.is_file() {
        return Ok(path.into());
    }
    if !there.is_symlink() {
        return Err(special(kind(there)));
    }
    let end = path.canonicalize().map_err(|_| special("a symbolic link that leads to no file"))?;
    match end.symlink_metadata().map_err(failed)?.is_file() {
        true => Ok(end),
        false => Err(special("a symbolic link to something else than a regular file")),
    }
}

/// The kind of a path that is no regular file, in words.
pub(crate) fn kind(found: FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if found.is_fifo() {
            return "a FIFO";
        }
        if found.is_socket() {
            return "a socket";
        }
        if found.is_char_device() || found.is_block_device() {
            return "a device";
        }
    }
    if found.is_dir() { "a folder" } else { "no regular file" }
}
