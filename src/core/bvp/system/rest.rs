//! Equilibria of a vector field, their linearisation, and their critical eigenvalues.

use super::discretisation::DiscretisedProblem;
use crate::core::bvp::erased::{Equations, Number};
use crate::core::failure::{Failure, unusable};
use crate::core::linalg::{balance, norm};
use crate::core::problem::FieldIn;
use crate::core::scalar::{CHUNK, Chunk, seeded};
use crate::core::system::{Solution, mixed, moving, third};
use faer::c64;
use nalgebra::{DMatrix, DVector, Dyn, LU};
use num_dual::{Dual, Dual2};
use std::f64::consts::TAU;

/// Computes the Jacobian of a segment's vector field with respect to the segment's states, column
/// by column.
pub(super) fn jacobian(
    problem: &dyn Equations,
    segment: usize,
    x: &[f64],
    q: &[f64],
) -> Result<Vec<f64>, Failure> {
    let (n, zero) = (x.len(), Chunk::from(0.0));
    let real = f64::residual(problem).on_segment(segment, q);
    real.domain(x, q)?;
    let q: Vec<Chunk> = q.iter().map(|q| Chunk::from(*q)).collect();
    let field = Chunk::residual(problem).on_segment(segment, &q);
    let (mut columns, mut f) = (vec![0.0; n * n], vec![zero; n]);
    for first in (0..n).step_by(CHUNK) {
        let x: Vec<Chunk> = x.iter().enumerate().map(|(i, x)| seeded(*x, i, first)).collect();
        field.slope(zero, &x, &q, &mut f);
        for (i, f) in f.iter().enumerate() {
            (first..n).zip(f.eps).for_each(|(j, part)| columns[j * n + i] = part);
        }
    }
    Ok(columns)
}

/// Rounding: an equilibrium counts as the origin if all its states, in their units, are smaller
/// than this bound.
const AT_ORIGIN: f64 = 1e-6;

/// Heuristic: the largest absolute value of the real part of a critical pair of eigenvalues, in
/// units of the imaginary part.
const NEAR_THE_AXIS: f64 = 1e-4;

/// Rounding: a component of an eigenvector of the balanced matrix that is smaller than this fraction of
/// the largest component is zero up to rounding, as for states that do not oscillate in the mode.
const STILL: f64 = 1e-13;

/// The name of the eigenvalues in errors.
const AT_HOPF: &str = "eigenvalues at the Hopf point";

/// Heuristic: the number of samples on an ellipse about the equilibrium.
const PHASES: usize = 8;

/// An eigenvalue with its eigenvector.
#[derive(Clone)]
pub(super) struct Mode {
    pub value: c64,
    pub vector: Vec<c64>,
}

/// Computes the eigenvalues and eigenvectors of a matrix that is stored column by column.
fn modes(matrix: &[f64], n: usize) -> Result<Vec<Mode>, Failure> {
    let mut balanced = matrix.to_vec();
    let units = balance(&mut balanced, n);
    let matrix = faer::MatRef::from_column_major_slice(&balanced, n, n);
    let decomposition = matrix.eigen().map_err(|_| Failure::Eigenvalues(AT_HOPF))?;
    let (values, vectors) = (decomposition.S().column_vector(), decomposition.U());
    let size = |entry: c64| entry.re.hypot(entry.im);
    let vector = |k: usize| {
        let column = (0..n).map(|i| vectors[(i, k)]);
        let largest = column.clone().map(size).fold(0.0, f64::max);
        let moves = |v: c64| if size(v) > STILL * largest { v } else { c64::new(0.0, 0.0) };
        column.zip(&units).map(|(v, unit)| moves(v) * *unit).collect()
    };
    Ok((0..n).map(|k| Mode { value: values[k], vector: vector(k) }).collect())
}

/// A direction in the space of states and parameters; the parameters are given by their positions.
pub(super) struct Direction {
    pub states: Vec<f64>,
    pub parameters: Vec<(usize, f64)>,
}

impl Direction {
    fn of_states(states: Vec<f64>) -> Self {
        Direction { states, parameters: Vec::new() }
    }

    fn by(&self, parameter: usize) -> f64 {
        let own = self.parameters.iter().filter(|(p, _)| *p == parameter);
        own.map(|(_, part)| part).sum()
    }
}

