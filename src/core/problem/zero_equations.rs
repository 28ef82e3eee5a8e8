//! Zero problems behind one object-safe face.
//!
//! Users write a [`ZeroProblem`] generically. [`Dense`](crate::core::system::Dense) sees it through
//! [`ZeroEquations`], one scalar at a time, so that it is compiled once and not for every problem.

use super::erasure::erased;
use super::names::Names;
use super::zero::{Dynamics, Profile, ZeroProblem};
use crate::core::failure::OutOfDomain;
use crate::core::scalar::{Chunk, Jet, Scalar, Traced};
use num_dual::{Dual, Dual2, Dual64};

/// The room of jets for center manifolds, of up to 126 coefficients (order 5 in 4 variables): a size
/// that the fields of hybrid systems have as well.
pub(in crate::core) const ROOM: usize = 128;

/// A scalar in which any zero problem can be evaluated.
pub trait ZeroNumber: Scalar {
    /// The problem in this scalar.
    fn functions(problem: &dyn ZeroEquations) -> &dyn ZeroFunctions<Self>;
}

/// A scalar in which the monitors of any zero problem can be evaluated.
pub trait MonitorNumber: Scalar {
    /// The monitors in this scalar.
    fn monitored(problem: &dyn ZeroEquations) -> &dyn ZeroMonitors<Self>;
}

erased! {
    /// The residual of a zero problem in one scalar.
    pub trait ZeroFunctions<T> of ZeroProblem by ZeroNumber::functions of ZeroEquations {
        /// The residual, written into `r`.
        fn residual as residual_in(z: &[T], p: &[T], r: &mut [T]) -> ();
    }
}

erased! {
    /// The monitors of a zero problem in one scalar.
    pub trait ZeroMonitors<T> of ZeroProblem by MonitorNumber::monitored of ZeroEquations {
        /// The monitors, written into `values`.
        fn monitors as monitors_in(z: &[T], p: &[T], values: &mut [T]) -> ();
    }
}

erased! {
    /// The functions of a zero problem in each scalar in which generic code needs them.
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
    /// A zero problem in the scalars that its derivatives need. Every [`ZeroProblem`] is one; its
    /// documentation says what each method means.
    pub trait ZeroEquations: InScalars of ZeroProblem {
        fn names() -> Names;
        fn domain(z: &[f64], p: &[f64]) -> Result<(), OutOfDomain>;
        fn dynamics() -> Dynamics;
        fn scales(p: &[f64]) -> Vec<f64>;
        fn profiles(z: &[f64], p: &[f64]) -> Vec<Profile>;
    }
}

/// A zero problem in numbers that record how they are computed. Every [`ZeroProblem`] is one.
pub trait TracedEquations: ZeroEquations {
    /// The residual, written into `r`.
    fn traced_residual(&self, z: &[Traced], p: &[Traced], r: &mut [Traced]);

    /// The monitors, written into `values`.
    fn traced_monitors(&self, z: &[Traced], p: &[Traced], values: &mut [Traced]);
}

impl<P: ZeroProblem> TracedEquations for P {
    fn traced_residual(&self, z: &[Traced], p: &[Traced], r: &mut [Traced]) {
        self.residual(z, p, r);
    }

    fn traced_monitors(&self, z: &[Traced], p: &[Traced], values: &mut [Traced]) {
        self.monitors(z, p, values);
    }
}
