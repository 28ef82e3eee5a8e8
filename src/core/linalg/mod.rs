//! Linear systems of numerical continuation: bordered matrices, and chains of intervals.
//!
//! [`BorderedLu`] factors a bordered dense matrix, and [`Factors`] factors a bordered dense or
//! sparse matrix. [`Chain`] condenses the intervals of a boundary-value problem to its ends (U.
//! Ascher, R. Mattheij and R. Russell, 1995), and [`multipliers`] computes Floquet multipliers from
//! the condensed equations (T. F. Fairgrieve and A. D. Jepson, 1991).
//!
//! ```
//! use tangency::core::linalg::{Border, BorderedLu};
//! // `A = [0]` is singular, as at a fold; the bordered matrix `[0 2; 4 0]` is regular.
//! let mut lu = BorderedLu::default();
//! let border = Border { width: 1, columns: &[2.0], rows: &[4.0], corner: &[0.0], units: &[] };
//! lu.factor(&[0.0], border)?;
//! let mut x = [2.0, 8.0];
//! lu.solve(&mut x);
//! assert_eq!(x, [2.0, 1.0]);
//! # Ok::<(), tangency::core::failure::Failure>(())
//! ```

mod balance;
mod border;
mod certain;
mod chain;
mod condensed;
mod cycle;
mod factors;
mod finite;
mod front;
mod gmres;
mod grouped_fronts;
mod lu;
mod mass;
mod pencil;
mod sparse;
mod vector;

pub(crate) use balance::{balance, balanced};
pub(crate) use certain::clear_rounding;
pub(crate) use vector::{
    advanced, along, are_joined, difference, dot, generic, largest, norm, normalise, orthogonalise,
    refill,
};

pub use border::{Border, Form, Spectrum, SpectrumRequest};
pub use chain::Chain;
pub(in crate::core) use condensed::{Condensed, CondensedLu, RotatedLu, rotate};
pub(in crate::core) use cycle::{Blocks, Cycle};
pub(crate) use factors::ShiftedLu;
pub use factors::{Factorisation, Factors};
pub use finite::finite_eigenvalues;
pub(in crate::core) use gmres::Gmres;
pub use lu::BorderedLu;
pub(in crate::core) use lu::{differ, solved, unit};
pub(in crate::core) use mass::{MassMatrix, factors_with_mass};
pub use pencil::multipliers;
pub(in crate::core) use pencil::undetermined;
pub(in crate::core) use sparse::{
    Coloring, Elimination, KnownFactors, LANES, Lanes, Largest, Leading, Pattern, Pencil,
    Rightmost, SharedLu, SparseLu, SparseShiftedLu,
};
