//! Vector fields with a sparse Jacobian `f_x`, differentiated in a few directions.

use crate::core::linalg::{Coloring, Pattern};
use crate::core::scalar::DualChunk;

/// The sparsity pattern of `f_x`, and the directions in which the vector field is differentiated: the
/// directions of the colors, and the probe as the last direction.
#[derive(Clone, Debug)]
pub(super) struct ColoredField {
    pub pattern: Pattern,
    coloring: Coloring,
}

impl ColoredField {
    pub fn of(pattern: Pattern) -> Self {
        ColoredField { coloring: Coloring::of(&pattern), pattern }
    }

    /// The number of directions.
    pub fn directions(&self) -> usize {
        self.coloring.count + 1
    }

    /// Returns state number `i` as a dual number, with its derivatives in the directions of the
    /// chunk that begins at direction `start`.
    pub fn seeded<const W: usize>(&self, x: f64, i: usize, start: usize) -> DualChunk<f64, W> {
        let Coloring { count, probe, .. } = &self.coloring;
        let color = self.coloring.color(i);
        let part = |k: usize| match start + k {
            direction if Some(direction) == color => 1.0,
            direction if direction == *count => probe[i],
            _ => 0.0,
        };
        DualChunk { re: x, eps: std::array::from_fn(part) }
    }

    /// Writes the entries of `f_x` whose columns have the colors of a chunk.
    pub fn place<const W: usize>(
        &self,
        f: &[DualChunk<f64, W>],
        start: usize,
        entries: &mut [f64],
    ) {
        self.coloring.scatter(&self.pattern, (start, W), |i, part| f[i].eps[part], entries);
    }

    /// Whether the derivative along the probe agrees with the product of `f_x` and the probe; true
    /// if the chunk that begins at `start` does not contain the probe. The argument `products` is
    /// scratch space.
    pub fn agrees<const W: usize>(
        &self,
        f: &[DualChunk<f64, W>],
        start: usize,
        entries: &[f64],
        products: &mut Vec<[f64; 2]>,
    ) -> bool {
        let part = self.coloring.count.wrapping_sub(start);
        let slopes = f.iter().map(|f| f.eps[part]);
        part >= W || self.coloring.agrees((&self.pattern, entries), slopes, products)
    }
}