/// The factors of a matrix `s − F_x`.
pub(super) struct Shifted(LU<c64, Dyn, Dyn>);

impl Shifted {
    /// Solves `(s − F_x) x = right`.
    pub fn solve(&self, right: &[c64]) -> Result<Vec<c64>, Failure> {
        let solution = self.0.solve(&DVector::from_column_slice(right));
        let sizes = || self.0.u().diagonal().map(|pivot| pivot.norm_sqr().sqrt());
        let solution = solution.ok_or_else(|| unusable(sizes().min(), sizes().max()))?;
        Ok(solution.iter().copied().collect())
    }
}

/// An equilibrium of a vector field, from which cycles emanate.
pub(super) struct Rest<'a> {
    problem: &'a dyn Equations,
    pub state: &'a [f64],
    /// The parameters, followed by the value 1 for each extra unknown.
    q: Vec<f64>,
    jacobian: Vec<f64>,
    modes: Vec<Mode>,
}

impl<'a> Rest<'a> {
    /// Creates the equilibrium of a saved solution.
    pub fn new(on: &'a DiscretisedProblem, solution: &'a Solution) -> Result<Self, Failure> {
        let (problem, state) = (&*on.problem, &solution.state[..]);
        let mut q = solution.parameters.clone();
        q.resize(on.layout.numbers(), 1.0);
        let jacobian = jacobian(problem, 0, state, &q)?;
        let modes = modes(&jacobian, state.len())?;
        Ok(Rest { problem, state, q, jacobian, modes })
    }

    /// Returns the typical sizes of the states.
    pub fn units(&self) -> Vec<f64> {
        let mut units = self.problem.scales(0, &self.q);
        units.resize(self.state.len().max(units.len()), 1.0);
        units
    }

    /// Returns the complex pairs, represented by the eigenvalues above the real axis; the pairs nearest
    /// to the imaginary axis, or to a known frequency, come first.
    fn pairs(&self, known: Option<f64>) -> Vec<&Mode> {
        let distance = |mode: &Mode| match known {
            Some(omega) => mode.value.re.hypot(mode.value.im - omega),
            None => mode.value.re.abs(),
        };
        let mut pairs: Vec<&Mode> = self.modes.iter().filter(|it| it.value.im > 0.0).collect();
        pairs.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        pairs
    }

    /// Returns the critical pair of eigenvalues, or the pair with a known frequency.
    pub fn critical_pair(&self, known: Option<f64>) -> Result<Mode, Failure> {
        let [pair] = self.critical_pairs(known)?;
        Ok(pair)
    }

    /// Returns several critical pairs of eigenvalues, starting with the pair nearest to a known
    /// frequency.
    pub fn critical_pairs<const N: usize>(&self, known: Option<f64>) -> Result<[Mode; N], Failure> {
        let pairs: Vec<Mode> = self.pairs(known).into_iter().take(N).cloned().collect();
        let off_axis = |it: &&Mode| it.value.re.abs() > NEAR_THE_AXIS * it.value.im;
        if let Some(Mode { value, .. }) = pairs.iter().find(off_axis) {
            return Err(Failure::Mismatch(format!(
                "the eigenvalue {:.3e} + {:.3e}i is not on the imaginary axis, but a branch of \
                 periodic orbits starts only at a Hopf point (HB)",
                value.re, value.im
            )));
        }
        pairs.try_into().map_err(|_| {
            Failure::Mismatch(
                "the equilibrium has no complex pair of eigenvalues, but a branch of periodic \
                 orbits starts only at a Hopf point (HB)"
                    .into(),
            )
        })
    }

    /// Returns several equal critical pairs, the pairs nearest to a known frequency.
    pub fn equal_pairs(&self, known: Option<f64>, count: usize) -> Result<Vec<Mode>, Failure> {
        let first = self.critical_pair(known)?;
        let pairs = self.pairs(Some(first.value.im));
        let equal = |it: &&&Mode| {
            (it.value - first.value).norm_sqr().sqrt() <= NEAR_THE_AXIS * first.value.im
        };
        let all: Vec<Mode> =
            pairs.iter().filter(equal).take(count).map(|it| (*it).clone()).collect();
        if all.len() < count {
            return Err(Failure::Mismatch(format!(
                "only {} of {count} pairs of eigenvalues are equal at this Hopf point",
                all.len()
            )));
        }
        Ok(all)
    }

