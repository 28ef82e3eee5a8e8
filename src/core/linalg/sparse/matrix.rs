//! A bordered sparse matrix, given by its entries.

use super::super::lu::Entry;
use super::Pattern;

/// The matrices `A` and `M` of a pencil `A − σ M`, given by their entries in the order of a common
/// pattern; without `M`, the identity matrix.
#[derive(Clone, Copy)]
pub(in crate::core) struct Pencil<'a> {
    pub entries: &'a [f64],
    pub mass: Option<&'a [f64]>,
}

/// A bordered sparse matrix `A − shift M`.
pub(super) struct Matrix<'a, E> {
    pub pencil: Pencil<'a>,
    pub shift: E,
    pub border: Bordering<'a, E>,
    /// Whether pivots are taken from the diagonal if possible.
    pub diagonal: bool,
}

impl<E: Entry> Matrix<'_, E> {
    /// Returns entry number `k` of the pattern without the share of an identity matrix `M`.
    pub fn entry(&self, k: usize) -> E {
        let own = E::from_real(self.pencil.entries[k]);
        self.pencil.mass.map_or(own, |mass| own - self.shift * E::from_real(mass[k]))
    }

    /// Returns the number that an identity matrix `M` subtracts from the diagonal.
    pub fn on_diagonal(&self) -> E {
        if self.pencil.mass.is_some() { E::default() } else { self.shift }
    }

    /// Visits the row, the column and the size of every entry, including the entries of the border.
    pub fn for_each_size(&self, pattern: &Pattern, mut visit: impl FnMut(usize, usize, f64)) {
        let (n, border, shift) = (pattern.size(), &self.border, self.on_diagonal());
        for j in 0..n {
            for (k, &i) in (pattern.start(j)..).zip(pattern.column(j)) {
                let shift = if i == j { shift } else { E::default() };
                visit(i, j, (self.entry(k) - shift).modulus());
            }
        }
        for k in 0..border.width {
            (0..n).for_each(|j| visit(n + k, j, (border.row)(k, j).modulus()));
            (0..n).for_each(|i| visit(i, n + k, (border.column)(i, k).modulus()));
        }
        for i in 0..border.width {
            (0..border.width).for_each(|k| visit(n + i, n + k, (border.corner)(i, k).modulus()));
        }
    }
}

/// The entries of a border: columns with one entry for each equation, rows with one entry for each
/// unknown, and the corner.
pub(super) struct Bordering<'a, E> {
    pub width: usize,
    pub column: &'a (dyn Fn(usize, usize) -> E + Sync),
    pub row: &'a (dyn Fn(usize, usize) -> E + Sync),
    pub corner: &'a (dyn Fn(usize, usize) -> E + Sync),
}
