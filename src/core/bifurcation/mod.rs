//! Bifurcations: minimally augmented defining systems, test functions and normal forms.
//!
//! A matrix that is singular at the bifurcation is bordered by additional rows and columns such
//! that the bordered matrix is regular. The border's multiplier `g` vanishes where the matrix is
//! singular, and its gradient is `−∇(wᵀ F_x v)` with the null vectors `v`, `w` from the bordered
//! system (A. Griewank and G. Reddien, *IMA J. Numer. Anal.* 4 (1984); W. Govaerts, *Numerical
//! Methods for Bifurcations of Dynamical Equilibria*, SIAM 2000, chapters 3 and 4).
//!
//! The same defining system locates a fold on a branch, and defines the curve of folds in two
//! parameters:
//!
//! ```
//! use tangency::prelude::*;
//! zero_problem! {
//!     /// Folds at `x² = b/3`, `a = −2x³`; they meet in a cusp at `a = b = 0`.
//!     struct Cubic [x; a, b] { 0 = a + b * x - x * x * x; }
//! }
//! let mut cubic = Dense::new(Cubic);
//! let start = Continuation::new(&mut cubic).from(&[-2.0]).at("a", -6.0).at("b", 1.0);
//! let branch = start.along("a", -6.0..=6.0).trace()?;
//! let fold = branch.of_kind(Kind::LP).next().expect("a fold");
//! assert!((fold.parameters[0] - 2.0 / 27.0_f64.sqrt()).abs() < 1e-13);
//! let curve = Continuation::new(&mut cubic).restart(&branch, fold.label).hold(Kind::LP);
//! let curve = curve.along("a", -1.0..=1.0).along("b", -1.0..=1.0).trace()?;
//! let cusp = curve.of_kind(Kind::CP).next().expect("a cusp");
//! assert!(cusp.parameters.iter().all(|p| p.abs() < 1e-12));
//! # Ok::<(), tangency::core::continuation::TraceError>(())
//! ```

mod at;
mod branch_point;
pub(crate) mod catalogue;
mod crossing;
mod defining_system;
mod degenerate_fold;
mod double_eigenvalue;
mod fold;
mod grazing;
mod hopf;
mod level;
mod normal_form;
mod null;
mod orientation;
mod resonance;
mod sides;
mod stability;
mod test_function;

pub use at::{At, Quantity};
pub use defining_system::DefiningSystem;
pub(crate) use double_eigenvalue::{has_pairs_beside, pairs_beside};
pub(crate) use level::Excess;
pub use level::Level;
pub(crate) use normal_form::{
    Case, ComputeNormalForm, DETAILS, DoubledOrbit, NormalForm, doubled_beside,
};
pub(in crate::core) use orientation::is_possible;
pub(in crate::core) use sides::Sides;
pub(crate) use stability::Critical;
pub use stability::Stability;
pub(in crate::core) use stability::{
    deciding, nearest_to_critical, neutral, unstable_besides, without_critical,
};
pub(crate) use test_function::ConditionValue;
pub use test_function::{Bracketed, Needs, Passage, PointValues, Reading, TestFunction};

pub use branch_point::BranchPoint;
pub(crate) use crossing::{branches_at, parameter_in_range, vertical_reach};
pub use degenerate_fold::DegenerateFold;
pub use fold::Fold;
pub(crate) use fold::{DOUBLE_ROOT, VERTICAL};
pub(crate) use grazing::OrderOfEvents;
pub(in crate::core) use grazing::without_event;
pub use hopf::Hopf;
pub use null::{NullSpace, NullVectors};
