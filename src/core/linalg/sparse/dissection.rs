//! Orders of elimination in which the parts of a matrix are eliminated before the unknowns that
//! separate the parts.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;
use std::cmp::Reverse;

/// Heuristic: the number of times that a matrix is divided into halves; three divisions give as many
/// parts as threads can eliminate side by side.
const DEPTH: usize = 3;

/// Heuristic: each of two separated halves has at least this fraction of the unknowns.
const LEAST_HALF: f64 = 0.4;

/// The mark of an unknown that has no level.
const NONE: usize = usize::MAX;

/// The neighbours of each unknown: the other unknowns with which it shares an entry of the matrix.
pub(super) struct Graph {
    starts: Vec<usize>,
    neighbours: Vec<usize>,
}

impl Graph {
    /// Creates the graph from the upper triangle of a pattern: the start of each column, and the rows
    /// of all entries.
    pub fn of(starts: &[usize], rows: &[usize]) -> Graph {
        let n = starts.len() - 1;
        let pairs =
            || (0..n).flat_map(|j| rows[starts[j]..starts[j + 1]].iter().map(move |&i| (i, j)));
        let mut counts = vec![0; n + 1];
        for (i, j) in pairs().filter(|(i, j)| i != j) {
            counts[i + 1] += 1;
            counts[j + 1] += 1;
        }
        (0..n).for_each(|i| counts[i + 1] += counts[i]);
        let (mut next, mut neighbours) = (counts.clone(), vec![0; counts[n]]);
        for (i, j) in pairs().filter(|(i, j)| i != j) {
            neighbours[next[i]] = j;
            neighbours[next[j]] = i;
            next[i] += 1;
            next[j] += 1;
        }
        Graph { starts: counts, neighbours }
    }

    fn neighbours(&self, v: usize) -> &[usize] {
        &self.neighbours[self.starts[v]..self.starts[v + 1]]
    }

    /// Returns an order of elimination: the unknowns are divided into halves repeatedly, and the
    /// unknowns that separate two parts come after both parts (A. George, SIAM J. Numer. Anal. 10
    /// (1973) 345). Within the smallest parts, the order is the approximate minimum degree order.
    /// `None` if this order cannot be computed.
    pub fn dissected_order(&self) -> Option<Vec<usize>> {
        let n = self.starts.len() - 1;
        self.dissect((0..n).collect(), DEPTH, &mut vec![NONE; n])
    }

    fn dissect(&self, part: Vec<usize>, depth: usize, levels: &mut [usize]) -> Option<Vec<usize>> {
        if depth == 0 || part.is_empty() {
            return self.minimum_degree(&part, levels);
        }
        let Some(middle) = self.separating_level(&part, levels) else {
            return self.minimum_degree(&part, levels);
        };
        let take = |keep: &dyn Fn(usize) -> bool| -> Vec<usize> {
            part.iter().copied().filter(|&v| keep(levels[v])).collect()
        };
        let [before, after, separator] =
            [take(&|level| level < middle), take(&|level| level > middle), take(&|l| l == middle)];
        part.iter().for_each(|&v| levels[v] = NONE);
        let mut order = self.dissect(before, depth - 1, levels)?;
        order.extend(self.dissect(after, depth - 1, levels)?);
        order.extend(separator);
        Some(order)
    }

    /// Returns the approximate minimum degree order of a part. `places` is memory for one number of
    /// each unknown.
    fn minimum_degree(&self, part: &[usize], places: &mut [usize]) -> Option<Vec<usize>> {
        part.iter().enumerate().for_each(|(place, &v)| places[v] = place);
        let (n, mut starts, mut rows) = (part.len(), vec![0], Vec::new());
        for (own, &v) in part.iter().enumerate() {
            let earlier = self.neighbours(v).iter().map(|&other| (other, places[other]));
            let earlier = earlier.filter(|&(other, at)| at < own && part[at] == other);
            let first = rows.len();
            rows.extend(earlier.map(|(_, at)| at));
            rows[first..].sort_unstable();
            starts.push(rows.len());
        }
        part.iter().for_each(|&v| places[v] = NONE);
        let upper = SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows);
        let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
        let mut memory = MemBuffer::new(amd::order_scratch::<usize>(n, rows.len()));
        let stack = MemStack::new(&mut memory);
        amd::order(&mut order, &mut inverse, upper, amd::Control::default(), stack).ok()?;
        Some(order.into_iter().map(|at| part[at]).collect())
    }

    /// Assigns levels to the unknowns of a part, so that only unknowns of the same level or of
    /// neighbouring levels are neighbours; returns the smallest level that divides the part into
    /// halves of similar size.
    fn separating_level(&self, part: &[usize], levels: &mut [usize]) -> Option<usize> {
        let mut first = part[0];
        // The last unknown of a search lies at the edge of the part.
        for _ in 0..2 {
            first = self.search(part, first, levels);
        }
        let mut sizes = Vec::new();
        for &v in part {
            sizes.resize(sizes.len().max(levels[v] + 1), 0);
            sizes[levels[v]] += 1;
        }
        let (least, mut before) = (LEAST_HALF * part.len() as f64, 0);
        let mut candidates = Vec::new();
        for (level, size) in sizes.into_iter().enumerate() {
            let after = part.len() - before - size;
            if before.min(after) as f64 >= least {
                candidates.push((size, Reverse(before.min(after)), level));
            }
            before += size;
        }
        candidates.into_iter().min().map(|(.., level)| level)
    }

    /// Assigns to each unknown of a part its distance from the first unknown, and returns the unknown
    /// that is found last. If a part is not connected, the levels of one component follow the levels of
    /// another component.
    fn search(&self, part: &[usize], first: usize, levels: &mut [usize]) -> usize {
        // Unknowns outside the part have the level `NONE`.
        let open = NONE - 1;
        part.iter().for_each(|&v| levels[v] = open);
        let mut found = Vec::with_capacity(part.len());
        let mut level = 0;
        for &start in [first].iter().chain(part) {
            if levels[start] != open {
                continue;
            }
            let mut next = found.len();
            levels[start] = level;
            found.push(start);
            while next < found.len() {
                let v = found[next];
                next += 1;
                for &other in self.neighbours(v) {
                    if levels[other] == open {
                        levels[other] = levels[v] + 1;
                        found.push(other);
                    }
                }
            }
            level = found.last().map_or(0, |&v| levels[v] + 1);
        }
        found.last().copied().unwrap_or(first)
    }
}
