//! A lock for each result: no two runs write the same files.

use super::leftovers::is_at;
use crate::output::error::FileError;
use std::fs::{File, TryLockError};
use std::io::{Error, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// The lock of the result `NAME` in a folder: the file `.NAME.lock`, which holds the id of the
/// process. It is released when it is dropped, and when the process ends, however it does: a file
/// that a killed run leaves is no lock.
pub(crate) struct Lock {
    path: PathBuf,
    _file: File,
}

/// How often a lock that was just released may be taken by others before they are given way.
const ATTEMPTS: usize = 100;

impl Lock {
    /// Locks a result in a folder that exists.
    ///
    /// # Errors
    /// [`FileError::Locked`] while another process holds the lock, [`FileError::Write`] if the
    /// folder cannot be written to.
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
        // While it is still locked: whoever has opened it sees that it is gone.
        let _ = std::fs::remove_file(&self.path);
    }
}

enum Attempt {
    Locked(File),
    /// By this process, if it says so.
    Held(Option<u32>),
    /// The file was removed after it was opened.
    Gone,
}

fn attempt(path: &Path) -> std::io::Result<Attempt> {
    if path.symlink_metadata().is_ok_and(|there| !there.is_file()) {
        return Err(Error::new(ErrorKind::AlreadyExists, "a lock is a regular file"));
    }
    // What another process wrote stays there.
    let options = File::options().read(true).write(true).create(true).truncate(false).clone();
    let mut file = options.open(path)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            let mut process = String::new();
            let _ = (&mut file).take(20).read_to_string(&mut process);
            return Ok(Attempt::Held(process.trim().parse().ok()));
        }
        // A file system without locks does not keep anybody from working.
        Ok(()) | Err(TryLockError::Error(_)) => {}
    }
    if !is_at(&file, path) {
        return Ok(Attempt::Gone);
    }
    file.set_len(0)?;
    writeln!(file, "{}", std::process::id())?;
    Ok(Attempt::Locked(file))
}
