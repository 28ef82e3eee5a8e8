//! Vector fields with a sparse Jacobian `f_x`, differentiated in a few directions.

use crate::core::linalg::{Pattern, generic};
use crate::core::scalar::DualChunk;

/// Rounding: a directional derivative of the vector field must agree with the product of the matrix
/// and the direction, up to this fraction of the sizes of the summed terms.
const AGREES: f64 = 1e-9;

/// The sparsity pattern of `f_x`, and the directions in which the vector field is differentiated:
/// one direction for each color of the states, and a generic direction, the *probe*, which detects
/// entries outside the pattern. No component of the field depends on two states of the same color.
#[derive(Clone, Debug)]
pub(super) struct ColoredField {
    pub pattern: Pattern,
    colors: Vec<usize>,
    count: usize,
    probe: Vec<f64>,
}

impl ColoredField {
    pub fn of(pattern: Pattern) -> Self {
        let (colors, count) = pattern.colors();
        ColoredField { probe: generic(pattern.size(), 3), colors, count, pattern }
    }

    /// The number of directions.
    pub fn directions(&self) -> usize {
        self.count + 1
    }

    /// Returns state number `i` as a dual number, with its derivatives in the directions of the
    /// chunk that begins at direction `start`.
    pub fn seeded<const W: usize>(&self, x: f64, i: usize, start: usize) -> DualChunk<f64, W> {
        let part = |k: usize| match start + k {
            direction if direction == self.colors[i] => 1.0,
            direction if direction == self.count => self.probe[i],
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
        for (j, color) in self.colors.iter().enumerate() {
            let part = color.wrapping_sub(start);
            if part < W {
                let rows = self.pattern.column(j).iter();
                let entries = &mut entries[self.pattern.start(j)..];
                entries.iter_mut().zip(rows).for_each(|(entry, &i)| *entry = f[i].eps[part]);
            }
        }
    }

    /// Whether the derivative along the probe agrees with the product of `f_x` and the probe; true
    /// if the chunk that begins at `start` does not contain the probe. The argument `product` is
    /// scratch space for the product and for the sizes of its terms.
    pub fn agrees<const W: usize>(
        &self,
        f: &[DualChunk<f64, W>],
        start: usize,
        entries: &[f64],
        product: &mut Vec<[f64; 2]>,
    ) -> bool {
        let part = self.count.wrapping_sub(start);
        if part >= W {
            return true;
        }
        product.clear();
        product.resize(f.len(), [0.0; 2]);
        for (j, x) in self.probe.iter().enumerate() {
            let column = self.pattern.column(j).iter();
            for (entry, &i) in entries[self.pattern.start(j)..].iter().zip(column) {
                let [sum, size] = &mut product[i];
                *sum += entry * x;
                *size += (entry * x).abs();
            }
        }
        // Numbers that are not finite are reported later, with their places.
        f.iter().zip(&*product).all(|(f, [sum, size])| {
            let slope = f.eps[part];
            (slope - sum).abs() <= AGREES * size.max(slope.abs()) || !slope.is_finite()
        })
    }
}
