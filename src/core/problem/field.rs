//! Vector fields: `x' = f(t, x, p)`, written once; derivatives come from automatic differentiation.

use super::forward::forward;
use super::measure::Measure;
use super::names::Names;
use super::zero::ZeroProblem;
use crate::core::failure::OutOfDomain;
use crate::core::scalar::Scalar;
use std::ops::Deref;

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

/// A vector field `f(t, x, p)` with named states and parameters: autonomous, or forced with a
/// period. [`vector_field!`](crate::vector_field) states one by the rates of its states.
///
/// ```
/// use std::f64::consts::TAU;
/// use tangency::core::problem::{Forcing, Names, VectorField};
/// use tangency::core::scalar::Scalar;
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

    /// The value of a monitor, by its position among those of [`names`](Self::names): a further
    /// scalar of a motion, which [`measures`](Self::measures) may name as they name states.
    fn monitor<T: Scalar>(&self, _monitor: usize, _t: T, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }

    /// What is recorded of equilibria and of orbits along branches, and of periods in sweeps, by
    /// name: by default the extremes of every state, and mean and extremes of every monitor
    /// ([`Measure::by_default`]).
    fn measures(&self) -> Vec<(String, Measure)> {
        let names = self.names();
        Measure::by_default(names.elements().collect(), names.monitors)
    }

    /// Typical sizes of the states, in their order, which the absolute tolerance of a flow is
    /// relative to: to be stated where they are far from 1. By default all are 1.
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Refuses states at which the field has no meaning.
    ///
    /// # Errors
    /// [`OutOfDomain`] with the quantity, its value and the domain.
    fn domain(&self, _x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }
}

/// A field that is shared or referred to.
impl<F: Deref<Target: VectorField> + Send + Sync> VectorField for F {
    forward! { |self| (**self);
        fn names() -> Names;
        fn defaults() -> Vec<f64>;
        fn field<T>(t: T, x: &[T], p: &[T], f: &mut [T]) -> ();
        fn forcing() -> Forcing;
        fn period<T>(p: &[T]) -> T;
        fn monitor<T>(monitor: usize, t: T, x: &[T], p: &[T]) -> T;
        fn measures() -> Vec<(String, Measure)>;
        fn scales(p: &[f64]) -> Vec<f64>;
        fn domain(x: &[f64], p: &[f64]) -> Result<(), OutOfDomain>;
    }
}

/// The equilibria of an autonomous vector field, `f(x, p) = 0`, stable or not as its motion says.
/// (A forced field is taken at time 0.)
///
/// Their monitors are the field's [`measures`](VectorField::measures), as of a motion that rests
/// there: `max_x` and `min_x` of a state `x` are the state itself, so that equilibria and periodic
/// orbits can be drawn in one diagram. What only motion has, as
/// [`Integral::Total`](super::measure::Integral::Total), is left out.
///
/// ```
/// use tangency::prelude::*;
/// vector_field! {
///     /// `x' = μx − y − x³, y' = x`: a Hopf point at μ = 0.
///     struct VanDerPol [x, y; mu] {
///         d/dt x = mu * x - y - x.powi(3);
///         d/dt y = x;
///     }
/// }
/// let mut rest = Dense::new(Equilibria(VanDerPol));
/// let branch = Continuation::new(&mut rest).at("mu", -1.0).along("mu", -1.0..=1.0).trace()?;
/// assert!(branch.of_kind(Kind::HB).next().unwrap().parameters[0].abs() < 1e-14);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Equilibria<F>(pub F);

impl<F: VectorField> Equilibria<F> {
    /// The measures that equilibria have, given the scalars there.
    fn measured<T: Scalar>(&self, scalar: impl Fn(&str) -> T) -> impl Iterator<Item = (String, T)> {
        let measures = Measure::of_rest(self.0.measures()).into_iter();
        measures.filter_map(move |(name, measure)| {
            Some((name, measure.at_rest(|name: &String| scalar(name))?))
        })
    }
}

impl<F: VectorField> ZeroProblem for Equilibria<F> {
    fn names(&self) -> Names {
        let mut names = self.0.names();
        names.monitors = self.measured(|_| 0.0).map(|(name, _)| name).collect();
        names
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        self.0.field(T::zero(), z, p, r);
    }

    fn monitors<T: Scalar>(&self, z: &[T], p: &[T], values: &mut [T]) {
        let names = self.0.names();
        let unknown = T::from(f64::NAN);
        let measured = self.measured(|name| match (names.unknown(name), names.monitor(name)) {
            (Some(state), _) => z[state],
            (None, Some(monitor)) => self.0.monitor(monitor, T::zero(), z, p),
            (None, None) => unknown,
        });
        values.iter_mut().zip(measured).for_each(|(value, (_, measure))| *value = measure);
    }

    fn scales(&self, p: &[f64]) -> Vec<f64> {
        self.0.names().sizes_of_groups(&self.0.scales(p))
    }

    fn domain(&self, z: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.0.domain(z, p)
    }
}
