//! Temporary files: how they are named, and how those of killed runs are recognised.
//!
//! A file `NAME` is written as `.NAME.PROCESS.tmp` beside it, which its writer keeps locked. A lock
//! ends with its process, however that ends, so that a file whose lock can be taken has no writer.
//! (A process id alone would not do: ids are used again, and containers that share a folder have
//! their own.)

use std::ffi::OsStr;
use std::fs::File;
use std::path::Path;

/// The name of the temporary file of a process, without its ending; a process that writes a file
/// twice at a time numbers them.
pub(super) fn temporary(name: &str, serial: usize) -> String {
    let process = std::process::id();
    match serial {
        0 => format!(".{name}.{process}"),
        _ => format!(".{name}.{process}-{serial}"),
    }
}

/// The ending of temporary files.
pub(super) const ENDING: &str = ".tmp";

/// Whether this is the name of a temporary file of a file.
fn is_temporary(found: &OsStr, name: &str) -> bool {
    let process = found.to_str().and_then(|found| {
        found.strip_prefix('.')?.strip_prefix(name)?.strip_prefix('.')?.strip_suffix(ENDING)
    });
    let number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    process.is_some_and(|process| process.splitn(2, '-').all(number))
}

/// Removes the temporary files of a file whose writers have ended. What cannot be removed is not in
/// the way.
pub(super) fn remove(folder: &Path, name: &str) {
    let entries = folder.read_dir().into_iter().flatten().flatten();
    for entry in entries.filter(|entry| is_temporary(&entry.file_name(), name)) {
        let path = entry.path();
        let regular = path.symlink_metadata().is_ok_and(|there| there.is_file());
        let opened = || File::options().write(true).open(&path);
        let abandoned = |file: &File| file.try_lock().is_ok() && is_at(file, &path);
        if regular && opened().is_ok_and(|file| abandoned(&file)) {
            let _ = std::fs::remove_file(&path);
        }
    }
}

/// Whether an open file is still what stands under a path: it may have been removed, or replaced.
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let identity = |there: std::fs::Metadata| (there.dev(), there.ino());
        let open = file.metadata().map(identity).ok();
        open.is_some() && open == path.symlink_metadata().map(identity).ok()
    }
    #[cfg(not(unix))]
    {
        // Open files cannot be removed there.
        let _ = file;
        path.exists()
    }
}
