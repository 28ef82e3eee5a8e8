//! Cycles that emanate from a Hopf point at which several pairs of eigenvalues `±iω` are equal, as in
//! systems with a symmetry.
//!
//! Let `q_j` be the right and `p_l` the left eigenvectors with the eigenvalue `iω`, and `p_l q_j = δ_lj`.
//! The amplitudes `z_j` of the deviation `Re Σ_j z_j q_j e^{iωt}` change at the rates `σ z_l + G_l(z)` to
//! third order, where `σ` is the growth rate of all pairs beside the Hopf point, and
//!
//! ```text
//!     G_l(z) = Σ_ijk G_lijk z_i z_j z̄_k,
//!     G_lijk = p_l (C(q_i, q_j, q̄_k) + B(q̄_k, h_ij) + B(q_i, g_jk) + B(q_j, g_ik))/2,
//!     (2iω − F_x) h_ij = B(q_i, q_j),      −F_x g_jk = B(q_j, q̄_k)
//! ```
//!
//! with the second and third derivatives `B` and `C` of the vector field `F`. Cycles emanate in the
//! directions `z` with `G(z) = κ z` (M. Golubitsky, I. Stewart and D. G. Schaeffer, *Singularities and
//! Groups in Bifurcation Theory II*, 1988, chapter XVI). Directions with the same `κ` are images of one
//! another under the symmetry.

use super::rest::{Mode, Rest};
use crate::core::failure::Failure;
use crate::core::linalg::generic;
use crate::core::scalar::Scalar;
use faer::c64;
use nalgebra::{DMatrix, DVector};
use num_dual::Dual64;

/// The number of starting directions of Newton's method per pair.
const STARTS: usize = 40;

/// The maximal number of iterations of Newton's method for one direction.
const ITERATIONS: usize = 60;

/// Rounding: two values `κ` are equal if they differ by less than this fraction of the largest
/// coefficient.
const EQUAL: f64 = 1e-6;

/// Rounding: a direction is isolated if all pivots of the Jacobian are larger than this threshold.
const ISOLATED: f64 = 1e-6;

/// Returns one of the directions in which cycles emanate from a Hopf point with `count` equal pairs, as an
/// eigenvector with the eigenvalue `iω`.
///
/// # Errors
/// [`Failure::Undetermined`] if terms of third order determine no direction, and [`Failure::NoBranch`] if
/// there are fewer directions.
pub(super) fn direction(
    rest: &Rest,
    frequency: Option<f64>,
    count: usize,
    which: usize,
) -> Result<Mode, Failure> {
    let pairs = rest.equal_pairs(frequency, count)?;
    let value = pairs[0].value;
    let directions = Cubic::new(rest, &pairs)?.directions();
    if directions.is_empty() {
        return Err(Failure::Undetermined(format!(
            "terms of third order determine no branch of cycles at this Hopf point of multiplicity {count}"
        )));
    }
    let z = directions.get(which).ok_or_else(|| Failure::no_branch(which, directions.len()))?;
    let component = |i: usize| pairs.iter().zip(z).map(|(pair, z)| pair.vector[i] * z).sum();
    Ok(Mode { value, vector: (0..rest.state.len()).map(component).collect() })
}

/// A complex number as real and imaginary part, in any scalar type.
type Parts<T> = [T; 2];

