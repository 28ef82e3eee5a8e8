//! Measures of a motion, described in the same way for branches, sweeps and equilibria.

use crate::core::scalar::Scalar;
use std::collections::HashSet;
use std::convert::Infallible;

/// A measure: a number computed from a motion. A measure has the same meaning for an orbit on a
/// branch and for a period of a sweep.
///
/// The type parameter `S` is the type by which a measure refers to a scalar of the motion. In user
/// code, `S` is the name of a state or of a monitor. In a boundary-value problem, `S` lists the
/// segments on which the scalar is defined, and `D` lists the surfaces to which distances are
/// measured ([`bvp::Monitor`](crate::core::bvp::Monitor)). Extremes of a scalar are taken over the
/// interior and the ends of all legs (parts of the motion between two events) in whose mode the
/// scalar is defined.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Measure<S = String, D = Infallible> {
    /// The duration of the motion, in units of time.
    Duration,
    /// The largest value of a scalar over the motion.
    Maximum(S),
    /// The smallest value of a scalar over the motion.
    Minimum(S),
    /// The difference between the largest and the smallest value of a scalar.
    Range(S),
    /// The smallest local minimum of a guard inside a leg (a part of the motion between two events)
    /// or at one of its ends, or the maximum of the guard if it has no minimum. This distance vanishes if
    /// the motion touches a surface.
    Distance(D),
    /// The negative of [`Distance`](Self::Distance): the depth to which motion would pass beyond a
    /// surface if the surface were absent.
    Penetration(D),
    /// The largest value of a scalar at the upward zero crossings of another scalar; 0 without such
    /// crossings.
    Rising {
        /// The scalar whose upward zero crossings are used.
        through: S,
        /// The scalar that is evaluated at the crossings.
        value: S,
    },
    /// A time integral of a sum over one or several scalars, given by the list.
    Integral(Integral, Vec<S>),
    /// A number, given by its index, that the problem computes from the states at the ends of all
    /// legs (parts of the motion between two events)
    /// ([`HybridSystem::measure`](crate::core::hybrid::HybridSystem::measure),
    /// [`BoundaryProblem::of_ends`](crate::core::bvp::BoundaryProblem::of_ends)).
    Ends(usize),
}

impl<S, D> Measure<S, D> {
    /// Returns the scalars to which the measure refers.
    pub(in crate::core) fn scalars(&self) -> Vec<&S> {
        match self {
            Measure::Maximum(s) | Measure::Minimum(s) | Measure::Range(s) => vec![s],
            Measure::Rising { through, value } => vec![through, value],
            Measure::Integral(_, all) => all.iter().collect(),
            _ => Vec::new(),
        }
    }
}

impl<S> Measure<S> {
    /// Converts the measure to a measure whose scalars are given by another type.
    ///
    /// ```
    /// use tangency::core::bvp::{Monitor, Watched};
    /// use tangency::core::problem::Measure;
    /// // The largest value of `x`, the first state on the only segment.
    /// let largest = Measure::Maximum("x").map(|_| vec![Watched::state(0, 0)]);
    /// assert_eq!(largest, Monitor::maximum(0, 0));
    /// ```
    pub fn map<R, D>(&self, scalar: impl Fn(&S) -> R) -> Measure<R, D> {
        match self {
            Measure::Duration => Measure::Duration,
            Measure::Maximum(s) => Measure::Maximum(scalar(s)),
            Measure::Minimum(s) => Measure::Minimum(scalar(s)),
            Measure::Range(s) => Measure::Range(scalar(s)),
            Measure::Distance(none) | Measure::Penetration(none) => match *none {},
            Measure::Rising { through, value } => {
                Measure::Rising { through: scalar(through), value: scalar(value) }
            }
            Measure::Integral(integral, all) => {
                Measure::Integral(*integral, all.iter().map(scalar).collect())
            }
            Measure::Ends(position) => Measure::Ends(*position),
        }
    }

    /// Returns the value of the measure for a motion at rest, given the values of the scalars;
    /// `None` for a measure that needs motion.
    pub fn at_rest<T: Scalar>(&self, scalar: impl Fn(&S) -> T) -> Option<T> {
        match self {
            Measure::Maximum(name) | Measure::Minimum(name) => Some(scalar(name)),
            Measure::Distance(none) | Measure::Penetration(none) => match *none {},
            Measure::Range(_) | Measure::Rising { .. } => Some(T::zero()),
            Measure::Integral(Integral::Total, _) | Measure::Duration | Measure::Ends(_) => None,
            Measure::Integral(integral, names) => {
                let terms = names.iter().map(|name| integral.integrand(scalar(name)));
                let sum = terms.fold(T::zero(), |sum, term| sum + term);
                Some(integral.of(sum, T::one()))
            }
        }
    }
}

