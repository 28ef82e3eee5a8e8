//! The division of sweeps into parts; each part is computed by a separate process.

use super::statement::{Scene, Sweep};
use crate::core::sweep::{MOST_RUNS, Order};

/// The division of a sweep into parts. The runs are assigned to the parts in whole *strands*, one
/// strand to each part in turn; a strand is a sequence of runs in which each run begins where the
/// preceding run ended.
///
/// ```
/// use tangency::scene::Division;
/// // Single runs always divide evenly, whatever the number of parts.
/// let runs = Division::new(vec![1; 100], 7);
/// assert!(runs.is_even() && runs.largest == 15);
/// // Four strands leave four of eight parts without work.
/// let strands = Division::new(vec![25; 4], 8);
/// assert!(!strands.is_even() && strands.largest == 25 && strands.even() == 13);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Division {
    /// The number of parts into which the sweep is divided.
    pub parts: usize,
    /// The number of strands of the sweep: sequences of runs in which each run begins where the
    /// preceding run ended.
    pub strands: usize,
    /// The number of runs of the sweep.
    pub runs: usize,
    /// The number of runs in the part that has the most runs.
    pub largest: usize,
}

impl Division {
    /// Assigns strands (sequences of runs that follow one another) to `parts` parts in turn; each
    /// strand is given by its number of runs.
    pub fn new(strands: impl IntoIterator<Item = usize>, parts: usize) -> Self {
        let parts = parts.max(1);
        let (mut sizes, mut count) = (Vec::new(), 0);
        for length in strands {
            match sizes.get_mut(count % parts) {
                Some(size) => *size += length,
                None => sizes.push(length),
            }
            count += 1;
        }
        let largest = sizes.iter().copied().max().unwrap_or(0);
        Division { parts, strands: count, runs: sizes.iter().sum(), largest }
    }

    /// Returns the number of runs in the largest part if single runs, instead of sequences of runs
    /// that follow one another, were assigned to the parts.
    pub fn even(&self) -> usize {
        self.runs.div_ceil(self.parts)
    }

    /// Returns whether the number of runs in the largest part exceeds the average number of runs
    /// per part by at most a tenth.
    pub fn is_even(&self) -> bool {
        self.largest <= self.even() + self.even() / 10
    }
}

impl Sweep {
    /// Returns the lengths of the sequences of runs that follow one another, in order, if the axis
    /// of the sweep were divided into `strands` sequences; for `None`, into the number of sequences
    /// that the sweep states.
    pub(super) fn strand_lengths(&self, strands: Option<usize>) -> impl Iterator<Item = usize> {
        let points = self.over.iter().try_fold(1, |points, grid| grid.count.checked_mul(points));
        // Larger sweeps are rejected before the first run.
        let points = points.filter(|points| *points <= MOST_RUNS).unwrap_or(0);
        let strands = strands.unwrap_or(self.strands);
        let starts = 0..self.starts.len().max(1);
        starts.flat_map(move |_| self.order.strand_lengths(points, strands))
    }
}

impl Scene {
    /// Returns the division of the runs of all sweeps into `parts` parts.
    ///
    /// ```
    /// let scene = tangency::scene::Scene::parse("Scene(title: \"t\", problem: ImpactOscillator(), sweeps: [
    ///     (name: \"up\", order: up, strands: 4, over: [(name: \"amplitude\", low: 1, high: 5, count: 100)]),
    /// ])")?;
    /// assert!(scene.division(4).is_even() && !scene.division(8).is_even());
    /// assert_eq!(scene.better_strands(8), Some((8, 13)));
    /// # Ok::<(), tangency::scene::SceneError>(())
    /// ```
    pub fn division(&self, parts: usize) -> Division {
        divided(&self.sweeps, None, parts)
    }

    /// Returns a value of the setting `strands` that divides the runs of all sweeps more evenly
    /// into `parts` parts, and the number of runs in the largest part with this value; `None` if no
    /// value divides the runs more evenly.
    pub fn better_strands(&self, parts: usize) -> Option<(usize, usize)> {
        let followed = || self.sweeps.iter().filter(|sweep| sweep.order != Order::Anew);
        let chains: usize = followed().map(|sweep| sweep.starts.len().max(1)).sum();
        let longest = followed().filter_map(|sweep| Some(sweep.over.first()?.count)).max()?;
        // One strand for each part in total, or one for each part in every sweep from every start.
        let offers = [parts.div_ceil(chains), parts].map(|strands| strands.min(longest));
        let divisions =
            offers.map(|strands| (strands, divided(&self.sweeps, Some(strands), parts)));
        let even = divisions.iter().find(|(_, division)| division.is_even());
        let best = even.or(divisions.iter().min_by_key(|(_, division)| division.largest))?;
        let (strands, Division { largest, .. }) = *best;
        (largest < self.division(parts).largest).then_some((strands, largest))
    }
}

/// Returns the division of the runs of sweeps into parts if the axis of each sweep were divided
/// into `strands` sequences; for `None`, into the number of sequences that the sweep states.
fn divided(sweeps: &[Sweep], strands: Option<usize>, parts: usize) -> Division {
    Division::new(sweeps.iter().flat_map(|sweep| sweep.strand_lengths(strands)), parts)
}
