//! A lock for each result, which prevents two runs from writing the same files.

use super::leftovers::is_at;
use crate::output::error::FileError;
use std::fs::{File, TryLockError};
use std::io::{Error, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// The lock of the result `NAME` in a folder: the file `.NAME.lock`, which contains the id of the
/// process. The lock is released when the `Lock` is dropped, and when the process ends for any
/// reason; a lock file that remains from a killed run does not lock the result.
pub(crate) struct Lock {
    path: PathBuf,
    _file: File,
}

/// The number of attempts to take a lock while another process is releasing it.
const ATTEMPTS: usize = 100;

impl Lock {
    /// Locks a result in an existing folder, if no other process holds the lock.
    ///
    /// # Errors
    /// [`FileError::Locked`] if another process holds the lock, [`FileError::Write`] if the folder
    /// is not writable.
    pub fn take(folder: &Path, name: &str) -> Result<Self, FileError> {
        let path = folder.join(format!(".{name}.lock"));
        for _ in 0..ATTEMPTS {
            match attempt(&path) {
                Ok(Attempt::Locked(file)) => return Ok(Lock { path, _file: file }),
                Ok(Attempt::Held(process)) => {
                    return Err(FileError::Locked { path: folder.join(name), process });
                }
                Ok(Attempt::Gone) => {}
                Err(source) => return Err(FileError::Write { path, source }),
            }
        }
        Err(FileError::Locked { path: folder.join(name), process: None })
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // The file is removed while still locked, so that other processes that opened it notice the
        // removal.
        let _ = std::fs::remove_file(&self.path);
    }
}

enum Attempt {
    Locked(File),
    /// Another process, with this id if known, holds the lock.
    Held(Option<u32>),
    /// The lock file was removed by another process after it was opened.
    Gone,
}

fn attempt(path: &Path) -> std::io::Result<Attempt> {
    if path.symlink_metadata().is_ok_and(|there| !there.is_file()) {
        return Err(Error::new(ErrorKind::AlreadyExists, "the lock file must be a regular file"));
    }
    // The text of another process is kept.
    let options = File::options().read(true).write(true).create(true).truncate(false).clone();
    let mut file = options.open(path)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            let mut process = String::new();
            let _ = (&mut file).take(20).read_to_string(&mut process);
            return Ok(Attempt::Held(process.trim().parse().ok()));
        }
        // File systems without locks are accepted.
        Ok(()) | Err(TryLockError::Error(_)) => {}
    }
    if !is_at(&file, path) {
        return Ok(Attempt::Gone);
    }
    file.set_len(0)?;
    writeln!(file, "{}", std::process::id())?;
    Ok(Attempt::Locked(file))
}
