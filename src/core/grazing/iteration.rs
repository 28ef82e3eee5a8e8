//! The local map applied.

use super::map::LocalMap;
use crate::core::jet::Monomials;
use crate::core::scalar::Scalar;

/// The iteration of a [`LocalMap`] in one scalar type, with all buffers: nothing is allocated after the first
/// image.
///
/// Points have as many components as the map has coordinates, and parameters as many as deviate.
///
/// On dual numbers it gives the Jacobian of the map, whose entries grow like `1/y` near grazing.
pub struct Iteration<'a, T> {
    map: &'a LocalMap,
    buffers: Buffers<T>,
}

impl<'a, T: Scalar> Iteration<'a, T> {
    pub(super) fn new(map: &'a LocalMap, order: usize) -> Self {
        Iteration { map, buffers: Buffers::new(order) }
    }

    /// The penetration `−h` at a point of the section, given deviations of its coordinates and of the
    /// parameters.
    pub fn penetration(&mut self, x: &[T], p: &[T]) -> T {
        self.buffers.penetration(self.map, x, p)
    }

    /// Replaces a point of the section, `x`, by its image.
    pub fn apply(&mut self, x: &mut [T], p: &[T]) {
        self.buffers.apply(self.map, x, p);
    }

    /// `D`, then `P_smooth`, of the virtual point given by `y` (which may be negative) in place of its normal
    /// coordinate, and the other coordinates. The image is written into `x`.
    pub fn apply_regular(&mut self, z: &[T], p: &[T], x: &mut [T]) {
        self.buffers.at(self.map, z, p);
        self.buffers.discontinue(self.map, x);
        self.buffers.at(self.map, x, p);
        self.buffers.follow(self.map, x);
    }

    /// `P_smooth` alone, whatever the penetration. The image is written into `image`.
    pub fn apply_smooth(&mut self, x: &[T], p: &[T], image: &mut [T]) {
        self.buffers.at(self.map, x, p);
        self.buffers.follow(self.map, image);
    }

    /// The normal coordinate of the virtual point given by `y` and the other coordinates.
    pub fn entry(&mut self, z: &[T], p: &[T]) -> T {
        self.buffers.at(self.map, z, p);
        self.map.discontinuity.entry.sum_to(self.buffers.order, &self.buffers.monomials)
    }
}

/// What an iteration needs beside the map.
pub(super) struct Buffers<T> {
    order: usize,
    monomials: Monomials<T>,
    place: Vec<T>,
}

impl<T: Scalar> Buffers<T> {
    /// For a map without terms beyond an order.
    pub fn new(order: usize) -> Self {
        Buffers { order, monomials: Monomials::default(), place: Vec::new() }
    }

    /// As [`Iteration::penetration`].
    pub fn penetration(&mut self, map: &LocalMap, x: &[T], p: &[T]) -> T {
        self.at(map, x, p);
        map.smooth.penetration.sum_to(self.order, &self.monomials)
    }

    /// As [`Iteration::apply`]. Returns the penetration.
    pub fn apply(&mut self, map: &LocalMap, x: &mut [T], p: &[T]) -> T {
        let penetration = self.penetration(map, x, p);
        if penetration.real() > 0.0 {
            self.place[map.normal] = penetration.sqrt();
            self.discontinue(map, x);
            self.at(map, x, p);
        }
        self.follow(map, x);
        penetration
    }

    fn at(&mut self, map: &LocalMap, x: &[T], p: &[T]) {
        self.place.clear();
        self.place.extend_from_slice(x);
        self.place.extend_from_slice(p);
        self.monomials.update(map.space(), &self.place);
    }

    fn discontinue(&mut self, map: &LocalMap, x: &mut [T]) {
        self.monomials.update(map.space(), &self.place);
        for (x, image) in x.iter_mut().zip(&map.discontinuity.images) {
            *x = image.sum_to(self.order, &self.monomials);
        }
    }

    fn follow(&mut self, map: &LocalMap, x: &mut [T]) {
        for (x, image) in x.iter_mut().zip(&map.smooth.images) {
            *x = image.sum_to(self.order, &self.monomials);
        }
    }
}
