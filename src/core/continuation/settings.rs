//! The settings of a continuation, with their allowed values.

use super::newton::Tolerances;
use crate::core::cancel::CancelToken;
use crate::core::system::Kind;
use serde::{Deserialize, Serialize};

/// The error for a setting whose value is outside its allowed range.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[error("the setting `{name}` is {value}, but must be {range}")]
pub struct SettingError {
    /// The name of the setting.
    pub name: &'static str,
    /// The given value.
    pub value: f64,
    /// The allowed values.
    pub range: &'static str,
}

/// The settings of Newton's method and of the continuation steps. Lengths are given in scaled
/// arclength: the scale of the continued parameter is the length of its range, and the scale of
/// each group of unknowns is its largest norm on the branch so far. Therefore the settings do not
/// depend on units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The length of the first step (more than 0).
    pub initial_step: f64,
    /// The length of the smallest step (more than 0). The branch ends if a step of this length
    /// fails.
    pub min_step: f64,
    /// The length of the largest step (at least `min_step`).
    pub max_step: f64,
    /// The maximal number of points in each direction (at least 1).
    pub max_points: usize,
    /// The largest estimated distance, in scaled arclength, between the branch and the cubic
    /// interpolant of its points and tangents (more than 0). The setting `curve_error` determines
    /// the accuracy of plots between points. The step control aims at one tenth of `curve_error`; a
    /// step whose estimated distance exceeds `curve_error` is repeated with a shorter length.
    pub curve_error: f64,
    /// The scaled correction below which Newton's method has converged along the branch (between
    /// 1e-15 and 1e-3).
    pub tolerance: f64,
    /// The scaled correction below which Newton's method has converged at special points (between
    /// 1e-15 and 1e-3).
    pub event_tolerance: f64,
    /// The maximal number of Newton iterations at a point (at least 2).
    pub max_iterations: usize,
    /// The requested relative error of special points if the problem can be refined (between 0 and
    /// 1). The value 0 disables refinement; without refinement, the `error` of special points does
    /// not include the discretisation error.
    pub refinement: f64,
    /// The names of parameters and monitors that must reach the relative error `refinement` at
    /// special points, in addition to the parameters that vary along the branch.
    pub refine: Vec<String>,
    /// The target for the estimated relative discretisation error (more than 0). Mesh intervals are
    /// added if the error exceeds the target, and added intervals are removed if the error is far
    /// below the target. On a curve of special points, the target is a hundredth of this value.
    pub target_mesh_error: f64,
    /// The largest estimated relative discretisation error (more than 0). The branch ends if the
    /// estimated discretisation error of its solutions remains larger than this value.
    pub max_mesh_error: f64,
    /// The largest ratio of the period of a cycle to the shortest period on the branch (more than
    /// 1). A branch of cycles ends if the ratio becomes larger than this value, as it does near a
    /// homoclinic orbit.
    pub max_period_growth: f64,
    /// The kinds of bifurcations to detect; if the list is empty, all kinds known for the type of
    /// curve are detected. Bounds, marks and user-defined events are always detected.
    pub detect: Vec<Kind>,
    /// Whether eigenvalues or multipliers are computed along branches of solutions. Eigenvalues and
    /// multipliers are needed to determine stability and to detect Hopf points, period doublings
    /// and torus points. If neither stability is computed nor branch points are detected, Newton's
    /// method keeps the factors of a matrix for several corrections.
    pub stability: bool,
    /// The number of points after which a point is saved with its state, as a regular point (`RG`)
    /// at which a branch can start; 0 if no regular points are saved with their states.
    pub save_every: usize,
    /// The number of leading eigenvalues or multipliers stored with each point (at most 16).
    pub eigenvalues: usize,
    /// The tolerances of parameters, with their names (more than 0). For each special point, the
    /// resulting variation of each parameter that varies along the branch is computed to first
    /// order.
    pub tolerances: Vec<(String, f64)>,
    /// Whether the phase response curve of autonomous cycles is computed at special points and
    /// stored as a profile for each state.
    pub phase_response: bool,
    /// Whether all points contain their solutions
    /// ([`Point::solution`](super::branch::Point::solution)) while the branch is in memory, so that
    /// other branches can start from them.
    #[serde(skip)]
    pub keep_solutions: bool,
    /// Whether the branch is a draft for a picture that is soon replaced. Special points of a draft
    /// have no sensitivities, and their relative discretisation error is at most 1e-7 or
    /// `refinement`, whichever is larger. On fine discretisations, the omitted work takes most of
    /// the time of a trace.
    #[serde(skip)]
    pub draft: bool,
    /// The token that cancels the continuation. A cancelled branch ends with
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
            draft: false,
            cancel: CancelToken::default(),
        }
    }
}

/// Heuristic: on curves of special points, the target for the discretisation error is this
/// fraction of the target on other branches. Where folds of cycles are nearly degenerate, as at
/// canards, their parameters change far more than the cycles.
const AT_SPECIAL_POINTS: f64 = 0.01;

/// Heuristic: the relative discretisation error of the special points of a draft, which is too small
/// to be seen in a picture.
const DRAFT: f64 = 1e-7;

impl Settings {
    /// Returns the relative accuracy to which special points are refined; 0 if they are not refined.
    pub(super) fn accuracy(&self) -> f64 {
        match self.draft && self.refinement > 0.0 {
            true => self.refinement.max(DRAFT),
            false => self.refinement,
        }
    }

    /// Returns the target for the discretisation error, which is smaller on curves of special points.
    pub(super) fn mesh_target(&self, of_special_points: bool) -> f64 {
        self.target_mesh_error * if of_special_points { AT_SPECIAL_POINTS } else { 1.0 }
    }

    /// Returns the stopping criteria of Newton's method for the given tolerance.
    pub(super) fn until(&self, tolerance: f64) -> Tolerances {
        Tolerances::new(tolerance, self.max_iterations)
    }

    /// Checks all settings.
    ///
    /// # Errors
    /// [`SettingError`] naming the first setting whose value is outside its allowed range.
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
            ("min_step", self.min_step, least..=f64::MAX, "more than 0"),
            ("initial_step", self.initial_step, self.min_step..=f64::MAX, "at least `min_step`"),
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
