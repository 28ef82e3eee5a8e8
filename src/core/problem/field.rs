//! Vector fields: `x' = f(t, x, p)`, written once; derivatives come from automatic differentiation.

use super::forward::forward;
use super::measure::Measure;
use super::names::Names;
use super::watch::Observable;
use super::zero::ZeroProblem;
use crate::core::failure::OutOfDomain;
use crate::core::scalar::Scalar;
use std::ops::Deref;

/// The dependence of a vector field or a hybrid system on time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Forcing {
    /// The system does not depend on time: it is autonomous.
    None,
    /// Time enters periodically.
    Periodic {
        /// The increase of the forcing's phase in a period, usually 2π.
        phase: f64,
    },
}

impl Forcing {
    /// Whether the system is periodically forced.
    pub fn is_periodic(self) -> bool {
        self != Forcing::None
    }
}

/// A vector field `f(t, x, p)` with named states and parameters: autonomous, or forced with a period.
/// [`vector_field!`](crate::vector_field) defines a vector field by formulas for the rates of its
/// states.
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
    /// Returns the names of the states and of the parameters; the number of states is the
    /// dimension.
    fn names(&self) -> Names;

    /// Returns the default values of all parameters, in order; an empty list if the field has no
    /// default values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Computes the vector field `f(t, x, p)` and writes it into `f`, which has the same length as
    /// `x`.
    fn field<T: Scalar>(&self, t: T, x: &[T], p: &[T], f: &mut [T]);

    /// Returns the kind of forcing; none by default.
    fn forcing(&self) -> Forcing {
        Forcing::None
    }

    /// Returns the period of a periodic [`forcing`](Self::forcing); unused in autonomous fields.
    fn period<T: Scalar>(&self, _p: &[T]) -> T {
        T::one()
    }

    /// Computes a monitor, which is a further scalar function of the motion, given its index in
    /// [`names`](Self::names). [`measures`](Self::measures) can refer to monitors in the same way
    /// as to states.
    fn monitor<T: Scalar>(&self, _monitor: usize, _t: T, _x: &[T], _p: &[T]) -> T {
        T::from(f64::NAN)
    }

    /// Returns the named measures that branches record for equilibria and orbits, and that sweeps
    /// record for periods. The default measures are the extremes of every state, and the mean and
    /// extremes of every monitor ([`Measure::by_default`]).
    fn measures(&self) -> Vec<(String, Measure)> {
        let names = self.names();
        Measure::by_default(names.elements().collect(), names.monitors)
    }

    /// Returns the typical sizes of the states, in their order, which are the units of the
    /// integrator's absolute tolerance; they must be given if they are far from 1. By default all
    /// sizes are 1.
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Returns an error for states outside the domain of the field.
    fn domain(&self, _x: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }
}

/// Every shared or borrowed vector field also implements [`VectorField`].
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

/// The equilibria of an autonomous vector field, `f(x, p) = 0`, with their stability under its
/// flow. (A forced field is evaluated at time 0.)
///
/// The monitors of an equilibrium are the field's [`measures`](VectorField::measures) of a motion at
/// rest: `max_x` and `min_x` of a state `x` are the state itself, so that equilibria and periodic
/// orbits can be drawn in one diagram. Measures that need motion, such as
/// [`Integral::Total`](super::measure::Integral::Total), are not monitors of equilibria.
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
/// let mut rest = Dense::new(Equilibria::new(VanDerPol));
/// let branch = Continuation::new(&mut rest).at("mu", -1.0).along("mu", -1.0..=1.0).trace()?;
/// assert!(branch.of_kind(Kind::HB).next().unwrap().parameters[0].abs() < 1e-14);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Equilibria<F> {
    field: F,
    names: Names,
    /// The measures of a motion at rest; a scalar that the field does not define is `None`.
    measures: Vec<Measure<Option<Observable>>>,
}

impl<F: VectorField> Equilibria<F> {
    /// Creates the zero problem `f(x, p) = 0` of a vector field.
    pub fn new(field: F) -> Self {
        let mut names = field.names();
        let (recorded, measures): (Vec<String>, Vec<_>) =
            Measure::of_rest(field.measures()).into_iter().unzip();
        let places = |name: &str| (names.unknown(name), names.monitor(name));
        let observable = |name: &String| match places(name) {
            (Some(state), _) => Some(Observable::State(state)),
            (None, function) => function.map(Observable::Function),
        };
        let measures = measures.iter().map(|measure| measure.map(observable)).collect();
        names.monitors = recorded;
        Equilibria { field, names, measures }
    }
}

impl<F: VectorField> ZeroProblem for Equilibria<F> {
    fn names(&self) -> Names {
        self.names.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.field.defaults()
    }

    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
        self.field.field(T::zero(), z, p, r);
    }

    fn monitors<T: Scalar>(&self, z: &[T], p: &[T], values: &mut [T]) {
        let scalar = |of: &Option<Observable>| match *of {
            Some(Observable::State(state)) => z[state],
            Some(Observable::Function(function)) => self.field.monitor(function, T::zero(), z, p),
            None => T::from(f64::NAN),
        };
        for (value, measure) in values.iter_mut().zip(&self.measures) {
            *value = measure.at_rest(scalar).unwrap_or_else(T::zero);
        }
    }

    fn scales(&self, p: &[f64]) -> Vec<f64> {
        self.names.sizes_of_groups(&self.field.scales(p))
    }

    fn domain(&self, z: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        self.field.domain(z, p)
    }
}
