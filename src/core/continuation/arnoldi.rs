//! Detection of singular Jacobians along a curve by Arnoldi's method, without computing the
//! eigenvalues of `F_z`.
//!
//! Along a step, the matrix `M = [F_z F_p; row]` changes from `M₀` to `M₁`. If the matrix changes
//! linearly, the number of singular matrices along the step is the number of negative eigenvalues
//! of `M₁⁻¹ M₀`. The other eigenvalues of `M₁⁻¹ M₀` cluster around 1, since `M₀` and `M₁` are
//! neighbouring discretised operators. The negative eigenvalues of `M₁⁻¹ M₀` are therefore found
//! with a few Arnoldi vectors. Let `M'` be the derivative of `M` along the tangent. `M + d M'` is
//! singular at the distances `d = −1/λ`, where `λ` are the eigenvalues of `M⁻¹ M'`: the dominant
//! eigenvalues give the nearest distances.

use super::corrector::Corrector;
use super::curve_point::CurvePoint;
use super::extended::{Closing, Extended};
use super::newton::{Newton, scale_to_one, scaled_norm};
use crate::core::failure::Failure;
use crate::core::linalg::{difference, dot, generic, orthogonalise};
use crate::core::system::Refinement;
use nalgebra::{Complex, DMatrix, Schur};

/// Heuristic: a test vector is assumed to have at least this component along every null vector. Let
/// `M` be singular at the arclength `d` beyond a step of length `ℓ`. The matrix `M₁⁻¹ M₀ − 1` maps
/// a vector to a vector whose length is at least `ℓ/d` times the component of the original vector
/// along the null vector. The length of the image of a vector therefore gives a lower bound of the
/// distance along the curve to any singular matrix. The solution of a linear system with a generic
/// right side has a component larger than this constant along all null vectors except rapidly
/// oscillating ones. (A generic vector itself has a smaller component if its dimension is large.)
/// With a smaller constant, branch points are counted more often; with a larger constant, null
/// vectors are missed.
const SHARE: f64 = 0.02;

/// Heuristic: the maximal distance beyond a step, in units of the step length, up to which branch
/// points are excluded: farther along the curve, the matrix may change differently.
const AHEAD: f64 = 12.0;

/// Heuristic: the maximal number of Arnoldi vectors for counting branch points. A few Arnoldi
/// vectors suffice because all eigenvalues of `M₁⁻¹ M₀` are near 1, except the eigenvalues that
/// pass zero.
const VECTORS: usize = 10;

/// Heuristic: the Arnoldi iteration stops when the new vector, before normalisation, is shorter
/// than this threshold. A negative eigenvalue of `M₁⁻¹ M₀` differs from 1 by more than 1; if it
/// were not yet found, the new Arnoldi vector would be longer than the threshold.
const SPENT: f64 = 1e-2;

/// The ratio of imaginary to real part below which an eigenvalue counts as real. The Arnoldi
/// iteration stops at residuals of [`SPENT`]; such a residual may split two equal real eigenvalues
/// into a complex pair whose imaginary part is the square root of the residual.
const REAL: f64 = 0.1;

fn is_real(value: &Complex<f64>) -> bool {
    value.im.abs() <= REAL * value.re.abs()
}

/// Rounding: a matrix is singular up to rounding if its inverse enlarges generic vectors by more
/// than this threshold, compared with the inverse of a neighbouring matrix. The threshold for
/// singular matrices is 1/√ε.
const SINGULAR: f64 = 1e8;

/// Heuristic: the number of starting vectors for computing distances to branch points. One starting
/// vector finds only one of several equal eigenvalues, and at most this number of eigenvalues is
/// assumed to pass zero together.
const BLOCK: usize = 6;

/// Heuristic: the maximal number of iterations of the Schur decomposition of a matrix with at most
/// 18 rows; each eigenvalue requires about two iterations.
const ITERATIONS: usize = 1000;

