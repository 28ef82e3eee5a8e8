//! Liouville's formula: the product of the Floquet multipliers of a smooth periodic orbit is
//! `exp ∫₀ᵀ tr f_x(x(t)) dt`. The formula detects rounding errors in computed multipliers, and
//! determines the multiplier that a rounding error replaces.

use super::assembly::AssembledJacobian;
use super::discretisation::DiscretisedProblem;
use super::mesh_error::MeshError;
use super::phase::Phase;
use super::work::Work;
use crate::core::bvp::erased::Number;
use crate::core::failure::Failure;
use crate::core::linalg::Spectrum;
use crate::core::problem::FieldIn;
use crate::core::scalar::{CHUNK, Chunk, seeded};

/// Discretisation: two products of multipliers agree if the difference of their logarithms is
/// smaller than this bound. The quadrature of the trace is far more accurate than this tolerance; a
/// product in which a rounding error replaces a multiplier is wrong by orders of magnitude.
const SAME: f64 = std::f64::consts::LN_2;

/// Heuristic: the formula determines a multiplier near 1 only if the error of the logarithm is
/// smaller than this bound.
const SMALL: f64 = 1e-3;

/// Rounding: the range of logarithms of numbers that neither underflow nor overflow.
const LOGARITHMS: [f64; 2] = [-708.0, 709.0];

/// Discretisation: multipliers smaller than this fraction of the largest multiplier may consist of
/// errors of rounding and integration.
const UNDETERMINED: f64 = 1e-7;

/// Heuristic: the largest relative error that is assumed for computed multipliers.
const LEAST_ACCURACY: f64 = 1e-2;

/// Heuristic: a multiplier whose error is at most this size is far from the unit circle.
const HARMLESS: f64 = 1e-3;

/// A periodic orbit whose equations are assembled.
pub(super) struct Orbit<'a> {
    pub equations: &'a DiscretisedProblem,
    pub phase: &'a Phase,
    pub assembled: &'a AssembledJacobian,
    pub errors: &'a mut MeshError,
    /// Scratch space.
    pub plain: &'a mut Work<f64>,
}

impl Orbit<'_> {
    /// Returns the vector field at a node of the orbit that was assembled last.
    pub fn motion_at(&self, node: usize) -> Vec<f64> {
        let (layout, at) = (&self.equations.layout, &self.assembled.at);
        let s = &layout.segments[0];
        let x: Vec<f64> = (0..s.states).map(|i| at[s.values + i * s.nodes + node]).collect();
        let q: Vec<f64> = (0..layout.numbers()).map(|k| at[layout.number(k)]).collect();
        let field = f64::residual(&*self.equations.problem).on_segment(0, &q);
        let mut motion = vec![0.0; s.states];
        field.slope(0.0, &x, &q, &mut motion);
        motion
    }
}

/// Returns the nontrivial Floquet multipliers of a smooth orbit, checked by Liouville's formula. A
/// multiplier that is lost in rounding errors, or that the mesh does not resolve, is replaced by
/// its value from Liouville's formula if the formula determines it.
///
/// # Errors
/// [`Failure::Undetermined`] if Liouville's formula contradicts the multipliers and does not
/// determine any of them.
pub(super) fn by_liouville(
    found: Result<Spectrum, Failure>,
    of: &mut Orbit,
) -> Result<Spectrum, Failure> {
    let layout = &of.equations.layout;
    let found = match found {
        // The formula alone determines a single multiplier.
        Err(Failure::Undetermined(_)) if layout.states == 1 + usize::from(layout.phase) => {
            vec![(f64::NAN, 0.0)]
        }
        found => found?,
    };
    let hides = |mu: &(f64, f64)| mu.0.is_nan() || UNDETERMINED * size(mu) >= HARMLESS;
    // The formula gives a single multiplier more accurately.
    let suspect = found.len() == 1 || odd(&found) || found.iter().any(hides);
    match log_product(of, suspect)? {
        Some(product) => resolved(found, product),
        None => Ok(found),
    }
}

/// Returns the errors of multipliers due to rounding, integration and mesh, relative to the largest
/// multiplier.
pub(super) fn accuracy_of_multipliers(of: &mut Orbit) -> f64 {
    let Orbit { equations, assembled, errors, plain, .. } = of;
    plain.load(&equations.layout, |i| assembled.at[i]);
    let error = errors.of(equations, plain);
    UNDETERMINED.max(10.0 * error).min(LEAST_ACCURACY)
}

