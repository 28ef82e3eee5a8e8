//! The file format of sweeps: an archive of columns.
//!
//! The file of sweeps is a NumPy archive (`.npz`): a ZIP file whose entries are compressed arrays
//! in NumPy's format. The entry `about` contains UTF-8 text as bytes: a RON structure with the tag
//! [`SWEEPS`] and all names. Each column of a sweep is an entry of 64-bit numbers:
//!
//! ```text
//!     about.npy
//!     SWEEP/runs/COLUMN.npy       one number for each run
//!     SWEEP/points/COLUMN.npy     one number for each point, run after run
//! ```
//!
//! Names of entries do not contain `..` or begin with `/`, so that an unpacked archive stays in its
//! folder.
//!
//! In Python, `numpy.load("mita-diagram.npz")["up/points/displacement"]` is a column.

use super::check::check_failures;
use super::table::{Row, SWEEPS, SweepTable, Sweeps};
use crate::output::error::{FileError, FormatError};
use crate::output::files::{SizeLimit, read as read_file, write_atomically};
use crate::output::npy::{Element, from_npy};
use crate::output::npz::Npz;
use crate::output::words::{Invalid, component, entry, text};
use std::fmt::Display;
use std::io::{Cursor, Read};
use std::path::Path;
use zip::ZipArchive;

/// An archive that is being read, and the number of bytes that may still be unpacked from it.
struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    limit: u64,
    left: u64,
}

impl Sweeps {
    /// Saves all finished runs of the sweeps to a file atomically.
    ///
    /// # Errors
    /// [`FileError::Write`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        write_atomically(path, self.to_bytes().map_err(|source| FileError::format(path, source))?)
    }

    /// Loads the finished runs of the sweeps from a file.
    ///
    /// # Errors
    /// [`FileError::Read`] if the file cannot be read, [`FileError::Format`] if the file does not
    /// contain sweeps, [`FileError::TooLarge`] if the file is larger than [`SizeLimit::default`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        Sweeps::load_within(SizeLimit::default(), path)
    }

    /// Loads the finished runs of the sweeps from a file of limited size.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_within(limit: SizeLimit, path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let bytes = read_file(path, limit)?;
        Sweeps::from_bytes(&bytes, limit).map_err(|source| FileError::format(path, source))
    }

    /// Returns the content of the file, which is identical for identical sweeps.
    ///
    /// # Errors
    /// [`FormatError`] if the content could not be read again, because the name of an entry is
    /// invalid or occurs twice.
    pub fn to_bytes(&self) -> Result<Vec<u8>, FormatError> {
        check(self)?;
        self.packed().map_err(FormatError::Unwritable)
    }

    fn packed(&self) -> Result<Vec<u8>, String> {
        let mut archive = Npz::new();
        let about = ron::to_string(self).map_err(|error| error.to_string())?;
        archive.add("about", about.as_bytes().iter().copied())?;
        for sweep in &self.sweeps {
            let SweepTable { name, rows, run_columns, point_columns, .. } = sweep;
            for (k, column) in run_columns.iter().enumerate() {
                let values = rows.values().map(|row| row.values[k]);
                archive.add(&format!("{name}/runs/{column}"), values)?;
            }
            let width = point_columns.len();
            for (k, column) in point_columns.iter().enumerate() {
                let values = rows.values().flat_map(|row| row.points.chunks(width).map(|p| p[k]));
                archive.add(&format!("{name}/points/{column}"), values)?;
            }
        }
        archive.finish()
    }

    fn from_bytes(bytes: &[u8], limit: SizeLimit) -> Result<Self, FormatError> {
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
        let limit = limit.unpacked;
        let mut archive = Archive { zip, limit, left: limit };
        let text = String::from_utf8(archive.read("about")?).map_err(damaged)?;
        let mut all: Sweeps = ron::from_str(&text).map_err(damaged)?;
        if all.format != SWEEPS {
            let found = all.format;
            return Err(damaged(format!(
                "the format of the file is `{found}`, but this program reads `{SWEEPS}`"
            )));
        }
        check(&all)?;
        all.sweeps.iter_mut().try_for_each(|sweep| fill(sweep, &mut archive))?;
        Ok(all)
    }
}

