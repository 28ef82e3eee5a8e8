//! Checks the tables of a file of sweeps: each table must be rectangular, contain valid run
//! numbers, and be consistent with the scene.

use super::table::{Row, SweepTable, Sweeps};
use crate::core::spelling::listed;
use std::collections::BTreeMap;

/// The columns with which every table of runs must begin.
const RUN_COLUMNS: [&str; 2] = ["run", "start"];
/// The columns with which every table of points must begin.
const POINT_COLUMNS: [&str; 4] = ["run", "period", "event", "time"];

/// The first difference between the tables in a file of sweeps and the tables expected for a scene.
#[derive(Clone, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[error("{what} of {place} differ: `{found}` in the file, `{expected}` in its scene")]
pub struct TableDifference {
    /// The place of the difference: the name of a sweep, or the whole file.
    pub place: String,
    /// The part of the tables in which the difference occurs, such as the axes.
    pub what: &'static str,
    /// The content of the differing part in the file.
    pub found: String,
    /// The content of the differing part that the scene would write.
    pub expected: String,
}

impl Sweeps {
    /// Checks that two sets of tables belong to the same sweeps, whether or not the sweeps are
    /// finished.
    ///
    /// # Errors
    /// [`TableDifference`] with the first name, columns or number of runs in which the two sets
    /// differ.
    pub fn check_tables(&self, expected: &Sweeps) -> Result<(), TableDifference> {
        let names = |all: &Sweeps| all.sweeps.iter().map(|sweep| sweep.name.clone()).collect();
        let (found, wanted): (Vec<String>, Vec<String>) = (names(self), names(expected));
        let differ = |place: &str, what: &'static str, found: &[String], wanted: &[String]| {
            let same = found == wanted;
            let [found, expected] = [found, wanted].map(listed);
            if same {
                Ok(())
            } else {
                Err(TableDifference { place: place.into(), what, found, expected })
            }
        };
        differ("the file", "the sweeps", &found, &wanted)?;
        for (found, wanted) in self.sweeps.iter().zip(&expected.sweeps) {
            let place = format!("the sweep `{}`", found.name);
            differ(&place, "the axes", &found.axes, &wanted.axes)?;
            differ(&place, "the events", &found.events, &wanted.events)?;
            differ(&place, "the columns of runs", &found.run_columns, &wanted.run_columns)?;
            differ(&place, "the columns of points", &found.point_columns, &wanted.point_columns)?;
            let totals = [found, wanted].map(|sweep| vec![sweep.total.to_string()]);
            differ(&place, "the numbers of runs", &totals[0], &totals[1])?;
        }
        Ok(())
    }
}

impl SweepTable {
    /// Returns an error if the tables do not begin with the required columns.
    pub(super) fn check_columns(&self) -> Result<(), String> {
        let begins = |columns: &[String], known: &[&str]| {
            columns.len() >= known.len() && columns.iter().zip(known).all(|(a, b)| a == b)
        };
        let tables = [
            ("runs", &self.run_columns, &RUN_COLUMNS[..]),
            ("points", &self.point_columns, &POINT_COLUMNS[..]),
        ];
        match tables.into_iter().find(|(_, columns, known)| !begins(columns, known)) {
            None => Ok(()),
            Some((table, columns, known)) => Err(format!(
                "the table of {table} of the sweep `{}` has the columns `{}`, but must begin with \
                 the columns `{}`",
                self.name,
                listed(columns),
                known.join(", ")
            )),
        }
    }

    /// Returns the number of a run as an integer, if the number in the file is a valid run number.
    pub(super) fn run_number(&self, value: f64) -> Result<usize, String> {
        let run = value as usize;
        match run < self.total && run as f64 == value {
            true => Ok(run),
            false => Err(format!(
                "the sweep `{}` contains a run with the number {value}, but the numbers of its \
                 runs must be 0 to {}",
                self.name,
                self.total as f64 - 1.0
            )),
        }
    }

    /// Adds a row to a table; returns an error if the table already contains a row of the same run.
    pub(super) fn take_row(&mut self, run: usize, row: Row) -> Result<(), String> {
        match self.rows.insert(run, row) {
            None => Ok(()),
            Some(_) => Err(format!("the sweep `{}` contains the run {run} twice", self.name)),
        }
    }
}

/// Returns an error if a failure is recorded for a run that is not in the table.
pub(super) fn check_failures(name: &str, left: &BTreeMap<usize, Row>) -> Result<(), String> {
    match left.keys().next() {
        None => Ok(()),
        Some(run) => Err(format!(
            "the sweep `{name}` contains a reason for the failure of run {run}, but no row of this \
             run"
        )),
    }
}
