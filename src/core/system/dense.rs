//! A zero problem as a dense system: Jacobians and higher derivatives by dual numbers.

use super::{Expansion, Functional, System, mixed, moving, third};
use crate::core::failure::{
    DIFFERENTIABLE, Failure, OutOfDomain, finite, finite_gradient, unknown_order,
};
use crate::core::linalg::{
    Border, BorderedLu, Factors, Form, ShiftedLu, Spectrum, SpectrumRequest, balanced,
};
use crate::core::problem::{
    Dynamics, Names, PotentialGradient, Profile, ROOM, ZeroEquations, ZeroNumber, ZeroProblem,
};
use crate::core::scalar::{CHUNK, Chunk, Jet, Space, seeded};
use faer::{MatRef, Side};
use num_dual::{Dual, Dual2, Dual64};
use std::mem::take;
use std::sync::Arc;

/// Arguments and residual in one scalar type, kept so that nothing is allocated twice.
struct Work<T> {
    x: Vec<T>,
    r: Vec<T>,
}

impl<T: ZeroNumber> Work<T> {
    fn new(names: &Names) -> Self {
        Work { x: vec![T::zero(); names.length()], r: vec![T::zero(); names.dimension()] }
    }

    /// Unknowns and parameters given component by component, and room for the residual.
    fn arguments(&mut self, argument: impl Fn(usize) -> T) -> (&[T], &[T], &mut [T]) {
        self.x.iter_mut().enumerate().for_each(|(i, x)| *x = argument(i));
        let (z, p) = self.x.split_at(self.r.len());
        (z, p, &mut self.r)
    }

    /// Evaluates the residual at arguments given component by component.
    fn evaluate(&mut self, problem: &dyn ZeroEquations, argument: impl Fn(usize) -> T) -> &[T] {
        let (z, p, r) = self.arguments(argument);
        problem.residual(z, p, r);
        r
    }
}

/// A [`ZeroProblem`] as a [`System`]: `F_z` is dense, and every derivative comes from evaluating
/// the residual on dual numbers: `⌈n/8⌉` passes for the Jacobian, one for a directional derivative
/// (two for a third one along three different directions), `⌈(n + m)/8⌉` nested ones for a gradient
/// (of [`Dynamics::Potential`] problems one, and one for each released parameter).
///
/// ```
/// use tangency::core::system::{Dense, System};
/// use tangency::problems::classic::Hyperbola;
/// // x² − μ² − ε², along x.
/// let mut slope = [0.0];
/// Dense::new(Hyperbola).derivative(&[5.0, 3.0, 4.0], &[&[1.0, 0.0, 0.0]], &mut slope)?;
/// assert_eq!(slope, [10.0]);
/// # Ok::<(), tangency::core::failure::Failure>(())
/// ```
pub struct Dense<P> {
    problem: Arc<P>,
    matrix: DenseMatrix,
}

impl<P: ZeroProblem + 'static> Dense<P> {
    /// The system of a problem.
    pub fn new(problem: P) -> Self {
        Dense::shared(Arc::new(problem))
    }

    /// The system of a problem that is shared.
    pub fn shared(problem: Arc<P>) -> Self {
        Dense { matrix: DenseMatrix::new(problem.clone()), problem }
    }

    /// Takes `F_z` from a function of the problem, for residuals whose Jacobian is a sum of
    /// constant tables: it must agree with the derivative of the residual by dual numbers.
    #[must_use]
    pub fn tabulated(mut self, jacobian: fn(&P, &[f64], &[f64], &mut [f64])) -> Self {
        let problem = self.problem.clone();
        self.matrix.tabulated = Some(Box::new(move |z, p, out| jacobian(&problem, z, p, out)));
        self
    }

    /// The problem itself.
    pub fn problem(&self) -> &P {
        &self.problem
    }

    /// The assembled `F_z` as a dense matrix, one column after the other (`n × n`).
    pub fn jacobian(&self, out: &mut [f64]) {
        out.copy_from_slice(self.matrix.jacobian());
    }
}

/// Writes `F_z(z, p)`, one column after the other.
type Tabulated = Box<dyn Fn(&[f64], &[f64], &mut [f64]) + Send>;

/// The system of a problem behind its object-safe face, compiled once for all problems.
pub(in crate::core) struct DenseMatrix {
    problem: Arc<dyn ZeroEquations>,
    names: Names,
    tabulated: Option<Tabulated>,
    jacobian: Vec<f64>,
    /// Where `jacobian` was assembled last; empty where that failed.
    assembled: Vec<f64>,
    plain: Work<f64>,
    chunk: Work<Chunk>,
    first: Work<Dual64>,
    /// Made at the first use: jets are large.
    jets: Option<Work<Jet<ROOM>>>,
    nested: Work<Dual<Chunk>>,
    nested_twice: Work<Dual2<Chunk>>,
    potential: PotentialGradient,
    monitors: (Vec<f64>, Vec<Chunk>),
}

