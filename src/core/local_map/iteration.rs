//! Evaluation of the local map.

use super::error::GrazingError;
use super::map::LocalMap;
use crate::core::scalar::{Monomials, Scalar};
use std::ops::Deref;

/// An evaluator of a [`LocalMap`] in one scalar type, with its buffers: after the first image, the
/// iteration allocates no memory.
///
/// A point is a list with one component for each coordinate of the map, and the parameters are
/// given as deviations from their values at the grazing.
///
/// With dual numbers the iteration computes the Jacobian of the map, whose entries grow like `1/y`
/// near grazing.
pub struct Iteration<M, T> {
    pub(super) map: M,
    /// The highest order of the terms that are evaluated.
    order: usize,
    monomials: Monomials<T>,
    place: Vec<T>,
}

impl LocalMap {
    /// Creates an evaluator with which the map can be iterated.
    pub fn iteration<T: Scalar>(&self) -> Iteration<&Self, T> {
        self.iteration_to(self.space().order())
    }

    /// Creates an evaluator of the map that omits terms above a given order.
    pub fn iteration_to<T: Scalar>(&self, order: usize) -> Iteration<&Self, T> {
        Iteration::new(self, order)
    }

    /// Returns the contribution of the terms of highest order to the image of a point. This
    /// contribution estimates the error of the local map of the next lower order; if the Taylor
    /// series converges, the contribution bounds the error of the local map of the full order.
    pub fn error(&self, x: &[f64], p: &[f64]) -> f64 {
        let (mut image, mut lower) = (x.to_vec(), x.to_vec());
        self.iteration().apply(&mut image, p);
        self.iteration_to(self.space().order() - 1).apply(&mut lower, p);
        image.iter().zip(&lower).fold(0.0, |most, (a, b)| (a - b).abs().max(most))
    }

    /// Computes the image of a point on the section, given the deviations of its coordinates and of
    /// the parameters.
    ///
    /// # Errors
    /// [`GrazingError::TooFar`] if the contribution of the highest order exceeds the tolerance,
    /// [`GrazingError::Length`] if the number of deviations is wrong.
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

    /// Computes the penetration `−h` at a point on the section, given the deviations of the point's
    /// coordinates and of the parameters from the grazing orbit.
    pub fn penetration(&mut self, x: &[T], p: &[T]) -> T {
        self.at(x, p);
        self.map.smooth.penetration.sum_to(self.order, &self.monomials)
    }

    /// Replaces a point `x` on the section by its image, and returns the penetration at the
    /// original point.
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

    /// Applies `D`, then `P_smooth`, to a virtual point, which is given by `y` (possibly negative)
    /// in place of its normal coordinate, and by its other coordinates. The image of the point is
    /// written into `x`.
    pub(crate) fn apply_regular(&mut self, z: &[T], p: &[T], x: &mut [T]) {
        self.at(z, p);
        self.discontinue(x);
        self.apply_smooth(x, p);
    }

    /// Replaces a point by its image under `P_smooth` alone, whatever the penetration.
    pub(super) fn apply_smooth(&mut self, x: &mut [T], p: &[T]) {
        self.at(x, p);
        self.follow(x);
    }

    /// Computes the normal coordinate of the virtual point, given `y` and the other coordinates.
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
