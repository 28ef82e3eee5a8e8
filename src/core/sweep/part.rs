//! How strands are dealt to parts.

use super::plan::PlanError;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::num::NonZeroUsize;

/// What one process does of a sweep: part `number` of `of` parts, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its number, from 1 on.
    pub number: usize,
    /// How many parts there are.
    pub of: usize,
    /// How many threads work; by default as many as rayon has, which are as many as there are
    /// cores.
    pub threads: Option<NonZeroUsize>,
}

impl Part {
    /// The whole.
    pub const WHOLE: Part = Part { number: 1, of: 1, threads: None };

    /// Whether there is such a part.
    pub(super) fn check(self) -> Result<(), PlanError> {
        let Part { number, of, .. } = self;
        match number == 0 || number > of {
            true => Err(PlanError::Part { number, of }),
            false => Ok(()),
        }
    }

    /// The part of a sweep that follows sweeps with `strands` strands in all. Strands are dealt to
    /// parts in turn, and the turn goes on from sweep to sweep: otherwise sweeps of few strands
    /// would all fall to the first parts.
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
    /// [`PlanError::Part`] if there is no such part.
    pub fn after(self, strands: usize) -> Result<Part, PlanError> {
        self.check()?;
        let (place, shift) = (self.number - 1, strands % self.of);
        let place = if place >= shift { place - shift } else { self.of - (shift - place) };
        Ok(Part { number: place + 1, ..self })
    }

    /// Threads of its own, if it says how many, and no more than there are strands.
    pub(super) fn pool(self, strands: usize) -> Result<Option<ThreadPool>, PlanError> {
        let pool = |threads: NonZeroUsize| {
            let threads = threads.min(NonZeroUsize::new(strands).unwrap_or(NonZeroUsize::MIN));
            let built = ThreadPoolBuilder::new().num_threads(threads.get()).build();
            built.map_err(|cause| PlanError::Threads { threads, cause: cause.to_string() })
        };
        self.threads.map(pool).transpose()
    }
}
