//! The files that a command writes: checked and locked before the work, saved together after it.

use super::error::CommandError;
use crate::output::{
    Document, FileError, Lock, Sweeps, draw, figures, kind, target, write_together,
};
use std::path::{Path, PathBuf};

/// The files of one result, `FOLDER/NAME.ENDING`, which no other run writes as long as this lives.
pub struct Results {
    folder: PathBuf,
    name: String,
    /// What it is made of, by its first file.
    source: Option<String>,
    // The lock is removed before the folders that hold nothing else.
    _lock: Lock,
    _made: Folders,
}

impl Results {
    /// Claims the files with these endings: what cannot be written is better known before the work
    /// than after it.
    ///
    /// # Errors
    /// [`CommandError::OutputIsInput`] for a file that is read; [`FileError`] for one that cannot
    /// be replaced, a folder that cannot be made, or a result that another run is writing.
    pub fn claim(
        folder: &Path,
        name: &str,
        endings: &[&str],
        inputs: &[&Path],
    ) -> Result<Self, CommandError> {
        let paths: Vec<PathBuf> = endings.iter().map(|ending| file(folder, name, ending)).collect();
        Results::claim_all(folder, name, &paths, inputs)
    }

    /// Claims one file.
    pub fn claim_file(path: &Path, inputs: &[&Path]) -> Result<Self, CommandError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Results::claim_all(folder, &name, &[path], inputs)
    }

    fn claim_all(
        folder: &Path,
        name: &str,
        paths: &[impl AsRef<Path>],
        inputs: &[&Path],
    ) -> Result<Self, CommandError> {
        let here = Path::new(".");
        let folder = if folder.as_os_str().is_empty() { here } else { folder };
        if name.contains(char::is_control) {
            return Err(FileError::Name { path: name.into() }.into());
        }
        let mut paths = paths.iter().map(AsRef::as_ref);
        let read = |path: &&Path| inputs.iter().any(|input| same_file(input, path));
        if let Some(path) = paths.clone().find(read) {
            return Err(CommandError::OutputIsInput { path: path.into() });
        }
        if name.len() > LONGEST_NAME {
            let (name, most) = (name.into(), LONGEST_NAME);
            return Err(FileError::LongName { name, most }.into());
        }
        // A folder would be made here, and its parents: none of them may be something else.
        let there = folder.ancestors().find_map(|path| Some((path, path.symlink_metadata().ok()?)));
        if let Some((path, there)) = there.filter(|(path, _)| !path.is_dir()) {
            let kind = match there.is_symlink() {
                true => "a link to nothing",
                false if there.is_file() => "a file",
                false => kind(there.file_type()),
            };
            return Err(FileError::NoFolder { path: path.into(), kind }.into());
        }
        let made = Folders::make(folder).map_err(|source| {
            let path = paths.clone().next().unwrap_or(folder).into();
            FileError::Write { path, source }
        })?;
        paths.try_for_each(|path| target(path).map(|_| ()))?;
        let lock = Lock::take(folder, name)?;
        let source = inputs.first().map(|input| input.display().to_string());
        Ok(Results { folder: folder.into(), name: name.into(), source, _lock: lock, _made: made })
    }

    /// The file with an ending.
    pub fn path(&self, ending: &str) -> PathBuf {
        file(&self.folder, &self.name, ending)
    }

    /// Saves branches and sweeps together with their picture and other files, and says where. A picture that cannot
    /// be drawn keeps nothing else from being saved; an earlier one, which shows something else, is
    /// removed.
    pub fn save(
        &self,
        document: Option<&Document>,
        sweeps: Option<&Sweeps>,
        others: Vec<(PathBuf, Vec<u8>)>,
    ) -> Result<Vec<PathBuf>, CommandError> {
        let named = document.map(|document| (&*self.name, document));
        let svg = figures(named.as_slice(), sweeps.map_or(&[], std::slice::from_ref), None, None)
            .and_then(|figures| draw(&figures));
        let mut files = self.data(document, sweeps)?;
        files.extend(others);
        let picture = self.path("svg");
        match svg {
            Ok(svg) => {
                files.push((picture, svg.into_bytes()));
                write_together(&files)?;
                Ok(files.into_iter().map(|(path, _)| path).collect())
            }
            Err(cause) => {
                write_together(&files)?;
                let _ = std::fs::remove_file(picture);
                let files = self.source.clone().unwrap_or_else(|| self.name.clone());
                Err(CommandError::Figure { files, cause })
            }
        }
    }

    /// Saves sweeps without a picture.
    pub fn save_alone(&self, sweeps: &Sweeps) -> Result<Vec<PathBuf>, CommandError> {
        let files = self.data(None, Some(sweeps))?;
        write_together(&files)?;
        Ok(files.into_iter().map(|(path, _)| path).collect())
    }

    fn data(
        &self,
        document: Option<&Document>,
        sweeps: Option<&Sweeps>,
    ) -> Result<Vec<(PathBuf, Vec<u8>)>, CommandError> {
        let [ron, npz] = ["ron", "npz"].map(|ending| self.path(ending));
        let unwritable = |path: &Path| {
            let path = path.to_path_buf();
            move |source| FileError::Format { path, source }
        };
        let mut files = Vec::new();
        if let Some(document) = document {
            let text = document.to_ron().map_err(unwritable(&ron))?;
            files.push((ron, text.into_bytes()));
        }
        if let Some(sweeps) = sweeps {
            let bytes = sweeps.to_bytes().map_err(unwritable(&npz))?;
            files.push((npz, bytes));
        }
        Ok(files)
    }
}

/// The most bytes of a result's name: that of its temporary files is longer, and file systems allow
/// 255.
const LONGEST_NAME: usize = 220;

fn file(folder: &Path, name: &str, ending: &str) -> PathBuf {
    folder.join(format!("{name}.{ending}"))
}

/// Whether two paths lead to one file, also by way of links.
fn same_file(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    a == b || real(a).is_some_and(|a| Some(a) == real(b))
}

/// Folders that were made for results; those that stay empty are removed.
struct Folders(Vec<PathBuf>);

impl Folders {
    fn make(folder: &Path) -> std::io::Result<Self> {
        let missing = folder.ancestors().take_while(|folder| !folder.exists());
        let missing = missing.map(PathBuf::from).collect();
        std::fs::create_dir_all(folder)?;
        Ok(Folders(missing))
    }
}

impl Drop for Folders {
    fn drop(&mut self) {
        self.0.iter().all(|folder| std::fs::remove_dir(folder).is_ok());
    }
}
