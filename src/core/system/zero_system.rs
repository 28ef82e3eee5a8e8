//! The system of a zero problem as a trait object; its code is compiled once for all problems.

use super::free_jacobian::FreeJacobian;
use super::jacobian::{DenseJacobian, Jacobian, Tabulated};
use super::sparse_jacobian::SparseJacobian;
use super::work::Work;
use super::{Deviation, Expansion, Functional, Representation, System, mixed, moving, third};
use crate::core::failure::{DIFFERENTIABLE, Failure, finite, finite_gradient, unknown_order};
use crate::core::linalg::{Border, Factors, Form, Spectrum, SpectrumRequest};
use crate::core::problem::{
    Dynamics, Names, PotentialGradient, Profile, ROOM, TracedEquations, ZeroEquations,
};
use crate::core::scalar::{CHUNK, Chunk, Jet, Space, Traced, seeded};
use num_dual::{Dual, Dual2, Dual64};
use serde::{Deserialize, Serialize};
use std::mem::take;
use std::sync::Arc;

/// The kind of matrices with which a zero problem is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Matrices {
    /// Sparse matrices if their elimination takes far fewer multiplications than dense elimination,
    /// otherwise dense matrices.
    #[default]
    Cheaper,
    /// Dense matrices.
    Dense,
    /// Sparse matrices.
    Sparse,
}

impl Matrices {
    /// The largest number of unknowns for which a dense matrix is used; such a matrix takes 200 MB.
    pub const LARGEST_DENSE: usize = 5000;
}

/// The system of a zero problem as a trait object.
pub(crate) struct ZeroSystem {
    problem: Arc<dyn ZeroEquations>,
    /// The same problem as a trait object that can determine its sparsity pattern, if the problem
    /// supports this.
    traced: Option<Arc<dyn TracedEquations>>,
    matrices: Matrices,
    names: Names,
    pub(super) jacobian: Jacobian,
    /// The point at which the Jacobian was assembled last; empty after a failed assembly.
    assembled: Vec<f64>,
    plain: Work<f64>,
    chunk: Work<Chunk>,
    first: Work<Dual64>,
    /// The space for Taylor expansions, created at the first use because jets are large.
    jets: Option<Work<Jet<ROOM>>>,
    nested: Work<Dual<Chunk>>,
    nested_twice: Work<Dual2<Chunk>>,
    potential: PotentialGradient,
    monitors: (Vec<f64>, Vec<Chunk>),
}

impl ZeroSystem {
    /// Creates the system of a type-erased problem, with dense matrices.
    pub fn new(problem: Arc<dyn ZeroEquations>) -> Self {
        Self::with(problem, None, Matrices::Dense)
    }

    /// Creates the system of a problem whose sparsity pattern can be determined.
    pub fn structured(problem: Arc<dyn TracedEquations>, matrices: Matrices) -> Self {
        Self::with(problem.clone(), Some(problem), matrices)
    }

    fn with(
        problem: Arc<dyn ZeroEquations>,
        traced: Option<Arc<dyn TracedEquations>>,
        matrices: Matrices,
    ) -> Self {
        let names = problem.names().with_defaults(problem.defaults());
        let monitors = names.monitors.len();
        ZeroSystem {
            traced,
            matrices,
            jacobian: Jacobian::Unknown,
            assembled: Vec::with_capacity(names.length()),
            plain: Work::new(&names),
            chunk: Work::new(&names),
            first: Work::new(&names),
            jets: None,
            nested: Work::new(&names),
            nested_twice: Work::new(&names),
            potential: PotentialGradient::new(&names),
            monitors: (vec![0.0; monitors], vec![Chunk::from(0.0); monitors]),
            names,
            problem,
        }
    }

    /// Uses a function to compute `F_z` in all later assemblies.
    pub fn tabulate(&mut self, jacobian: Tabulated) {
        self.matrices = Matrices::Dense;
        self.jacobian = Jacobian::Dense(DenseJacobian::tabulated(self.names.dimension(), jacobian));
    }

    /// Writes the assembled `F_z`, column by column.
    pub fn jacobian(&self, out: &mut [f64]) {
        self.jacobian.write(out);
    }

