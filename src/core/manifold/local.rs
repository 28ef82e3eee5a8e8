//! The local manifold of a saddle as a Taylor polynomial.

use super::error::ManifoldError;
use super::planar::{Matrix, PlanarMap, Vector, minus, norm, plus, solved};
use super::saddle::{derivative, eigenvector};
use crate::core::problem::ROOM;
use crate::core::scalar::jet::jet_of;
use crate::core::scalar::{Jet, Space};

/// Heuristic: the order of the Taylor polynomial, equal to the highest order of jets.
const ORDER: usize = 8;

/// Discretisation: the largest allowed size of the last terms of the polynomial, relative to the
/// norm of the saddle or to the distance from the saddle, whichever is larger.
const NEGLIGIBLE: f64 = 1e-15;

/// Discretisation: the largest allowed error of the equation `g(W(s)) = W(λ s)`, relative to the
/// norm of the saddle or to the distance from the saddle, whichever is larger.
const LARGEST: f64 = 1e-12;

/// Heuristic: the largest number of times that the domain of the polynomial is halved until the
/// equation `g(W(s)) = W(λ s)` holds.
const HALVED: usize = 40;

/// The Taylor polynomial `W(s)` with `g(W(s)) = W(λ s)` at a point of a cycle.
pub(super) struct Local {
    /// The coefficients of the polynomial, by increasing powers of `s`.
    coefficients: Vec<Vector>,
    /// The largest `|s|` at which the polynomial is used.
    pub radius: f64,
    /// The error of the equation `g(W(s)) = W(λ s)` at both ends of the domain.
    pub error: f64,
}

impl Local {
    /// Computes the Taylor polynomial at the first point of a cycle, for one of the cycle's
    /// multipliers. The argument `largest` is the largest allowed radius of the domain.
    pub fn new(
        map: &dyn PlanarMap,
        cycle: &[Vector],
        multiplier: f64,
        largest: f64,
    ) -> Result<Self, ManifoldError> {
        let (slope, _) = derivative(map, cycle);
        let mut coefficients = vec![cycle[0], eigenvector(slope, multiplier)];
        for order in 2..=ORDER {
            let rest = coefficient(map, cycle.len(), &coefficients, order);
            let factor = multiplier.powi(order as i32);
            let [a, b] = slope;
            let left: Matrix = [[a[0] - factor, a[1]], [b[0], b[1] - factor]];
            coefficients.push(solved(left, rest.map(|part| -part)));
        }
        let mut local = Local { coefficients, radius: largest, error: 0.0 };
        local.radius = local.range(largest);
        for _ in 0..HALVED {
            local.error = local.defect(map, cycle.len(), multiplier);
            if local.error <= LARGEST * local.size(local.radius) {
                return Ok(local);
            }
            local.radius *= 0.5;
        }
        Err(ManifoldError::NoSeries { error: local.error, distance: local.radius })
    }

    /// Evaluates the point `W(s)`, and its derivative with respect to `s`.
    pub fn at(&self, s: f64) -> (Vector, Vector) {
        let mut value = [0.0; 2];
        let mut slope = [0.0; 2];
        for c in self.coefficients.iter().rev() {
            slope = plus(value, s, slope);
            value = plus(*c, s, value);
        }
        (value, slope)
    }

    /// Returns the size to which errors at the distance `s` from the saddle are compared.
    fn size(&self, s: f64) -> f64 {
        norm(self.coefficients[0]).max(s)
    }

    /// Returns the largest `s` at which the last two terms of the polynomial are negligible.
    fn range(&self, largest: f64) -> f64 {
        let negligible = |s: f64| {
            let term = |k: usize| norm(self.coefficients[k]) * s.powi(k as i32);
            term(ORDER).max(term(ORDER - 1)) <= NEGLIGIBLE * self.size(s)
        };
        let mut s = largest;
        while !negligible(s) && s > f64::MIN_POSITIVE {
            s *= 0.8;
        }
        s
    }

    /// Returns the error of the equation `g(W(s)) = W(λ s)` at both ends of the domain; the larger
    /// one of the arguments `s` and `λ s` is the end of the domain.
    fn defect(&self, map: &dyn PlanarMap, iterates: usize, multiplier: f64) -> f64 {
        let reach = self.radius / multiplier.abs().max(1.0);
        let of = |s: f64| {
            let mut u = self.at(s).0;
            (0..iterates).for_each(|_| u = map.image(u));
            norm(minus(u, self.at(multiplier * s).0))
        };
        let [a, b] = [of(reach), of(-reach)];
        if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
    }
}

/// Computes the coefficient of a power of `s` in the image of the polynomial without the term of
/// this power.
fn coefficient(
    map: &dyn PlanarMap,
    iterates: usize,
    coefficients: &[Vector],
    order: usize,
) -> Vector {
    let known = |i: usize| -> Option<Jet<ROOM>> {
        let space = Space::of(1, order).ok()?;
        jet_of(space, |k| coefficients.get(k).map_or(0.0, |c| c[i])).ok()
    };
    // Orders up to 8 of one variable fit into the jets.
    let (Some(x), Some(y)) = (known(0), known(1)) else { return [f64::NAN; 2] };
    let mut u = [x, y];
    (0..iterates).for_each(|_| u = map.series(u));
    u.map(|part| part.coefficients().get(order).copied().unwrap_or(0.0))
}
