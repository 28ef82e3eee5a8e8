//! Implements [`System`] for zero problems, with dense or sparse matrices, or without a matrix.

use super::free_jacobian::{FreeJacobian, Preconditioner};
use super::jacobian::Jacobian;
use super::zero_system::{Matrices, ZeroSystem};
use super::{Deviation, Functional, Representation, System};
use crate::core::failure::Failure;
use crate::core::linalg::{Border, Factors, Form, Spectrum, SpectrumRequest};
use crate::core::problem::{Dynamics, Names, Profile, ZeroProblem};
use crate::core::scalar::Space;
use std::sync::Arc;

/// A [`ZeroProblem`] as a [`System`] with a dense matrix `F_z`. All derivatives are evaluations of
/// the residual on dual numbers: `⌈n/8⌉` passes for the Jacobian, one for a directional derivative
/// (two for a third derivative along three different directions), and `⌈(n + m)/8⌉` nested passes
/// for a gradient (for [`Dynamics::Potential`] problems one pass, and one for each released
/// parameter).
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
    system: ZeroSystem,
}

impl<P: ZeroProblem + 'static> Dense<P> {
    /// Creates the system, with dense matrices, of a zero problem.
    pub fn new(problem: P) -> Self {
        Dense::shared(Arc::new(problem))
    }

    /// Creates the system of a zero problem in shared ownership.
    pub fn shared(problem: Arc<P>) -> Self {
        Dense { system: ZeroSystem::structured(problem.clone(), Matrices::Dense), problem }
    }

    /// Uses a function of the problem to compute `F_z`, for residuals whose Jacobian is a sum of
    /// constant tables. The result of the function must agree with the derivative of the residual
    /// by dual numbers.
    #[must_use]
    pub fn tabulated(mut self, jacobian: fn(&P, &[f64], &[f64], &mut [f64])) -> Self {
        let problem = self.problem.clone();
        self.system.tabulate(Box::new(move |z, p, out| jacobian(&problem, z, p, out)));
        self
    }

    /// The problem itself.
    pub fn problem(&self) -> &P {
        &self.problem
    }

    /// Writes the assembled `F_z` as a dense `n × n` matrix, column by column.
    pub fn jacobian(&self, out: &mut [f64]) {
        self.system.jacobian(out);
    }
}

/// A [`ZeroProblem`] as a [`System`] whose `F_z` is sparse: each equation depends on few unknowns,
/// as in a discretised partial differential equation. Time and memory for a sparse matrix grow only
/// slightly faster than linearly in the number of unknowns.
///
/// The sparsity pattern of `F_z` is determined at the first point, by evaluating the residual on
/// numbers that record its computation. Each assembled `F_z` is compared with a directional
/// derivative of the residual. The pattern is extended if an equation that contains comparisons
/// depends on further unknowns. Columns that have no common row get the same color and are
/// differentiated together: a Jacobian with `c` colors takes `⌈c/8⌉` passes. Only the rightmost
/// eigenvalues of a sparse `F_z` are computed.
///
/// ```
/// use tangency::core::continuation::{Continuation, Settings};
/// use tangency::core::problem::{Names, ZeroProblem};
/// use tangency::core::scalar::Scalar;
/// use tangency::core::system::{Kind, Sparse};
/// /// Bratu's problem u'' + λ eᵘ = 0, u(0) = u(1) = 0, by finite differences.
/// struct Bratu(usize);
/// impl ZeroProblem for Bratu {
///     fn names(&self) -> Names {
///         Names::new([("u", self.0)], ["lambda"])
///     }
///     fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
///         let h = 1.0 / (self.0 + 1) as f64;
///         let at = |i: usize| u.get(i.wrapping_sub(1)).copied().unwrap_or(T::zero());
///         for i in 1..=self.0 {
///             r[i - 1] = (at(i - 1) - at(i) * 2.0 + at(i + 1)) / (h * h) + p[0] * at(i).exp();
///         }
///     }
/// }
/// let mut system = Sparse::new(Bratu(2000));
/// let settings = Settings { max_points: 60, ..Settings::default() };
/// let solutions = Continuation::new(&mut system).settings(settings);
/// let branch = solutions.along("lambda", 0.0..=4.0).trace()?;
/// let fold = branch.of_kind(Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] - 3.513830719).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Sparse<P> {
    problem: Arc<P>,
    system: ZeroSystem,
}

impl<P: ZeroProblem + 'static> Sparse<P> {
    /// Creates the system, with sparse matrices, of a zero problem.
    pub fn new(problem: P) -> Self {
        let problem = Arc::new(problem);
        Sparse { system: ZeroSystem::structured(problem.clone(), Matrices::Sparse), problem }
    }

    /// The problem itself.
    pub fn problem(&self) -> &P {
        &self.problem
    }
}