fn damaged(reason: impl ToString) -> FormatError {
    FormatError::Archive { reason: reason.to_string() }
}

/// Checks all names: the names of sweeps and columns must be valid names of entries, and the name
/// of the scene a valid file name.
fn check(all: &Sweeps) -> Result<(), Invalid> {
    component("the scene's name", &all.name)?;
    text("the title", &all.title)?;
    for sweep in &all.sweeps {
        entry("the name of a sweep", &sweep.name)?;
        let place = format!("sweep `{}`, a column", sweep.name);
        let columns = sweep.run_columns.iter().chain(&sweep.point_columns);
        columns.chain(&sweep.axes).chain(&sweep.events).try_for_each(|name| entry(&place, name))?;
    }
    for (column, label) in &all.plot.labels {
        text(&format!("plot, the label of `{column}`"), label)?;
    }
    Ok(())
}

impl Archive<'_> {
    /// Reads an entry.
    fn read<T: Element>(&mut self, name: &str) -> Result<Vec<T>, FormatError> {
        let failed = |error: &dyn Display| damaged(format!("`{name}`: {error}"));
        let mut bytes = Vec::new();
        let entry = self.zip.by_name(&format!("{name}.npy")).map_err(|error| failed(&error))?;
        // The declared size of an entry may be wrong.
        let more = self.left.saturating_add(1);
        entry.take(more).read_to_end(&mut bytes).map_err(|error| failed(&error))?;
        let left = self.left.checked_sub(bytes.len() as u64);
        self.left = left.ok_or(FormatError::Unpacked { limit: self.limit })?;
        from_npy(&bytes).map_err(|error| failed(&error))
    }

    /// Reads the columns of one sweep, which must all have the same length.
    fn columns(
        &mut self,
        sweep: &str,
        table: &str,
        names: &[String],
    ) -> Result<Vec<Vec<f64>>, FormatError> {
        let column = |name: &String| self.read::<f64>(&format!("{sweep}/{table}/{name}"));
        let columns = names.iter().map(column).collect::<Result<Vec<_>, _>>()?;
        match columns.iter().all(|column| column.len() == columns[0].len()) {
            true => Ok(columns),
            false => Err(damaged(format!("the columns of `{sweep}/{table}` differ in length"))),
        }
    }
}

/// Combines the columns of a sweep into its rows.
fn fill(sweep: &mut SweepTable, archive: &mut Archive) -> Result<(), FormatError> {
    sweep.check_columns().map_err(damaged)?;
    let name = &sweep.name;
    let runs = archive.columns(name, "runs", &sweep.run_columns)?;
    let points = archive.columns(name, "points", &sweep.point_columns)?;
    let of =
        |columns: &[Vec<f64>], k: usize| -> Vec<f64> { columns.iter().map(|c| c[k]).collect() };
    let mut failures = std::mem::take(&mut sweep.rows);
    for k in 0..runs.first().map_or(0, Vec::len) {
        let values = of(&runs, k);
        let run = sweep.run_number(values[0]).map_err(damaged)?;
        let failure = failures.remove(&run).and_then(|row| row.failure);
        sweep.take_row(run, Row { values, points: Vec::new(), failure }).map_err(damaged)?;
    }
    check_failures(&sweep.name, &failures).map_err(damaged)?;
    for k in 0..points.first().map_or(0, Vec::len) {
        let point = of(&points, k);
        let run = sweep.run_number(point[0]).map_err(damaged)?;
        let run = sweep.rows.get_mut(&run);
        run.ok_or_else(|| {
            damaged(format!("a point belongs to run {}, which does not exist", point[0]))
        })?
        .points
        .extend(point);
    }
    Ok(())
}
