//! Flows with derivatives in a number of directions known at compile time.

use super::extremum_search::ExtremumSearch;
use crate::core::bvp::derivatives::Derivatives;
use crate::core::bvp::erased::Number;
use crate::core::bvp::interval::{Block, Interval};
use crate::core::failure::Failure;
use crate::core::linalg::refill;
use crate::core::ode::{Flow, Settings};
use crate::core::scalar::{DualChunk, seeded};

/// A flow of dual numbers with derivatives in `N` directions.
pub(super) struct Variation<const N: usize> {
    flow: Flow<DualChunk<f64, N>>,
    x: Vec<DualChunk<f64, N>>,
    q: Vec<DualChunk<f64, N>>,
    /// The real parts of the states at the end of the interval.
    end: Vec<f64>,
}

impl<const N: usize> Default for Variation<N> {
    fn default() -> Self {
        let (mut flow, x, q, end): (Flow<_>, _, _, _) = Default::default();
        flow.measure_small_states_by(Derivatives::largest_derivative);
        Variation { flow, x, q, end }
    }
}

impl<const N: usize> Variation<N>
where
    DualChunk<f64, N>: Number,
{
    /// Computes the end of the flow and its derivatives in the directions from `first` on; the
    /// directions are the states at the left end, then the active entries of `q`.
    pub fn linearise(
        &mut self,
        settings: Settings,
        interval: &Interval<f64>,
        (active, first): (&[usize], usize),
        block: &mut Block,
        search: &mut ExtremumSearch,
    ) -> Result<(), Failure> {
        let Interval { problem, span, nodes, q } = *interval;
        let n = nodes.len() / 2;
        let states = nodes[..n].iter().enumerate();
        refill(&mut self.x, states.map(|(i, x)| seeded(*x, i, first)));
        refill(&mut self.q, q.iter().map(|q| DualChunk::from(*q)));
        for (k, number) in active.iter().enumerate() {
            self.q[*number] = seeded(q[*number], n + k, first);
        }
        self.flow.settings = settings;
        let dual = Interval { problem, span, nodes: &[], q: &self.q };
        let (start, length) = dual.times();
        search.begin();
        search.end(interval, 0.0, &nodes[..n]);
        let field = dual.field();
        self.flow.observe(&field, start, length, &mut self.x, &self.q, |step| {
            search.dual(interval, step)
        })?;
        refill(&mut self.end, self.x.iter().map(|x| x.re));
        search.end(interval, 1.0, &self.end);
        for (i, x) in self.x.iter().enumerate() {
            block.residual[i] = x.re - nodes[n + i];
            for (direction, part) in (first..n + active.len()).zip(x.eps) {
                match direction.checked_sub(n) {
                    None => block.nodes[i * 2 * n + direction] = part,
                    Some(k) => block.numbers[i * active.len() + k] = part,
                }
            }
        }
        Ok(())
    }
}
