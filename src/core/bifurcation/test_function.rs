//! Test functions, which detect events between two points of a curve.

use super::at::{At, Quantity};
use super::normal_form::ComputeRate;
use super::stability::Stability;
use crate::core::failure::Failure;
use crate::core::linalg::dot;
use crate::core::problem::Dynamics;
use std::sync::{Mutex, PoisonError};

/// The data at a point of a curve that test functions use in addition to the system and `x`.
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

/// The value of a test function at a point of a curve, and the numbers of unstable eigenvalues or
/// multipliers there. Events are detected by comparing the values and stability at two points of a
/// curve.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading {
    /// The bound for `slope` below which the slope may consist only of numerical errors.
    pub vertical: f64,
    /// The value of the test function, if it is defined at the point.
    pub value: Option<f64>,
    /// The component of the tangent along the continued parameter, in scaled arclength.
    pub slope: f64,
    /// The sign of the determinant of the Jacobian bordered by the tangent.
    pub determinant: f64,
    /// The numbers of unstable eigenvalues or multipliers, if known.
    pub stability: Option<Stability>,
}

/// The direction in which a test function passes an event along a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passage {
    /// The test function changes from negative to positive, or the number of unstable eigenvalues
    /// increases.
    Rising,
    /// The test function changes from positive to negative, or the number of unstable eigenvalues
    /// decreases.
    Falling,
}

/// The data that a test function needs in addition to the point of the curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// No further data.
    Point,
    /// The test function needs the eigenvalues or multipliers, or the number of unstable
    /// eigenvalues or multipliers.
    Eigenvalues,
    /// The test function needs the defining system of the event: the value of the test function is
    /// the left side of the first equation of this system.
    DefiningSystem,
}

/// The data at the ends of an interval in which a test function vanishes.
#[derive(Clone, Copy, Debug)]
pub struct Bracketed {
    /// The values of the test function at the ends of the interval.
    pub values: [f64; 2],
    /// The arclength of the interval.
    pub length: f64,
    /// The change of the continued parameter over the interval.
    pub rise: f64,
    /// The derivative of the test function with respect to arclength at the second end, if known.
    pub slope: Option<f64>,
}

/// A function of the points of a curve that detects an event between two points.
///
/// An implementation needs only a value that changes sign at the event. Instead of signs, an
/// implementation can compare numbers of unstable eigenvalues, as the test functions of Hopf points
/// and period doublings do.
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
    /// Computes the value of the test function at a point; `None` if the value is undefined.
    ///
    /// # Errors
    /// [`Failure`] only for errors that also prevent the continuation of the branch.
    fn value(&self, at: &mut At, known: &PointValues) -> Result<Option<f64>, Failure>;

    /// Returns the direction in which the curve passes the event between two points, or `None` if
    /// the event does not lie between them. By default, the event is passed if the value changes
    /// sign.
    fn passes(&self, [before, after]: [&Reading; 2]) -> Option<Passage> {
        sign_change(before.value?, after.value?)
    }

    /// The data that the test function needs in addition to the point of the curve.
    fn needs(&self) -> Needs {
        Needs::Point
    }

    /// Whether the value of the test function changes sign when the direction of the curve is
    /// reversed.
    fn is_odd(&self) -> bool {
        false
    }

    /// Whether the event between two points is detected by the numbers of unstable eigenvalues.
    fn counts(&self, _ends: [&Reading; 2]) -> bool {
        self.needs() == Needs::Eigenvalues
    }

    /// Whether a sign change between two points may be caused by rounding. A doubtful sign change
    /// counts as an event only if stability changes and Newton's method converges on the defining
    /// system of the event.
    fn is_doubtful(&self, _ends: [&Reading; 2]) -> bool {
        false
    }

    /// Whether the value at a point may consist of rounding errors, as the cubic coefficients of
    /// conservative systems do, which vanish along whole curves. A sign change between two such points
    /// is no event.
    fn is_noise(&self, _at: &mut At) -> bool {
        false
    }

    /// Whether the test function is an indicator that jumps at the event, such as the indicator of
    /// the order of events; Newton's method on a defining system cannot converge at a jump.
    fn is_decision(&self) -> bool {
        false
    }

    /// Whether the value of the test function may also change sign at a pole.
    fn has_poles(&self) -> bool {
        false
    }

    /// If the event is that a parameter or monitor reaches a given level, returns the parameter or
    /// monitor and the level.
    fn level(&self) -> Option<(Quantity, f64)> {
        None
    }

    /// If the event is that an auxiliary unknown of the curve reaches a given level, returns the
    /// index of the unknown and the level.
    fn auxiliary(&self) -> Option<(usize, f64)> {
        None
    }

    /// Estimates the position of the event in an interval, as a fraction of the length of the
    /// interval. By default, the test function is interpolated linearly.
    fn guess(&self, within: &Bracketed) -> f64 {
        let [low, high] = within.values;
        low / (low - high)
    }

    /// Whether a solution of the defining system is an event of the kind that is being located;
    /// this is decided from the first auxiliary unknown and from the spectra at the ends of the
    /// interval. Events of other kinds may satisfy the same defining system.
    fn confirms(&self, _unknown: f64, _spectra: [&[(f64, f64)]; 2], _of: Dynamics) -> bool {
        true
    }

    /// Returns the value of a smooth function with the same zeros as the test function, if one
    /// exists. A step with an extremum of the smooth function close to zero may contain two events.
    fn smooth(&self, reading: &Reading, _spectrum: &[(f64, f64)], _of: Dynamics) -> Option<f64> {
        reading.value
    }

    /// Whether the function [`smooth`](Self::smooth) depends on the eigenvalues.
    fn is_spectral(&self) -> bool {
        self.needs() == Needs::Eigenvalues
    }
}

