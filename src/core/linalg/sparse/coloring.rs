//! Sparse matrices of derivatives, computed in a few directions.

use super::pattern::Pattern;
use crate::core::linalg::generic;

/// Rounding: the derivative in a generic direction must agree with the product of the matrix and the
/// direction, up to this fraction of the sizes of the summed terms.
const AGREES: f64 = 1e-9;

/// The directions in which a sparse matrix of derivatives is computed: one direction for each color of
/// its columns. No row has entries in two columns of the same color. A generic direction, the *probe*,
/// detects entries outside the pattern.
#[derive(Clone, Debug)]
pub(in crate::core) struct Coloring {
    colors: Vec<usize>,
    /// The number of colors.
    pub count: usize,
    /// The generic direction.
    pub probe: Vec<f64>,
}

impl Coloring {
    pub fn of(pattern: &Pattern) -> Self {
        let (colors, count) = pattern.colors();
        Coloring { colors, count, probe: generic(pattern.size(), 3) }
    }

    /// The number of columns.
    pub fn size(&self) -> usize {
        self.colors.len()
    }

    /// The color of a column; `None` for numbers that are not columns.
    pub fn color(&self, column: usize) -> Option<usize> {
        self.colors.get(column).copied()
    }

    /// Returns the columns whose colors belong to the `width` colors from `start` on, each with the
    /// position of its color among these colors.
    pub fn columns(&self, start: usize, width: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let part = move |(j, color): (usize, &usize)| (j, color.wrapping_sub(start));
        self.colors.iter().enumerate().map(part).filter(move |(_, part)| *part < width)
    }

    /// Writes the entries of the columns whose colors belong to the `width` colors from `start` on:
    /// `derivative(i, part)` is the derivative of component `i` in direction `start + part`.
    pub fn scatter(
        &self,
        pattern: &Pattern,
        (start, width): (usize, usize),
        derivative: impl Fn(usize, usize) -> f64,
        entries: &mut [f64],
    ) {
        for (j, part) in self.columns(start, width) {
            let column = entries[pattern.start(j)..].iter_mut().zip(pattern.column(j));
            column.for_each(|(entry, &i)| *entry = derivative(i, part));
        }
    }

    /// Whether the derivatives along the probe agree with the product of the matrix and the probe.
    /// The argument `products` is scratch space for the products and for the sizes of their terms.
    pub fn agrees(
        &self,
        (pattern, entries): (&Pattern, &[f64]),
        derivatives: impl Iterator<Item = f64>,
        products: &mut Vec<[f64; 2]>,
    ) -> bool {
        products.clear();
        products.resize(self.size(), [0.0; 2]);
        for (j, x) in self.probe.iter().enumerate() {
            for (entry, &i) in entries[pattern.start(j)..].iter().zip(pattern.column(j)) {
                let [sum, size] = &mut products[i];
                *sum += entry * x;
                *size += (entry * x).abs();
            }
        }
        // Numbers that are not finite are reported later, with their places.
        derivatives.zip(&*products).all(|(slope, [sum, size])| {
            (slope - sum).abs() <= AGREES * size.max(slope.abs()) || !slope.is_finite()
        })
    }
}
