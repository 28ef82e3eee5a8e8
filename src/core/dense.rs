//! A zero problem as a dense system: Jacobians and higher derivatives by dual numbers.

use super::chunk::{CHUNK, Chunk, seeded};
use super::linear::BorderedLu;
use super::motion::{DenseOscillation, Oscillation};
use super::scalar::Scalar;
use super::zero::{
    Border, Dynamics, LeftDomain, Names, Profile, Singular, Slot, Spectrum, System, ZeroProblem,
};
use faer::{MatRef, Side};
use num_dual::{Dual, Dual2, Dual64, HyperDual64, HyperHyperDual64};

/// Arguments and residual in one scalar type, kept so that nothing is allocated twice.
struct Work<T> {
    x: Vec<T>,
    r: Vec<T>,
}

impl<T: Scalar> Work<T> {
    fn new(names: &Names) -> Self {
        Work { x: vec![T::zero(); names.length()], r: vec![T::zero(); names.dimension()] }
    }

    /// Evaluates the residual at arguments given component by component.
    fn evaluate<P: ZeroProblem>(&mut self, problem: &P, argument: impl Fn(usize) -> T) -> &[T] {
        for (i, x) in self.x.iter_mut().enumerate() {
            *x = argument(i);
        }
        let (z, p) = self.x.split_at(self.r.len());
        problem.residual(z, p, &mut self.r);
        &self.r
    }
}

/// A [`ZeroProblem`] as a [`System`]: `F_z` is dense, and every derivative comes from evaluating the
/// residual on dual numbers: `⌈n/8⌉` passes for the Jacobian, one for a directional derivative of
/// any order, `⌈(n + m)/8⌉` nested ones for a gradient.
///
/// ```
/// use tangency::core::{dense::Dense, scalar::Scalar, zero::{Names, System, ZeroProblem}};
/// struct Circle;
/// impl ZeroProblem for Circle {
///     fn names(&self) -> Names {
///         Names::new(["y"], ["x"])
///     }
///     fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
///         r[0] = z[0] * z[0] + p[0] * p[0] - 1.0;
///     }
/// }
/// let mut circle = Dense::new(Circle);
/// let mut slope = [0.0];
/// circle.derivative(&[0.6, 0.8], &[1.0, 0.0], &mut slope);
/// assert_eq!(slope, [1.2]);
/// ```
pub struct Dense<P> {
    problem: P,
    names: Names,
    jacobian: Vec<f64>,
    /// Where `jacobian` was assembled last; empty where that failed.
    assembled: Vec<f64>,
    factors: [BorderedLu; 2],
    oscillation: DenseOscillation,
    plain: Work<f64>,
    chunk: Work<Chunk>,
    first: Work<Dual64>,
    second: Work<HyperDual64>,
    third: Work<HyperHyperDual64>,
    nested: Work<Dual<Chunk>>,
    nested_twice: Work<Dual2<Chunk>>,
    monitors: Vec<Chunk>,
}

impl<P: ZeroProblem> Dense<P> {
    /// The system of a problem.
    pub fn new(problem: P) -> Self {
        let names = problem.names();
        let n = names.dimension();
        Dense {
            jacobian: vec![0.0; n * n],
            assembled: Vec::with_capacity(names.length()),
            factors: Default::default(),
            oscillation: DenseOscillation::default(),
            plain: Work::new(&names),
            chunk: Work::new(&names),
            first: Work::new(&names),
            second: Work::new(&names),
            third: Work::new(&names),
            nested: Work::new(&names),
            nested_twice: Work::new(&names),
            monitors: vec![Chunk::from(0.0); names.monitors.len()],
            names,
            problem,
        }
    }

    /// The problem itself.
    pub fn problem(&self) -> &P {
        &self.problem
    }

    fn check_domain(&self, x: &[f64]) -> Result<(), LeftDomain> {
        let (z, p) = x.split_at(self.names.dimension());
        self.problem.domain(z, p)
    }
}