impl Measure {
    /// The name of a measure that every hybrid system has: the depth to which the motion would
    /// pass, at its event with the smallest approach speed, beyond the surface if the surface were
    /// absent. The value of the penetration is the magnitude of the guard at the turning point
    /// ([`virtual_point`](crate::core::hybrid::virtual_point)). For a motion without events, the
    /// penetration is the negative of the smallest distance from a surface.
    pub const PENETRATION: &str = "penetration";

    /// Creates the measure of a scalar's mean over time.
    pub fn mean(scalar: impl Into<String>) -> Self {
        Measure::Integral(Integral::Mean, vec![scalar.into()])
    }

    /// Creates the L2 norm of several scalars ([`Integral::Norm`]); for all states, the norm is the
    /// one that AUTO records.
    pub fn norm<S: Into<String>>(scalars: impl IntoIterator<Item = S>) -> Self {
        Measure::Integral(Integral::Norm, scalars.into_iter().map(Into::into).collect())
    }

    /// Returns the measures that are recorded by default: the largest and the smallest value of
    /// each state (`max_x`, `min_x`), and for every monitor its mean, under the monitor's name, and
    /// its extremes.
    pub fn by_default(states: Vec<String>, monitors: Vec<String>) -> Vec<(String, Measure)> {
        let mut measures: Vec<(String, Measure)> = Vec::new();
        let extremes = |name: String| {
            let largest = (largest(&name), Measure::Maximum(name.clone()));
            [largest, (smallest(&name), Measure::Minimum(name))]
        };
        for state in states {
            if !measures.iter().any(|(_, known)| *known == Measure::Maximum(state.clone())) {
                measures.extend(extremes(state));
            }
        }
        for monitor in monitors {
            measures.push((monitor.clone(), Measure::mean(&monitor)));
            measures.extend(extremes(monitor));
        }
        measures
    }

    /// Returns the measures of a motion at rest: a scalar whose extremes `max_x` and `min_x` are
    /// measured has the same value at all times, which is listed once, under the name `x`.
    pub(in crate::core) fn of_rest(measures: Vec<(String, Measure)>) -> Vec<(String, Measure)> {
        let name = |name: String, measure: &Measure| match measure {
            Measure::Maximum(scalar) if name == largest(scalar) => scalar.clone(),
            Measure::Minimum(scalar) if name == smallest(scalar) => scalar.clone(),
            _ => name,
        };
        let mut known = HashSet::new();
        let all = measures.into_iter().filter(|(_, measure)| measure.at_rest(|_| 0.0).is_some());
        let named = all.map(|(given, measure)| (name(given, &measure), measure));
        named.filter(|(name, _)| known.insert(name.clone())).collect()
    }
}

/// Returns the name of the column that contains the largest value of a scalar.
fn largest(scalar: &str) -> String {
    format!("{MAX}{scalar}")
}

/// Returns the name of the column that contains the smallest value of a scalar.
fn smallest(scalar: &str) -> String {
    format!("{MIN}{scalar}")
}

const MAX: &str = "max_";
const MIN: &str = "min_";

/// Returns the names of the columns that show a quantity: the column with the quantity's name, if it
/// exists; for an extreme of a scalar at rest, the scalar's column; for a scalar in motion, the
/// columns of its largest and smallest values.
pub(crate) fn columns_showing(name: &str, known: impl Fn(&str) -> bool) -> Vec<String> {
    if known(name) {
        return vec![name.into()];
    }
    let scalar = name.strip_prefix(MAX).or(name.strip_prefix(MIN));
    match scalar.filter(|scalar| known(scalar)) {
        Some(scalar) => vec![scalar.into()],
        None => [largest(name), smallest(name)].into_iter().filter(|name| known(name)).collect(),
    }
}

/// The kind of time integral of one or several scalars.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Integral {
    /// The total `∫ Σ h dt`.
    Total,
    /// The mean over time, `1/T ∫ Σ h dt`, where `T` is the duration.
    Mean,
    /// The L2 norm over the motion in scaled time, `(1/T ∫ Σ h² dt)^½`.
    Norm,
}

impl Integral {
    /// Returns the integrand for a scalar: the scalar itself or its square.
    pub(in crate::core) fn integrand<T: Scalar>(self, scalar: T) -> T {
        match self {
            Integral::Norm => scalar * scalar,
            Integral::Total | Integral::Mean => scalar,
        }
    }

    /// Converts a time integral, given the duration, to the value of the measure; the value is 0 if
    /// the integral is 0, as for a zero duration.
    pub(in crate::core) fn of<T: Scalar>(self, sum: T, time: T) -> T {
        match self {
            Integral::Total => sum,
            _ if sum.real() == 0.0 => T::zero(),
            Integral::Mean => sum / time,
            Integral::Norm => (sum / time).sqrt(),
        }
    }
}

/// Returns the larger of two numbers, or the second number if the first is missing.
pub(in crate::core) fn larger<T>(known: Option<T>, found: T, value: fn(&T) -> f64) -> Option<T> {
    match known {
        Some(known) if value(&known) >= value(&found) => Some(known),
        _ => Some(found),
    }
}
