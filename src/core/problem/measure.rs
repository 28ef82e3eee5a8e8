//! What is measured on a motion: one description for branches, sweeps and equilibria.

use crate::core::scalar::Scalar;

/// A number of a motion: of an orbit, recorded along a branch; or of a period, recorded in a sweep.
/// It means the same in both.
///
/// Scalars are given by name: states, and monitors of the system's own. Extremes are those over all
/// legs whose mode has the scalar, inside legs as well as at their ends.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Measure {
    /// The largest value of a scalar.
    Maximum(String),
    /// The smallest value of a scalar.
    Minimum(String),
    /// The difference between the largest and the smallest value of a scalar.
    Range(String),
    /// The largest value of a scalar where another one passes through zero, rising; 0 where it
    /// never does.
    Rising {
        /// The scalar that rises through zero.
        through: String,
        /// The scalar whose value is taken.
        value: String,
    },
    /// An integral over time, of several scalars together.
    Integral(Integral, Vec<String>),
    /// How far motion goes beyond the surface of the event that it approaches most slowly, or would
    /// go were the surface not there ([`virtual_point`](crate::core::hybrid::virtual_point)): the size of
    /// the guard there. Of a motion without events, the least distance from a surface, negative.
    Penetration,
    /// A number that the system computes from the states at the ends of all legs, by its position
    /// ([`HybridSystem::measure`](crate::core::hybrid::HybridSystem::measure)).
    Cycle(usize),
}

impl Measure {
    /// The name of [`Penetration`](Self::Penetration), which every hybrid system has.
    pub const PENETRATION: &str = "penetration";

    /// The names of the scalars that it is taken of.
    pub(in crate::core) fn scalars(&self) -> Vec<&str> {
        match self {
            Measure::Maximum(name) | Measure::Minimum(name) | Measure::Range(name) => vec![name],
            Measure::Rising { through, value } => vec![through, value],
            Measure::Integral(_, names) => names.iter().map(String::as_str).collect(),
            Measure::Penetration | Measure::Cycle(_) => Vec::new(),
        }
    }

    /// The mean of a scalar over time.
    pub fn mean(scalar: impl Into<String>) -> Self {
        Measure::Integral(Integral::Mean, vec![scalar.into()])
    }

    /// The L2 norm of several scalars ([`Integral::Norm`]): of all states, the one that AUTO
    /// records.
    pub fn norm<S: Into<String>>(scalars: impl IntoIterator<Item = S>) -> Self {
        Measure::Integral(Integral::Norm, scalars.into_iter().map(Into::into).collect())
    }

    /// What is recorded by default: largest and smallest values of states (`max_x`, `min_x`), and
    /// of every monitor its mean, under its own name, and its extremes.
    pub fn by_default(states: Vec<String>, monitors: Vec<String>) -> Vec<(String, Measure)> {
        let mut measures: Vec<(String, Measure)> = Vec::new();
        let extremes = |name: String| {
            let largest = (format!("max_{name}"), Measure::Maximum(name.clone()));
            [largest, (format!("min_{name}"), Measure::Minimum(name))]
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

    /// The number of a motion that rests, given the scalars there; `None` where only motion has it.
    pub fn at_rest<T: Scalar>(&self, scalar: impl Fn(&str) -> T) -> Option<T> {
        match self {
            Measure::Maximum(name) | Measure::Minimum(name) => Some(scalar(name)),
            Measure::Range(_) | Measure::Rising { .. } => Some(T::zero()),
            Measure::Integral(Integral::Total, _) | Measure::Penetration | Measure::Cycle(_) => {
                None
            }
            Measure::Integral(integral, names) => {
                let terms = names.iter().map(|name| integral.integrand(scalar(name)));
                let sum = terms.fold(T::zero(), |sum, term| sum + term);
                Some(integral.of(sum, T::one()))
            }
        }
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
