//! Distribution of the strands (chains of dependent runs) of a sweep among its parts.

use super::plan::PlanError;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::num::NonZeroUsize;

/// The part of a sweep that one process executes: part number `number` of the `of` parts, counted
/// from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The number of the part, counted from 1.
    pub number: usize,
    /// The number of parts of the sweep.
    pub of: usize,
    /// The number of threads; by default the number of cores, as in rayon.
    pub threads: Option<NonZeroUsize>,
}

impl Part {
    /// The whole sweep.
    pub const WHOLE: Part = Part { number: 1, of: 1, threads: None };

    /// Checks that the number of the part is between 1 and the number of parts.
    pub(super) fn check(self) -> Result<(), PlanError> {
        let Part { number, of, .. } = self;
        match number == 0 || number > of {
            true => Err(PlanError::Part { number, of }),
            false => Ok(()),
        }
    }

    /// Returns which part of a sweep the process with this part must execute, if other sweeps with
    /// `strands` strands (chains of dependent runs) in total were distributed before. Strands are
    /// assigned to the parts in turn, and each sweep continues with the part after the last one
    /// used; otherwise the first parts would get all strands of small sweeps.
    ///
    /// ```
    /// use tangency::core::sweep::Part;
    /// let part = |number| Part { number, of: 4, threads: None };
    /// // Two strands went to parts 1 and 2: parts 3 and 4 are the next.
    /// assert_eq!(part(3).after(2)?, part(1));
    /// assert_eq!(part(1).after(2)?, part(3));
    /// # Ok::<(), tangency::core::sweep::PlanError>(())
    /// ```
    ///
    /// # Errors
    /// [`PlanError::Part`] if the number of the part is not between 1 and the number of parts.
    pub fn after(self, strands: usize) -> Result<Part, PlanError> {
        self.check()?;
        let (place, shift) = (self.number - 1, strands % self.of);
        let place = if place >= shift { place - shift } else { self.of - (shift - place) };
        Ok(Part { number: place + 1, ..self })
    }

    /// Creates a thread pool if the number of threads is set; the pool has at most one thread for
    /// each strand.
    pub(super) fn pool(self, strands: usize) -> Result<Option<ThreadPool>, PlanError> {
        let pool = |threads: NonZeroUsize| {
            let threads = threads.min(NonZeroUsize::new(strands).unwrap_or(NonZeroUsize::MIN));
            let built = ThreadPoolBuilder::new().num_threads(threads.get()).build();
            built.map_err(|cause| PlanError::Threads { threads, cause: cause.to_string() })
        };
        self.threads.map(pool).transpose()
    }
}
