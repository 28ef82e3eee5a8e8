//! The triangular factors of a part of the elimination tree.

use super::super::lu::Entry;
use std::array::from_fn;
use std::ops::Range;

/// The two kinds of members of a part, and of lists of a front.
#[derive(Clone, Copy)]
pub(super) enum Side {
    Rows,
    Columns,
}

/// The eliminated part of a front.
#[derive(Clone, Debug)]
struct Eliminated {
    pivots: usize,
    /// The number of pivots of the fronts before this front.
    before: usize,
    /// The range of this front's rows and columns in the lists that hold the rows and columns of
    /// all fronts.
    place: Range<usize>,
    /// The position of the front's factors among all factors: first `L` (all rows of the pivot
    /// columns), then `U` (the pivot rows of all other columns).
    factors: usize,
}

/// The triangular factors of a part of the elimination tree.
///
/// The members of the part are the equations and unknowns that are eliminated in the part, in the
/// order of elimination, followed by the equations and unknowns that are coupled to them but
/// eliminated in the last part of the tree.
#[derive(Default)]
pub(super) struct Triangles<E> {
    /// The rows and the columns of all fronts, given by equations and unknowns; after
    /// [`close`](Self::close), by positions among the members.
    pub lists: [Vec<usize>; 2],
    fronts: Vec<Eliminated>,
    factors: Vec<E>,
    members: [Vec<usize>; 2],
    pivots: usize,
    /// The members' components of the vectors of a linear system that is being solved.
    vector: Vec<E>,
}

impl<E: Entry> Triangles<E> {
    /// Removes all factors, and keeps their storage.
    pub fn clear(&mut self) {
        self.lists.iter_mut().for_each(Vec::clear);
        self.fronts.clear();
        self.factors.clear();
        self.pivots = 0;
    }

    /// Stores the factors of the eliminated columns, which are the first columns of a front; the row
    /// and column lists of the front begin at `from`.
    pub fn keep(&mut self, front: &[E], from: usize, pivots: usize) {
        if pivots == 0 {
            return;
        }
        let (place, factors, before) = (from..self.lists[0].len(), self.factors.len(), self.pivots);
        let size = place.len();
        self.fronts.push(Eliminated { pivots, before, place, factors });
        self.factors.extend_from_slice(&front[..pivots * size]);
        for column in front[pivots * size..].chunks_exact(size) {
            self.factors.extend_from_slice(&column[..pivots]);
        }
        self.pivots += pivots;
    }

    /// Determines the members, and replaces the equations and unknowns in the lists of the fronts by
    /// the members' positions. `positions` is memory for the position of each equation and unknown.
    pub fn close(&mut self, positions: &mut [Vec<usize>; 2]) {
        let sides = self.members.iter_mut().zip(&mut self.lists).zip(positions);
        for ((members, list), positions) in sides {
            members.clear();
            for Eliminated { pivots, place, .. } in &self.fronts {
                for &v in &list[place.start..][..*pivots] {
                    positions[v] = members.len();
                    members.push(v);
                }
            }
            for Eliminated { pivots, place, .. } in &self.fronts {
                for v in &mut list[place.clone()][*pivots..] {
                    if members.get(positions[*v]) != Some(v) {
                        positions[*v] = members.len();
                        members.push(*v);
                    }
                    *v = positions[*v];
                }
            }
        }
    }

    /// Iterates over the pivots.
    pub fn pivots(&self) -> impl Iterator<Item = E> {
        self.fronts.iter().flat_map(move |Eliminated { pivots, place, factors, .. }| {
            (0..*pivots).map(move |k| self.factors[factors + k * place.len() + k])
        })
    }

    /// Returns the equations or the unknowns of the pivots.
    pub fn eliminated(&self, side: Side) -> &[usize] {
        &self.members[side as usize][..self.pivots]
    }

    /// Solves with `L` for several right-hand sides, with one right-hand side in each lane of a
    /// vector register, because reading the factors from memory takes longer than multiplying by
    /// them.
    pub fn forward<const W: usize>(&mut self, right: &[[E; W]]) {
        self.load(Side::Rows, right);
        let (rows, mut part) = (&self.lists[0], Vec::new());
        let vector = self.vector.as_chunks_mut::<W>().0;
        for Eliminated { pivots, before, place, factors } in &self.fronts {
            let (size, others) = (place.len(), &rows[place.clone()][*pivots..]);
            gather(&mut part, vector, (*before, *pivots), others);
            let lower = self.factors[*factors..][..pivots * size].chunks_exact(size);
            for (k, column) in lower.enumerate() {
                let x = part[k];
                reduce(&mut part[k + 1..], &column[k + 1..], x);
            }
            vector[*before..][..*pivots].copy_from_slice(&part[..*pivots]);
            others.iter().zip(&part[*pivots..]).for_each(|(&row, x)| vector[row] = *x);
        }
    }

