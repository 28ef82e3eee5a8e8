//! The text of a scene, and the files that it names.

use super::error::SceneError;
use crate::output::{FileError, SizeLimit, read};
use std::path::{Path, PathBuf};

/// The text of a scene, and the folder that its file names are relative to. Without a folder, the scene
/// must not name files.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneText<'a> {
    pub text: &'a str,
    pub folder: Option<&'a Path>,
}

/// The path and the content of a file that the field `what` of a scene names.
pub(super) fn file_of(
    scene: SceneText,
    what: &str,
    file: &str,
) -> Result<(PathBuf, Vec<u8>), SceneError> {
    let folder = scene.folder.ok_or_else(|| {
        SceneError::value(what, file, "an archive holds all that it needs, and names no files")
    })?;
    let path = folder.join(file);
    let bytes = read(&path, SizeLimit::default()).map_err(|cause| SceneError::File {
        path: path.display().to_string(),
        cause: match cause {
            FileError::Read { source, .. } => source.to_string(),
            other => other.to_string(),
        },
    })?;
    Ok((path, bytes))
}
