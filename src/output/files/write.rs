//! Atomic writing of files: each file is written completely or not at all, and all files of one
//! result are written together.

use super::leftovers::{self, ENDING, temporary};
use super::target::target;
use crate::output::error::FileError;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Writes a file completely or not at all, like [`write_together`] with one file.
///
/// # Errors
/// As [`write_together`].
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("new folder").join("a.txt");
/// tangency::output::write_atomically(&path, "content")?;
/// assert_eq!(std::fs::read_to_string(&path)?, "content");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_atomically(
    path: impl AsRef<Path>,
    content: impl AsRef<[u8]>,
) -> Result<(), FileError> {
    write_together(&[(path, content)])
}

/// Writes the files of one result, each completely or not at all. Each file is first written as a
/// temporary file in the folder of its target, and then all temporary files are renamed in direct
/// succession. After a failure or a kill, all targets are therefore unchanged, unless the process
/// ends between two renames. Missing folders of the targets are created. If a target is a symbolic
/// link to a regular file, that file is replaced. Temporary files that remain from writers that
/// were killed are removed.
///
/// # Errors
/// [`FileError::Write`] with the path, if a folder cannot be created or written to;
/// [`FileError::Special`] if a target exists and is not a regular file, for example a device.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let [data, picture] = ["a.ron", "a.svg"].map(|name| folder.path().join(name));
/// tangency::output::write_together(&[(&data, "()"), (&picture, "<svg/>")])?;
/// assert_eq!(std::fs::read_to_string(&picture)?, "<svg/>");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_together<P: AsRef<Path>, C: AsRef<[u8]>>(files: &[(P, C)]) -> Result<(), FileError> {
    let written = files.iter().map(|(path, content)| Written::new(path.as_ref(), content.as_ref()));
    let written = written.collect::<Result<Vec<_>, _>>()?;
    written.into_iter().try_for_each(Written::rename)
}

/// A temporary file that is completely written, but not yet renamed to its final name. The
/// temporary file is removed when the value is dropped.
struct Written<'a> {
    path: &'a Path,
    target: PathBuf,
    file: NamedTempFile,
}

impl<'a> Written<'a> {
    fn new(path: &'a Path, content: &[u8]) -> Result<Self, FileError> {
        let failed = |source| FileError::Write { path: path.into(), source };
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        std::fs::create_dir_all(parent.unwrap_or(Path::new("."))).map_err(failed)?;
        let target = target(path)?;
        let write = || {
            let mut file = create(&target)?;
            file.write_all(content)?;
            file.as_file().sync_all()?;
            Ok(file)
        };
        let file = write().map_err(failed)?;
        Ok(Written { path, target, file })
    }

    fn rename(self) -> Result<(), FileError> {
        let Written { path, target, file } = self;
        let renamed = file.persist(target);
        renamed
            .map(|_| ())
            .map_err(|error| FileError::Write { path: path.into(), source: error.error })
    }
}

/// The maximum number of temporary files for one target in one process.
const MOST: usize = 100;

/// Creates a locked temporary file for a target file.
fn create(target: &Path) -> std::io::Result<NamedTempFile> {
    let Some(name) = target.file_name() else {
        return Err(std::io::Error::new(ErrorKind::InvalidInput, "the path does not name a file"));
    };
    let name = name.to_string_lossy();
    let folder = target.parent().filter(|parent| !parent.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    leftovers::remove(folder, &name);
    for serial in 0..MOST {
        let prefix = temporary(&name, serial);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).rand_bytes(0).suffix(ENDING);
        // Temporary files are private by default; a document should be as readable as any new file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        match builder.tempfile_in(folder) {
            Ok(file) => {
                // On systems without locks, no temporary file is ever considered abandoned.
                let _ = file.as_file().lock();
                // Another writer may have removed the file before it was locked.
                if leftovers::is_at(file.as_file(), file.path()) {
                    return Ok(file);
                }
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(std::io::Error::new(ErrorKind::ResourceBusy, "too many simultaneous writes"))
}
