//! Fronts in groups that threads eliminate side by side.

use super::front::{Fronts, Pivots};
use crate::core::failure::Failure;
use crate::core::threads::side_by_side;

/// Heuristic: the number of multiplications from which on fronts are divided into groups. Below this
/// number, starting threads takes a noticeable part of the time.
const LEAST_PRODUCTS: usize = 4_000_000;

/// Heuristic: the number of groups.
const GROUPS: usize = 8;

/// Fronts of the same shape that do not depend on each other, in groups that are eliminated side by
/// side.
#[derive(Default)]
pub(super) struct GroupedFronts {
    groups: Vec<Group>,
    /// The number of fronts of each group but the last.
    each: usize,
}

struct Group {
    fronts: Fronts,
    count: usize,
    /// The pivots of the last elimination, or the error of the first front that is singular.
    outcome: Result<Pivots, Failure>,
}

impl GroupedFronts {
    /// Creates `count` fronts; `shape` gives, for each front, the number of eliminated columns, of
    /// rows that can contain a pivot, of rows after these rows, and of columns.
    pub fn new(count: usize, shape: [usize; 4]) -> Self {
        let [eliminated, pivotal, border, width] = shape;
        let products = count * eliminated * (pivotal + border) * width;
        let each = if products < LEAST_PRODUCTS { count } else { count.div_ceil(GROUPS) };
        let group = |first: usize| {
            let count = each.min(count - first);
            let fronts = Fronts::new(count, eliminated, pivotal, border, width);
            Group { fronts, count, outcome: Ok(Pivots::new()) }
        };
        GroupedFronts { groups: (0..count).step_by(each.max(1)).map(group).collect(), each }
    }

    /// Fills and eliminates all fronts; `fill` writes the entries of a front, given its number.
    ///
    /// # Errors
    /// The first error of `fill`, or of [`Fronts::eliminate`].
    pub fn eliminate(
        &mut self,
        fill: impl Fn(usize, &mut [f64]) -> Result<(), Failure> + Sync,
    ) -> Result<Pivots, Failure> {
        let each = self.each;
        side_by_side(&mut self.groups, |number, group| {
            let (mut pivots, fronts) = (Pivots::new(), &mut group.fronts);
            let mut eliminate = |i: usize| {
                fill(number * each + i, fronts.front_mut(i))?;
                fronts.eliminate(i, &mut pivots)
            };
            let outcome = (0..group.count).try_for_each(&mut eliminate);
            group.outcome = outcome.map(|()| pivots);
        });
        let mut all = Pivots::new();
        for group in &self.groups {
            all.join(group.outcome.as_ref().map_err(Clone::clone)?);
        }
        Ok(all)
    }

    /// Sets the inverse of a typical entry for each column.
    pub fn set_scales(&mut self, mut set: impl FnMut(&mut [f64])) {
        self.groups.iter_mut().for_each(|group| set(&mut group.fronts.scales));
    }

    /// Returns the group with front number `i`, and the number of the front in the group.
    pub fn at(&self, i: usize) -> (&Fronts, usize) {
        (&self.groups[i / self.each].fronts, i % self.each)
    }

    /// Returns the entries of a front, row by row.
    pub fn front(&self, i: usize) -> &[f64] {
        let (fronts, i) = self.at(i);
        fronts.front(i)
    }
}