    /// Returns the critical real eigenvalue.
    pub fn zero(&self) -> Result<Mode, Failure> {
        let real = self.modes.iter().filter(|it| it.value.im == 0.0);
        let zero = real.min_by(|a, b| a.value.re.abs().total_cmp(&b.value.re.abs()));
        zero.cloned().ok_or_else(|| Failure::Mismatch("no eigenvalue is zero".into()))
    }

    /// Returns the left eigenvector `p` with `p F_x = λ p` and `p v = 1`, for an eigenvalue `λ` and
    /// its eigenvector `v`.
    pub fn left(&self, of: &Mode) -> Result<Vec<c64>, Failure> {
        let [left] = <[_; 1]>::try_from(self.left_of(std::slice::from_ref(of))?)
            .map_err(|_| Failure::Eigenvalues(AT_HOPF))?;
        Ok(left)
    }

    /// Returns the left eigenvectors `p_l` with `p_l v_j = δ_lj`, for several eigenvectors `v_j` with equal
    /// eigenvalues.
    pub fn left_of(&self, all: &[Mode]) -> Result<Vec<Vec<c64>>, Failure> {
        let n = self.state.len();
        let transposed: Vec<f64> = (0..n * n).map(|k| self.jacobian[(k % n) * n + k / n]).collect();
        let mut left = modes(&transposed, n)?;
        let distance = |mode: &Mode| (mode.value - all[0].value).norm_sqr();
        left.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        left.truncate(all.len());
        let products = DMatrix::from_fn(left.len(), all.len(), |l, j| -> c64 {
            left[l].vector.iter().zip(&all[j].vector).map(|(p, v)| p * v).sum()
        });
        let inverse = products.try_inverse().ok_or(Failure::Eigenvalues(AT_HOPF))?;
        let component = |l: usize, i: usize| -> c64 {
            left.iter().enumerate().map(|(k, mode)| inverse[(l, k)] * mode.vector[i]).sum()
        };
        Ok((0..all.len()).map(|l| (0..n).map(|i| component(l, i)).collect()).collect())
    }

    /// Factors the matrix `s − F_x`.
    pub fn shifted(&self, s: c64) -> Shifted {
        let n = self.state.len();
        let entry = |i: usize, j: usize| {
            let own = if i == j { s } else { c64::new(0.0, 0.0) };
            own - self.jacobian[j * n + i]
        };
        Shifted(DMatrix::from_fn(n, n, entry).lu())
    }

