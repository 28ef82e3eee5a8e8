//! The one way to write a file: whole or not at all.

use super::error::FileError;
use std::io::Write;
use std::path::Path;

/// Writes a file whole or not at all: into a temporary file of the same folder, which then takes the
/// name. The folder is made if it is missing. What was under the name before is replaced only at
/// the end, so that a failure leaves it as it was.
///
/// # Errors
/// [`FileError::Write`] with the path, if the folder cannot be made or written to.
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
    let path = path.as_ref();
    attempt(path, content.as_ref())
        .map_err(|source| FileError::Write { path: path.to_path_buf(), source })
}

fn attempt(path: &Path, content: &[u8]) -> std::io::Result<()> {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let folder = parent.unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut builder = tempfile::Builder::new();
    // Temporary files are private by default; a document should be as readable as any new file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(content)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}