impl DenseMatrix {
    /// The system of a problem behind its face.
    pub fn new(problem: Arc<dyn ZeroEquations>) -> Self {
        let names = problem.names();
        let n = names.dimension();
        DenseMatrix {
            tabulated: None,
            jacobian: vec![0.0; n * n],
            assembled: Vec::with_capacity(names.length()),
            plain: Work::new(&names),
            chunk: Work::new(&names),
            first: Work::new(&names),
            jets: None,
            nested: Work::new(&names),
            nested_twice: Work::new(&names),
            potential: PotentialGradient::new(&names),
            monitors: (
                vec![0.0; names.monitors.len()],
                vec![Chunk::from(0.0); names.monitors.len()],
            ),
            names,
            problem,
        }
    }

    /// The assembled `F_z`, one column after the other.
    pub fn jacobian(&self) -> &[f64] {
        &self.jacobian
    }

    /// `F_z` by dual numbers.
    fn differentiate(&mut self, x: &[f64]) {
        let n = self.names.dimension();
        for start in (0..n).step_by(CHUNK) {
            let r = self.chunk.evaluate(&*self.problem, |i| seeded(x[i], i, start));
            for (i, r) in r.iter().enumerate() {
                for (j, part) in (start..n).zip(r.eps) {
                    self.jacobian[j * n + i] = part;
                }
            }
        }
    }

    fn check_domain(&self, x: &[f64]) -> Result<(), OutOfDomain> {
        let (z, p) = x.split_at(self.names.dimension());
        self.problem.domain(z, p)
    }
}

/// The gradient, in the directions of a chunk, of a sum of numbers with these weights.
fn weighted<'a>(numbers: impl Iterator<Item = &'a Chunk>, weights: &[f64], out: &mut [f64]) {
    let mut sums = [0.0; CHUNK];
    for (number, weight) in numbers.zip(weights) {
        sums.iter_mut().zip(number.eps).for_each(|(sum, part)| *sum += part * weight);
    }
    out.iter_mut().zip(sums).for_each(|(out, sum)| *out = sum);
}

/// Whether a matrix is exactly symmetric, as that of a discretised self-adjoint operator is: its
/// eigenvalues then cost a fraction.
fn symmetric(matrix: &[f64], n: usize) -> bool {
    (0..n).all(|j| (0..j).all(|i| matrix[j * n + i] == matrix[i * n + j]))
}

impl<P: ZeroProblem + 'static> System for Dense<P> {
    fn names(&self) -> &Names {
        &self.matrix.names
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        self.matrix.residual(x, r)
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.matrix.assemble(x)
    }

    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        self.matrix.factor(form, border, into)
    }

    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.matrix.derivative(x, directions, out)
    }

    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        self.matrix.gradient(x, of, released, out)
    }

    fn dynamics(&self) -> Dynamics {
        self.matrix.dynamics()
    }

    fn spectrum(
        &mut self,
        x: &[f64],
        request: SpectrumRequest,
    ) -> Result<Option<Spectrum>, Failure> {
        self.matrix.spectrum(x, request)
    }

    fn expand(
        &mut self,
        x: &[f64],
        space: &'static Space,
        terms: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        self.matrix.expand(x, space, terms)
    }

    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure> {
        self.matrix.monitors(x, first, values)
    }

    fn unknown_scales(&self, p: &[f64]) -> Vec<f64> {
        self.matrix.unknown_scales(p)
    }

    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        self.matrix.profiles(x)
    }
}

