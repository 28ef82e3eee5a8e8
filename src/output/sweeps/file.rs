//! The file of a sweep: an archive of columns.
//!
//! It is a NumPy archive (`.npz`): a ZIP file whose entries are arrays in NumPy's format, compressed. The entry
//! `about` holds UTF-8 text as bytes, a RON structure with the tag [`SWEEPS`] and all names; each column is an
//! entry of 64-bit numbers:
//!
//! ```text
//!     about.npy
//!     SWEEP/runs/COLUMN.npy       one number for each run
//!     SWEEP/points/COLUMN.npy     one number for each point, run after run
//! ```
//!
//! In Python `numpy.load("mita-diagram.npz")["up/points/displacement"]` is a column.

use super::check::check_failures;
use super::table::{Row, SWEEPS, SweepTable, Sweeps};
use crate::output::error::{FileError, FormatError};
use crate::output::write_atomically;
use npyz::{NpyFile, WriterBuilder};
use std::io::{Cursor, Read, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

type Archive<'a> = ZipArchive<Cursor<&'a [u8]>>;

impl Sweeps {
    /// Saves all that is done, whole or not at all.
    ///
    /// # Errors
    /// [`FileError::Write`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        let bytes = self.to_bytes().map_err(FormatError::Unwritable);
        write_atomically(path, bytes.map_err(|source| FileError::format(path, source))?)
    }

    /// Loads what is done.
    ///
    /// # Errors
    /// [`FileError::Read`] if the file cannot be read, [`FileError::Format`] if it holds no sweeps.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| FileError::read(path, source))?;
        Sweeps::from_bytes(&bytes)
            .map_err(|reason| FileError::format(path, FormatError::Archive { reason }))
    }

    /// The file's content: the same bytes for the same sweeps.
    pub(super) fn to_bytes(&self) -> Result<Vec<u8>, String> {
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        let about = ron::to_string(self).map_err(|error| error.to_string())?;
        write(&mut zip, "about", about.as_bytes().iter().copied())?;
        for sweep in &self.sweeps {
            let SweepTable { name, rows, run_columns, point_columns, .. } = sweep;
            for (k, column) in run_columns.iter().enumerate() {
                let values = rows.values().map(|row| row.values[k]);
                write(&mut zip, &format!("{name}/runs/{column}"), values)?;
            }
            let width = point_columns.len();
            for (k, column) in point_columns.iter().enumerate() {
                let values = rows.values().flat_map(|row| row.points.chunks(width).map(|p| p[k]));
                write(&mut zip, &format!("{name}/points/{column}"), values)?;
            }
        }
        Ok(zip.finish().map_err(|error| error.to_string())?.into_inner())
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
        let text =
            String::from_utf8(read(&mut zip, "about")?).map_err(|error| error.to_string())?;
        let mut all: Sweeps = ron::from_str(&text).map_err(|error| error.to_string())?;
        if all.format != SWEEPS {
            let found = all.format;
            return Err(format!("its format is `{found}`, but this program reads `{SWEEPS}`"));
        }
        all.sweeps.iter_mut().try_for_each(|sweep| fill(sweep, &mut zip))?;
        Ok(all)
    }
}

/// Writes an array as an entry.
fn write<T: npyz::AutoSerialize>(
    zip: &mut ZipWriter<Cursor<Vec<u8>>>,
    name: &str,
    values: impl Iterator<Item = T>,
) -> Result<(), String> {
    let array = || -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let options = npyz::WriteOptions::new().default_dtype();
        let mut writer = options.writer(Cursor::new(&mut bytes)).begin_1d()?;
        writer.extend(values)?;
        writer.finish()?;
        Ok(bytes)
    };
    let bytes = array().map_err(|error| error.to_string())?;
    let options = SimpleFileOptions::default().large_file(bytes.len() > u32::MAX as usize / 2);
    zip.start_file(format!("{name}.npy"), options).map_err(|error| error.to_string())?;
    zip.write_all(&bytes).map_err(|error| error.to_string())
}

/// Reads an entry.
fn read<T: npyz::Deserialize>(zip: &mut Archive, name: &str) -> Result<Vec<T>, String> {
    let mut bytes = Vec::new();
    let mut entry = zip.by_name(&format!("{name}.npy")).map_err(|e| format!("`{name}`: {e}"))?;
    entry.read_to_end(&mut bytes).map_err(|error| format!("`{name}`: {error}"))?;
    let array = NpyFile::new(&bytes[..]).map_err(|error| format!("`{name}`: {error}"))?;
    array.into_vec().map_err(|error| format!("`{name}`: {error}"))
}

/// The columns of one sweep, all of one length.
fn columns(
    zip: &mut Archive,
    sweep: &str,
    table: &str,
    names: &[String],
) -> Result<Vec<Vec<f64>>, String> {
    let column = |name: &String| read::<f64>(zip, &format!("{sweep}/{table}/{name}"));
    let columns = names.iter().map(column).collect::<Result<Vec<_>, _>>()?;
    match columns.iter().all(|column| column.len() == columns[0].len()) {
        true => Ok(columns),
        false => Err(format!("the columns of `{sweep}/{table}` differ in length")),
    }
}

/// Reads the rows of a sweep.
fn fill(sweep: &mut SweepTable, zip: &mut Archive) -> Result<(), String> {
    sweep.check_columns()?;
    let name = &sweep.name;
    let runs = columns(zip, name, "runs", &sweep.run_columns)?;
    let points = columns(zip, name, "points", &sweep.point_columns)?;
    let of =
        |columns: &[Vec<f64>], k: usize| -> Vec<f64> { columns.iter().map(|c| c[k]).collect() };
    let mut failures = std::mem::take(&mut sweep.rows);
    for k in 0..runs.first().map_or(0, Vec::len) {
        let values = of(&runs, k);
        let run = sweep.run_number(values[0])?;
        let failure = failures.remove(&run).and_then(|row| row.failure);
        sweep.take_row(run, Row { values, points: Vec::new(), failure })?;
    }
    check_failures(&sweep.name, &failures)?;
    for k in 0..points.first().map_or(0, Vec::len) {
        let point = of(&points, k);
        let run = sweep.run_number(point[0])?;
        let run = sweep.rows.get_mut(&run);
        run.ok_or_else(|| format!("a point of run {} that is not there", point[0]))?
            .points
            .extend(point);
    }
    Ok(())
}
