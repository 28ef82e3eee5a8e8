//! The largest eigenvalues of a matrix that is given by its products with vectors.

use super::block::LANES;
use super::krylov::{Krylov, RitzPairs};
use crate::core::failure::Failure;
use crate::core::linalg::{Spectrum, generic};
use std::mem::take;

/// Rounding: the error at which an eigenvalue counts as converged, relative to the largest
/// eigenvalue (or to 1, if all eigenvalues are smaller).
const CONVERGED: f64 = 1e-11;

/// Heuristic: the number of eigenvectors of the previous matrix with which a Krylov space begins, in
/// addition to one random vector.
const WARM: usize = LANES - 1;

/// Heuristic: the largest number of eigenvalues inside the unit circle that are computed.
const MOST: usize = 48;

/// The description of the requested eigenvalues in error messages.
const LARGEST: &str = "largest Floquet multipliers";

/// Several vectors of the same length side by side.
pub(in crate::core) type Lanes = [[f64; LANES]];

/// The largest eigenvalues of matrices along a branch, by a block Arnoldi method (Y. Saad, *Numerical
/// Methods for Large Eigenvalue Problems*, SIAM 2011, ch. 6) that begins with the eigenvectors of the
/// previous matrix.
#[derive(Default)]
pub(in crate::core) struct Largest {
    start: Vec<Vec<f64>>,
}

impl Largest {
    /// Computes all eigenvalues with a modulus above 1, and the `least` largest other eigenvalues (at
    /// most 48), of an `n × n` matrix; `apply` replaces vectors by their products with the matrix.
    ///
    /// # Errors
    /// [`Failure::Eigenvalues`] if the eigenvalues do not converge.
    pub fn outside(
        &mut self,
        (n, least): (usize, usize),
        mut apply: impl FnMut(&mut Lanes),
    ) -> Result<Spectrum, Failure> {
        let least = least.min(MOST).min(n.saturating_sub(1));
        let mut start = take(&mut self.start);
        start.truncate(WARM);
        let random = (start.len()..LANES.min(n)).map(|k| generic(n, k + 1));
        let random: Vec<Vec<f64>> = random.collect();
        start.extend(random);
        let mut space = Krylov::new(&start, (&[], None), n);
        loop {
            space.grow(&mut apply);
            let complete = space.is_complete();
            if space.images < 2 * least && !complete {
                continue;
            }
            let ritz = space.ritz()?;
            let wanted = wanted(&ritz, least);
            let largest = ritz.order.first().map_or(0.0, |&k| ritz.size(k)).max(1.0);
            let within = |k: &usize| ritz.errors[*k] <= CONVERGED * largest;
            if wanted.iter().all(within) && (wanted.len() > least || complete) {
                self.start = ritz.vectors_in(wanted.iter().take(WARM), &space.vectors);
                return Ok(wanted
                    .iter()
                    .map(|&k| (ritz.values[k].re, ritz.values[k].im))
                    .collect());
            }
            if complete {
                return Err(Failure::Eigenvalues(LARGEST));
            }
        }
    }
}

/// Returns the positions of the eigenvalues outside the unit circle, and of at least `least + 1`
/// others, starting with the largest.
fn wanted(ritz: &RitzPairs, least: usize) -> Vec<usize> {
    let outside = ritz.order.iter().take_while(|&&k| ritz.size(k) > 1.0).count();
    let mut count = (outside + least + 1).min(ritz.order.len());
    // Both eigenvalues of a complex pair.
    if count > 0 && ritz.values[ritz.order[count - 1]].im > 0.0 {
        count = (count + 1).min(ritz.order.len());
    }
    ritz.order[..count].to_vec()
}
