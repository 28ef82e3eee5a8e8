//! Test functions, which say that an event lies between two points of a curve.

use super::at::{At, Quantity};
use super::normal_form::ComputeRate;
use super::stability::Stability;
use crate::core::failure::Failure;
use crate::core::problem::Dynamics;

/// The values at a point of a curve that test functions use beside the system and `x`.
#[derive(Clone, Copy, Default)]
pub struct PointValues<'s> {
    /// The component of the tangent along the continued parameter.
    pub slope: f64,
    /// The sign of the determinant of the Jacobian bordered by the tangent.
    pub determinant: f64,
    /// All eigenvalues or multipliers as (real part, imaginary part), where they are known.
    pub spectrum: Option<&'s [(f64, f64)]>,
    /// All monitors.
    pub monitors: &'s [f64],
}

/// What a test function compares at two points of a curve.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading {
    /// Slopes that are smaller than this may be errors.
    pub vertical: f64,
    /// The value of the test function, where it has one.
    pub value: Option<f64>,
    /// The component of the tangent along the continued parameter, in scaled arclength.
    pub slope: f64,
    /// The sign of the determinant of the Jacobian bordered by the tangent.
    pub determinant: f64,
    /// The counts of unstable eigenvalues or multipliers, where they are known.
    pub stability: Option<Stability>,
}

/// How a test function passes an event along a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passage {
    /// From negative to positive; of a count, from fewer to more unstable eigenvalues.
    Rising,
    /// From positive to negative, or from more to fewer.
    Falling,
}

/// What a test function needs beside the point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing.
    Point,
    /// The eigenvalues or multipliers. Stability is counted by them.
    Eigenvalues,
    /// The event's defining system, whose first left side is the value.
    DefiningSystem,
}

/// The ends of an interval in which a test function vanishes.
#[derive(Clone, Copy, Debug)]
pub struct Bracketed {
    /// The values at the ends.
    pub values: [f64; 2],
    /// The arclength.
    pub length: f64,
    /// The change of the continued parameter.
    pub rise: f64,
    /// The derivative of the value by arclength at the second end, where it is known.
    pub slope: Option<f64>,
}

/// A function of the points of a curve that tells whether an event lies between two of them.
///
/// A value that changes sign is enough. An implementation can compare counts instead, as the test
/// functions of Hopf points and period doublings do.
///
/// ```
/// use tangency::core::bifurcation::{At, Passage, PointValues, Reading, TestFunction};
/// use tangency::core::failure::Failure;
/// /// `x μ − 20` at a point `(x, μ, …)`.
/// struct Product;
/// impl TestFunction for Product {
///     fn value(&self, at: &mut At, _: &PointValues) -> Result<Option<f64>, Failure> {
///         Ok(Some(at.x[0] * at.x[1] - 20.0))
///     }
/// }
/// let [before, after] = [-1.0, 2.0].map(|v| Reading { value: Some(v), ..Reading::default() });
/// assert_eq!(Product.passes([&before, &after]), Some(Passage::Rising));
/// ```
pub trait TestFunction: Send + Sync {
    /// The value at a point; `None` where there is none.
    ///
    /// # Errors
    /// [`Failure`] where the branch cannot be continued either.
    fn value(&self, at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure>;

    /// Whether, and how, the event is passed between two points: by default where the value changes
    /// sign.
    fn passes(&self, [before, after]: [&Reading; 2]) -> Option<Passage> {
        sign_change(before.value?, after.value?)
    }

    /// What the function needs beside the point.
    fn needs(&self) -> Needs {
        Needs::Point
    }

    /// Whether the value changes sign where a curve is seen in the other direction.
    fn is_odd(&self) -> bool {
        false
    }

    /// Whether counts of eigenvalues tell the event between two points.
    fn counts(&self, _ends: [&Reading; 2]) -> bool {
        self.needs() == Needs::Eigenvalues
    }

    /// Whether a passage between two points may be rounding, so that it counts only where stability
    /// changes and the event's defining system converges.
    fn is_doubtful(&self, _ends: [&Reading; 2]) -> bool {
        false
    }

    /// Whether the value jumps where a decision changes: then no defining system converges there.
    fn is_decision(&self) -> bool {
        false
    }

    /// Whether the value may also change sign by passing infinity.
    fn has_poles(&self) -> bool {
        false
    }

    /// The parameter or monitor that is at a level there, and the level.
    fn level(&self) -> Option<(Quantity, f64)> {
        None
    }

    /// The auxiliary unknown of the conditions held along the curve that is at a level there, and
    /// the level.
    fn auxiliary(&self) -> Option<(usize, f64)> {
        None
    }

    /// Where in an interval the event probably lies, as a share of its length: by default where a
    /// linear function vanishes.
    fn guess(&self, within: &Bracketed) -> f64 {
        let [low, high] = within.values;
        low / (low - high)
    }

    /// Whether a solution of the defining system is the event, by the first of the system's own
    /// unknowns there and by the spectra at the ends of the interval. Other events may solve the
    /// same equations.
    fn confirms(&self, _unknown: f64, _spectra: [&[(f64, f64)]; 2], _of: Dynamics) -> bool {
        true
    }

    /// The value of a smooth function with the same zeros, whose extremum close to zero shows that
    /// two events lie in one step; `None` where there is none.
    fn smooth(&self, reading: &Reading, _spectrum: &[(f64, f64)], _of: Dynamics) -> Option<f64> {
        reading.value
    }

    /// Whether that smooth function depends on the eigenvalues.
    fn is_spectral(&self) -> bool {
        self.needs() == Needs::Eigenvalues
    }
}

/// The value is the first left side of the event's own condition.
pub(crate) struct ConditionValue;

impl TestFunction for ConditionValue {
    fn value(&self, _at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(None)
    }

    fn needs(&self) -> Needs {
        Needs::DefiningSystem
    }
}

/// An auxiliary unknown of the conditions held along the curve, less a level.
pub(super) struct Auxiliary {
    /// The position among the auxiliary unknowns.
    pub unknown: usize,
    pub level: f64,
}

impl TestFunction for Auxiliary {
    fn value(&self, at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(at.held.get(self.unknown).map(|value| value - self.level))
    }

    fn auxiliary(&self) -> Option<(usize, f64)> {
        Some((self.unknown, self.level))
    }
}

/// The rate that decides whether what emanates attracts; no value where the rate is not defined, as
/// at a strong resonance.
pub(super) struct Criticality(pub ComputeRate);

impl TestFunction for Criticality {
    fn value(&self, at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        match self.0(at) {
            Err(cause @ Failure::Cancelled(_)) => Err(cause),
            rate => Ok(rate.ok().filter(|rate| rate.is_finite())),
        }
    }

    /// Where another eigenvalue is critical as well.
    fn has_poles(&self) -> bool {
        true
    }
}

/// The amplitude of a cycle about its mean, relative to the amplitude of the last accepted cycle.
pub(super) struct Amplitude;

impl TestFunction for Amplitude {
    fn value(&self, at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(at.system.traits(at.x).amplitude)
    }

    fn smooth(&self, _: &Reading, _: &[(f64, f64)], _: Dynamics) -> Option<f64> {
        None
    }
}

/// How a value passes zero between two points.
pub(super) fn sign_change(before: f64, after: f64) -> Option<Passage> {
    match (before, after) {
        (before, after) if before < 0.0 && after >= 0.0 => Some(Passage::Rising),
        (before, after) if before > 0.0 && after <= 0.0 => Some(Passage::Falling),
        _ => None,
    }
}

/// The value nearest to zero.
pub(super) fn nearest_to_zero(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}
