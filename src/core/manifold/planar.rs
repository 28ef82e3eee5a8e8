//! Maps of the plane at given parameters, with their derivatives and Taylor polynomials.

use crate::core::problem::{DiscreteMap, ROOM};
use crate::core::scalar::{Chunk, Jet, Scalar, seeded};

/// A point or a vector of the plane, in units of the states' scales.
pub(super) type Vector = [f64; 2];

/// A 2 × 2 matrix, row by row.
pub(super) type Matrix = [Vector; 2];

/// A map of the plane in units of its states' scales.
pub(super) trait PlanarMap {
    /// Computes the image of a point.
    fn image(&self, u: Vector) -> Vector;

    /// Computes the image of a point, and the derivative of the map at this point.
    fn linear(&self, u: Vector) -> (Vector, Matrix);

    /// Computes the image of a curve that is given by Taylor polynomials.
    fn series(&self, u: [Jet<ROOM>; 2]) -> [Jet<ROOM>; 2];
}

/// A user-defined map at given parameters, in units of its states' scales.
pub(super) struct Scaled<'a, M> {
    map: &'a M,
    p: Vec<f64>,
    chunks: Vec<Chunk>,
    jets: Vec<Jet<ROOM>>,
    scales: Vector,
}

impl<'a, M: DiscreteMap> Scaled<'a, M> {
    pub fn new(map: &'a M, p: &[f64], scales: Vector) -> Self {
        let chunks = p.iter().map(|p| Chunk::from(*p)).collect();
        let jets = p.iter().map(|p| Jet::constant(*p)).collect();
        Scaled { map, p: p.to_vec(), chunks, jets, scales }
    }

    fn at<T: Scalar>(&self, u: [T; 2], p: &[T]) -> [T; 2] {
        let mut next = [T::zero(); 2];
        self.map.next(&[u[0] * self.scales[0], u[1] * self.scales[1]], p, &mut next);
        [next[0] / self.scales[0], next[1] / self.scales[1]]
    }
}

impl<M: DiscreteMap> PlanarMap for Scaled<'_, M> {
    fn image(&self, u: Vector) -> Vector {
        self.at(u, &self.p)
    }

    fn linear(&self, u: Vector) -> (Vector, Matrix) {
        let [a, b] = self.at([seeded(u[0], 0, 0), seeded(u[1], 1, 0)], &self.chunks);
        ([a.re, b.re], [[a.eps[0], a.eps[1]], [b.eps[0], b.eps[1]]])
    }

    fn series(&self, u: [Jet<ROOM>; 2]) -> [Jet<ROOM>; 2] {
        self.at(u, &self.jets)
    }
}

pub(super) fn plus(a: Vector, factor: f64, b: Vector) -> Vector {
    [a[0] + factor * b[0], a[1] + factor * b[1]]
}

pub(super) fn minus(a: Vector, b: Vector) -> Vector {
    plus(a, -1.0, b)
}

pub(super) fn norm(a: Vector) -> f64 {
    a[0].hypot(a[1])
}

pub(super) fn cross(a: Vector, b: Vector) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn times(m: Matrix, v: Vector) -> Vector {
    [m[0][0] * v[0] + m[0][1] * v[1], m[1][0] * v[0] + m[1][1] * v[1]]
}

pub(super) fn determinant(m: Matrix) -> f64 {
    cross(m[0], m[1])
}

/// Solves the linear system `m x = v`; the solution is not finite if the matrix is singular.
pub(super) fn solved(m: Matrix, v: Vector) -> Vector {
    let det = determinant(m);
    [(m[1][1] * v[0] - m[0][1] * v[1]) / det, (m[0][0] * v[1] - m[1][0] * v[0]) / det]
}

pub(super) fn is_finite(a: Vector) -> bool {
    a[0].is_finite() && a[1].is_finite()
}