/// The branch points along one step of a curve.
#[derive(Clone, Copy, Default)]
pub(super) struct Crossings {
    /// The number of branch points along the step, which is exact if the matrix changes linearly.
    pub count: usize,
    /// Whether the end of the step is itself a branch point, up to rounding.
    pub singular: bool,
    /// The distance beyond the end of the step up to which the curve contains no branch point.
    pub quiet: f64,
}

/// The last factored matrix of a curve's equations, and the weights of the scaled norm.
struct Factored<'p, 'a> {
    equations: &'p mut Extended<'a>,
    weights: &'p [f64],
}

impl<'p, 'a> Factored<'p, 'a> {
    fn of(corrector: &'p mut Corrector<'a>) -> Self {
        Factored { equations: &mut corrector.equations, weights: &corrector.norm.weights }
    }

    /// Computes the product of `M⁻¹` and a generic vector, and scales it to length 1.
    fn solution_of_generic(&mut self, seed: usize) -> Vec<f64> {
        let mut solution = generic(self.equations.length(), seed);
        self.equations.factors.solve(&mut solution);
        scale_to_one(&mut solution, self.weights);
        solution
    }

    /// Makes a vector orthogonal to other vectors of scaled length 1 and scales it to length 1.
    /// Returns the vector's inner products with the other vectors, and the vector's length after
    /// orthogonalisation.
    fn orthogonal(&self, v: &mut [f64], others: &[Vec<f64>]) -> (Vec<f64>, f64) {
        let product = |a: &[f64], b: &[f64]| -> f64 {
            a.iter().zip(b).zip(self.weights).map(|((a, b), w)| a * b * w).sum()
        };
        let overlaps = orthogonalise(v, others, product);
        (overlaps, scale_to_one(v, self.weights))
    }

    /// Computes the Ritz values of an operator by Arnoldi's method, on the Krylov space of the
    /// given starting vectors with a dimension of at most `most`; empty if the operator cannot be
    /// evaluated.
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

    /// Computes `M⁻¹ M₀ v`, where `M₀` is the matrix at the point `from` with the last row `row`.
    fn carried_back(&mut self, from: &[f64], row: &[f64], v: &[f64]) -> Result<Vec<f64>, Failure> {
        let direction = self.equations.direction_of(v);
        self.solved(from, &[&direction], dot(row, v))
    }

    /// Computes `M⁻¹ M' v`, where `M'` is the derivative of `M` along the tangent at the point of
    /// the factored matrix `M`.
    fn changed(
        &mut self,
        unknowns: &[f64],
        tangent: &[f64],
        v: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        let [along, direction] = [tangent, v].map(|v| self.equations.direction_of(v));
        self.solved(unknowns, &[&along, &direction], 0.0)
    }

    /// Computes `M⁻¹ (b, last)`, where `b` is the derivative of `F` along the given directions at a
    /// point.
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

    /// Returns the distances along the curve from a point with the given tangent to the nearest
    /// points where the matrix `M` of the curve's equations is singular, in increasing order.
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

/// Counts the branch points along a step of the given length. The last factored matrix must be the
/// matrix at the end of the step, with the last row `row`.
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
    // If the curve starts at a branch point, its matrix has the eigenvalue 0 there, up to the
    // residual.
    let least = if from.determinant == 0.0 { SPENT } else { 0.0 };
    let passes = |l: &&Complex<f64>| l.re < -least && is_real(l);
    Crossings { count: values.iter().filter(passes).count(), ..Crossings::default() }
}

/// Returns the distances along the curve from a point to the nearest branch points, in increasing
/// order; `None` if the distances cannot be computed.
pub(super) fn distances(corrector: &mut Corrector, place: &CurvePoint) -> Option<Vec<f64>> {
    Factored::of(corrector).distances(&place.unknowns, &place.tangent).ok()
}

/// Computes by how much a branch point moves along the curve when the discretisation is refined:
/// the difference of its distances from a given point, computed on the two discretisations. Of the
/// branch points with the multiplicity `count`, the branch point nearest to the given point is
/// used. The shift of a branch point is 0 for equations that are not discretised, or if special
/// points are not refined.
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
