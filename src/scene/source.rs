//! The text of a scene, together with the files to which it refers.

use super::error::SceneError;
use crate::output::{FileError, SizeLimit, read};
use std::path::{Path, PathBuf};

/// The files to which a scene may refer: a folder and a maximum size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Files<'a> {
    /// The folder that contains the files; the names of files in a scene are relative to this
    /// folder.
    pub folder: &'a Path,
    /// The maximum size of each file in bytes.
    pub limit: SizeLimit,
}

impl<'a> Files<'a> {
    /// Allows a scene to refer to files in a given folder, each of up to 256 MB.
    pub fn of(folder: &'a Path) -> Self {
        Files { folder, limit: SizeLimit::default() }
    }
}

/// The text of a scene, and the files to which it may refer; `None` if files are not allowed.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneText<'a> {
    pub text: &'a str,
    pub files: Option<Files<'a>>,
}

/// Returns the path and the content of the file that the field `what` of a scene names.
pub(super) fn file_of(
    scene: SceneText,
    what: &str,
    file: &str,
) -> Result<(PathBuf, Vec<u8>), SceneError> {
    let files = scene.files.ok_or_else(|| {
        SceneError::value(what, file, "a scene in an archive must not refer to other files")
    })?;
    let path = files.folder.join(file);
    let bytes = read(&path, files.limit).map_err(|cause| SceneError::File {
        path: path.display().to_string(),
        cause: match cause {
            FileError::Read { source, .. } => source.to_string(),
            other => other.to_string(),
        },
    })?;
    Ok((path, bytes))
}