    /// Solves with `U`, after [`forward`](Self::forward).
    pub fn backward<const W: usize>(&mut self) {
        let (columns, mut part) = (&self.lists[1], Vec::new());
        let vector = self.vector.as_chunks_mut::<W>().0;
        for Eliminated { pivots, before, place, factors } in self.fronts.iter().rev() {
            let (size, others) = (place.len(), &columns[place.clone()][*pivots..]);
            let (lower, upper) = self.factors[*factors..].split_at(pivots * size);
            gather(&mut part, vector, (*before, *pivots), &[]);
            for (column, &unknown) in upper.chunks_exact(*pivots).zip(others) {
                reduce(&mut part, column, vector[unknown]);
            }
            for (k, column) in lower.chunks_exact(size).enumerate().rev() {
                part[k].iter_mut().for_each(|x| *x /= column[k]);
                let x = part[k];
                reduce(&mut part[..k], column, x);
            }
            vector[*before..][..*pivots].copy_from_slice(&part);
        }
    }

    /// Solves with the transpose of `U` (for complex factors, the conjugate transpose).
    pub fn forward_transposed(&mut self, right: &[[E; 1]]) {
        self.load(Side::Columns, right);
        let (columns, vector) = (&self.lists[1], &mut self.vector);
        for Eliminated { pivots, before, place, factors } in &self.fronts {
            let (size, others) = (place.len(), &columns[place.clone()][*pivots..]);
            let (lower, upper) = self.factors[*factors..].split_at(pivots * size);
            let (own, later) = vector[*before..].split_at_mut(*pivots);
            for (k, column) in lower.chunks_exact(size).enumerate() {
                let sum = product(&column[..k], own);
                own[k] = (own[k] - sum) / column[k].conjugate();
            }
            for (column, &unknown) in upper.chunks_exact(*pivots).zip(others) {
                later[unknown - before - pivots] -= product(column, own);
            }
        }
    }

    /// Solves with the transpose of `L`, after [`forward_transposed`](Self::forward_transposed).
    pub fn backward_transposed(&mut self) {
        let (rows, mut part) = (&self.lists[0], Vec::new());
        let vector = self.vector.as_chunks_mut::<1>().0;
        for Eliminated { pivots, before, place, factors } in self.fronts.iter().rev() {
            let (size, others) = (place.len(), &rows[place.clone()][*pivots..]);
            gather(&mut part, vector, (*before, *pivots), others);
            let part = part.as_flattened_mut();
            let lower = self.factors[*factors..][..pivots * size].chunks_exact(size);
            for (k, column) in lower.enumerate().rev() {
                let sum = product(&column[k + 1..], &part[k + 1..]);
                part[k] -= sum;
            }
            vector.as_flattened_mut()[*before..][..*pivots].copy_from_slice(&part[..*pivots]);
        }
    }

    /// Copies the right-hand sides of the pivots to the part; the components of the other members
    /// are set to zero.
    fn load<const W: usize>(&mut self, side: Side, right: &[[E; W]]) {
        let members = &self.members[side as usize];
        self.vector.resize(W * members.len(), E::default());
        let (own, others) = self.vector.as_chunks_mut::<W>().0.split_at_mut(self.pivots);
        own.iter_mut().zip(members).for_each(|(row, &v)| *row = right[v]);
        others.fill([E::default(); W]);
    }

    /// Adds the changes of the other members' right-hand sides to the right-hand sides.
    pub fn add_changes<const W: usize>(&self, side: Side, right: &mut [[E; W]]) {
        let members = self.members[side as usize].iter().zip(self.vector.as_chunks::<W>().0);
        for (&v, change) in members.skip(self.pivots) {
            right[v] = from_fn(|lane| right[v][lane] + change[lane]);
        }
    }

    /// Copies the known components of the other members to the part.
    pub fn load_others<const W: usize>(&mut self, side: Side, known: &[[E; W]]) {
        let others = self.members[side as usize][self.pivots..].iter().map(|&v| known[v]);
        self.vector.truncate(W * self.pivots);
        self.vector.extend(others.flatten());
    }

    /// Copies the solution's components at the pivots to the whole solution.
    pub fn store<const W: usize>(&self, side: Side, solution: &mut [[E; W]]) {
        let own = self.eliminated(side).iter().zip(self.vector.as_chunks::<W>().0);
        own.for_each(|(&v, x)| solution[v] = *x);
    }
}

/// Copies the components at consecutive positions, and at other positions, to contiguous memory.
fn gather<T: Copy>(
    part: &mut Vec<T>,
    vector: &[T],
    (from, count): (usize, usize),
    others: &[usize],
) {
    part.clear();
    part.extend_from_slice(&vector[from..][..count]);
    part.extend(others.iter().map(|&place| vector[place]));
}

/// Subtracts a multiple of one column of the factors from the right-hand side in each lane.
#[inline]
fn reduce<E: Entry, const W: usize>(part: &mut [[E; W]], column: &[E], multiples: [E; W]) {
    let column = &column[..part.len()];
    for i in 0..column.len() {
        for lane in 0..W {
            part[i][lane] -= column[i] * multiples[lane];
        }
    }
}

fn product<E: Entry>(column: &[E], part: &[E]) -> E {
    column.iter().zip(part).map(|(a, x)| a.conjugate() * *x).sum()
}
