//! How many branch points a step passes, where no eigenvalues are known.
//!
//! Along a step the matrix `M = [F_z F_p; row]` goes from `M₀` to `M₁`. If it changes linearly, it is singular in between as
//! often as `M₁⁻¹ M₀` has negative eigenvalues. Those differ from 1, which the eigenvalues of two neighbouring
//! discretised operators crowd around, so that a few of Arnoldi's vectors find them.

use super::stepper::{Crossings, Place, Stepper};
use crate::core::condition::Failure;
use crate::core::newton::{scale_to_one, scaled_norm};
use crate::core::vector::{difference, dot, generic};
use nalgebra::{Complex, DMatrix};

/// If `M` is singular at the arclength `d` beyond a step of length `ℓ`, `M₁⁻¹ M₀ − 1` makes a vector at least `ℓ/d` times its share
/// of the null vector long: from the length follows how far away any singular matrix is. Of `N` components of a random unit
/// vector 4 in 100 are smaller than this over `√N`. Of what is missed then the determinant still shows odd numbers.
const SHARE: f64 = 0.05;

/// The most lengths of a step that are looked ahead.
const AHEAD: f64 = 12.0;

/// The most vectors spent.
const VECTORS: usize = 10;

/// Vectors whose new part is smaller than this have been spent: an eigenvalue below zero that is still missing, whose distance from 1 is
/// more than 1, would make it larger.
const SPENT: f64 = 1e-2;

/// Matrices that differ by less than this, applied to a generic vector, have no singular one between them.
const NEAR: f64 = 0.1;

/// A matrix that makes generic vectors larger than this, compared with a neighbouring one, is singular but for rounding.
const SINGULAR: f64 = 1e8;

impl Stepper<'_> {
    /// The branch points in a step to a place, if they are looked for and eigenvalues do not tell. The matrix factored last is
    /// that of the place, with this row.
    pub fn crossings(&mut self, from: &Place, row: &[f64], step: f64, to: &mut Place) -> Crossings {
        let looked_for = self.branch_points().is_some() && self.held.is_empty();
        if !looked_for || to.spectrum.is_some() {
            return Crossings::default();
        }
        let crossings = self.count_crossings(from, row, step);
        to.quiet = crossings.quiet;
        crossings
    }

    fn count_crossings(&mut self, from: &Place, row: &[f64], step: f64) -> Crossings {
        if from.quiet >= step {
            return Crossings { quiet: from.quiet - step, ..Crossings::default() };
        }
        let length = from.unknowns.len();
        let share = SHARE / (length as f64).sqrt();
        let mut basis: Vec<Vec<f64>> = vec![generic(length, 5)];
        scale_to_one(&mut basis[0], &self.weights);
        let mut h = DMatrix::<f64>::zeros(VECTORS + 1, VECTORS);
        let mut used = 0;
        for k in 0..VECTORS.min(length) {
            let Ok(mut v) = self.carried_back(from, row, &basis[k]) else {
                return Crossings::default();
            };
            if k == 0 {
                let size = scaled_norm(&difference(&v, &basis[0]), &self.weights);
                if !(NEAR..=SINGULAR).contains(&size) {
                    let quiet = if size < NEAR { (share / size).min(AHEAD) * step } else { 0.0 };
                    return Crossings { count: 0, singular: size > SINGULAR, quiet };
                }
            }
            used = k + 1;
            for _ in 0..2 {
                for (j, other) in basis.iter().enumerate() {
                    let terms = other.iter().zip(&v).zip(&self.weights);
                    let overlap: f64 = terms.map(|((a, b), w)| a * b * w).sum();
                    h[(j, k)] += overlap;
                    v.iter_mut().zip(other).for_each(|(v, o)| *v -= overlap * o);
                }
            }
            let size = scale_to_one(&mut v, &self.weights);
            h[(k + 1, k)] = size;
            if size.is_nan() || size <= SPENT {
                break;
            }
            basis.push(v);
        }
        let square = h.view((0, 0), (used, used)).into_owned();
        let values = square.complex_eigenvalues();
        let passes = |l: &&Complex<f64>| l.re < 0.0 && l.im.abs() < 1e-6 * l.re.abs();
        Crossings { count: values.iter().filter(passes).count(), ..Crossings::default() }
    }

    /// `M₁⁻¹ M₀ v`.
    fn carried_back(&mut self, from: &Place, row: &[f64], v: &[f64]) -> Result<Vec<f64>, Failure> {
        let n = self.equations.dimension();
        let direction = self.equations.direction_of(v);
        let x = self.equations.load(&from.unknowns).to_vec();
        let mut out = vec![0.0; v.len()];
        self.equations.system().derivative(&x, &[&direction], &mut out[..n])?;
        out[v.len() - 1] = dot(row, v);
        self.equations.solve(&mut out);
        Ok(out)
    }
}
