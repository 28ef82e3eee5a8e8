//! Merging of the parts of a sweep, as in the command `tangency merge`.

use super::check::TableDifference;
use super::table::Sweeps;

/// The error of files that should together form a complete sweep but do not.
#[derive(Clone, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// The list of the parts of a sweep is empty.
    #[error("no part of a sweep is given to merge")]
    #[diagnostic(help("name the files of all parts of the sweep"))]
    Nothing,
    /// Two parts of a sweep belong to different scenes.
    #[error(
        "part {number} belongs to another scene than the first part: all parts must be made by one \
         scene with the same settings"
    )]
    Different {
        /// The number, counted from 1, of the part that belongs to another scene than the first
        /// part.
        number: usize,
    },
    /// Two parts of a sweep have tables with different columns or numbers of runs.
    #[error("part {number} belongs to other sweeps than the first: {cause}")]
    Tables {
        /// The number, counted from 1, of the part whose tables differ from the tables of the first
        /// part.
        number: usize,
        /// The difference.
        #[source]
        cause: TableDifference,
    },
    /// Two parts of a sweep contain different results for the same run.
    #[error(
        "part {number} and an earlier part have different results for run {run} of the sweep \
         `{sweep}`: one of the two parts is from another version of the program"
    )]
    Contradiction {
        /// The number, counted from 1, of the later of the two parts with different results.
        number: usize,
        /// The name of the sweep.
        sweep: String,
        /// The number of the run with different results.
        run: usize,
    },
    /// Some runs are not contained in any part.
    #[error(
        "{missing} of {total} runs of the sweep `{sweep}` are missing in all parts, starting with run {first}"
    )]
    #[diagnostic(help("run all parts to the end"))]
    Missing {
        /// The name of the sweep whose runs are incomplete.
        sweep: String,
        /// The number of missing runs.
        missing: usize,
        /// The total number of runs of the sweep.
        total: usize,
        /// The number of the first missing run.
        first: usize,
    },
}

impl MergeError {
    /// Returns the number of the invalid part of the sweep, counted from 1, if the error concerns a
    /// single part.
    pub fn part(&self) -> Option<usize> {
        match self {
            MergeError::Different { number }
            | MergeError::Tables { number, .. }
            | MergeError::Contradiction { number, .. } => Some(*number),
            MergeError::Nothing | MergeError::Missing { .. } => None,
        }
    }
}

/// Merges the parts of a sweep into the complete sweep.
///
/// # Errors
/// [`MergeError`] if the parts do not form a complete sweep.
pub fn merge(parts: Vec<Sweeps>) -> Result<Sweeps, MergeError> {
    let mut parts = parts.into_iter();
    let mut whole = parts.next().ok_or(MergeError::Nothing)?;
    for (index, part) in parts.enumerate() {
        let number = index + 2;
        if (&part.name, &part.scene) != (&whole.name, &whole.scene) {
            return Err(MergeError::Different { number });
        }
        part.check_tables(&whole).map_err(|cause| MergeError::Tables { number, cause })?;
        for (sweep, more) in whole.sweeps.iter_mut().zip(part.sweeps) {
            for (run, row) in more.rows {
                let same = sweep.rows.get(&run).is_none_or(|old| old.is_identical(&row));
                if !same {
                    let sweep = sweep.name.clone();
                    return Err(MergeError::Contradiction { number, sweep, run });
                }
                sweep.rows.insert(run, row);
            }
        }
    }
    match whole.sweeps.iter().find(|sweep| !sweep.is_complete()) {
        None => Ok(whole),
        Some(sweep) => Err(MergeError::Missing {
            sweep: sweep.name.clone(),
            missing: sweep.total - sweep.rows.len(),
            total: sweep.total,
            first: (0..sweep.total).find(|run| !sweep.rows.contains_key(run)).unwrap_or(0),
        }),
    }
}