/// A [`ZeroProblem`] as a [`System`] without a matrix: `F_z` is neither stored nor factored. Linear
/// systems are solved by a Krylov method from products `F_z v`, which are directional derivatives
/// of the residual by dual numbers. A [`Preconditioner`] approximates the inverse of `F_z`; with a
/// good preconditioner, a linear system takes about ten to thirty evaluations of the residual.
///
/// Branches are continued past folds, and folds are located, because the bordered `F_z` is regular
/// at folds. The gradients in the last corrections of a fold take `n/8` evaluations of the residual.
/// Without a matrix, eigenvalues and the sign of the determinant are not computed: the stability of
/// solutions is unknown, and branch points and Hopf points are not detected. A warning of the branch
/// reports this.
///
/// ```
/// use tangency::core::continuation::{Continuation, Settings};
/// use tangency::core::problem::{Names, ZeroProblem};
/// use tangency::core::scalar::Scalar;
/// use tangency::core::system::{Kind, MatrixFree, Preconditioner};
/// /// Bratu's problem u'' + λ eᵘ = 0, u(0) = u(1) = 0, by finite differences.
/// struct Bratu(usize);
/// impl ZeroProblem for Bratu {
///     fn names(&self) -> Names {
///         Names::new([("u", self.0)], ["lambda"])
///     }
///     fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
///         let h = 1.0 / (self.0 + 1) as f64;
///         let at = |i: usize| u.get(i.wrapping_sub(1)).copied().unwrap_or(T::zero());
///         for i in 1..=self.0 {
///             r[i - 1] = (at(i - 1) - at(i) * 2.0 + at(i + 1)) / (h * h) + p[0] * at(i).exp();
///         }
///     }
/// }
/// /// The inverse of u'', by two sums: v'' = f, v(0) = v(1) = 0.
/// struct Inverse;
/// impl Preconditioner for Inverse {
///     fn apply(&self, _z: &[f64], _p: &[f64], v: &mut [f64]) {
///         let h = 1.0 / (v.len() + 1) as f64;
///         let (mut slope, mut sum) = (0.0, 0.0);
///         for v in v.iter_mut() {
///             sum += h * slope;
///             slope += h * *v;
///             *v = sum;
///         }
///         let end = sum + h * slope;
///         for (i, v) in v.iter_mut().enumerate() {
///             *v -= (i + 1) as f64 * h * end;
///         }
///     }
/// }
/// let mut system = MatrixFree::new(Bratu(99), Inverse);
/// let settings = Settings { max_points: 30, ..Settings::default() };
/// let solutions = Continuation::new(&mut system).settings(settings);
/// let branch = solutions.along("lambda", 0.0..=4.0).trace()?;
/// let fold = branch.of_kind(Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] - 3.513647904).abs() < 1e-8);
/// assert!(fold.unstable.is_none());
/// assert!(branch.warnings.iter().any(|warning| warning.contains("without a matrix")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct MatrixFree<P> {
    problem: Arc<P>,
    system: ZeroSystem,
}

impl<P: ZeroProblem + 'static> MatrixFree<P> {
    /// Creates the system, without a matrix, of a zero problem.
    pub fn new(problem: P, preconditioner: impl Preconditioner) -> Self {
        let problem = Arc::new(problem);
        let mut system = ZeroSystem::structured(problem.clone(), Matrices::Dense);
        let free = FreeJacobian::new(problem.clone(), Arc::new(preconditioner));
        system.jacobian = Jacobian::Free(free);
        MatrixFree { system, problem }
    }

    /// The problem itself.
    pub fn problem(&self) -> &P {
        &self.problem
    }
}

/// Delegates all methods of [`System`] to the inner system.
macro_rules! delegated {
    ($system:ident) => {
        impl<P: ZeroProblem + 'static> System for $system<P> {
            fn names(&self) -> &Names {
                self.system.names()
            }

            fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Failure> {
                self.system.residual(x, r)
            }

            fn assemble(&mut self, x: &[f64]) -> Result<(), Failure> {
                self.system.assemble(x)
            }

            fn factor(
                &mut self,
                form: Form,
                border: Border,
                into: &mut Factors,
            ) -> Result<(), Failure> {
                self.system.factor(form, border, into)
            }

            fn derivative(
                &mut self,
                x: &[f64],
                directions: &[&[f64]],
                out: &mut [f64],
            ) -> Result<(), Failure> {
                self.system.derivative(x, directions, out)
            }

            fn gradient(
                &mut self,
                x: &[f64],
                of: Functional,
                released: &[usize],
                out: &mut [f64],
            ) -> Result<(), Failure> {
                self.system.gradient(x, of, released, out)
            }

            fn slopes(&mut self, x: &[f64], first: usize, along: &[f64], out: &mut [f64]) {
                self.system.slopes(x, first, along, out);
            }

            fn dynamics(&self) -> Dynamics {
                self.system.dynamics()
            }

            fn spectrum(
                &mut self,
                x: &[f64],
                request: SpectrumRequest,
            ) -> Result<Option<Spectrum>, Failure> {
                self.system.spectrum(x, request)
            }

            fn expand(
                &mut self,
                x: &[f64],
                space: &'static Space,
                terms: &[Vec<f64>],
            ) -> Result<Vec<Vec<f64>>, Failure> {
                self.system.expand(x, space, terms)
            }

            fn deviation(&mut self, x: &[f64], d: &[f64]) -> Result<Deviation, Failure> {
                self.system.deviation(x, d)
            }

            fn monitors(
                &mut self,
                x: &[f64],
                first: usize,
                values: &mut [f64],
            ) -> Result<(), Failure> {
                self.system.monitors(x, first, values)
            }

            fn unknown_scales(&self, p: &[f64]) -> Vec<f64> {
                self.system.unknown_scales(p)
            }

            fn representation(&self) -> Representation {
                self.system.representation()
            }

            fn factors_for_eigenvalues(&self) -> bool {
                self.system.factors_for_eigenvalues()
            }

            fn doubts(&self) -> Option<String> {
                self.system.doubts()
            }

            fn profiles(&mut self, x: &[f64]) -> Vec<Profile> {
                self.system.profiles(x)
            }
        }
    };
}

delegated!(Dense);
delegated!(Sparse);
delegated!(MatrixFree);
