//! Conditions of bifurcations, each as a minimally augmented system.
//!
//! A matrix that is singular at the bifurcation is bordered so that it is regular there; the border's
//! multiplier `g` vanishes where the matrix is singular, and its gradient is `−∇(wᵀ F_x v)` with the
//! null vectors `v`, `w` that the bordered system yields (A. Griewank and G. Reddien, *IMA J. Numer.
//! Anal.* 4 (1984); W. Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, SIAM
//! 2000, chapters 3 and 4).

mod branch_point;
mod cusp;
mod fold;
mod hopf;
mod null;

pub use branch_point::{BranchPoint, branches_at};
pub use cusp::{BogdanovTakens, Cusp};
pub use fold::Fold;
pub use hopf::Hopf;

/// A vector without symmetry, the same in every run: a first border, which a null vector is not
/// orthogonal to unless by misfortune.
pub(super) fn generic_vector(length: usize, seed: usize) -> Vec<f64> {
    (0..length).map(|i| (1.0 + (i + 1) as f64 * (0.618 + seed as f64)).sin() + 0.1).collect()
}

fn normalise(v: &mut [f64]) {
    let norm = v.iter().map(|v| v * v).sum::<f64>().sqrt();
    if norm > 0.0 {
        v.iter_mut().for_each(|v| *v /= norm);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