/// The gradient, in the directions of a chunk, of a sum of numbers with these weights.
fn weighted<'a>(numbers: impl Iterator<Item = &'a Chunk>, weights: &[f64]) -> [f64; CHUNK] {
    let mut sums = [0.0; CHUNK];
    for (number, weight) in numbers.zip(weights) {
        sums.iter_mut().zip(number.eps).for_each(|(sum, part)| *sum += part * weight);
    }
    sums
}

/// Whether a matrix is exactly symmetric, as that of a discretised self-adjoint operator is: its
/// eigenvalues then cost a fraction.
fn symmetric(matrix: &[f64], n: usize) -> bool {
    (0..n).all(|j| (0..j).all(|i| matrix[j * n + i] == matrix[i * n + j]))
}

impl<P> Oscillation for Dense<P> {
    fn factor(&mut self, omega: f64, column: &[f64], row: &[f64]) -> Result<(), Singular> {
        self.oscillation.factor(&self.jacobian, omega, column, row)
    }

    fn solve(&mut self, right: &mut [f64]) {
        self.oscillation.solve(right);
    }

    fn solve_transposed(&mut self, right: &mut [f64]) {
        self.oscillation.solve_transposed(right);
    }

    fn slope(&mut self, _omega: f64, v: &[f64], out: &mut [f64]) {
        DenseOscillation::slope(v, out);
    }
}

impl<P: ZeroProblem> System for Dense<P> {
    fn names(&self) -> &Names {
        &self.names
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), LeftDomain> {
        self.check_domain(x)?;
        r.copy_from_slice(self.plain.evaluate(&self.problem, |i| x[i]));
        match r.iter().position(|r| !r.is_finite()) {
            Some(i) => Err(LeftDomain::new(
                format!("component {i} of the residual"),
                r[i],
                "the residual must be finite; bound the branch before the equations lose their meaning",
            )),
            None => Ok(()),
        }
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), LeftDomain> {
        if self.assembled == x {
            return Ok(());
        }
        self.assembled.clear();
        self.check_domain(x)?;
        let n = self.names.dimension();
        for start in (0..n).step_by(CHUNK) {
            let r = self.chunk.evaluate(&self.problem, |i| seeded(x[i], i, start));
            for (i, r) in r.iter().enumerate() {
                for (j, part) in (start..n).zip(r.eps) {
                    self.jacobian[j * n + i] = part;
                }
            }
        }
        match self.jacobian.iter().position(|entry| !entry.is_finite()) {
            Some(k) => Err(LeftDomain::new(
                format!("derivative of component {} by unknown {}", k % n, k / n),
                self.jacobian[k],
                "the residual must be differentiable here (√ at 0 is not)",
            )),
            None => {
                self.assembled.extend_from_slice(x);
                Ok(())
            }
        }
    }

    fn factor(&mut self, slot: Slot, border: Border) -> Result<(), Singular> {
        self.factors[slot as usize].factor(&self.jacobian, border)
    }

    fn solve(&mut self, slot: Slot, right: &mut [f64]) {
        self.factors[slot as usize].solve(right);
    }

    fn solve_transposed(&mut self, slot: Slot, right: &mut [f64]) {
        self.factors[slot as usize].solve_transposed(right);
    }

    fn jacobian(&mut self, out: &mut [f64]) {
        out.copy_from_slice(&self.jacobian);
    }

    fn determinant_sign(&self, slot: Slot) -> f64 {
        self.factors[slot as usize].determinant_sign()
    }

    fn derivative(&mut self, x: &[f64], d: &[f64], out: &mut [f64]) {
        let r = self.first.evaluate(&self.problem, |i| Dual64::new(x[i], d[i]));
        out.iter_mut().zip(r).for_each(|(out, r)| *out = r.eps);
    }

    fn second_derivative(&mut self, x: &[f64], d: &[f64], e: &[f64], out: &mut [f64]) {
        let r = self.second.evaluate(&self.problem, |i| HyperDual64::new(x[i], d[i], e[i], 0.0));
        out.iter_mut().zip(r).for_each(|(out, r)| *out = r.eps1eps2);
    }

