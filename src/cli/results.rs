//! The files that a command writes: the files are checked and locked before the computation, and
//! saved together after the computation.

use super::error::CommandError;
use super::warning::warn;
use crate::output::{self, Document, FileError, Format, Lock, SaveError, Sweeps, kind, target};
use std::io::Read;
use std::path::{Path, PathBuf};

/// The files of one result, `FOLDER/NAME.ENDING`; they are locked against other runs of the program
/// while this value exists.
pub struct Results {
    folder: PathBuf,
    name: String,
    formats: Vec<Format>,
    /// The first input file; messages refer to the result by the name of this file.
    source: Option<String>,
    // The lock is removed before the new folders, so that they can be removed if empty.
    _lock: Lock,
    _made: Folders,
}

impl Results {
    /// Locks the files of the result in the given formats. Files that cannot be written are
    /// reported before the computation starts.
    ///
    /// # Errors
    /// [`CommandError::OutputIsInput`] if a file of the result is also an input file; [`FileError`]
    /// if a file cannot be replaced, if a folder cannot be created, or if another run is writing
    /// the same result.
    pub fn claim(
        folder: &Path,
        name: &str,
        formats: &[Format],
        inputs: &[&Path],
    ) -> Result<Self, CommandError> {
        let stem = folder.join(name);
        let paths: Vec<PathBuf> = formats.iter().map(|format| format.file(&stem)).collect();
        let claimed = Results::claim_all(folder, name, &paths, inputs)?;
        Ok(Results { formats: formats.into(), ..claimed })
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
        // Missing parent folders are created here: none of the existing ones may be something else.
        let there = folder.ancestors().find_map(|path| Some((path, path.symlink_metadata().ok()?)));
        if let Some((path, there)) = there.filter(|(path, _)| !path.is_dir()) {
            let kind = match there.is_symlink() {
                true => "a dangling link",
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
        let (folder, name, formats) = (folder.into(), name.into(), Vec::new());
        Ok(Results { folder, name, formats, source, _lock: lock, _made: made })
    }

    /// Returns the path of the result's file in a format.
    pub fn path(&self, format: Format) -> PathBuf {
        format.file(&self.folder.join(&self.name))
    }

    /// Saves branches and sweeps in the formats whose files are locked, and returns the paths of
    /// the files.
    pub fn save(
        &self,
        document: Option<&Document>,
        sweeps: Option<&Sweeps>,
    ) -> Result<Vec<PathBuf>, CommandError> {
        if let Some(document) = document {
            self.announce_replaced(document);
        }
        let named = document.map(|document| (&*self.name, document));
        let sweeps = sweeps.map_or(&[][..], std::slice::from_ref);
        let found = output::Results { documents: named.as_slice(), sweeps, ..Default::default() };
        let lacks = |format: &Format| *format == Format::Ron && document.is_none();
        let formats: Vec<Format> = self.formats.iter().copied().filter(|it| !lacks(it)).collect();
        let saved = output::save(&found, &self.folder.join(&self.name), &formats);
        saved.map_err(|cause| self.unsaved(cause))
    }

    /// Warns if the file to be replaced contains the results of another scene.
    fn announce_replaced(&self, document: &Document) {
        let path = self.path(Format::Ron);
        // The title is in the first lines.
        let mut begin = vec![0; BEGIN];
        let read = std::fs::File::open(&path).and_then(|mut file| file.read(&mut begin));
        let text = String::from_utf8_lossy(&begin[..read.unwrap_or(0)]);
        // Settings are listed by name after `settings: [`.
        let is_known = |line: &str| {
            let name = line.trim().strip_prefix("(\"").and_then(|rest| rest.split('"').next());
            name.is_none_or(|name| document.settings.iter().any(|(known, _)| known == name))
        };
        let begins = text.find("settings: [").map_or("", |at| &text[at..]);
        let mut settings = begins.lines().skip(1).take_while(|line| line.trim().ends_with("),"));
        let has_others = !settings.all(is_known);
        let line = text.lines().find_map(|line| line.trim().strip_prefix("title: "));
        let earlier =
            line.and_then(|line| ron::from_str::<String>(line.trim_end_matches(',')).ok());
        // Changed values are omitted from the title.
        let main = |title: &str| title.split(", ").next().map(String::from);
        let differs = |earlier: &String| main(earlier) != main(&document.title);
        if let Some(earlier) = earlier.filter(|earlier| has_others || differs(earlier)) {
            warn(&format!(
                "the file {} contained the results of another scene, `{earlier}`, and is now \
                 replaced; choose another folder with `--out` to keep the results of several \
                 scenes",
                path.display()
            ));
        }
    }

    fn unsaved(&self, cause: SaveError) -> CommandError {
        match cause {
            SaveError::Figure(cause) => {
                let files = self.source.clone().unwrap_or_else(|| self.name.clone());
                CommandError::Figure { files, cause }
            }
            SaveError::File(cause) => cause.into(),
            cause => CommandError::Unsaved(cause),
        }
    }
}

/// The number of bytes at the start of a document within which its title is found.
const BEGIN: usize = 4096;

/// The maximum length of a result's name in bytes: file systems allow 255 bytes, and the names of
/// temporary files are longer than the name.
const LONGEST_NAME: usize = 220;

/// Returns whether two paths lead to the same file, directly or through links.
fn same_file(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    a == b || real(a).is_some_and(|a| Some(a) == real(b))
}

/// Folders that were created for results; folders that are still empty are removed when this value
/// is dropped.
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
