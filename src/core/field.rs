//! Vector fields: `x' = f(t, x, p)`, written once; derivatives come from automatic differentiation.

use super::scalar::Scalar;
use super::zero::{LeftDomain, Names, ZeroProblem};

/// Whether time itself enters a vector field or a hybrid system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Forcing {
    /// It does not: the system is autonomous.
    None,
    /// It enters periodically.
    Periodic {
        /// By how much the phase of the forcing grows in a period: usually 2π.
        phase: f64,
    },
}

impl Forcing {
    /// Whether there is a forcing.
    pub fn is_periodic(self) -> bool {
        self != Forcing::None
    }
}

/// A vector field `f(t, x, p)` with named states and parameters: autonomous, or forced with a period.
///
/// ```
/// use std::f64::consts::TAU;
/// use tangency::core::{field::{Forcing, VectorField}, scalar::Scalar, zero::Names};
/// /// A linear oscillator under a force of frequency ω: `x'' + c x' + x = cos ωt`.
/// struct Oscillator;
/// impl VectorField for Oscillator {
///     fn names(&self) -> Names {
///         Names::new(["x", "v"], ["frequency", "damping"])
///     }
///     fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]) {
///         f[0] = x[1];
///         f[1] = (p[0] * t).cos() - x[0] - p[1] * x[1];
///     }
///     fn forcing(&self) -> Forcing {
///         Forcing::Periodic { phase: TAU }
///     }
///     fn period<T: Scalar>(&self, p: &[T]) -> T {
///         p[0].recip() * TAU
///     }
/// }
/// let mut f = [0.0; 2];
/// Oscillator.field(0.0, &[0.5, 2.0], &[1.0, 0.1], &mut f);
/// assert_eq!(f, [2.0, 1.0 - 0.5 - 0.2]);
/// ```
pub trait VectorField: Send + Sync {
    /// The names of the states and of the parameters; their number is the field's size.
    fn names(&self) -> Names;

    /// The default values of all parameters, in order; empty if there are none.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The field `f(t, x, p)`, written into `f` (as long as `x`).
    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// The forcing: by default there is none.
    fn forcing(&self) -> Forcing {
        Forcing::None
    }

    /// The period of a periodic [`forcing`](Self::forcing); not used without one.
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::one()
    }

    /// Typical sizes of the states, in their order, which the absolute tolerance of a flow is relative to: to be stated
    /// where they are far from 1. By default all are 1.
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Refuses states at which the field has no meaning.
    ///
    /// # Errors
    /// [`LeftDomain`] with the quantity, its value and the domain.
    fn domain(&self, _x: &[f64], _p: &[f64]) -> Result<(), LeftDomain> {
        Ok(())
    }
}

/// The equilibria of an autonomous vector field, `f(x, p) = 0`, stable or not as its motion says. (A forced
/// field is taken at time 0.)
///
/// Its monitors `max_x` and `min_x` of a state `x` are the state itself, so that equilibria and periodic orbits
/// can be drawn in one diagram.
///
/// ```
/// use tangency::core::{continuation::{Continuation, Kind}, dense::Dense, scalar::Scalar, zero::Names};
/// use tangency::core::field::{Equilibria, VectorField};
/// /// `x' = μx − y − x³, y' = x`: a Hopf point at μ = 0.
/// #[derive(Clone)]
/// struct VanDerPol;
/// impl VectorField for VanDerPol {
///     fn names(&self) -> Names {
///         Names::new(["x", "y"], ["mu"])
///     }
///     fn field<T: Scalar>(&self, _t: T, x: &[T], p: &[T], f: &mut [T]) {
///         f[0] = p[0] * x[0] - x[1] - x[0].powi(3);
///         f[1] = x[0];
///     }
/// }
/// let mut rest = Dense::new(Equilibria(VanDerPol));
/// let branch = Continuation::of(&mut rest).at("mu", -1.0).along("mu", -1.0..=1.0).trace()?;
/// assert!(branch.of_kind(Kind::HB).next().unwrap().parameters[0].abs() < 1e-14);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Equilibria<F>(pub F);

impl<F: VectorField> ZeroProblem for Equilibria<F> {
    fn names(&self) -> Names {
        let names = self.0.names();
        let states: Vec<String> = names.unknowns.iter().map(|state| state.name.clone()).collect();
        names.with_monitors(extremes(&states))
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        self.0.field(T::zero(), z, p, r);
    }

    fn monitors<T: Scalar>(&self, z: &[T], _p: &[T], values: &mut [T]) {
        for (values, z) in values.chunks_exact_mut(2).zip(z) {
            values.fill(*z);
        }
    }

    fn domain(&self, z: &[f64], p: &[f64]) -> Result<(), LeftDomain> {
        self.0.domain(z, p)
    }
}

/// The names of the largest and the smallest value of each state.
pub(super) fn extremes(states: &[String]) -> Vec<String> {
    states.iter().flat_map(|x| [format!("max_{x}"), format!("min_{x}")]).collect()
}