    /// Adds missing entries to the pattern of the sparse matrix, if at this point the directional
    /// derivative along `probe` differs from the product of the matrix and `probe`.
    fn complete(&mut self, x: &[f64]) -> Result<(), Failure> {
        let (Jacobian::Sparse(sparse), Some(traced)) = (&mut self.jacobian, &self.traced) else {
            return Ok(());
        };
        let n = self.names.dimension();
        for attempt in 0..2 {
            sparse.differentiate(&mut self.chunk, &*self.problem, x);
            let mut agrees = match sparse.part(None) {
                Some(part) => {
                    sparse.agrees(self.chunk.results().iter().map(|r| r.eps[part]), false)
                }
                None => {
                    let probe = sparse.probe();
                    let along = |i: usize| Dual64::new(x[i], probe.get(i).copied().unwrap_or(0.0));
                    let slopes = self.first.evaluate(&*self.problem, along);
                    sparse.agrees(slopes.iter().map(|r| r.eps), false)
                }
            };
            if sparse.mass().is_some() {
                let rates = sparse.probe().to_vec();
                let (at, rate) = (|i: usize| x[i], |i: usize| rates[i]);
                let products = self.plain.products(&*self.problem, at, rate);
                agrees &= sparse.agrees(products.iter().copied(), true);
            }
            if agrees {
                return Ok(());
            }
            if attempt == 0 && !sparse.widen(&**traced, x) {
                break;
            }
        }
        Err(Failure::Unsupported(format!(
            "the derivatives of the residual with respect to its {n} unknowns do not match the \
             sparsity pattern of the equations: use dense matrices instead"
        )))
    }
}

/// Returns the equations that were differentiated at `x`, if the assembly of a sparse matrix has kept
/// these equations.
fn evaluated<'s>(system: &'s ZeroSystem, x: &[f64]) -> Option<(&'s SparseJacobian, &'s [Chunk])> {
    match &system.jacobian {
        Jacobian::Sparse(sparse) if sparse.keeps_equations() && system.assembled == x => {
            Some((sparse, system.chunk.results()))
        }
        _ => None,
    }
}

/// Writes the derivatives of the equations along one parameter, if the assembly of a sparse matrix has
/// computed these derivatives. Returns whether the derivatives are known.
fn derivative_is_known(system: &ZeroSystem, x: &[f64], direction: &[f64], out: &mut [f64]) -> bool {
    if direction.len() != x.len() {
        return false;
    }
    let (unknowns, parameters) = direction.split_at(system.names.dimension());
    let mut moving = parameters.iter().enumerate().filter(|(_, step)| **step != 0.0);
    let (Some((parameter, 1.0)), None) = (moving.next(), moving.next()) else { return false };
    let Some((sparse, equations)) = evaluated(system, x) else { return false };
    let Some(part) = sparse.part(Some(parameter)) else { return false };
    if unknowns.iter().any(|step| *step != 0.0) {
        return false;
    }
    out.iter_mut().zip(equations).for_each(|(out, r)| *out = r.eps[part]);
    true
}

/// Chooses dense or sparse matrices at the first point.
fn chosen(
    traced: Option<&dyn TracedEquations>,
    matrices: Matrices,
    x: &[f64],
    n: usize,
) -> Result<Jacobian, Failure> {
    let traced = traced.filter(|_| match matrices {
        Matrices::Dense => false,
        Matrices::Sparse => true,
        Matrices::Cheaper => n >= SparseJacobian::LEAST,
    });
    let most = if matrices == Matrices::Sparse { usize::MAX } else { n * n / 4 };
    let sparse = traced.and_then(|traced| SparseJacobian::traced(traced, x, most));
    let worth = |sparse: &SparseJacobian| matrices == Matrices::Sparse || sparse.pays();
    match sparse.filter(worth) {
        Some(sparse) => Ok(Jacobian::Sparse(Box::new(sparse))),
        None if n <= Matrices::LARGEST_DENSE => Ok(Jacobian::Dense(DenseJacobian::new(n))),
        None => Err(Failure::Unsupported(format!(
            "a dense matrix of {n} unknowns does not fit into memory (at most {} unknowns): use \
             fewer unknowns, or sparse equations, in which each equation depends on few unknowns",
            Matrices::LARGEST_DENSE
        ))),
    }
}

