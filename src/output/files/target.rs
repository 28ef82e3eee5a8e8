//! Finds the file that will be replaced when a result is written to a path.

use crate::output::error::FileError;
use std::fs::FileType;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Returns the file that is created or replaced when a result is written to a path: the path
/// itself, or the regular file to which a symbolic link leads.
///
/// # Errors
/// [`FileError::Special`] if the path leads to an existing file that is not a regular file, such as
/// a device, because renaming would replace a device by a regular file.
pub(crate) fn target(path: &Path) -> Result<PathBuf, FileError> {
    let failed = |source| FileError::Write { path: path.into(), source };
    let special = |kind| FileError::Special { path: path.into(), kind };
    let there = match path.symlink_metadata() {
        Ok(there) => there.file_type(),
        // Other errors of the path are reported when writing.
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(path.into()),
        Err(error) => return Err(failed(error)),
    };
    if there.is_file() {
        return Ok(path.into());
    }
    if !there.is_symlink() {
        return Err(special(kind(there)));
    }
    let end = path.canonicalize().map_err(|_| special("a dangling symbolic link"))?;
    match end.symlink_metadata().map_err(failed)?.is_file() {
        true => Ok(end),
        false => Err(special("a symbolic link to something other than a regular file")),
    }
}

/// Describes the kind of a file that is not a regular file.
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
    if found.is_dir() { "a folder" } else { "not a regular file" }
}
