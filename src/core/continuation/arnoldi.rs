//! Where the matrix of a curve is singular, where no eigenvalues are known.
//!
//! Along a step the matrix `M = [F_z F_p; row]` goes from `M₀` to `M₁`. If it changes linearly, it
//! is singular in between as often as `M₁⁻¹ M₀` has negative eigenvalues. Those differ from 1,
//! which the eigenvalues of two neighbouring discretised operators crowd around, so that a few of
//! Arnoldi's vectors find them. With the derivative `M'` along the tangent, `M + d M'` is singular
//! at the distances `d = −1/λ` with the eigenvalues `λ` of `M⁻¹ M'`: the nearest ones dominate.

use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::extended::{Closing, Extended};
use super::newton::{Newton, scale_to_one, scaled_norm};
use crate::core::failure::Failure;
use crate::core::linalg::{difference, dot, generic, orthogonalise};
use crate::core::system::Refinement;
use nalgebra::{Complex, DMatrix, Schur};

/// (H) If `M` is singular at the arclength `d` beyond a step of length `ℓ`, `M₁⁻¹ M₀ − 1` makes a
/// vector at least `ℓ/d` times its share of the null vector long: from the length follows how far
/// away any singular matrix is. A solution of a problem with generic right sides has a larger share
/// than this of all null vectors but those that oscillate fast. (A generic vector itself has not,
/// if it has many components.) A smaller share costs more counts, a larger one misses null vectors.
const SHARE: f64 = 0.02;

/// (H) The most lengths of a step that are looked ahead: farther away matrices may have changed in
/// another way.
const AHEAD: f64 = 12.0;

/// (H) The most vectors spent on counting: all eigenvalues but those that pass are near 1.
const VECTORS: usize = 10;

/// (H) Vectors whose new part is smaller than this have been spent: an eigenvalue below zero that
/// is still missing, whose distance from 1 is more than 1, would make it larger.
const SPENT: f64 = 1e-2;

/// Eigenvalues with a smaller imaginary part, compared with the real one, are real: Arnoldi's
/// iteration ends at residuals of [`SPENT`], which may split two equal eigenvalues by as much as
/// the square root of that.
const REAL: f64 = 0.1;

fn is_real(value: &Complex<f64>) -> bool {
    value.im.abs() <= REAL * value.re.abs()
}

/// (R) A matrix that makes generic vectors larger than this, compared with a neighbouring one, is
/// singular but for rounding: the inverse of √ε.
const SINGULAR: f64 = 1e8;

/// (H) The number of vectors that distances are looked for from: one vector shows one of several
/// equal eigenvalues, and more than this many do not pass together.
const BLOCK: usize = 6;

/// (H) The most iterations for the eigenvalues of a matrix with at most 18 rows, which takes about
/// two for each.
const ITERATIONS: usize = 1000;

/// The branch points in a step.
#[derive(Clone, Copy, Default)]
pub(super) struct Crossings {
    /// Their number, as far as a linear change of the matrix tells.
    pub count: usize,
    /// Whether the end of the step is a branch point itself, but for rounding.
    pub singular: bool,
    /// The arclength beyond the step in which there is none.
    pub quiet: f64,
}

/// The matrix of a curve's equations that was factored last, and the weights of the scaled norm.
struct Factored<'p, 'a> {
    equations: &'p mut Extended<'a>,
    weights: &'p [f64],
}

impl<'p, 'a> Factored<'p, 'a> {
    fn of(corrector: &'p mut Corrector<'a>) -> Self {
        Factored { equations: &mut corrector.equations, weights: &corrector.norm.weights }
    }

    /// `M⁻¹` times a generic vector, of scaled length 1.
    fn solution_of_generic(&mut self, seed: usize) -> Vec<f64> {
        let mut solution = generic(self.equations.length(), seed);
        self.equations.factors.solve(&mut solution);
        scale_to_one(&mut solution, self.weights);
        solution
    }