impl ZeroSystem {
    /// Computes the gradient of a functional, one chunk of components at a time.
    fn chunked_gradient(&mut self, x: &[f64], of: Functional, out: &mut [f64]) {
        let (problem, zero) = (&*self.problem, Chunk::from(0.0));
        for start in (0..x.len()).step_by(CHUNK) {
            let at = |i: usize| x.get(i).copied().unwrap_or(0.0);
            let (seed, out) = (|i: usize| seeded(at(i), i, start), &mut out[start..]);
            match of {
                Functional::First(w, v) => {
                    let argument = |i| Dual::new(seed(i), Chunk::from(v[i]));
                    let r = self.nested.left(problem, v.len() > x.len(), argument);
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
    }

    /// Computes the gradient of a functional, one color of unknowns at a time: each equation
    /// depends on at most one unknown of a color.
    fn colored_gradient(&mut self, x: &[f64], of: Functional, released: &[usize], out: &mut [f64]) {
        let Jacobian::Sparse(sparse) = &self.jacobian else { return };
        let (problem, zero) = (&*self.problem, Chunk::from(0.0));
        for start in (0..sparse.seeds(released)).step_by(CHUNK) {
            let at = |i: usize| x.get(i).copied().unwrap_or(0.0);
            let seed = |i: usize| seeded(at(i), sparse.seed(i, released), start);
            match of {
                Functional::First(w, v) => {
                    let argument = |i| Dual::new(seed(i), Chunk::from(v[i]));
                    let r = self.nested.left(problem, v.len() > x.len(), argument);
                    sparse.weigh(|i| &r[i].eps, (w, released, start), out);
                }
                Functional::Second(w, v) => {
                    let argument = |i| Dual2::new(seed(i), Chunk::from(v[i]), zero);
                    let r = self.nested_twice.evaluate(problem, argument);
                    sparse.weigh(|i| &r[i].v2, (w, released, start), out);
                }
                // Monitors can depend on all unknowns.
                Functional::Monitor(_) => {}
            }
        }
    }
}

/// Computes the gradient of a monitor by a backward pass through the recorded computation of the
/// monitor.
fn monitor_gradient(
    problem: &dyn TracedEquations,
    x: &[f64],
    (monitor, count): (usize, usize),
    out: &mut [f64],
) {
    Traced::begin();
    let inputs: Vec<Traced> = x.iter().map(|x| Traced::input(*x)).collect();
    let (z, p) = inputs.split_at(problem.names().dimension());
    let mut values = vec![Traced::from(0.0); count];
    problem.traced_monitors(z, p, &mut values);
    Traced::gradient([(values[monitor], 1.0)].into_iter(), out);
}

/// Computes the gradient of a weighted sum of the equations, which are evaluated to dual numbers,
/// in the directions of a chunk.
fn weighted<'a>(numbers: impl Iterator<Item = &'a Chunk>, weights: &[f64], out: &mut [f64]) {
    let mut sums = [0.0; CHUNK];
    for (number, weight) in numbers.zip(weights) {
        sums.iter_mut().zip(number.eps).for_each(|(sum, part)| *sum += part * weight);
    }
    out.iter_mut().zip(sums).for_each(|(out, sum)| *out = sum);
}

impl System for ZeroSystem {
    fn names(&self) -> &Names {
        &self.names
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
        if let Jacobian::Free(free) = &self.jacobian {
            free.check(x)?;
        }
        let (z, p) = x.split_at(self.names.dimension());
        self.problem.domain(z, p)?;
        match evaluated(self, x) {
            Some((_, equations)) => {
                r.iter_mut().zip(equations).for_each(|(r, equation)| *r = equation.re);
            }
            None => r.copy_from_slice(self.plain.evaluate(&*self.problem, |i| x[i])),
        }
        finite(
            r,
            |i| format!("component {i} of the residual"),
            "the residual must be finite: end the branch before the equations become undefined, \
             and write every component of the residual (components that are not written are NaN)",
        )
    }

    fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
        if self.assembled == x {
            return Ok(());
        }
        self.assembled.clear();
        let n = self.names.dimension();
        let (z, p) = x.split_at(n);
        self.problem.domain(z, p)?;
        if let Jacobian::Unknown = self.jacobian {
            self.jacobian = chosen(self.traced.as_deref(), self.matrices, x, n)?;
        }
        match &mut self.jacobian {
            Jacobian::Dense(dense) => dense.differentiate(&mut self.chunk, &*self.problem, x),
            Jacobian::Free(free) => free.move_to(x),
            _ => self.complete(x)?,
        }
        let name = |k: usize| {
            let [i, j] = self.jacobian.place(k, n);
            format!("derivative of component {i} with respect to unknown {j}")
        };
        finite(self.jacobian.entries(), name, DIFFERENTIABLE)?;
        if let Some(mass) = self.jacobian.mass(n) {
            finite(&mass.entries(), |_| "an entry of the mass matrix".into(), DIFFERENTIABLE)?;
        }
        self.assembled.extend_from_slice(x);
        Ok(())
    }

    fn factor(&mut self, form: Form, border: Border, into: &mut Factors) -> Result<(), Failure> {
        self.jacobian.factor(self.names.dimension(), form, border, into)
    }

    fn derivative(
        &mut self,
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let problem = &*self.problem;
        let moves = directions.iter().any(|d| d.len() > x.len());
        let at = |i: usize| x.get(i).copied().unwrap_or(0.0);
        match *directions {
            [d] if derivative_is_known(self, x, d, out) => {}
            [d] => {
                let r = self.first.left(problem, moves, |i| Dual64::new(at(i), d[i]));
                out.iter_mut().zip(r).for_each(|(out, r)| *out = r.eps);
            }
            [d, e] => {
                let r = self.nested.left(problem, moves, |i| moving(at(i), d[i], e[i]));
                out.iter_mut().zip(r).for_each(|(out, r)| *out = mixed(r));
            }
            [d, e, f] => third([d, e, f], out, |v, w, out| {
                let r = self.nested_twice.left(problem, moves, |i| moving(at(i), v[i], w[i]));
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
        let names = &self.names;
        let expansion = Expansion::new(x, space, terms)?.of_unknowns(names.dimension());
        let work = self.jets.get_or_insert_with(|| Work::new(names));
        let left = work.left(&*self.problem, expansion.moves(), |i| expansion.argument(i));
        expansion.images(left)
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
        match (&self.jacobian, of, &self.traced) {
            (Jacobian::Sparse(_), Functional::Monitor(monitor), Some(traced)) => {
                monitor_gradient(&**traced, x, (monitor, self.monitors.0.len()), out);
            }
            (Jacobian::Sparse(_), _, _) => self.colored_gradient(x, of, released, out),
            _ => self.chunked_gradient(x, of, out),
        }
        finite_gradient(out, self.names.dimension(), released)
    }

    fn slopes(&mut self, x: &[f64], first: usize, direction: &[f64], out: &mut [f64]) {
        let moving = |i: usize| {
            let mut moving = Chunk::from(x[i]);
            moving.eps[0] = direction[i];
            moving
        };
        let (z, p, _) = self.chunk.arguments(moving);
        self.problem.monitors(z, p, &mut self.monitors.1);
        let moving = self.monitors.1[first..].iter();
        out.iter_mut().zip(moving).for_each(|(slope, moving)| *slope = moving.eps[0]);
    }

    fn dynamics(&self) -> Dynamics {
        self.problem.dynamics()
    }

    fn spectrum(
        &mut self,
        _: &[f64],
        request: SpectrumRequest,
    ) -> Result<Option<Spectrum>, Failure> {
        let dynamics = self.problem.dynamics();
        match dynamics {
            Dynamics::None => Ok(None),
            Dynamics::Periodic => Err(Failure::Unsupported(
                "a `ZeroProblem` does not define the Floquet multipliers of a periodic orbit: \
                 define a vector field and use its `periodic_orbits`, or set the dynamics to \
                 `None`"
                    .into(),
            )),
            _ => self.jacobian.spectrum(dynamics, request).map(Some),
        }
    }

    /// Returns the size of a deviation, without unknowns whose rates the equations do not contain:
    /// their values follow from the other unknowns.
    fn deviation(&mut self, _x: &[f64], d: &[f64]) -> Result<Deviation, Failure> {
        let n = self.names.dimension();
        let mass = self.jacobian.mass(n);
        let moving = mass.map_or(vec![true; n], |mass| mass.moving());
        let square = d.iter().zip(moving).filter(|(_, moves)| *moves).map(|(d, _)| d * d).sum();
        Ok(Deviation { square, ..Deviation::default() })
    }

    fn monitors(&mut self, x: &[f64], first: usize, values: &mut [f64]) -> Result<(), Failure> {
        let (z, p) = x.split_at(self.names.dimension());
        self.problem.monitors(z, p, &mut self.monitors.0);
        values.copy_from_slice(&self.monitors.0[first..][..values.len()]);
        let name = |k: usize| format!("monitor {}", self.names.monitors[first + k]);
        finite(values, name, "a monitor must be finite wherever the residual is finite")
    }

    fn unknown_scales(&self, p: &[f64]) -> Vec<f64> {
        self.problem.scales(p)
    }

    /// Adds the use of sparse matrices to the description of the method, because with sparse
    /// matrices only the rightmost eigenvalues are computed, and without a matrix no eigenvalues.
    fn representation(&self) -> Representation {
        let method = match self.jacobian {
            Jacobian::Sparse(_) => "sparse matrices",
            Jacobian::Free(_) => "matrix-free",
            _ => "",
        };
        Representation { method: method.into(), ..Representation::default() }
    }

    fn factors_for_eigenvalues(&self) -> bool {
        matches!(self.jacobian, Jacobian::Sparse(_))
    }

    fn doubts(&self) -> Option<String> {
        match &self.jacobian {
            Jacobian::Sparse(sparse) => sparse.doubts(),
            Jacobian::Free(_) => Some(FreeJacobian::doubts()),
            _ => None,
        }
    }

    fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
        let (z, p) = x.split_at(self.names.dimension());
        match self.problem.profiles(z, p) {
            own if own.is_empty() => Profile::of_arrays(&self.names.unknowns, z),
            own => own,
        }
    }
}