/// The logarithm of the product of all Floquet multipliers, with an error estimate.
#[derive(Clone, Copy)]
struct LogProduct {
    /// The integral `∫₀ᵀ tr f_x(x(t)) dt`.
    value: f64,
    /// The estimated error of the integral of the trace: the mesh error times the integral of the
    /// trace's absolute value.
    error: f64,
}

/// Computes the logarithm of the product of multipliers along the orbit that was assembled last; if
/// the assembled equations do not contain the trace, the logarithm is computed only for suspect
/// multipliers.
fn log_product(of: &mut Orbit, suspect: bool) -> Result<Option<LogProduct>, Failure> {
    let share = accuracy_of_multipliers(of);
    let (layout, assembled) = (&of.equations.layout, of.assembled);
    let s = &layout.segments[0];
    let block = layout.degree * s.states * (layout.degree + 1) * s.states;
    let mut sums = [0.0; 2];
    let held = assembled.blocks[0].chunks_exact(block).all(|block| {
        let integrals = of.equations.method.trace_integrals(block, s.states);
        integrals.is_some_and(|[trace, modulus]| {
            sums = [sums[0] + trace, sums[1] + modulus];
            true
        })
    });
    match (held, suspect) {
        (true, _) => Ok(Some(LogProduct { value: sums[0], error: share * sums[1] })),
        (false, true) => Ok(Some(LogProduct { value: integral(of)?, error: 0.0 })),
        (false, false) => Ok(None),
    }
}

/// Computes the integral of the trace by a quadrature along the orbit.
fn integral(of: &mut Orbit) -> Result<f64, Failure> {
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

/// Returns the trace of the Jacobian of a vector field.
fn trace(field: &impl FieldIn<Chunk>, t: f64, x: &[f64], q: &[Chunk]) -> f64 {
    let mut slope = vec![Chunk::of(0.0); x.len()];
    let mut trace = 0.0;
    for first in (0..x.len()).step_by(CHUNK) {
        let x: Vec<Chunk> = x.iter().enumerate().map(|(i, x)| seeded(*x, i, first)).collect();
        field.slope(Chunk::of(t), &x, q, &mut slope);
        trace += slope[first..].iter().zip(0..CHUNK).map(|(f, i)| f.eps[i]).sum::<f64>();
    }
    trace
}

fn size(mu: &(f64, f64)) -> f64 {
    mu.0.hypot(mu.1)
}

/// Corrects multipliers by means of their known product. If the product of the computed multipliers
/// differs from the formula or is negative, the formula determines a single multiplier; if there
/// are several, it determines the smallest one, provided that this multiplier is a rounding error.
/// If several multipliers are below the error of the largest multiplier, the formula does not
/// determine them; the computed multipliers are kept if all of them are far inside the unit circle.
/// If not all multipliers are far inside the unit circle, even the sign of the largest multiplier
/// is uncertain, because no digit of its inverse is correct.
fn resolved(mut found: Spectrum, product: LogProduct) -> Result<Spectrum, Failure> {
    let LogProduct { value: product, error } = product;
    found.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let log = |mu: &(f64, f64)| size(mu).clamp(f64::MIN_POSITIVE, f64::MAX).ln();
    let sum: f64 = found.iter().map(log).sum();
    let (negative, last) = (odd(&found), found.len().saturating_sub(1));
    let differs = (sum - product.clamp(LOGARITHMS[0], LOGARITHMS[1])).abs() > SAME;
    // A single multiplier is given by the formula: in a canard explosion, rounding errors grow by
    // orders of magnitude before they shrink again.
    if let [only] = &mut found[..]
        && (product.abs() > error || error < SMALL)
        && ((sum - product).abs() > error.min(SAME) || negative || !sum.is_finite())
    {
        *only = (product.exp(), 0.0);
        return Ok(found);
    }
    if !negative && !differs && sum.is_finite() {
        return Ok(found);
    }
    // A contraction that the mesh does not resolve is a contraction of the discrete equations, too.
    if !negative && product < sum && found.iter().all(|mu| size(mu) < 1.0) {
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
            "the Floquet multipliers are not determined to working accuracy: their product is \
             {}e^{sum:.1}, but must be e^{product:.1} by Liouville's formula: use a finer mesh, or \
             `stability: false`",
            if negative { "-" } else { "" }
        ))),
    }
}

/// Whether the number of negative multipliers is odd, which is impossible for a smooth flow: the
/// product of its multipliers is positive.
fn odd(found: &[(f64, f64)]) -> bool {
    found.iter().filter(|mu| mu.1 == 0.0 && mu.0 < 0.0).count() % 2 == 1
}
