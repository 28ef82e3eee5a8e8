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
use crate::core::numerics::{isolated_root, starting_direction};
use faer::c64;
use nalgebra::{Complex, DMatrix, DVector};
use num_dual::Dual64;
use num_traits::{One, Zero};

/// Heuristic: the number of starting directions of Newton's method per pair. Of 120 starts for two pairs,
/// at least 16 converged to each of three directions.
const STARTS: usize = 60;

/// Rounding: two values `κ` are equal if they differ by less than this fraction of the largest
/// coefficient.
const EQUAL: f64 = 1e-6;

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
    fn value(&self, z: &[Complex<Dual64>]) -> Vec<Complex<Dual64>> {
        let number =
            |term: &c64| -> Complex<Dual64> { Complex::new(term.re.into(), term.im.into()) };
        let mut terms = self.terms.iter().map(number);
        let mut sums = vec![Complex::new(Dual64::zero(), Dual64::zero()); self.count];
        for sum in &mut sums {
            for a in z {
                for b in z {
                    for (c, term) in z.iter().zip(terms.by_ref()) {
                        *sum += term * a * b * c.conj();
                    }
                }
            }
        }
        sums
    }

    /// Computes the left sides of `G(z) = κ z`, `|z|² = 1` and `Im (s̄·z) = 0`, where `y` contains `z` and
    /// `κ`, and a fixed `s` determines the phase of `z`.
    fn residual(&self, y: &[Dual64], s: &[f64]) -> Vec<Dual64> {
        let numbers: Vec<_> =
            y.as_chunks().0.iter().map(|[re, im]| Complex::new(*re, *im)).collect();
        let (z, kappa) = numbers.split_at(self.count);
        let left = self.value(z).into_iter().zip(z).map(|(g, z)| g - z * kappa[0]);
        let norm = z.iter().fold(-Dual64::one(), |sum, z| sum + z.norm_sqr());
        let phase = z.iter().zip(s.as_chunks::<2>().0);
        let phase = phase.fold(Dual64::zero(), |sum, (z, s)| sum + z.im * s[0] - z.re * s[1]);
        left.flat_map(|c| [c.re, c.im]).chain([norm, phase]).collect()
    }

    /// Computes the first value of `κ`, `s̄·G(s)`: from `κ = 0`, few searches converge to
    /// some of the roots.
    fn rate_along(&self, s: &[f64]) -> [f64; 2] {
        let number = |[re, im]: &[f64; 2]| Complex::new((*re).into(), (*im).into());
        let z: Vec<Complex<Dual64>> = s.as_chunks().0.iter().map(number).collect();
        let products = z.iter().zip(self.value(&z)).map(|(z, g)| z.conj() * g);
        products.fold([0.0; 2], |[re, im], product| [re + product.re.re, im + product.im.re])
    }

    /// Returns the left sides of the equations for a direction, and their Jacobian.
    fn linearised(&self, y: &DVector<f64>, s: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
        let column = |k: usize| {
            let seeded = y.iter().enumerate().map(|(i, y)| Dual64::new(*y, f64::from(i == k)));
            self.residual(&seeded.collect::<Vec<_>>(), s)
        };
        let columns: Vec<Vec<Dual64>> = (0..y.len()).map(column).collect();
        let residual = DVector::from_fn(y.len(), |i, _| columns[0][i].re);
        (residual, DMatrix::from_fn(y.len(), y.len(), |i, j| columns[j][i].eps))
    }

    /// Returns one direction `z` for each value `κ`, in the order of the real parts of `κ`.
    fn directions(&self) -> Vec<Vec<c64>> {
        let mut found: Vec<Vec<c64>> = Vec::new();
        let kappa = |numbers: &[c64]| numbers[self.count];
        for seed in 0..STARTS * self.count {
            let start = starting_direction(2 * self.count, seed);
            let s = start.as_slice();
            let y = DVector::from_vec([s, &self.rate_along(s)].concat());
            let Some(y) = isolated_root(y, |y| self.linearised(y, s)) else { continue };
            let numbers = y.as_slice().as_chunks().0.iter();
            let numbers: Vec<c64> = numbers.map(|[re, im]| c64::new(*re, *im)).collect();
            let distance = |other: &Vec<c64>| (kappa(other) - kappa(&numbers)).norm_sqr().sqrt();
            if found.iter().all(|other| distance(other) > EQUAL) {
                found.push(numbers);
            }
        }
        found.sort_by(|a, b| kappa(a).re.total_cmp(&kappa(b).re));
        found.iter_mut().for_each(|numbers| numbers.truncate(self.count));
        found
    }
}