    fn third_derivative(&mut self, x: &[f64], d: &[f64], e: &[f64], f: &[f64], out: &mut [f64]) {
        let r = self.third.evaluate(&self.problem, |i| {
            HyperHyperDual64::new(x[i], d[i], e[i], f[i], 0.0, 0.0, 0.0, 0.0)
        });
        out.iter_mut().zip(r).for_each(|(out, r)| *out = r.eps1eps2eps3);
    }

    fn gradient(&mut self, x: &[f64], w: &[f64], v: &[f64], _released: &[usize], out: &mut [f64]) {
        for start in (0..x.len()).step_by(CHUNK) {
            let r = self
                .nested
                .evaluate(&self.problem, |i| Dual::new(seeded(x[i], i, start), Chunk::from(v[i])));
            let slopes = weighted(r.iter().map(|r| &r.eps), w);
            out[start..].iter_mut().zip(slopes).for_each(|(out, slope)| *out = slope);
        }
    }

    fn second_gradient(
        &mut self,
        x: &[f64],
        w: &[f64],
        v: &[f64],
        _released: &[usize],
        out: &mut [f64],
    ) {
        for start in (0..x.len()).step_by(CHUNK) {
            let r = self.nested_twice.evaluate(&self.problem, |i| {
                Dual2::new(seeded(x[i], i, start), Chunk::from(v[i]), Chunk::from(0.0))
            });
            let slopes = weighted(r.iter().map(|r| &r.v2), w);
            out[start..].iter_mut().zip(slopes).for_each(|(out, slope)| *out = slope);
        }
    }

    fn oscillation(&mut self) -> Option<&mut dyn Oscillation> {
        Some(self)
    }

    fn dynamics(&self) -> Dynamics {
        self.problem.dynamics()
    }

    fn spectrum(&mut self, _x: &[f64]) -> Option<Spectrum> {
        let n = self.names.dimension();
        let matrix = MatRef::from_column_major_slice(&self.jacobian, n, n);
        let mut eigenvalues: Spectrum = match self.problem.dynamics() {
            Dynamics::Static | Dynamics::Periodic => return None,
            Dynamics::Flow if symmetric(&self.jacobian, n) => {
                let real = matrix.self_adjoint_eigenvalues(Side::Lower).ok()?;
                real.into_iter().map(|l| (l, 0.0)).collect()
            }
            Dynamics::Flow => {
                matrix.eigenvalues().ok()?.into_iter().map(|l| (l.re, l.im)).collect()
            }
            Dynamics::Restoring => {
                matrix.eigenvalues().ok()?.into_iter().map(|l| (-l.re, l.im)).collect()
            }
            Dynamics::Potential => {
                let hessian = matrix.self_adjoint_eigenvalues(Side::Lower).ok()?;
                hessian.into_iter().map(|l| (-l, 0.0)).collect()
            }
        };
        eigenvalues.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
        Some(eigenvalues)
    }

    fn monitors(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), LeftDomain> {
        let (z, p) = x.split_at(self.names.dimension());
        self.problem.monitors(z, p, values);
        match values.iter().position(|value| !value.is_finite()) {
            Some(k) => Err(LeftDomain::new(
                format!("monitor {}", self.names.monitors[k]),
                values[k],
                "a monitor must be finite wherever the residual is",
            )),
            None => Ok(()),
        }
    }

    fn monitor_gradient(
        &mut self,
        monitor: usize,
        x: &[f64],
        _released: &[usize],
        out: &mut [f64],
    ) {
        for start in (0..x.len()).step_by(CHUNK) {
            for (i, (slot, x)) in self.chunk.x.iter_mut().zip(x).enumerate() {
                *slot = seeded(*x, i, start);
            }
            let (z, p) = self.chunk.x.split_at(self.names.dimension());
            self.problem.monitors(z, p, &mut self.monitors);
            let slopes = self.monitors[monitor].eps;
            out[start..].iter_mut().zip(slopes).for_each(|(out, slope)| *out = slope);
        }
    }

    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        let (z, p) = x.split_at(self.names.dimension());
        self.problem.profiles(z, p)
    }
}
