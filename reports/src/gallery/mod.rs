//! The gallery: an interactive page for each built-in scene and each model of the project, and an
//! index of all pages.
//!
//! All pages load Plotly from one file, `plotly.min.js`, in the folder of the gallery.

mod drawn;
mod entries;
mod index;

pub use drawn::{Failure, PERIODS};
pub use entries::{Entry, Section, entries};

use drawn::Drawn;
use index::index;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};
use tangency::output::{FileError, PLOTLY, write_atomically, write_together};

/// The file from which all pages of a gallery load Plotly.
pub const SCRIPT: &str = "plotly.min.js";

/// An entry of a gallery that has been traced, and whose page has been written.
struct Card<'a> {
    entry: &'a Entry,
    /// The drawn entry, or the reason why the entry could not be drawn.
    drawn: Result<Drawn, Failure>,
}

/// A gallery that has been written.
pub struct Gallery {
    /// The path of the index.
    pub index: PathBuf,
    /// The names of the entries that could not be drawn, each with the reason.
    pub failures: Vec<(String, Failure)>,
}

/// Traces entries on all cores, and writes the page of each entry and the index of all pages into a
/// folder. Calls `traced` after each entry, with the time that the entry took and the reason of a
/// failure. The index lists the entries that could not be drawn.
///
/// ```no_run
/// use std::path::Path;
/// use tangency_reports::gallery::{entries, gallery};
/// let gallery = gallery(&entries(), Path::new("docs/gallery"), &|_, _, _| ())?;
/// assert!(gallery.failures.is_empty() && gallery.index.is_file());
/// # Ok::<(), tangency::output::FileError>(())
/// ```
///
/// # Errors
/// [`FileError`] if the index or the script cannot be written.
pub fn gallery(
    entries: &[Entry],
    folder: &Path,
    traced: &(impl Fn(&Entry, Duration, Option<&Failure>) + Sync),
) -> Result<Gallery, FileError> {
    write_atomically(folder.join(SCRIPT), PLOTLY)?;
    let queue = Mutex::new(entries.iter().enumerate());
    let cards = Mutex::new(Vec::new());
    let work = || {
        while let Some((place, entry)) = { queue.lock().expect("no panic").next() } {
            let start = Instant::now();
            let drawn = entry.draw().and_then(|drawn| write(entry, folder, drawn));
            traced(entry, start.elapsed(), drawn.as_ref().err());
            cards.lock().expect("no panic").push((place, Card { entry, drawn }));
        }
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..cores).for_each(|_| drop(scope.spawn(work))));
    let mut cards = cards.into_inner().expect("no panic");
    cards.sort_by_key(|(place, _)| *place);
    let cards: Vec<Card> = cards.into_iter().map(|(_, card)| card).collect();
    let path = folder.join("index.html");
    write_atomically(&path, index(&cards))?;
    let failures = cards
        .into_iter()
        .filter_map(|Card { entry, drawn }| Some((entry.name.clone(), drawn.err()?)));
    Ok(Gallery { index: path, failures: failures.collect() })
}

/// Writes the page and the thumbnail of an entry, and returns the entry without the page and the
/// thumbnail.
fn write(entry: &Entry, folder: &Path, mut drawn: Drawn) -> Result<Drawn, Failure> {
    let file = |ending: &str| folder.join(format!("{}.{ending}", entry.name));
    let [page, thumbnail] = std::mem::take(&mut drawn.files);
    write_together(&[(file("html"), page), (file("svg"), thumbnail)])?;
    Ok(drawn)
}
