//! Temporary files: their names, and the detection of temporary files left by killed runs.
//!
//! A file `NAME` is first written as `.NAME.PROCESS.tmp` in the same folder, and the writer keeps
//! this temporary file locked. The operating system releases a lock when its process ends for any
//! reason; a temporary file whose lock can be taken therefore has no writer. (A process id alone
//! would not suffice: ids are reused, and containers that share a folder have separate ids.)

use std::ffi::OsStr;
use std::fs::File;
use std::path::Path;

/// Returns the name of the temporary file of a process, without the extension; the name contains a
/// counter because a process can have several temporary files simultaneously.
pub(super) fn temporary(name: &str, serial: usize) -> String {
    let process = std::process::id();
    match serial {
        0 => format!(".{name}.{process}"),
        _ => format!(".{name}.{process}-{serial}"),
    }
}

/// The extension of temporary files.
pub(super) const ENDING: &str = ".tmp";

/// Returns whether a name is the name of a temporary file that will replace the given file.
fn is_temporary(found: &OsStr, name: &str) -> bool {
    let process = found.to_str().and_then(|found| {
        found.strip_prefix('.')?.strip_prefix(name)?.strip_prefix('.')?.strip_suffix(ENDING)
    });
    let number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    process.is_some_and(|process| process.splitn(2, '-').all(number))
}

/// Removes the temporary files of a given file if their writers have ended. Failures are ignored.
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

/// Returns whether an open file is still the file at a path; since it was opened, the file may have
/// been removed or replaced.
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
        // Open files cannot be removed on this system.
        let _ = file;
        path.exists()
    }
}
