//! Settings of a trace, with their ranges.

use super::newton::Tolerances;
use crate::core::cancel::CancelToken;
use crate::core::system::Kind;
use serde::{Deserialize, Serialize};

/// A setting out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the setting `{name}` is {value}, but must be {range}")]
pub struct SettingError {
    /// The setting.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What it may be.
    pub range: &'static str,
}

/// Settings of Newton's iteration and of steps. Lengths are in units of scaled arclength: the
/// continued parameter is measured by the length of its range, each group of unknowns by the
/// largest norm it has had on the branch, so that no setting depends on units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The first step (more than 0).
    pub initial_step: f64,
    /// The smallest step before the branch ends (more than 0).
    pub min_step: f64,
    /// The largest step (at least `min_step`).
    pub max_step: f64,
    /// The largest number of points in each direction (at least 1).
    pub max_points: usize,
    /// The distance of the branch from the cubic curve through its points with their tangents,
    /// estimated in units of scaled arclength: how well a picture shows what lies between the points.
    /// Steps aim at a tenth; a step with more is taken again, shorter (more than 0).
    pub curve_error: f64,
    /// The scaled correction below which Newton's iteration has converged along the branch
    /// (between 1e-15 and 1e-3).
    pub tolerance: f64,
    /// The same for special points.
    pub event_tolerance: f64,
    /// The largest number of Newton's iterations at a point (at least 2).
    pub max_iterations: usize,
    /// The relative error asked of special points where the problem can be refined; 0 asks for no
    /// refinement, and leaves the discretisation out of their `error` (between 0 and 1).
    pub refinement: f64,
    /// Names of parameters and monitors that special points have to that relative error, beside the
    /// parameters that vary along their branch.
    pub refine: Vec<String>,
    /// The estimated relative error of the mesh above which it gets more intervals, and far below
    /// which it gives up those that the start did not have (more than 0).
    pub target_mesh_error: f64,
    /// The largest error, estimated and relative, that the mesh of a discretised solution may cause
    /// before the branch ends (more than 0).
    pub max_mesh_error: f64,
    /// A branch of cycles of which the period grows beyond this many times the shortest one ends,
    /// near a homoclinic orbit (more than 1).
    pub max_period_growth: f64,
    /// The kinds of bifurcations that are looked for; all that are known for a curve if it is
    /// empty. Bounds, marks and events of the user's own are looked for in any case.
    pub detect: Vec<Kind>,
    /// Whether eigenvalues or multipliers are computed along branches of solutions, which tells
    /// stability, Hopf points, period doublings and torus points.
    pub stability: bool,
    /// Every so many points one is saved with its state, as a regular point (`RG`) that a branch
    /// can start from; none if 0.
    pub save_every: usize,
    /// How many of the eigenvalues or multipliers that decide stability are kept with each point
    /// (at most 16).
    pub eigenvalues: usize,
    /// Tolerances of parameters, by name: special points get the spread that these cause, to first
    /// order, of each parameter that varies along their branch (more than 0).
    pub tolerances: Vec<(String, f64)>,
    /// Whether special points of autonomous cycles have their phase response, a profile for each
    /// state.
    pub phase_response: bool,
    /// Whether points keep their solutions ([`Point::solution`](super::branch::Point::solution))
    /// while the branch is in memory, so that other branches can start from them.
    #[serde(skip)]
    pub keep_solutions: bool,
    /// Cancels the trace, which then ends with
    /// [`End::Interrupted`](super::end::End::Interrupted) and keeps its points.
    #[serde(skip)]
    pub cancel: CancelToken,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            initial_step: 0.02,
            min_step: 1e-7,
            max_step: 0.15,
            max_points: 5000,
            curve_error: 1e-3,
            tolerance: 1e-10,
            event_tolerance: 1e-12,
            max_iterations: 12,
            refinement: 1e-8,
            refine: Vec::new(),
            target_mesh_error: 1e-4,
            max_mesh_error: 0.02,
            max_period_growth: 1e4,
            detect: Vec::new(),
            stability: true,
            save_every: 0,
            eigenvalues: 0,
            tolerances: Vec::new(),
            phase_response: false,
            keep_solutions: false,
            cancel: CancelToken::default(),
        }
    }
}

impl Settings {
    /// When Newton's iteration stops, with one of the tolerances.
    pub(super) fn until(&self, tolerance: f64) -> Tolerances {
        Tolerances { tolerance, max_iterations: self.max_iterations }
    }

    /// Checks every range.
    ///
    /// # Errors
    /// [`SettingError`] with the first setting out of its range.
    ///
    /// ```
    /// use tangency::core::continuation::Settings;
    /// let settings = Settings { max_step: -1.0, ..Settings::default() };
    /// assert_eq!(
    ///     settings.check().unwrap_err().to_string(),
    ///     "the setting `max_step` is -1, but must be at least `min_step`"
    /// );
    /// ```
    pub fn check(&self) -> Result<(), SettingError> {
        let [iterations, points] = [self.max_iterations, self.max_points].map(|count| count as f64);
        let least = f64::MIN_POSITIVE;
        let rules = [
            ("initial_step", self.initial_step, least..=f64::MAX, "more than 0"),
            ("min_step", self.min_step, least..=f64::MAX, "more than 0"),
            ("max_step", self.max_step, self.min_step..=f64::MAX, "at least `min_step`"),
            ("max_points", points, 1.0..=f64::MAX, "at least 1"),
            ("curve_error", self.curve_error, least..=f64::MAX, "more than 0"),
            ("tolerance", self.tolerance, 1e-15..=1e-3, "between 1e-15 and 1e-3"),
            ("event_tolerance", self.event_tolerance, 1e-15..=1e-3, "between 1e-15 and 1e-3"),
            ("max_iterations", iterations, 2.0..=f64::MAX, "at least 2"),
            ("refinement", self.refinement, 0.0..=1.0_f64.next_down(), "between 0 and 1"),
            ("target_mesh_error", self.target_mesh_error, least..=f64::MAX, "more than 0"),
            ("max_mesh_error", self.max_mesh_error, least..=f64::MAX, "more than 0"),
            ("max_period_growth", self.max_period_growth, 1.0..=f64::MAX, "at least 1"),
            ("eigenvalues", self.eigenvalues as f64, 0.0..=16.0, "at most 16"),
        ];
        let of_parameters = self
            .tolerances
            .iter()
            .map(|(_, tolerance)| ("tolerances", *tolerance, least..=f64::MAX, "more than 0"));
        let mut rules = rules.into_iter().chain(of_parameters);
        match rules.find(|(_, value, allowed, _)| !allowed.contains(value)) {
            Some((name, value, _, range)) => Err(SettingError { name, value, range }),
            None => Ok(()),
        }
    }
}
