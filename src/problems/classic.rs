//! Test problems from the literature, as used by other continuation toolkits.
//!
//! | problem | equations |
//! |---|---|
//! | [`ParallelPlate`], [`Hyperbola`] | equations in one unknown: an equation with a fold, and an equation whose two branches nearly cross |
//! | [`Lure`], [`Isothermal`] | vector fields with a Hopf point and period doublings (R. Seydel, *Practical Bifurcation and Stability Analysis*, example 7.8) |
//! | [`ProtheroRobinson`] | a stiff vector field, the Prothero–Robinson equation (1974) |
//! | [`ImpactOscillator`] | a hybrid system, the forced impact oscillator (S. W. Shaw and P. J. Holmes, 1983) |
//! | [`Bratu`], [`Decay`] | boundary-value problems |
//!
//! ```
//! use tangency::prelude::*;
//! use tangency::problems::classic::Lure;
//! // The equilibrium 0 of `x″′ + αx″ + βx′ + x = x²` at β = 1 has a Hopf point at α = 1.
//! let mut rest = Dense::new(Equilibria::new(Lure));
//! let start = Continuation::new(&mut rest).at("alpha", 0.5).at("beta", 1.0);
//! let branch = start.along("alpha", 0.5..=1.5).trace()?;
//! let hopf = branch.of_kind(Kind::HB).next().expect("a Hopf point");
//! assert!((hopf.parameters[0] - 1.0).abs() < 1e-13);
//! # Ok::<(), tangency::core::continuation::TraceError>(())
//! ```

mod equilibria;
mod impact_oscillator;
mod prothero_robinson;

pub use equilibria::{Hyperbola, ParallelPlate};
pub use impact_oscillator::ImpactOscillator;
pub use prothero_robinson::ProtheroRobinson;

use crate::core::bvp::{BoundaryProblem, Ends, Monitor};
use crate::core::scalar::Scalar;
use crate::vector_field;

vector_field! {
    /// A feedback control system of Lur'e type (also MatCont's `adaptx`):
    /// `x' = y, y' = z, z' = −αz − βy − x + x²`.
    ///
    /// At β = 1 the equilibrium 0 has a Hopf point at α = 1, and the emanating periodic orbits
    /// double their period at α = 0.630302006160.
    ///
    /// ```
    /// use tangency::core::problem::VectorField;
    /// use tangency::problems::classic::Lure;
    /// let mut f = [0.0; 3];
    /// Lure.field(0.0, &[0.5, 1.0, 2.0], &[1.0, 1.0], &mut f);
    /// assert_eq!(f, [1.0, 2.0, -3.25]);
    /// ```
    pub struct Lure [x, y, z; alpha = 1.2, beta = 1.0] {
        d/dt x = y;
        d/dt y = z;
        d/dt z = x * x - x - beta * y - alpha * z;
    }
}

vector_field! {
    /// An isothermal reaction (R. Seydel, *Practical Bifurcation and Stability Analysis*, example 7.8),
    /// with a cascade of period doublings in λ.
    ///
    /// ```
    /// use tangency::core::problem::VectorField;
    /// use tangency::problems::classic::Isothermal;
    /// let mut f = [0.0; 3];
    /// Isothermal.field(0.0, &[4.0, 0.0, 0.0], &[12.0], &mut f);
    /// assert_eq!(f, [4.0 * 29.0 + 0.1, 0.1, 0.1]);
    /// ```
    pub struct Isothermal [y1, y2, y3; lambda = 14.0] {
        d/dt y1 = y1 * (-y1 * 0.25 - y2 - y3 + 30.0) + y2 * y2 * 0.001 + 0.1;
        d/dt y2 = y2 * (y1 - y2 * 0.001 - lambda) + 0.1;
        d/dt y3 = y3 * (-y1 - y3 * 0.5 + 16.5) + 0.1;
    }
}

/// Bratu's problem `u'' + λeᵘ = 0`, `u(0) = u(1) = 0`, as the first-order system `u' = v, v' =
/// −λeᵘ`. The fold of Bratu's problem is at `λ = 8θ²/cosh²θ` with `θ tanh θ = 1`.
///
/// ```
/// use tangency::core::bvp::BoundaryProblem;
/// use tangency::problems::classic::Bratu;
/// let mut f = [0.0; 2];
/// Bratu.field(0, 0.0, &[0.0, 4.0], &[3.0], &mut f);
/// assert_eq!(f, [4.0, -3.0]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bratu;

impl BoundaryProblem for Bratu {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![vec!["u".into(), "v".into()]]
    }

    fn parameters(&self) -> Vec<String> {
        vec!["lambda".into()]
    }

    fn defaults(&self) -> Vec<f64> {
        vec![0.0]
    }

    fn field<T: Scalar>(&self, _segment: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = x[1];
        f[1] = -q[0] * x[0].exp();
    }

    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0];
        b[1] = ends.end[0];
    }

    fn monitors(&self) -> Vec<(String, Monitor)> {
        vec![("max_u".into(), Monitor::maximum(0, 0))]
    }
}

/// Exponential decay `x' = −rate·x`, `x(0) = 1`, over one unit of time, with the solution `x =
/// e^{−rate t}`.
///
/// ```
/// use tangency::core::bvp::{BoundaryProblem, Ends};
/// use tangency::problems::classic::Decay;
/// let mut b = [0.0];
/// Decay.boundary(Ends { start: &[3.0], end: &[1.0] }, &[], &mut b);
/// assert_eq!(b, [2.0]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Decay;

impl BoundaryProblem for Decay {
    fn segments(&self) -> Vec<Vec<String>> {
        vec![vec!["x".into()]]
    }

    fn parameters(&self) -> Vec<String> {
        vec!["rate".into()]
    }

    fn field<T: Scalar>(&self, _segment: usize, _t: T, x: &[T], q: &[T], f: &mut [T]) {
        f[0] = -q[0] * x[0];
    }

    fn boundary<T: Scalar>(&self, ends: Ends<T>, _q: &[T], b: &mut [T]) {
        b[0] = ends.start[0] - 1.0;
    }
}