    /// Makes a vector orthogonal to others of scaled length 1, and of that length itself; its
    /// overlaps with them, and the length of what was left of it.
    fn orthogonal(&self, v: &mut [f64], others: &[Vec<f64>]) -> (Vec<f64>, f64) {
        let product = |a: &[f64], b: &[f64]| -> f64 {
            a.iter().zip(b).zip(self.weights).map(|((a, b), w)| a * b * w).sum()
        };
        let overlaps = orthogonalise(v, others, product);
        (overlaps, scale_to_one(v, self.weights))
    }

    /// The eigenvalues of an operator on the Krylov space of some vectors (Arnoldi), whose
    /// dimension is at most `most`; none where the operator has no meaning.
    fn ritz_values(
        &mut self,
        starts: Vec<Vec<f64>>,
        most: usize,
        operator: impl Fn(&mut Self, &[f64]) -> Result<Vec<f64>, Failure>,
    ) -> Vec<Complex<f64>> {
        let (mut basis, mut h) = (Vec::new(), DMatrix::<f64>::zeros(most, most));
        for mut start in starts {
            let (_, size) = self.orthogonal(&mut start, &basis);
            if size > SPENT {
                basis.push(start);
            }
        }
        let mut used = 0;
        while used < basis.len().min(most) {
            let Ok(mut v) = operator(self, &basis[used]) else { return Vec::new() };
            let (overlaps, size) = self.orthogonal(&mut v, &basis);
            if !overlaps.iter().chain([&size]).all(|number| number.is_finite()) {
                return Vec::new();
            }
            for (j, overlap) in overlaps.into_iter().enumerate().take(most) {
                h[(j, used)] = overlap;
            }
            if size > SPENT && basis.len() < most {
                h[(basis.len(), used)] = size;
                basis.push(v);
            }
            used += 1;
        }
        let square = h.view((0, 0), (used, used)).into_owned();
        let schur = Schur::try_new(square, f64::EPSILON, ITERATIONS);
        schur.map_or_else(Vec::new, |schur| schur.complex_eigenvalues().iter().copied().collect())
    }

    /// `M⁻¹ M₀ v` with the matrix `M₀` of another point and this row.
    fn carried_back(&mut self, from: &[f64], row: &[f64], v: &[f64]) -> Result<Vec<f64>, Failure> {
        let direction = self.equations.direction_of(v);
        self.solved(from, &[&direction], dot(row, v))
    }

    /// `M⁻¹ M' v` with the derivative of the matrix along the tangent, where it was factored.
    fn changed(
        &mut self,
        unknowns: &[f64],
        tangent: &[f64],
        v: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        let [along, direction] = [tangent, v].map(|v| self.equations.direction_of(v));
        self.solved(unknowns, &[&along, &direction], 0.0)
    }

    /// `M⁻¹ (F_x[…], last)` with a derivative at a point.
    fn solved(
        &mut self,
        unknowns: &[f64],
        directions: &[&[f64]],
        last: f64,
    ) -> Result<Vec<f64>, Failure> {
        let n = self.equations.dimension();
        let x = self.equations.load(unknowns).to_vec();
        let mut out = vec![0.0; unknowns.len()];
        self.equations.system().derivative(&x, directions, &mut out[..n])?;
        out[unknowns.len() - 1] = last;
        self.equations.factors.solve(&mut out);
        Ok(out)
    }

    /// The distances along the curve from a point, with this tangent, to the nearest singular
    /// matrices, the nearest first.
    fn distances(mut self, unknowns: &[f64], tangent: &[f64]) -> Result<Vec<f64>, Failure> {
        let row: Vec<f64> = tangent.iter().zip(self.weights).map(|(t, w)| t * w).collect();
        self.equations.assemble(unknowns)?;
        self.equations.factor(Some(&row))?;
        let starts = (0..BLOCK).map(|k| self.solution_of_generic(5 + 10 * k)).collect();
        let operator = |own: &mut Self, v: &[f64]| own.changed(unknowns, tangent, v);
        let values = self.ritz_values(starts, 3 * BLOCK, operator);
        let real = values.iter().filter(|l| l.re != 0.0 && is_real(l));
        let mut distances: Vec<f64> = real.map(|l| -1.0 / l.re).collect();
        distances.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        Ok(distances)
    }
}

