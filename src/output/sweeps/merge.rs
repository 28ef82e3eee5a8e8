//! Parts of a sweep, put together.

use super::check::TableDifference;
use super::table::Sweeps;

/// Why parts do not make a whole.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// Nothing to merge.
    #[error("there is no part to merge: name the files of all parts")]
    Nothing,
    /// Parts of different scenes.
    #[error(
        "part {number} is of another scene than the first: parts are made by one scene with the same settings"
    )]
    Different {
        /// Which of the parts, from 1 on.
        number: usize,
    },
    /// Parts with other tables.
    #[error("part {number} is not of the same sweeps as the first: {cause}")]
    Tables {
        /// Which of the parts, from 1 on.
        number: usize,
        /// How they differ.
        #[source]
        cause: TableDifference,
    },
    /// Parts that say different things about one run.
    #[error(
        "part {number} disagrees with an earlier one about run {run} of the sweep `{sweep}`: one of them was made by another program"
    )]
    Contradiction {
        /// Which of the parts, from 1 on.
        number: usize,
        /// The sweep.
        sweep: String,
        /// The run.
        run: usize,
    },
    /// Runs that no part has.
    #[error(
        "{missing} of {total} runs of the sweep `{sweep}` are in none of the parts, the first is run {first}: do all parts, and each to its end"
    )]
    Missing {
        /// The sweep.
        sweep: String,
        /// How many are missing.
        missing: usize,
        /// How many there are.
        total: usize,
        /// The first that is missing.
        first: usize,
    },
}

impl MergeError {
    /// Which part is at fault, from 1 on, if it is one of them.
    pub fn part(&self) -> Option<usize> {
        match self {
            MergeError::Different { number }
            | MergeError::Tables { number, .. }
            | MergeError::Contradiction { number, .. } => Some(*number),
            MergeError::Nothing | MergeError::Missing { .. } => None,
        }
    }
}

/// Puts the parts of a sweep together.
///
/// # Errors
/// [`MergeError`] if they are not the parts of one whole.
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