impl System for DenseMatrix {
    fn names(&self) -> &Names {
        &self.names
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        self.check_domain(x)?;
        r.copy_from_slice(self.plain.evaluate(&*self.problem, |i| x[i]));
        finite(
            r,
            |i| format!("component {i} of the residual"),
            "the residual must be finite: bound the branch before the equations lose their meaning, and write every \
             component (one that is never written is not a number)",
        )
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        if self.assembled == x {
            return Ok(());
        }
        self.assembled.clear();
        self.check_domain(x)?;
        let n = self.names.dimension();
        match &self.tabulated {
            Some(jacobian) => jacobian(&x[..n], &x[n..], &mut self.jacobian),
            None => self.differentiate(x),
        }
        let name = |k: usize| format!("derivative of component {} by unknown {}", k % n, k / n);
        finite(&self.jacobian, name, DIFFERENTIABLE)?;
        self.assembled.extend_from_slice(x);
        Ok(())
    }

    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        match form {
            Form::Jacobian => {
                let lu = into.reuse(|_: &BorderedLu| true, BorderedLu::default);
                lu.factor(&self.jacobian, border)
            }
            Form::Oscillation(omega) => {
                let lu = into.reuse(|_: &ShiftedLu| true, ShiftedLu::default);
                lu.factor(&self.jacobian, omega, border)
            }
            Form::Antiperiodic => Err(Failure::Unsupported(
                "the unknowns of a `ZeroProblem` are no periodic orbit".into(),
            )),
        }
    }

    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        match *directions {
            [d] => {
                let r = self.first.evaluate(&*self.problem, |i| Dual64::new(x[i], d[i]));
                out.iter_mut().zip(r).for_each(|(out, r)| *out = r.eps);
            }
            [d, e] => {
                let r = self.nested.evaluate(&*self.problem, |i| moving(x[i], d[i], e[i]));
                out.iter_mut().zip(r).for_each(|(out, r)| *out = mixed(r));
            }
            [d, e, f] => third([d, e, f], out, |v, w, out| {
                let r = self.nested_twice.evaluate(&*self.problem, |i| moving(x[i], v[i], w[i]));
                out.iter_mut().zip(r).for_each(|(out, r)| *out = mixed(r));
                Ok(())
            })?,
            _ => return Err(unknown_order(directions.len())),
        }
        finite(out, |i| format!("a derivative of component {i} of the residual"), DIFFERENTIABLE)
    }

    fn expand(
        &mut self,
        x: &[f64],
        space: &'static Space,
        terms: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let expansion = Expansion::new(x, space, terms)?;
        let names = &self.names;
        let work = self.jets.get_or_insert_with(|| Work::new(names));
        expansion.images(work.evaluate(&*self.problem, |i| expansion.argument(i)))
    }

    fn gradient(
        &mut self,
        x: &[f64],
        of: Functional,
        released: &[usize],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        if let (Dynamics::Potential, Functional::First(w, v) | Functional::Second(w, v)) =
            (self.dynamics(), of)
        {
            let mut memory = take(&mut self.potential);
            let order = if let Functional::Second(..) = of { 3 } else { 2 };
            let along = |d: &[f64], out: &mut [f64]| self.derivative(x, &[d, v, v][..order], out);
            let outcome = memory.gradient(w, released, along, out);
            self.potential = memory;
            return outcome;
        }
        let (problem, zero) = (&*self.problem, Chunk::from(0.0));
        for start in (0..x.len()).step_by(CHUNK) {
            let (seed, out) = (|i: usize| seeded(x[i], i, start), &mut out[start..]);
            match of {
                Functional::First(w, v) => {
                    let argument = |i| Dual::new(seed(i), Chunk::from(v[i]));
                    let r = self.nested.evaluate(problem, argument);
                    weighted(r.iter().map(|r| &r.eps), w, out);
                }
                Functional::Second(w, v) => {
                    let argument = |i| Dual2::new(seed(i), Chunk::from(v[i]), zero);
                    let r = self.nested_twice.evaluate(problem, argument);
                    weighted(r.iter().map(|r| &r.v2), w, out);
                }
                Functional::Monitor(monitor) => {
                    let (z, p, _) = self.chunk.arguments(seed);
                    problem.monitors(z, p, &mut self.monitors.1);
                    let slopes = self.monitors.1[monitor].eps;
                    out.iter_mut().zip(slopes).for_each(|(out, slope)| *out = slope);
                }
            }
        }
        finite_gradient(out, self.names.dimension(), released)
    }

    fn dynamics(&self) -> Dynamics {
        self.problem.dynamics()
    }

    fn spectrum(&mut self, _: &[f64], _: SpectrumRequest) -> Result<Option<Spectrum>, Failure> {
        let n = self.names.dimension();
        let (dynamics, unknown) = (self.problem.dynamics(), Failure::Eigenvalues("eigenvalues"));
        let self_adjoint = match dynamics {
            Dynamics::None => return Ok(None),
            Dynamics::Periodic => {
                return Err(Failure::Unsupported(
                    "the unknowns of a `ZeroProblem` are no periodic orbit of which multipliers are known: state a \
                     vector field and its `periodic_orbits`, or the dynamics `None`"
                        .into(),
                ));
            }
            Dynamics::Flow => symmetric(&self.jacobian, n),
            Dynamics::Potential => true,
            Dynamics::SecondOrder => false,
        };
        let mut eigenvalues: Spectrum = if self_adjoint {
            let matrix = MatRef::from_column_major_slice(&self.jacobian, n, n);
            let real = matrix.self_adjoint_eigenvalues(Side::Lower).map_err(|_| unknown)?;
            real.into_iter().map(|l| (l, 0.0)).collect()
        } else {
            let balanced = balanced(&self.jacobian, n);
            let matrix = MatRef::from_column_major_slice(&balanced, n, n);
            let found = matrix.eigenvalues().map_err(|_| unknown)?;
            found.into_iter().map(|l| (l.re, l.im)).collect()
        };
        if dynamics != Dynamics::Flow {
            eigenvalues.iter_mut().for_each(|l| l.0 = -l.0);
        }
        eigenvalues.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
        Ok(Some(eigenvalues))
    }

    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure> {
        let (z, p) = x.split_at(self.names.dimension());
        self.problem.monitors(z, p, &mut self.monitors.0);
        values.copy_from_slice(&self.monitors.0[first..][..values.len()]);
        let name = |k: usize| format!("monitor {}", self.names.monitors[first + k]);
        finite(values, name, "a monitor must be finite wherever the residual is")
    }

    fn unknown_scales(&self, p: &[f64]) -> Vec<f64> {
        self.problem.scales(p)
    }

    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        let (z, p) = x.split_at(self.names.dimension());
        match self.problem.profiles(z, p) {
            own if own.is_empty() => Profile::of_arrays(&self.names.unknowns, z),
            own => own,
        }
    }
}
