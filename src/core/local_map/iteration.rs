//! Evaluation of the local map.

use super::error::GrazingError;
use super::map::LocalMap;
use crate::core::scalar::{Monomials, Scalar};
use std::ops::Deref;

/// The iteration of a [`LocalMap`] in one scalar type, with all buffers: nothing is allocated after
/// the first image.
///
/// A point has one component per coordinate of the map, and one parameter per deviating parameter.
///
/// On dual numbers the iteration gives the Jacobian of the map, whose entries grow like `1/y` near
/// grazing.
pub struct Iteration<M, T> {
    pub(super) map: M,
    /// Terms of higher order are omitted.
    order: usize,
    monomials: Monomials<T>,
    place: Vec<T>,
}

impl LocalMap {
    /// Creates an iteration of the map.
    pub fn iteration<T: Scalar>(&self) -> Iteration<&Self, T> {
        self.iteration_to(self.space().order())
    }

    /// Creates an iteration of the map without terms above an order.
    pub fn iteration_to<T: Scalar>(&self, order: usize) -> Iteration<&Self, T> {
        Iteration::new(self, order)
    }

    /// Returns the contribution of the highest order to the image of a point: an estimate of the
    /// error of the map of the next lower order, and, if the series converges, a bound for the
    /// error of this map.
    pub fn error(&self, x: &[f64], p: &[f64]) -> f64 {
        let (mut image, mut lower) = (x.to_vec(), x.to_vec());
        self.iteration().apply(&mut image, p);
        self.iteration_to(self.space().order() - 1).apply(&mut lower, p);
        image.iter().zip(&lower).fold(0.0, |most, (a, b)| (a - b).abs().max(most))
    }

    /// Computes the image of a point of the section, given deviations of its coordinates and of the
    /// parameters.
    ///
    /// # Errors
    /// [`GrazingError::TooFar`] if the contribution of the highest order exceeds the tolerance,
    /// [`GrazingError::Length`] for another number of deviations.
    pub fn image(&self, x: &[f64], p: &[f64], tolerance: f64) -> Result<Vec<f64>, GrazingError> {
        let lengths = [
            ("coordinates", x.len(), self.coordinates().len()),
            ("parameters", p.len(), self.parameters().len()),
        ];
        if let Some((what, found, expected)) = lengths.into_iter().find(|(_, a, b)| a != b) {
            return Err(GrazingError::Length { what, found, expected });
        }
        let (order, estimate) = (self.space().order(), self.error(x, p));
        let mut iteration = self.iteration();
        if estimate.is_nan() || estimate > tolerance {
            let penetration = iteration.penetration(x, p);
            return Err(GrazingError::TooFar { order, estimate, tolerance, penetration });
        }
        let mut image = x.to_vec();
        iteration.apply(&mut image, p);
        Ok(image)
    }
}

impl<M: Deref<Target = LocalMap>, T: Scalar> Iteration<M, T> {
    pub(super) fn new(map: M, order: usize) -> Self {
        Iteration { map, order, monomials: Monomials::default(), place: Vec::new() }
    }

    /// Computes the penetration `−h` at a point of the section, given deviations of its coordinates
    /// and of the parameters.
    pub fn penetration(&mut self, x: &[T], p: &[T]) -> T {
        self.at(x, p);
        self.map.smooth.penetration.sum_to(self.order, &self.monomials)
    }

    /// Replaces a point `x` of the section by its image, and returns the penetration.
    pub fn apply(&mut self, x: &mut [T], p: &[T]) -> T {
        let penetration = self.penetration(x, p);
        if penetration.real() > 0.0 {
            self.place[self.map.normal()] = penetration.sqrt();
            self.monomials.update(self.map.space(), &self.place);
            self.discontinue(x);
            self.at(x, p);
        }
        self.follow(x);
        penetration
    }

    /// Applies `D`, then `P_smooth`, to the virtual point given by `y` (which may be negative) in
    /// place of its normal coordinate, and the other coordinates. The image is written into `x`.
    pub(crate) fn apply_regular(&mut self, z: &[T], p: &[T], x: &mut [T]) {
        self.at(z, p);
        self.discontinue(x);
        self.apply_smooth(x, p);
    }

    /// Replaces a point by its image under `P_smooth` only, whatever the penetration.
    pub(super) fn apply_smooth(&mut self, x: &mut [T], p: &[T]) {
        self.at(x, p);
        self.follow(x);
    }

    /// Computes the normal coordinate of the virtual point given by `y` and the other coordinates.
    pub(crate) fn entry(&mut self, z: &[T], p: &[T]) -> T {
        self.at(z, p);
        self.map.discontinuity.entry.sum_to(self.order, &self.monomials)
    }

    fn at(&mut self, x: &[T], p: &[T]) {
        self.place.clear();
        self.place.extend_from_slice(x);
        self.place.extend_from_slice(p);
        self.monomials.update(self.map.space(), &self.place);
    }

    fn discontinue(&self, x: &mut [T]) {
        for (x, image) in x.iter_mut().zip(&self.map.discontinuity.images) {
            *x = image.sum_to(self.order, &self.monomials);
        }
    }

    fn follow(&self, x: &mut [T]) {
        for (x, image) in x.iter_mut().zip(&self.map.smooth.images) {
            *x = image.sum_to(self.order, &self.monomials);
        }
    }
}
