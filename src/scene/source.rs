//! The text of a scene, and the files that it names.

use super::error::SceneError;
use crate::output::{FileError, SizeLimit, read};
use std::path::{Path, PathBuf};

/// The files that a scene may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Files<'a> {
    /// The folder to which their names are relative.
    pub folder: &'a Path,
    /// How large they may be.
    pub limit: SizeLimit,
}

impl<'a> Files<'a> {
    /// Files of a folder, of up to 256 MB.
    pub fn of(folder: &'a Path) -> Self {
        Files { folder, limit: SizeLimit::default() }
    }
}

/// The text of a scene, and the files that the scene may name; `None` if it must not name any.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneText<'a> {
    pub text: &'a str,
    pub files: Option<Files<'a>>,
}

/// The path and the content of a file that the field `what` of a scene names.
pub(super) fn file_of(
    scene: SceneText,
    what: &str,
    file: &str,
) -> Result<(PathBuf, Vec<u8>), SceneError> {
    let files = scene.files.ok_or_else(|| {
        SceneError::value(what, file, "an archive holds all that it needs, and names no files")
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
