//! Test functions, whose change of sign says that an event lies between two points of a branch.

use super::condition::{At, Quantity};
use super::stability::Stability;
use crate::core::failure::Failure;
use crate::core::linalg::Spectrum;
use crate::core::problem::Dynamics;
use crate::core::system::System;

/// The function whose change of sign says that an event lies between two points of a branch.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Test {
    /// The component of the tangent along the continued parameter.
    Fold,
    /// The determinant of the Jacobian bordered by the tangent.
    BranchPoint,
    /// The sign of the product of all sums of two eigenvalues, or of all products of two
    /// multipliers less 1.
    Hopf,
    /// The product of all multipliers plus 1.
    PeriodDoubling,
    /// A parameter or monitor less a level.
    Level(Quantity, f64),
    /// An auxiliary unknown of the conditions held along the curve, less a level.
    Own {
        /// Its position among the auxiliary unknowns.
        unknown: usize,
        /// The level.
        level: f64,
    },
    /// The oscillation of a cycle about its mean, compared with that of the cycle before.
    Amplitude,
    /// The first equation of the condition itself.
    Condition,
    /// The event's own function.
    Function,
    /// 1 if the orbit's events occur in the prescribed order of modes, −1 otherwise.
    Itinerary,
}

/// A slope of the continued parameter, on curves of scaled arclength, that is rounding.
pub(crate) const VERTICAL: f64 = 1e-7;

/// Multipliers beyond this are known by their size only.
const HUGE: f64 = 1e7;

/// A point of a curve as test functions see it.
pub(crate) struct Sight<'s> {
    /// The system with the point loaded.
    pub at: At<'s>,
    /// The auxiliary unknowns of the conditions held along the curve.
    pub held: &'s [f64],
    /// The component of the tangent along the continued parameter.
    pub slope: f64,
    /// The sign of the determinant of the Jacobian bordered by the tangent.
    pub determinant: f64,
    /// The verdict on eigenvalues or multipliers, where they are known.
    pub stability: Option<Stability>,
    /// All monitors.
    pub monitors: &'s [f64],
}

impl Test {
    /// The value at a point; `None` where it is unknown, and for functions that an event brings
    /// along.
    pub(crate) fn value(self, sight: &mut Sight) -> Result<Option<f64>, Failure> {
        let At { system, x, .. } = &mut sight.at;
        Ok(match self {
            Test::Fold => Some(sight.slope),
            Test::BranchPoint => Some(sight.determinant),
            Test::Hopf => sight.stability.map(|stability| stability.oscillation),
            Test::PeriodDoubling => sight.stability.map(|stability| stability.doubling),
            Test::Level(Quantity::Parameter(p), level) => {
                Some(x[system.names().dimension() + p] - level)
            }
            Test::Level(Quantity::Monitor(m), level) => {
                Some(sight.monitors[m] - level).filter(|value| !value.is_nan())
            }
            Test::Own { .. } | Test::Amplitude => self.mirrored(&mut **system, x, sight.held),
            Test::Itinerary => match system.events().map(|events| events.check(x)) {
                None => None,
                Some(Ok(())) => Some(1.0),
                Some(Err(failure @ Failure::OutOfDomain(_))) => return Err(failure),
                Some(Err(_)) => Some(-1.0),
            },
            Test::Condition | Test::Function => None,
        })
    }

    /// The value of a function in which a curve may be its own mirror image: an auxiliary unknown,
    /// or the amplitude of a cycle.
    pub(crate) fn mirrored(self, system: &mut dyn System, x: &[f64], held: &[f64]) -> Option<f64> {
        match self {
            Test::Own { unknown, level } => Some(held[unknown] - level),
            Test::Amplitude => system.traits(x).amplitude,
            _ => None,
        }
    }

    /// Whether the sign changes where a curve is seen in the other direction.
    pub(crate) fn is_odd(self) -> bool {
        matches!(self, Test::Fold | Test::BranchPoint)
    }

    /// Whether it is computed from eigenvalues or multipliers.
    pub(crate) fn needs_eigenvalues(self) -> bool {
        matches!(self, Test::Hopf | Test::PeriodDoubling)
    }

    /// Whether eigenvalues or multipliers, where they are known, tell more than its sign.
    pub(crate) fn is_spectral(self) -> bool {
        self.needs_eigenvalues() || self.is_sign()
    }

    /// Whether only the sign of its values means something.
    pub(crate) fn is_sign(self) -> bool {
        matches!(self, Test::BranchPoint | Test::Hopf)
    }

    /// What is at a level there, and the level.
    pub(crate) fn level(self) -> Option<(Quantity, f64)> {
        match self {
            Test::Level(quantity, level) => Some((quantity, level)),
            _ => None,
        }
    }

    /// Which auxiliary unknown is at a level there, and the level.
    pub(crate) fn own(self) -> Option<(usize, f64)> {
        match self {
            Test::Own { unknown, level } => Some((unknown, level)),
            _ => None,
        }
    }

    /// The value of a smooth function with the same zeros: in place of the sign of a determinant or
    /// of a spectrum's product, the real eigenvalue that is nearest to zero, or the real part of
    /// the pair that is nearest to the imaginary axis. Those of periodic orbits are left to the
    /// counts of unstable multipliers.
    pub(crate) fn smooth(
        self,
        value: Option<f64>,
        spectrum: Option<&Spectrum>,
        dynamics: Dynamics,
    ) -> Option<f64> {
        let spectrum = spectrum.filter(|_| dynamics != Dynamics::Periodic).into_iter().flatten();
        let least = |a: &f64, b: &f64| a.abs().total_cmp(&b.abs());
        match self {
            Test::BranchPoint => spectrum.filter(|l| l.1 == 0.0).map(|l| l.0).min_by(least),
            Test::Hopf => spectrum.filter(|l| l.1 > 0.0).map(|l| l.0).min_by(least),
            Test::Amplitude => None,
            _ => value,
        }
    }

    /// Whether a change of sign between two points means nothing: that of the parameter's slope (in
    /// scaled arclength) on a vertical branch; where multipliers are so large that their signs are
    /// rounding, that of the test function of period doublings; at a neutral saddle, λ and −λ, that
    /// of the test function of Hopf points: nothing is lost or gained in stability there.
    pub(crate) fn is_noise(
        self,
        slopes: [f64; 2],
        same_stability: bool,
        spectra: [Option<&Spectrum>; 2],
    ) -> bool {
        let is_huge = |spectrum: &Option<&Spectrum>| {
            spectrum.is_some_and(|all| all.iter().any(|mu| mu.0.abs() > HUGE))
        };
        match self {
            Test::Fold => slopes[0].abs().max(slopes[1].abs()) < VERTICAL,
            Test::Hopf => same_stability,
            Test::PeriodDoubling => same_stability && spectra.iter().all(is_huge),
            _ => false,
        }
    }
}
