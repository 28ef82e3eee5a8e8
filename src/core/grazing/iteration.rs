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
    order: usize,
    monomials: Monomials<T>,
    place: Vec<T>,
}

impl<'a, T: Scalar> Iteration<'a, T> {
    pub(super) fn new(map: &'a LocalMap, order: usize) -> Self {
        Iteration { map, order, monomials: Monomials::default(), place: Vec::new() }
    }

    /// The penetration `−h` at a point of the section, given deviations of its coordinates and of the
    /// parameters.
    pub fn penetration(&mut self, x: &[T], p: &[T]) -> T {
        self.at(x, p);
        self.map.smooth.penetration.sum_to(self.order, &self.monomials)
    }

    /// Replaces a point of the section, `x`, by its image.
    pub fn apply(&mut self, x: &mut [T], p: &[T]) {
        let penetration = self.penetration(x, p);
        if penetration.real() > 0.0 {
            self.place[self.map.normal] = penetration.sqrt();
            self.discontinue(x);
            self.at(x, p);
        }
        self.follow(x);
    }

    /// `D`, then `P_smooth`, of the virtual point given by `y` (which may be negative) in place of its normal
    /// coordinate, and the other coordinates. The image is written into `x`.
    pub fn apply_regular(&mut self, z: &[T], p: &[T], x: &mut [T]) {
        self.at(z, p);
        self.discontinue(x);
        self.at(x, p);
        self.follow(x);
    }

    /// `P_smooth` alone, whatever the penetration. The image is written into `image`.
    pub fn apply_smooth(&mut self, x: &[T], p: &[T], image: &mut [T]) {
        self.at(x, p);
        self.follow(image);
    }

    /// The normal coordinate of the virtual point given by `y` and the other coordinates.
    pub fn entry(&mut self, z: &[T], p: &[T]) -> T {
        self.at(z, p);
        self.map.discontinuity.entry.sum_to(self.order, &self.monomials)
    }

    fn at(&mut self, x: &[T], p: &[T]) {
        self.place.clear();
        self.place.extend_from_slice(x);
        self.place.extend_from_slice(p);
        self.monomials.update(self.map.space(), &self.place);
    }

    fn discontinue(&mut self, x: &mut [T]) {
        self.monomials.update(self.map.space(), &self.place);
        for (x, image) in x.iter_mut().zip(&self.map.discontinuity.images) {
            *x = image.sum_to(self.order, &self.monomials);
        }
    }

    fn follow(&mut self, x: &mut [T]) {
        for (x, image) in x.iter_mut().zip(&self.map.smooth.images) {
            *x = image.sum_to(self.order, &self.monomials);
        }
    }
}
