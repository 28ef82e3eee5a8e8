//! The multipliers of cycles in [families](super::conservative) of conservative systems: a second
//! multiplier is 1, and the other multipliers occur in pairs with the product 1.

use crate::core::bifurcation::{Critical, Stability, without_critical};
use crate::core::linalg::Spectrum;
use crate::core::problem::Dynamics;

/// Discretisation: the moduli of multipliers on the unit circle may have errors of this size.
const NEAR_CIRCLE: f64 = 1e-2;

/// Discretisation: the logarithm of the product of all multipliers may have an error of this size. On the
/// coarsest meshes, large multipliers have relative errors of a few percent.
const NEAR_PRODUCT: f64 = 0.1;

/// Returns the multipliers of a cycle of a family without the second multiplier 1. If the product of
/// the other multipliers is 1, complex multipliers near the unit circle lie on the circle, unless
/// they are half of a quadruple `μ, μ̄, 1/μ, 1/μ̄`.
pub(super) fn besides_second_one(spectrum: &[(f64, f64)]) -> Spectrum {
    let distance = |mu: &(f64, f64)| Critical::One.distance(Dynamics::Periodic, mu);
    let others = without_critical(spectrum, 1, distance);
    let product: f64 = others.iter().map(|(re, im)| re.hypot(*im).ln()).sum();
    if product.abs() > NEAR_PRODUCT {
        return others;
    }
    others.iter().map(|mu| on_circle(*mu, &others)).collect()
}

/// Counts the unstable multipliers of a cycle of a family. Pairs with a product larger than 1 are not
/// counted, because the products of real pairs are 1, up to errors.
pub(super) fn stability(others: &[(f64, f64)]) -> Stability {
    Stability { odd_pairs: false, ..Stability::of(Dynamics::Periodic, others) }
}

/// Returns a multiplier on the unit circle without its numerical error; other multipliers are
/// returned unchanged. The inverse of the conjugate of a multiplier on the circle is the multiplier
/// itself; otherwise it is another multiplier.
fn on_circle(mu: (f64, f64), all: &[(f64, f64)]) -> (f64, f64) {
    let size = mu.0.hypot(mu.1);
    let inverse = (mu.0 / (size * size), mu.1 / (size * size));
    let distance = |other: &(f64, f64)| (other.0 - inverse.0).hypot(other.1 - inverse.1);
    let own = distance(&mu);
    let is_other = |other: &&(f64, f64)| other.0 != mu.0 || other.1.abs() != mu.1.abs();
    let in_quadruple = all.iter().filter(is_other).any(|other| distance(other) < own);
    if mu.1 == 0.0 || (size - 1.0).abs() > NEAR_CIRCLE || in_quadruple {
        return mu;
    }
    (mu.0 / size, mu.1 / size)
}
