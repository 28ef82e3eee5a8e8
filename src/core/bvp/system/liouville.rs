//! Liouville's formula: the product of the multipliers of a smooth periodic orbit is
//! `exp ∫₀ᵀ tr f_x(x(t)) dt`. It tells a multiplier from a rounding error, and gives the one that
//! rounding errors hide.

use super::assembly::Assembly;
use super::discretisation::Discretisation;
use super::mesh_error::MeshError;
use super::phase::Phase;
use super::work::Work;
use crate::core::bvp::erased::Number;
use crate::core::failure::Failure;
use crate::core::linalg::Spectrum;
use crate::core::problem::FieldIn;
use crate::core::scalar::{CHUNK, Chunk};

/// Logarithms of products that differ by no more than this are the same (D): quadratures on meshes
/// that determine anything are far more accurate, and rounding errors in place of a multiplier far
/// less.
const SAME: f64 = std::f64::consts::LN_2;

/// Rows of a pencil that are smaller than this, compared with its largest entry, are errors of
/// rounding and integration (D).
const UNDETERMINED: f64 = 1e-7;

/// The largest error that multipliers are meant to have (H).
const LEAST_ACCURACY: f64 = 1e-2;

/// An error below this size (H) is far from any multiplier on the unit circle.
const HARMLESS: f64 = 1e-3;

/// The solution that is assembled, whose multipliers are asked for.
pub(super) struct Orbit<'a> {
    pub equations: &'a Discretisation,
    pub phase: &'a Phase,
    pub assembled: &'a Assembly,
    pub errors: &'a mut MeshError,
    /// Scratch space.
    pub plain: &'a mut Work<f64>,
}

/// The nontrivial multipliers of a smooth orbit, with Liouville's formula in the place of the
/// one that errors hide.
///
/// # Errors
/// [`Failure::Undetermined`] if errors may hide more than one.
pub(super) fn by_liouville(found: Spectrum, of: &mut Orbit) -> Result<Spectrum, Failure> {
    let largest = found.iter().map(size).fold(1.0, f64::max);
    if !odd(&found) && UNDETERMINED * largest < HARMLESS {
        return Ok(found);
    }
    let product = log_product(of)?;
    resolved(found, product)
}

/// Errors of multipliers in parts of the largest one: those of rounding, integration and mesh.
pub(super) fn accuracy_of_multipliers(of: &mut Orbit) -> f64 {
    let Orbit { equations, assembled, errors, plain, .. } = of;
    plain.load(&equations.layout, |i| assembled.at[i]);
    let error = errors.of(equations, plain);
    UNDETERMINED.max(10.0 * error).min(LEAST_ACCURACY)
}

/// `∫₀ᵀ tr f_x(x(t)) dt` along the orbit assembled last.
fn log_product(of: &mut Orbit) -> Result<f64, Failure> {
    let Orbit { equations, assembled, plain, .. } = of;
    plain.load(&equations.layout, |i| assembled.at[i]);
    let Work { nodes, numbers, local, .. } = &mut **plain;
    let mut sum = 0.0;
    for place in equations.layout.intervals() {
        let interval = equations.interval(place, nodes, numbers);
        let q: Vec<Chunk> = interval.q.iter().map(|q| Chunk::of(*q)).collect();
        let field = Chunk::residual(interval.problem).on_segment(place.0, &q);
        equations.method.quadrature(interval, &mut local.method, &mut |weight, t, x| {
            sum += weight * trace(&field, t, x, &q);
        })?;
    }
    Ok(sum)
}

/// The trace of the Jacobian of a field.
fn trace(field: &impl FieldIn<Chunk>, t: f64, x: &[f64], q: &[Chunk]) -> f64 {
    let mut slope = vec![Chunk::of(0.0); x.len()];
    let mut trace = 0.0;
    for first in (0..x.len()).step_by(CHUNK) {
        let seeded = |(i, x): (usize, &f64)| match i.checked_sub(first) {
            Some(direction) => Chunk::seeded(*x, direction),
            None => Chunk::of(*x),
        };
        let x: Vec<Chunk> = x.iter().enumerate().map(seeded).collect();
        field.slope(Chunk::of(t), &x, q, &mut slope);
        trace += slope[first..].iter().zip(0..CHUNK).map(|(f, i)| f.eps[i]).sum::<f64>();
    }
    trace
}

fn size(mu: &(f64, f64)) -> f64 {
    mu.0.hypot(mu.1)
}

/// The multipliers whose product has a known logarithm. If the product found is another one, or
/// negative, the smallest is an error, and Liouville's formula gives its value. Errors hide more than
/// one if several are small; if those are not all far inside the unit circle, nothing is known, not
/// the sign of the largest one either, whose inverse has as few digits.
fn resolved(mut found: Spectrum, product: f64) -> Result<Spectrum, Failure> {
    found.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let log = |mu: &(f64, f64)| size(mu).clamp(f64::MIN_POSITIVE, f64::MAX).ln();
    let sum: f64 = found.iter().map(log).sum();
    let (negative, last) = (odd(&found), found.len().saturating_sub(1));
    if !negative && (sum - product).abs() <= SAME {
        return Ok(found);
    }
    let errors = UNDETERMINED * found.first().map_or(1.0, size).max(1.0);
    let known = found.iter().take_while(|mu| size(mu) > errors).count();
    match &mut found[known.min(last)..] {
        [hidden] if hidden.1 == 0.0 && size(hidden) < HARMLESS => {
            let sign = if negative { -hidden.0.signum() } else { hidden.0.signum() };
            *hidden = (sign * (product - (sum - log(hidden))).exp(), 0.0);
            Ok(found)
        }
        [largest, ..] if size(largest) < HARMLESS => Ok(found),
        _ => Err(Failure::Undetermined(format!(
            "the multipliers are not determined to working accuracy: their product is {}e^{sum:.1}, and e^{product:.1} by \
             Liouville's formula: take a finer mesh, or stability: false",
            if negative { "-" } else { "" }
        ))),
    }
}

/// Whether the number of negative multipliers is odd: those of a smooth flow have a positive product.
fn odd(found: &[(f64, f64)]) -> bool {
    found.iter().filter(|mu| mu.1 == 0.0 && mu.0 < 0.0).count() % 2 == 1
}
