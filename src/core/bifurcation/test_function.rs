//! Test functions, which detect an event between two points of a curve.

use super::at::{At, Quantity};
use super::normal_form::ComputeRate;
use super::stability::Stability;
use crate::core::failure::Failure;
use crate::core::problem::Dynamics;

/// The values at a point of a curve that test functions use besides the system and `x`.
#[derive(Clone, Copy, Default)]
pub struct PointValues<'s> {
    /// The component of the tangent along the continued parameter.
    pub slope: f64,
    /// The sign of the determinant of the Jacobian bordered by the tangent.
    pub determinant: f64,
    /// All eigenvalues or multipliers as (real part, imaginary part), if known.
    pub spectrum: Option<&'s [(f64, f64)]>,
    /// All monitors.
    pub monitors: &'s [f64],
}

/// The values of a test function and of stability at a point, compared between two points of a
/// curve.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading {
    /// Smaller slopes may be errors.
    pub vertical: f64,
    /// The value of the test function, if any.
    pub value: Option<f64>,
    /// The component of the tangent along the continued parameter, in scaled arclength.
    pub slope: f64,
    /// The sign of the determinant of the Jacobian bordered by the tangent.
    pub determinant: f64,
    /// The counts of unstable eigenvalues or multipliers, if known.
    pub stability: Option<Stability>,
}

/// The direction in which a test function passes an event along a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passage {
    /// From negative to positive; for counts, from fewer to more unstable eigenvalues.
    Rising,
    /// From positive to negative; for counts, from more to fewer unstable eigenvalues.
    Falling,
}

/// The data that a test function needs besides the point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// No further data.
    Point,
    /// The eigenvalues or multipliers, which also give the counts of stability.
    Eigenvalues,
    /// The event's defining system, whose first left side is the value.
    DefiningSystem,
}

/// The ends of an interval in which a test function vanishes.
#[derive(Clone, Copy, Debug)]
pub struct Bracketed {
    /// The values at the ends.
    pub values: [f64; 2],
    /// The arclength of the interval.
    pub length: f64,
    /// The change of the continued parameter over the interval.
    pub rise: f64,
    /// The derivative of the value by arclength at the second end, if known.
    pub slope: Option<f64>,
}

/// A function of the points of a curve that detects an event between two of them.
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
    /// Computes the value at a point; `None` if undefined.
    ///
    /// # Errors
    /// [`Failure`] where the branch cannot be continued either.
    fn value(&self, at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure>;

    /// Returns the direction in which the event is passed between two points, if it is; by default
    /// where the value changes sign.
    fn passes(&self, [before, after]: [&Reading; 2]) -> Option<Passage> {
        sign_change(before.value?, after.value?)
    }

    /// The data that the function needs besides the point.
    fn needs(&self) -> Needs {
        Needs::Point
    }

    /// Whether the value changes sign when the curve is reversed.
    fn is_odd(&self) -> bool {
        false
    }

    /// Whether counts of eigenvalues detect the event between two points.
    fn counts(&self, _ends: [&Reading; 2]) -> bool {
        self.needs() == Needs::Eigenvalues
    }

    /// Whether a passage between two points may be rounding: it then counts only if stability
    /// changes and the event's defining system converges.
    fn is_doubtful(&self, _ends: [&Reading; 2]) -> bool {
        false
    }

    /// Whether the value jumps where a decision changes: no defining system converges there.
    fn is_decision(&self) -> bool {
        false
    }

    /// Whether the value may also change sign by passing infinity.
    fn has_poles(&self) -> bool {
        false
    }

    /// The parameter or monitor of a level event, and the level.
    fn level(&self) -> Option<(Quantity, f64)> {
        None
    }

    /// The position and the level of an auxiliary unknown of the curve, for an event at such a
    /// level.
    fn auxiliary(&self) -> Option<(usize, f64)> {
        None
    }

    /// Estimates the position of the event in an interval, as a fraction of its length: by default,
    /// the zero of a linear function.
    fn guess(&self, within: &Bracketed) -> f64 {
        let [low, high] = within.values;
        low / (low - high)
    }

    /// Whether a solution of the defining system is the event, judged by the first auxiliary
    /// unknown and by the spectra at the ends of the interval. Other events may solve the same
    /// equations.
    fn confirms(&self, _unknown: f64, _spectra: [&[(f64, f64)]; 2], _of: Dynamics) -> bool {
        true
    }

    /// The value of a smooth function with the same zeros, or `None`. An extremum of this function
    /// close to zero shows that one step contains two events.
    fn smooth(&self, reading: &Reading, _spectrum: &[(f64, f64)], _of: Dynamics) -> Option<f64> {
        reading.value
    }

    /// Whether the smooth function depends on the eigenvalues.
    fn is_spectral(&self) -> bool {
        self.needs() == Needs::Eigenvalues
    }
}

/// The test function whose value is the first left side of the event's defining system.
pub(crate) struct ConditionValue;

impl TestFunction for ConditionValue {
    fn value(&self, _at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(None)
    }

    fn needs(&self) -> Needs {
        Needs::DefiningSystem
    }
}

/// The test function of a level of an auxiliary unknown along the curve.
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

/// The test function of criticality: the rate whose sign determines whether emanating solutions
/// attract; undefined at strong resonances.
pub(super) struct Criticality(pub ComputeRate);

impl TestFunction for Criticality {
    fn value(&self, at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        match self.0(at) {
            Err(cause @ Failure::Cancelled(_)) => Err(cause),
            rate => Ok(rate.ok().filter(|rate| rate.is_finite())),
        }
    }

    /// The rate has poles where another eigenvalue is also critical.
    fn has_poles(&self) -> bool {
        true
    }
}

/// The test function of shrinking cycles: the amplitude relative to the last accepted cycle.
pub(super) struct Amplitude;

impl TestFunction for Amplitude {
    fn value(&self, at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(at.system.traits(at.x).amplitude)
    }

    fn smooth(&self, _: &Reading, _: &[(f64, f64)], _: Dynamics) -> Option<f64> {
        None
    }
}

/// Returns the direction in which a value passes zero between two points, if it does.
pub(super) fn sign_change(before: f64, after: f64) -> Option<Passage> {
    match (before, after) {
        (before, after) if before < 0.0 && after >= 0.0 => Some(Passage::Rising),
        (before, after) if before > 0.0 && after <= 0.0 => Some(Passage::Falling),
        _ => None,
    }
}

/// Returns the value nearest to zero.
pub(super) fn nearest_to_zero(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}
