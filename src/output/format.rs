//! The formats that pictures may have.

use super::error::FileError;
use std::path::Path;

/// The format of a file of branches to look at, by the ending of its name.
///
/// ```
/// use std::path::Path;
/// use tangency::output::Format;
/// assert_eq!(Format::of(Path::new("a.svg"))?, Format::Svg);
/// let error = Format::of(Path::new("a.jpg")).unwrap_err().to_string();
/// assert!(error.contains("known: .svg, .csv"), "{error}");
/// # Ok::<(), tangency::output::FileError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// A picture of lines.
    Svg,
    /// All points, as comma-separated values.
    Csv,
    /// A picture of pixels.
    #[cfg(feature = "png")]
    Png,
}

/// The endings that are known.
const ENDINGS: &[&str] = if cfg!(feature = "png") {
    &[".svg", ".csv", ".png"]
} else {
    &[".svg", ".csv", ".png (in a build with `--features png`)"]
};

impl Format {
    /// The format of a file.
    ///
    /// # Errors
    /// [`FileError::Ending`] for other endings, and for none.
    pub fn of(path: &Path) -> Result<Self, FileError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match &*ending {
            "svg" => Ok(Format::Svg),
            "csv" => Ok(Format::Csv),
            #[cfg(feature = "png")]
            "png" => Ok(Format::Png),
            _ => Err(FileError::Ending { path: path.into(), known: ENDINGS }),
        }
    }
}
