//! What is measured on a motion: one description for branches, sweeps and equilibria.

use crate::core::scalar::Scalar;
use std::collections::HashSet;
use std::convert::Infallible;

/// A number of a motion. It has the same meaning for an orbit, along a branch, and for a period, in
/// a sweep.
///
/// `S` stands for a scalar of the motion. Users give the name of a state or of a monitor. A
/// boundary-value problem gives the scalar on each of its segments, and surfaces `D` whose distance
/// is measured ([`bvp::Monitor`](crate::core::bvp::Monitor)). Extremes are taken inside legs as well
/// as at their ends, over all legs whose mode has the scalar.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Measure<S = String, D = Infallible> {
    /// The duration of the motion, in time.
    Duration,
    /// The largest value of a scalar.
    Maximum(S),
    /// The smallest value of a scalar.
    Minimum(S),
    /// The difference between the largest and the smallest value of a scalar.
    Range(S),
    /// The smallest local minimum inside a leg or at its end, or the maximum if there is none: a
    /// distance that vanishes where motion touches a surface.
    Distance(D),
    /// `−`[`Distance`](Self::Distance): how far motion would penetrate a surface that is not there.
    Penetration(D),
    /// The largest value of a scalar where another one passes through zero, rising; 0 where it
    /// never does.
    Rising {
        /// The scalar that rises through zero.
        through: S,
        /// The scalar whose value is taken.
        value: S,
    },
    /// An integral over time, of several scalars together.
    Integral(Integral, Vec<S>),
    /// A number that the problem computes from the states at the ends of all legs, by its position
    /// ([`HybridSystem::measure`](crate::core::hybrid::HybridSystem::measure),
    /// [`BoundaryProblem::of_ends`](crate::core::bvp::BoundaryProblem::of_ends)).
    Ends(usize),
}

impl<S, D> Measure<S, D> {
    /// The scalars of the measure.
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
    /// The same measure of scalars that are given in another way.
    ///
    /// ```
    /// use tangency::core::bvp::{Monitor, Watched};
    /// use tangency::core::problem::Measure;
    /// // The largest value of `x`, which is the first state on the only segment.
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

    /// The number of a motion that rests, given the scalars there; `None` where only motion has it.
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
    /// The name of a measure that every hybrid system has: how far the motion penetrates the
    /// surface of the event that it approaches most slowly, or would penetrate a surface that is
    /// not there. The measure is the size of the guard at the turning point
    /// ([`virtual_point`](crate::core::hybrid::virtual_point)). Without events it is the negative
    /// of the smallest distance from a surface.
    pub const PENETRATION: &str = "penetration";

    /// The mean of a scalar over time.
    pub fn mean(scalar: impl Into<String>) -> Self {
        Measure::Integral(Integral::Mean, vec![scalar.into()])
    }

    /// The L2 norm of several scalars ([`Integral::Norm`]): of all states, the one that AUTO
    /// records.
    pub fn norm<S: Into<String>>(scalars: impl IntoIterator<Item = S>) -> Self {
        Measure::Integral(Integral::Norm, scalars.into_iter().map(Into::into).collect())
    }

    /// The measures recorded by default: largest and smallest values of states (`max_x`, `min_x`),
    /// and of every monitor its mean, under its own name, and its extremes.
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

    /// The measures that motion has where it rests: of a scalar with the extremes `max_x` and
    /// `min_x` its value, `x`, once.
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

/// The column of the largest value of a scalar.
fn largest(scalar: &str) -> String {
    format!("{MAX}{scalar}")
}

/// The column of the smallest value of a scalar.
fn smallest(scalar: &str) -> String {
    format!("{MIN}{scalar}")
}

const MAX: &str = "max_";
const MIN: &str = "min_";

/// The columns that show a quantity, some of which may be known: the column of its name; else, of
/// the extreme of a scalar where motion rests, the scalar's; else, of a scalar that moves, the
/// columns of its largest and smallest value.
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

/// How scalars are integrated over time, in the motion in which there are any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Integral {
    /// `∫ Σ h dt`.
    Total,
    /// The mean over time, `1/T ∫ Σ h dt`.
    Mean,
    /// The L2 norm on the interval of scaled time, `(1/T ∫ Σ h² dt)^½`.
    Norm,
}

impl Integral {
    /// What is integrated of a scalar.
    pub(in crate::core) fn integrand<T: Scalar>(self, scalar: T) -> T {
        match self {
            Integral::Norm => scalar * scalar,
            Integral::Total | Integral::Mean => scalar,
        }
    }

    /// The number that an integral over some time becomes; 0 where there was no time.
    pub(in crate::core) fn of<T: Scalar>(self, sum: T, time: T) -> T {
        match self {
            Integral::Total => sum,
            _ if sum.real() == 0.0 => T::zero(),
            Integral::Mean => sum / time,
            Integral::Norm => (sum / time).sqrt(),
        }
    }
}

/// The larger one of two numbers, the first of which there may not be: how a motion's rises become
/// one.
pub(in crate::core) fn larger<T>(known: Option<T>, found: T, value: fn(&T) -> f64) -> Option<T> {
    match known {
        Some(known) if value(&known) >= value(&found) => Some(known),
        _ => Some(found),
    }
}