    /// Computes the third derivative of the vector field along three complex directions.
    pub fn third(&self, along: [&[c64]; 3]) -> Result<Vec<c64>, Failure> {
        let parts = |v: &[c64]| -> [Vec<f64>; 2] {
            [v.iter().map(|c| c.re).collect(), v.iter().map(|c| c.im).collect()]
        };
        let [a, b, c] = along.map(parts);
        let mut sum = vec![c64::new(0.0, 0.0); a[0].len()];
        for bits in 0..8_usize {
            let [i, j, k] = [bits & 1, bits >> 1 & 1, bits >> 2];
            let mut own = vec![0.0; sum.len()];
            third([&a[i], &b[j], &c[k]], &mut own, |v, w, out| {
                let x: Vec<Dual2<Chunk>> =
                    (0..v.len()).map(|i| moving(self.state[i], v[i], w[i])).collect();
                let q: Vec<Dual2<Chunk>> = self.q.iter().map(|q| Dual2::from(*q)).collect();
                let mut f = vec![Dual2::from(0.0); x.len()];
                let field = Dual2::<Chunk>::residual(self.problem).on_segment(0, &q);
                field.slope(Dual2::from(0.0), &x, &q, &mut f);
                out.iter_mut().zip(&f).for_each(|(out, f)| *out = mixed(f));
                Ok(())
            })?;
            // The product of the three units 1 or i.
            let unit = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][i + j + k];
            let unit = c64::new(unit.0, unit.1);
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += unit * own);
        }
        Ok(sum)
    }

    /// Computes the second derivative `B(a, b)` of the vector field along two complex directions.
    pub fn second(&self, a: &[c64], b: &[c64]) -> Vec<c64> {
        let parts = |v: &[c64]| -> [Direction; 2] {
            [v.iter().map(|c| c.re).collect(), v.iter().map(|c| c.im).collect()]
                .map(Direction::of_states)
        };
        let ([ar, ai], [br, bi]) = (parts(a), parts(b));
        let [rr, ii] = [self.along(&ar, &br), self.along(&ai, &bi)];
        let [ri, ir] = [self.along(&ar, &bi), self.along(&ai, &br)];
        (0..rr.len()).map(|i| c64::new(rr[i] - ii[i], ri[i] + ir[i])).collect()
    }

    /// Computes the second derivative of the vector field along two real directions.
    pub fn along(&self, a: &Direction, b: &Direction) -> Vec<f64> {
        self.image(a, b).iter().map(mixed).collect()
    }

    /// Computes the derivative of the field with respect to a parameter.
    pub fn by_parameter(&self, parameter: usize) -> Vec<f64> {
        let still = vec![0.0; self.state.len()];
        let along = Direction { states: still.clone(), parameters: vec![(parameter, 1.0)] };
        self.image(&along, &Direction::of_states(still)).iter().map(|f| f.eps.re).collect()
    }

    fn image(&self, a: &Direction, b: &Direction) -> Vec<Dual<Chunk>> {
        let directions = self.state.iter().zip(&a.states).zip(&b.states);
        let x: Vec<Dual<Chunk>> = directions.map(|((x, a), b)| moving(*x, *a, *b)).collect();
        let number = |(p, q): (usize, &f64)| moving(*q, a.by(p), b.by(p));
        let q: Vec<Dual<Chunk>> = self.q.iter().enumerate().map(number).collect();
        let mut f = vec![Dual::from(0.0); x.len()];
        let field = Dual::<Chunk>::residual(self.problem).on_segment(0, &q);
        field.slope(Dual::from(0.0), &x, &q, &mut f);
        f
    }

    /// Samples the ellipse `x* + ε Re(v e^{iφ})`, and returns the relative difference between the
    /// vector field and its linearisation there; infinite if the ellipse leaves the vector field's
    /// domain.
    pub fn nonlinearity(&self, v: &[c64], amplitude: f64) -> f64 {
        let (n, units) = (self.state.len(), self.units());
        let field = f64::residual(self.problem).on_segment(0, &self.q);
        let length =
            |f: &[f64]| f.iter().zip(&units).map(|(f, unit)| (f / unit).powi(2)).sum::<f64>();
        let mut most = 0.0_f64;
        for k in 0..PHASES {
            let (sine, cosine) = (TAU * k as f64 / PHASES as f64).sin_cos();
            let deviation: Vec<f64> =
                v.iter().map(|v| amplitude * (v.re * cosine - v.im * sine)).collect();
            let x: Vec<f64> = self.state.iter().zip(&deviation).map(|(x, d)| x + d).collect();
            if field.domain(&x, &self.q).is_err() {
                return f64::INFINITY;
            }
            let mut f = vec![0.0; n];
            field.slope(0.0, &x, &self.q, &mut f);
            let row = |i: usize| (0..n).map(|j| self.jacobian[j * n + i] * deviation[j]).sum();
            let linear: Vec<f64> = (0..n).map(row).collect();
            let left: Vec<f64> = f.iter().zip(&linear).map(|(f, linear)| f - linear).collect();
            let part = (length(&left) / length(&linear)).sqrt();
            most = if part.is_nan() { f64::INFINITY } else { most.max(part) };
        }
        most
    }

    /// Returns the Jacobian in the units of the states.
    pub fn in_units(&self) -> DMatrix<f64> {
        let (n, units) = (self.state.len(), self.units());
        DMatrix::from_fn(n, n, |i, j| self.jacobian[j * n + i] * units[j] / units[i])
    }

    /// Returns the value of a parameter.
    pub fn parameter(&self, parameter: usize) -> f64 {
        self.q[parameter]
    }

    /// Returns the size of the equilibrium in the units of its states; 1 at the origin.
    pub fn size(&self) -> f64 {
        let parts = self.state.iter().zip(self.units()).map(|(x, unit)| x / unit);
        let size = norm(&parts.collect::<Vec<f64>>());
        if size > AT_ORIGIN { size } else { 1.0 }
    }
}
