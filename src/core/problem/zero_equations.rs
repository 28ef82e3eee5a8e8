//! An object-safe trait that represents all zero problems.
//!
//! Users implement the trait [`ZeroProblem`] generically for all scalar types.
//! [`Dense`](crate::core::system::Dense) calls a zero problem through [`ZeroEquations`], one scalar
//! type at a time, and is therefore compiled once for all problems.

use super::erasure::erased;
use super::names::Names;
use super::zero::{Dynamics, Profile, ZeroProblem};
use crate::core::failure::OutOfDomain;
use crate::core::scalar::{Chunk, Jet, Scalar, Traced};
use num_dual::{Dual, Dual2, Dual64};

/// The capacity, in coefficients, of the jets that compute center manifolds: at most 126
/// coefficients are used (order 5 in 4 variables). The vector fields of hybrid systems are
/// evaluated with jets of the same capacity.
pub(in crate::core) const ROOM: usize = 128;

/// A scalar type in which every zero problem can be evaluated.
pub trait ZeroNumber: Scalar {
    /// Returns the residual of a zero problem, evaluated in this scalar type.
    fn functions(problem: &dyn ZeroEquations) -> &dyn ZeroFunctions<Self>;
}

/// A scalar type in which the monitors of every zero problem can be evaluated.
pub trait MonitorNumber: Scalar {
    /// Returns the monitors of a zero problem, evaluated in this scalar type.
    fn monitored(problem: &dyn ZeroEquations) -> &dyn ZeroMonitors<Self>;
}

erased! {
    /// The residual and the mass matrix of a zero problem, evaluated in one scalar type.
    pub trait ZeroFunctions<T> of ZeroProblem by ZeroNumber::functions of ZeroEquations {
        /// Computes the residual of the zero problem and writes it into `r`.
        fn residual as residual_in(z: &[T], p: &[T], r: &mut [T]) -> ();
        /// Computes the products of the mass matrix with the rates and writes them into
        /// `products`.
        fn mass_product as mass_product_in(
            z: &[T], p: &[T], rates: &[T], products: &mut [T]
        ) -> ();
    }
}

erased! {
    /// The monitors of a zero problem, evaluated in one scalar type.
    pub trait ZeroMonitors<T> of ZeroProblem by MonitorNumber::monitored of ZeroEquations {
        /// Computes the monitors of the zero problem and writes them into `values`.
        fn monitors as monitors_in(z: &[T], p: &[T], values: &mut [T]) -> ();
    }
}

erased! {
    /// The functions of a zero problem, in each of the scalar types that generic code needs.
    pub trait InScalars;

    impl ZeroNumber by ZeroFunctions for [
        f64, Dual64, Jet<ROOM>, Chunk, Dual<Chunk>, Dual2<Chunk>
    ] {
        fn functions(problem: &dyn ZeroEquations) -> &dyn ZeroFunctions<Self> { problem }
    }
    impl MonitorNumber by ZeroMonitors for [f64, Chunk] {
        fn monitored(problem: &dyn ZeroEquations) -> &dyn ZeroMonitors<Self> { problem }
    }
}

erased! {
    /// A zero problem in the scalar types that are needed for its derivatives. Every
    /// [`ZeroProblem`] implements this trait; the methods are documented at [`ZeroProblem`].
    pub trait ZeroEquations: InScalars of ZeroProblem {
        fn names() -> Names;
        fn defaults() -> Vec<f64>;
        fn domain(z: &[f64], p: &[f64]) -> Result<(), OutOfDomain>;
        fn dynamics() -> Dynamics;
        fn scales(p: &[f64]) -> Vec<f64>;
        fn profiles(z: &[f64], p: &[f64]) -> Vec<Profile>;
    }
}

/// A zero problem evaluated with numbers that record the operations of the computation. Every
/// [`ZeroProblem`] implements this trait.
pub trait TracedEquations: ZeroEquations {
    /// Computes the residual of the zero problem and writes it into `r`.
    fn traced_residual(&self, z: &[Traced], p: &[Traced], r: &mut [Traced]);

    /// Computes the products of the mass matrix with the rates and writes them into `products`.
    fn traced_mass_product(
        &self,
        z: &[Traced],
        p: &[Traced],
        rates: &[Traced],
        products: &mut [Traced],
    );

    /// Computes the monitors of the zero problem and writes them into `values`.
    fn traced_monitors(&self, z: &[Traced], p: &[Traced], values: &mut [Traced]);
}

impl<P: ZeroProblem> TracedEquations for P {
    fn traced_residual(&self, z: &[Traced], p: &[Traced], r: &mut [Traced]) {
        self.residual(z, p, r);
    }

    fn traced_mass_product(
        &self,
        z: &[Traced],
        p: &[Traced],
        rates: &[Traced],
        products: &mut [Traced],
    ) {
        self.mass_product(z, p, rates, products);
    }

    fn traced_monitors(&self, z: &[Traced], p: &[Traced], values: &mut [Traced]) {
        self.monitors(z, p, values);
    }
}
