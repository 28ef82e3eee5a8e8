//! Initial profiles of solutions of boundary-value problems; they are read from files or stated in
//! scenes.

use super::error::SceneError;
use super::source::{SceneText, file_of};
use crate::core::problem::{Names, UnknownName};
use serde::{Deserialize, Serialize};

/// The name of the field, in the start of a run, that names a file with the points of a profile.
const FILE: &str = "file";

/// An initial profile of a solution of a boundary-value problem, given as a table of states whose
/// first column is time. The time range of the table is stretched to the length of the problem's
/// interval.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// The file that contains the table of the profile; `None` after the file has been read.
    #[serde(default, skip_serializing)]
    file: Option<String>,
    /// The names of the columns of the table: first time, then the names of states.
    #[serde(default)]
    columns: Vec<String>,
    /// The rows of the table, in the order of increasing time.
    #[serde(default)]
    rows: Vec<Vec<f64>>,
}

impl Profile {
    /// Reads the table of the profile from its file, if a file is named.
    pub(super) fn load(&mut self, scene: SceneText) -> Result<(), SceneError> {
        let Some(file) = self.file.take() else { return Ok(()) };
        if !(self.columns.is_empty() && self.rows.is_empty()) {
            let reason = "the scene also contains a table of values for the profile that \
                          this file defines";
            return Err(SceneError::value(FILE, &file, reason)
                .with_help("give the table of the profile either in the file or in the scene"));
        }
        let (path, bytes) = file_of(scene, FILE, &file)?;
        *self = table(&String::from_utf8_lossy(&bytes))
            .map_err(|cause| SceneError::File { path: path.display().to_string(), cause })?;
        Ok(())
    }

    /// Checks that the table has at least two rows, a finite number in each cell, and increasing
    /// times.
    pub(super) fn check(&self, place: &str) -> Result<(), SceneError> {
        let wrong = |message: String| Err(SceneError::invalid(format!("{place}: {message}")));
        if self.columns.len() < 2 || self.rows.len() < 2 {
            let (columns, rows) = (self.columns.len(), self.rows.len());
            return wrong(format!(
                "the profile has {columns} columns and {rows} rows, but needs a column of times, \
                 at least one column of a state, and at least two rows"
            ));
        }
        for (k, row) in self.rows.iter().enumerate() {
            if row.len() != self.columns.len() || row.iter().any(|x| !x.is_finite()) {
                return wrong(format!(
                    "row {} of the profile is {row:?}, but must contain a finite number for each \
                     column",
                    k + 1
                ));
            }
        }
        match self.rows.windows(2).find(|pair| pair[0][0] >= pair[1][0]) {
            Some(pair) => {
                let [before, after] = [pair[0][0], pair[1][0]];
                wrong(format!(
                    "the time {before} of the profile is followed by the time {after}, but times \
                     must increase"
                ))
            }
            None => Ok(()),
        }
    }

    /// Checks that the name of each column after the first column is the name of a state.
    pub(super) fn check_names(&self, names: &Names) -> Result<(), SceneError> {
        let states = names.elements().collect::<Vec<_>>();
        match self.columns[1..].iter().find(|name| !states.contains(name)) {
            Some(name) => Err(UnknownName::new("state", name, states).into()),
            None => Ok(()),
        }
    }

    /// Returns the states at a given time, in units of the interval's length, by linear
    /// interpolation in the table of the profile.
    pub(super) fn at(&self, tau: f64) -> Vec<(String, f64)> {
        let time = |row: &[f64]| row[0];
        let [start, end] = [0, self.rows.len() - 1].map(|k| time(&self.rows[k]));
        let t = start + tau * (end - start);
        let k = self.rows.partition_point(|row| time(row) <= t).clamp(1, self.rows.len() - 1);
        let (before, behind) = (&self.rows[k - 1], &self.rows[k]);
        let share = (t - before[0]) / (behind[0] - before[0]);
        let states = self.columns.iter().zip(before.iter().zip(behind)).skip(1);
        states.map(|(name, (a, b))| (name.clone(), a + share * (b - a))).collect()
    }
}

/// Parses a table from text: the first line contains the names of the columns, and each further
/// line contains a row of numbers, separated by blanks, commas or semicolons. Empty lines of a
/// table and lines that begin with `#` are skipped.
fn table(text: &str) -> Result<Profile, String> {
    let separates = |c: char| c.is_whitespace() || c == ',' || c == ';';
    let cells = |line: &str| -> Vec<String> {
        let cells = line.split(separates).filter(|cell| !cell.is_empty());
        cells.map(|cell| cell.trim_matches('"').to_string()).collect()
    };
    let mut lines = text.lines().enumerate().filter_map(|(k, line)| {
        let line = line.trim_start_matches('\u{feff}').trim();
        (!line.is_empty() && !line.starts_with('#')).then(|| (k + 1, cells(line)))
    });
    let (_, columns) = lines.next().ok_or("the file is empty")?;
    if columns.iter().all(|name| name.parse::<f64>().is_ok()) {
        return Err(
            "the first line of the file must contain the names of the columns, as in `t, u, \
                    v`"
            .into(),
        );
    }
    let mut rows = Vec::new();
    for (line, cells) in lines {
        let number = |cell: &String| {
            cell.parse().map_err(|_| format!("`{cell}` in line {line} is not a number"))
        };
        rows.push(cells.iter().map(number).collect::<Result<Vec<f64>, _>>()?);
        if cells.len() != columns.len() {
            let (found, known) = (cells.len(), columns.len());
            return Err(format!(
                "line {line} has {found} numbers, but the table has {known} columns"
            ));
        }
    }
    Ok(Profile { file: None, columns, rows })
}