/// The branch points in a step of this length. The matrix factored last is the one at its end, with
/// this row.
pub(super) fn count_crossings(
    corrector: &mut Corrector,
    from: &CurvePoint,
    row: &[f64],
    length: f64,
) -> Crossings {
    if from.quiet >= length {
        return Crossings { quiet: from.quiet - length, ..Crossings::default() };
    }
    let mut factored = Factored::of(corrector);
    let start = factored.solution_of_generic(5);
    let carried = factored.carried_back(&from.unknowns, row, &start);
    let Ok(moved) = carried else { return Crossings::default() };
    let size = scaled_norm(&difference(&moved, &start), factored.weights);
    if !(SHARE..=SINGULAR).contains(&size) {
        let quiet = if size < SHARE { (SHARE / size).min(AHEAD) * length } else { 0.0 };
        return Crossings { count: 0, singular: size > SINGULAR, quiet };
    }
    let operator = |own: &mut Factored, v: &[f64]| own.carried_back(&from.unknowns, row, v);
    let values = factored.ritz_values(vec![start], VECTORS, operator);
    // The matrix of a branch point that the curve leaves has the eigenvalue 0, up to the residual.
    let least = if from.determinant == 0.0 { SPENT } else { 0.0 };
    let passes = |l: &&Complex<f64>| l.re < -least && is_real(l);
    Crossings { count: values.iter().filter(passes).count(), ..Crossings::default() }
}

/// The distances along the curve from a point to the nearest branch points, the nearest first;
/// `None` if they are not known.
pub(super) fn distances(corrector: &mut Corrector, place: &CurvePoint) -> Option<Vec<f64>> {
    Factored::of(corrector).distances(&place.unknowns, &place.tangent).ok()
}

/// The distance between the nearest branch point of this multiplicity and the same one on a finer
/// discretisation, as seen from a point: 0 for equations that are exact as they stand, or if no
/// special point is refined.
pub(super) fn shift_on_finer(
    corrector: &mut Corrector,
    refines: bool,
    place: &CurvePoint,
    count: usize,
) -> Option<f64> {
    let mean = |distances: Vec<f64>| {
        (distances.len() >= count).then(|| distances[..count].iter().sum::<f64>() / count as f64)
    };
    let here = mean(distances(corrector, place)?)?;
    let Corrector { equations: coarse, tolerances, .. } = corrector;
    let x = coarse.load(&place.unknowns).to_vec();
    if !refines || coarse.system().representation().mesh.is_empty() {
        return Some(0.0);
    }
    let Refinement { mut system, x } = coarse.system().discretised()?.refined(&x)?;
    let (released, sign) =
        (coarse.released.to_vec(), place.tangent[coarse.parameters_at()].signum());
    let tolerances = *tolerances;
    let weights = corrector.norm.metric.weights(system.names());
    let mut equations = Extended::new(&mut *system, &x, released);
    let base = equations.unload(&x);
    let (mut unknowns, parameter) = (base.clone(), equations.parameters_at());
    let mut row = vec![0.0; base.len()];
    row[parameter] = sign;
    let closing = Closing { row: &row, base: &base, length: 0.0 };
    let newton = &mut Newton::default();
    newton.solve(&mut equations, &mut unknowns, Some(closing), &weights, tolerances).ok()?;
    equations.assemble(&unknowns).ok()?;
    equations.factor(Some(&row)).ok()?;
    let mut tangent = vec![0.0; base.len()];
    equations.tangent(&mut tangent);
    scale_to_one(&mut tangent, &weights);
    let factored = Factored { equations: &mut equations, weights: &weights };
    let there = mean(factored.distances(&unknowns, &tangent).ok()?)?;
    Some((there - here).abs())
}