/// The test function whose value is the left side of the first equation of the event's defining
/// system.
pub(crate) struct ConditionValue;

impl TestFunction for ConditionValue {
    fn value(&self, _at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(None)
    }

    fn needs(&self) -> Needs {
        Needs::DefiningSystem
    }
}

/// The test function that vanishes where an auxiliary unknown of the curve reaches a given level:
/// the unknown minus the level.
pub(super) struct Auxiliary {
    /// The index of the unknown among the auxiliary unknowns of the curve.
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

/// The test function of criticality: the normal-form coefficient whose sign determines whether the
/// emanating solutions are attracting. This normal-form coefficient is undefined at strong
/// resonances.
pub(super) struct Criticality(pub ComputeRate);

impl TestFunction for Criticality {
    fn value(&self, at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        match self.0(at) {
            Err(cause @ Failure::Cancelled(_)) => Err(cause),
            rate => Ok(rate.ok().map(|rate| rate.value).filter(|value| value.is_finite())),
        }
    }

    fn is_noise(&self, at: &mut At) -> bool {
        self.0(at).is_ok_and(|rate| !rate.has_sign())
    }

    /// Returns true: the normal-form coefficient has poles where another eigenvalue is also
    /// critical.
    fn has_poles(&self) -> bool {
        true
    }
}

/// The test function of cycles that shrink to an equilibrium: the amplitude relative to the
/// amplitude of the last accepted cycle.
pub(super) struct Amplitude;

impl TestFunction for Amplitude {
    fn value(&self, at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        Ok(at.system.traits(at.x).amplitude)
    }

    fn smooth(&self, _: &Reading, _: &[(f64, f64)], _: Dynamics) -> Option<f64> {
        None
    }
}

/// The test function of doubled orbits that shrink onto orbits of half the period: the size of the
/// difference between the two halves, with the opposite sign once the halves have changed places. The test
/// function remembers the last difference, since signs are followed along the curve.
#[derive(Default)]
pub(super) struct Alternation(Mutex<Vec<f64>>);

impl TestFunction for Alternation {
    fn value(&self, at: &mut At, _known: &PointValues) -> Result<Option<f64>, Failure> {
        let solutions = at.system.discretised();
        let Some(own) = solutions.and_then(|it| it.difference_of_halves(at.x)) else {
            return Ok(None);
        };
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let size = dot(&own, &own).sqrt();
        if last.len() == own.len() && dot(&last, &own) < 0.0 {
            return Ok(Some(-size));
        }
        *last = own;
        Ok(Some(size))
    }

    fn smooth(&self, _: &Reading, _: &[(f64, f64)], _: Dynamics) -> Option<f64> {
        None
    }
}

/// Returns the direction in which a value changes sign between two points; `None` if its sign does
/// not change.
pub(super) fn sign_change(before: f64, after: f64) -> Option<Passage> {
    match (before, after) {
        (before, after) if before < 0.0 && after >= 0.0 => Some(Passage::Rising),
        (before, after) if before > 0.0 && after <= 0.0 => Some(Passage::Falling),
        _ => None,
    }
}

/// Returns the value with the smallest modulus among several values.
pub(super) fn nearest_to_zero(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}
