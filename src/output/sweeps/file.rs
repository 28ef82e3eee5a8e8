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

use super::table::{Row, SweepTable, Sweeps};
use crate::output::error::{FileError, FormatError};
use crate::output::{Plot, write_atomically};
use npyz::{NpyFile, WriterBuilder};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// The tag by which a file of sweeps is known, with the version of its format.
pub const SWEEPS: &str = "tangency-sweeps/1";

/// What the columns mean.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct About {
    format: String,
    name: String,
    title: String,
    scene: String,
    plot: Plot,
    sweeps: Vec<Names>,
}

/// The names of one sweep, and the runs that failed.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Names {
    name: String,
    axes: Vec<String>,
    events: Vec<String>,
    total: usize,
    runs: Vec<String>,
    points: Vec<String>,
    failures: Vec<(usize, String)>,
}

type Archive<'a> = ZipArchive<Cursor<&'a [u8]>>;

impl Sweeps {
    /// Saves all that is done, whole or not at all.
    ///
    /// # Errors
    /// [`FileError::Write`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        let bytes = self.to_bytes().map_err(|source| FileError::Format {
            path: path.into(),
            source: FormatError::Unwritable(source),
        })?;
        write_atomically(path, bytes)
    }

    /// Loads what is done.
    ///
    /// # Errors
    /// [`FileError::Read`] if the file cannot be read, [`FileError::Format`] if it holds no sweeps.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let bytes =
            std::fs::read(path).map_err(|source| FileError::Read { path: path.into(), source })?;
        Sweeps::from_bytes(&bytes).map_err(|reason| FileError::Format {
            path: path.into(),
            source: FormatError::Archive { reason },
        })
    }

    /// The file's content: the same bytes for the same sweeps.
    pub(super) fn to_bytes(&self) -> Result<Vec<u8>, String> {
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        let about = ron::to_string(&self.about()).map_err(|error| error.to_string())?;
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

    fn about(&self) -> About {
        let names = |sweep: &SweepTable| Names {
            name: sweep.name.clone(),
            axes: sweep.axes.clone(),
            events: sweep.events.clone(),
            total: sweep.total,
            runs: sweep.run_columns.clone(),
            points: sweep.point_columns.clone(),
            failures: sweep
                .rows
                .iter()
                .filter_map(|(run, row)| Some((*run, row.failure.clone()?)))
                .collect(),
        };
        About {
            format: SWEEPS.into(),
            name: self.name.clone(),
            title: self.title.clone(),
            scene: self.scene.clone(),
            plot: self.plot.clone(),
            sweeps: self.sweeps.iter().map(names).collect(),
        }
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
        let text =
            String::from_utf8(read(&mut zip, "about")?).map_err(|error| error.to_string())?;
        let about: About = ron::from_str(&text).map_err(|error| error.to_string())?;
        if about.format != SWEEPS {
            return Err(format!(
                "its format is `{}`, but this program reads `{SWEEPS}`",
                about.format
            ));
        }
        let sweeps = about.sweeps.into_iter().map(|names| sweep(&mut zip, names));
        Ok(Sweeps {
            name: about.name,
            title: about.title,
            scene: about.scene,
            plot: about.plot,
            sweeps: sweeps.collect::<Result<_, _>>()?,
        })
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

fn sweep(zip: &mut Archive, names: Names) -> Result<SweepTable, String> {
    let runs = columns(zip, &names.name, "runs", &names.runs)?;
    let points = columns(zip, &names.name, "points", &names.points)?;
    let of =
        |columns: &[Vec<f64>], k: usize| -> Vec<f64> { columns.iter().map(|c| c[k]).collect() };
    let mut rows = BTreeMap::new();
    for k in 0..runs.first().map_or(0, Vec::len) {
        let values = of(&runs, k);
        rows.insert(values[0] as usize, Row { values, ..Row::default() });
    }
    for k in 0..points.first().map_or(0, Vec::len) {
        let point = of(&points, k);
        let run = rows.get_mut(&(point[0] as usize));
        run.ok_or_else(|| format!("a point of run {} that there is not", point[0]))?
            .points
            .extend(point);
    }
    for (run, failure) in names.failures {
        if let Some(row) = rows.get_mut(&run) {
            row.failure = Some(failure);
        }
    }
    Ok(SweepTable {
        name: names.name,
        axes: names.axes,
        events: names.events,
        total: names.total,
        run_columns: names.runs,
        point_columns: names.points,
        rows,
    })
}
