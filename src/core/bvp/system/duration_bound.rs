//! The bound on the duration of trial solutions.

use super::discretisation::DiscretisedProblem;
use crate::core::failure::Failure;

/// Heuristic: the longest allowed duration of a segment of a trial solution, as a multiple of the
/// last solution's duration. Steps along a branch change durations by smaller factors, and flows
/// over the durations of diverging iterates would be very expensive.
const ASTRAY: f64 = 10.0;

/// The longest allowed duration of a segment of a trial solution.
#[derive(Clone, Copy)]
pub(super) struct DurationBound(f64);

impl Default for DurationBound {
    /// No bound.
    fn default() -> Self {
        DurationBound(f64::INFINITY)
    }
}

impl DurationBound {
    /// Returns the bound on durations that follows from the last solution; `numbers` contains the
    /// vectors `q` of all segments of this solution.
    pub fn behind(equations: &DiscretisedProblem, numbers: &[f64]) -> Self {
        let whole = equations.duration(numbers, |_| true).abs();
        if whole > 0.0 { DurationBound(ASTRAY * whole) } else { DurationBound::default() }
    }

    /// Returns an error if a segment of a trial solution has an excessive duration, or a duration
    /// that is NaN.
    pub fn check(self, equations: &DiscretisedProblem, numbers: &[f64]) -> Result<(), Failure> {
        let DurationBound(longest) = self;
        let segments = 0..equations.meshes.len();
        let mut durations = segments.map(|s| equations.duration(numbers, |other| other == s));
        match durations.find(|duration| duration.is_nan() || duration.abs() > longest) {
            Some(duration) => Err(Failure::Astray { duration, longest }),
            None => Ok(()),
        }
    }
}