fn product<T: Scalar>(a: Parts<T>, b: Parts<T>) -> Parts<T> {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// The cubic terms `G` of the amplitudes, divided by the largest coefficient.
struct Cubic {
    count: usize,
    /// The coefficients `G_lijk` in the order of their indices.
    terms: Vec<c64>,
}

impl Cubic {
    fn new(rest: &Rest, pairs: &[Mode]) -> Result<Self, Failure> {
        let (count, omega) = (pairs.len(), pairs[0].value.im);
        let left = rest.left_of(pairs)?;
        let q: Vec<&[c64]> = pairs.iter().map(|pair| &pair.vector[..]).collect();
        let conjugates: Vec<Vec<c64>> =
            q.iter().map(|q| q.iter().map(c64::conj).collect()).collect();
        let all = || (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
        let (double, zero) = (c64::new(0.0, 2.0 * omega), c64::new(0.0, 0.0));
        let [oscillating, still] = [double, zero].map(|s| rest.shifted(s));
        let h = all().map(|(i, j)| oscillating.solve(&rest.second(q[i], q[j])));
        let h: Vec<Vec<c64>> = h.collect::<Result<_, _>>()?;
        let g = all().map(|(j, k)| still.solve(&rest.second(q[j], &conjugates[k])));
        let g: Vec<Vec<c64>> = g.collect::<Result<_, _>>()?;
        let mut terms = vec![zero; count.pow(4)];
        for (i, j) in all() {
            for k in 0..count {
                let parts = [
                    rest.third([q[i], q[j], &conjugates[k]])?,
                    rest.second(&conjugates[k], &h[i * count + j]),
                    rest.second(q[i], &g[j * count + k]),
                    rest.second(q[j], &g[i * count + k]),
                ];
                for (l, p) in left.iter().enumerate() {
                    let along =
                        |part: &Vec<c64>| -> c64 { p.iter().zip(part).map(|(p, f)| p * f).sum() };
                    let sum: c64 = parts.iter().map(along).sum();
                    terms[((l * count + i) * count + j) * count + k] = sum * 0.5;
                }
            }
        }
        let largest = terms.iter().fold(0.0, |most: f64, term| most.max(term.norm_sqr().sqrt()));
        if largest > 0.0 {
            terms.iter_mut().for_each(|term| *term /= largest);
        }
        Ok(Cubic { count, terms })
    }

    /// Computes `G(z)`.
    fn value<T: Scalar>(&self, z: &[Parts<T>]) -> Vec<Parts<T>> {
        let mut sums = vec![[T::zero(); 2]; self.count];
        let mut terms = self.terms.iter();
        for sum in &mut sums {
            for i in 0..self.count {
                for j in 0..self.count {
                    let both = product(z[i], z[j]);
                    for (z, term) in z.iter().zip(terms.by_ref()) {
                        let all = product(both, [z[0], -z[1]]);
                        let own = product(all, [term.re, term.im].map(T::constant));
                        *sum = [sum[0] + own[0], sum[1] + own[1]];
                    }
                }
            }
        }
        sums
    }

    /// Computes the left sides of `G(z) = κ z`, `|z|² = 1` and `Im (s̄·z) = 0` for a fixed `s`, which
    /// determines the phase of `z`; `y` contains `z` and `κ`.
    fn residual<T: Scalar>(&self, y: &[T], s: &[f64]) -> Vec<T> {
        let numbers: Vec<Parts<T>> = y.as_chunks().0.to_vec();
        let (z, kappa) = numbers.split_at(self.count);
        let cubic = self.value(z);
        let mut out = Vec::with_capacity(y.len());
        for (g, z) in cubic.iter().zip(z) {
            let turned = product(*z, kappa[0]);
            out.extend([g[0] - turned[0], g[1] - turned[1]]);
        }
        let norm = z.iter().fold(-T::one(), |sum, z| sum + z[0] * z[0] + z[1] * z[1]);
        let phase = z.iter().zip(s.as_chunks::<2>().0);
        let phase = phase.fold(T::zero(), |sum, (z, s)| sum + z[1] * s[0] - z[0] * s[1]);
        out.extend([norm, phase]);
        out
    }

    /// Refines an approximate direction by Newton's method; `None` if the direction is not isolated, or
    /// if the method does not converge.
    fn polished(&self, s: &[f64]) -> Option<Vec<f64>> {
        let start: Vec<Parts<f64>> = s.as_chunks().0.to_vec();
        let along = start.iter().zip(self.value(&start));
        let kappa = along.fold([0.0; 2], |sum, (z, g)| {
            let own = product([z[0], -z[1]], g);
            [sum[0] + own[0], sum[1] + own[1]]
        });
        let mut y = [s, &kappa].concat();
        let size = y.len();
        for _ in 0..ITERATIONS {
            let column = |k: usize| {
                let seeded = y.iter().enumerate();
                let seeded: Vec<Dual64> =
                    seeded.map(|(i, y)| Dual64::new(*y, f64::from(u8::from(i == k)))).collect();
                self.residual(&seeded, s)
            };
            let columns: Vec<Vec<Dual64>> = (0..size).map(column).collect();
            let lu = DMatrix::from_fn(size, size, |i, j| columns[j][i].eps).lu();
            let isolated = lu.u().diagonal().iter().all(|pivot| pivot.abs() > ISOLATED);
            let correction = lu.solve(&DVector::from_vec(self.residual(&y, s)))?;
            let length = correction.norm();
            // A long correction leaves the region in which the equations are nearly linear.
            let damping = (0.5 / length).min(1.0);
            y.iter_mut().zip(&correction).for_each(|(y, d)| *y -= damping * d);
            if !length.is_finite() {
                return None;
            }
            if length < 1e-13 {
                return isolated.then_some(y);
            }
        }
        None
    }

    /// Returns one direction `z` for each value `κ`, in the order of the real parts of `κ`.
    fn directions(&self) -> Vec<Vec<c64>> {
        let mut found: Vec<Vec<f64>> = Vec::new();
        let kappa = |y: &[f64]| [y[2 * self.count], y[2 * self.count + 1]];
        for seed in 0..STARTS * self.count {
            let start = DVector::from_vec(generic(2 * self.count, seed));
            let start = (start - DVector::repeat(2 * self.count, 0.1)).normalize();
            let Some(y) = self.polished(start.as_slice()) else { continue };
            let [re, im] = kappa(&y);
            let is_known = |other: &Vec<f64>| {
                let [a, b] = kappa(other);
                (a - re).hypot(b - im) <= EQUAL
            };
            if !found.iter().any(is_known) {
                found.push(y);
            }
        }
        found.sort_by(|a, b| kappa(a)[0].total_cmp(&kappa(b)[0]));
        let numbers = |y: Vec<f64>| -> Vec<c64> {
            let all = y.as_chunks::<2>().0.iter().take(self.count);
            all.map(|[re, im]| c64::new(*re, *im)).collect()
        };
        found.into_iter().map(numbers).collect()
    }
}
