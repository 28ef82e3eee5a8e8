//! The errors of scenes: invalid statements, and runs that failed.

use super::expansion::ExpansionError;
use crate::core::attractor::{CycleSearchError, StroboscopicError};
use crate::core::continuation::TraceError;
use crate::core::hybrid::HybridError;
use crate::core::local_map::GrazingError;
use crate::core::manifold::ManifoldError;
use crate::core::problem::UnknownName;
use crate::core::sweep::PlanError;
use crate::language::ModelError;
use crate::output::{Chosen, FigureError, TableDifference};
use crate::spelling::{sentence, shown, spelled};
use std::error::Error;
use std::sync::Arc;

/// The error of a problem that cannot be built from its settings.
#[derive(Clone, Debug, thiserror::Error)]
#[error(transparent)]
pub struct ProblemError(Arc<dyn Error + Send + Sync>);

impl ProblemError {
    /// Wraps the error of a problem.
    pub fn new(cause: impl Error + Send + Sync + 'static) -> Self {
        ProblemError(Arc::new(cause))
    }
}

impl PartialEq for ProblemError {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl From<ModelError> for SceneError {
    fn from(error: ModelError) -> Self {
        SceneError::Model(Box::new(error))
    }
}

/// The error of a scene, or of a request to it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A parameter or state is given both in `--over` and in `--from`, or twice in one of them.
    #[error("`{0}` is given twice: give each parameter or state once, in `--over` or in `--from`")]
    Twice(String),
    /// `--both` is given without exactly one parameter to sweep.
    #[error(
        "`--both` sweeps the values of one parameter upward and downward: give one `--over`, of a parameter"
    )]
    BothWays,
    /// A name that the scene does not have.
    #[error("{}", sentence(.0))]
    UnknownName(#[from] UnknownName),
    /// A value of the wrong form.
    #[error("`{}` cannot be `{}`: {reason}", shown(name), shown(value))]
    Value {
        /// The parameter or setting.
        name: String,
        /// The value.
        value: String,
        /// The expected form.
        reason: String,
    },
    /// A setting without effect.
    #[error("`{name}` has no effect {reason}")]
    NoEffect {
        /// The parameter or setting.
        name: String,
        /// Where and why the setting has no effect, and the remedy.
        reason: String,
    },
    /// A parameter or setting that a run of the scene sets.
    #[error(
        "`{name}` is set by the scene: the run `{run}` sets it to `{value}`; copy the scene to a file to change that"
    )]
    Varied {
        /// The parameter or setting.
        name: String,
        /// The run that sets the value.
        run: String,
        /// The value set by the run.
        value: String,
    },
    /// A file of equations cannot be read.
    #[error("{path} cannot be read: {cause}; check the path")]
    File {
        /// The path of the file.
        path: String,
        /// The message of the operating system.
        cause: String,
    },
    /// A scene has syntax errors, or its equations cannot be parsed.
    #[error(transparent)]
    Model(Box<ModelError>),
    /// The scene contains an invalid value.
    #[error("{place} is {}, but {rule}", shown(found))]
    Invalid {
        /// The place, for example "run `plate`, mark `load`".
        place: String,
        /// The present value.
        found: String,
        /// The condition that the value violates.
        rule: String,
    },
    /// The problem cannot be built.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The problem lacks a capability that the scene needs.
    #[error(
        "{needs}, and this problem is {kind}; to use a vector field in this way, state it as a hybrid system of one mode"
    )]
    Unsupported {
        /// The problems that have the capability, in words.
        needs: &'static str,
        /// The kind of the problem.
        kind: &'static str,
    },
    /// Parameters without a value.
    #[error("`{problem}` has no default values for {}: give them in `parameters`", missing.join(", "))]
    MissingParameters {
        /// The problem.
        problem: &'static str,
        /// The names of the parameters.
        missing: Vec<String>,
    },
    /// The plan of a sweep is invalid.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The motion cannot be sampled.
    #[error("{}", spelled(.0))]
    Strobe(#[from] StroboscopicError),
    /// The known results belong to another scene.
    #[error(
        "the earlier runs are from another scene, or from other settings: remove their file, start with --afresh, or \
         choose another folder"
    )]
    OtherScene,
    /// The known results have other tables.
    #[error(
        "the earlier runs are in other tables: {0}; remove their file, start with --afresh, or choose another folder"
    )]
    OtherTables(#[source] TableDifference),
    /// The finest discretisation does not reach the accuracy that a scene requests.
    #[error("{chosen}, which is more: request a lower accuracy, or state the discretisation")]
    Unmet {
        /// The finest discretisation and its estimated error.
        chosen: Box<Chosen>,
    },
    /// The plot is invalid for every result.
    #[error("the plot: {0}")]
    Figure(#[from] FigureError),
    /// The run was cancelled, for example by Ctrl-C.
    #[error("the run `{run}` was interrupted before its first point; earlier runs are saved")]
    GivenUp {
        /// The name of the run.
        run: String,
    },
    /// A run starts from a point that an earlier run did not find.
    #[error(
        "the run `{run}` starts at {kind} number {} of `{from}`, and the branch has {} ({ends})",
        nth + 1, counted(*found, kind)
    )]
    NoSuchPoint {
        /// The name of the run.
        run: String,
        /// The run with the special points.
        from: String,
        /// The kind of the special point.
        kind: String,
        /// The index of the special point among its kind.
        nth: usize,
        /// The number of special points of that kind.
        found: usize,
        /// The reasons for the ends of the earlier run.
        ends: String,
    },
    /// No branch starts from the given state, and the motion from there does not converge to an
    /// attractor.
    #[error(
        "the motion from the given state does not converge: {cause}; no branch starts at the state itself: {near}"
    )]
    NoStart {
        /// The reason why no branch starts at the state.
        near: Box<SceneError>,
        /// The reason why the motion does not converge.
        cause: Box<SceneError>,
    },
    /// A run failed.
    #[error("run `{run}`: {}", spelled(&**cause))]
    Run {
        /// The name of the run.
        run: String,
        /// The reason for the failure.
        #[source]
        cause: Box<RunError>,
    },
}

/// The reason for the failure of a run, or of a sweep of a local map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[error("{0}")]
pub enum RunError {
    /// There is no local map.
    Local(#[from] GrazingError),
    /// No curve emanates from the grazing of a local map.
    Expansion(#[from] ExpansionError),
    /// A simulation ended early.
    Simulation(#[from] HybridError),
    /// A simulation found no periodic motion to start from.
    Unsettled(#[from] CycleSearchError),
    /// There is no saddle whose manifolds could be computed.
    Manifold(#[from] ManifoldError),
    /// A trace could not start.
    Trace(#[from] TraceError),
}

impl SceneError {
    /// Returns whether the message names a file of equations, which then replaces the scene's file.
    pub fn names_file(&self) -> bool {
        match self {
            SceneError::File { .. } => true,
            SceneError::Model(error) => !error.file.is_empty(),
            _ => false,
        }
    }

    /// Returns whether another start could avoid the error of a run that varies parameters: no
    /// solution was found, or only one out of bounds.
    pub(super) fn is_of_start(&self, is_released: impl Fn(&str) -> bool) -> bool {
        use TraceError::{OutOfRange, Start};
        let of_run = |cause: &RunError| match cause {
            RunError::Trace(Start { .. }) => true,
            RunError::Trace(OutOfRange { name, .. }) => !is_released(name),
            _ => false,
        };
        match self {
            SceneError::Model(_) => true,
            SceneError::Run { cause, .. } => of_run(cause),
            _ => false,
        }
    }

    pub(super) fn of_run(run: &str, cause: impl Into<RunError>) -> Self {
        SceneError::Run { run: run.into(), cause: Box::new(cause.into()) }
    }

    pub(super) fn value(name: &str, value: &str, reason: impl Into<String>) -> Self {
        SceneError::Value { name: name.into(), value: value.into(), reason: reason.into() }
    }

    /// Returns the error for a setting that has no effect while another setting has a given value.
    pub(super) fn no_effect_under(name: &str, under: &str, value: &str) -> Self {
        SceneError::NoEffect { name: name.into(), reason: under_setting(under, value) }
    }

    pub(super) fn invalid(
        place: impl Into<String>,
        found: impl Into<String>,
        rule: impl Into<String>,
    ) -> Self {
        SceneError::Invalid { place: place.into(), found: found.into(), rule: rule.into() }
    }
}

/// Explains why a setting has no effect while another setting has a given value, with the remedy.
pub(super) fn under_setting(under: &str, value: &str) -> String {
    format!("where `{under}` is `{value}`: leave it out, or set `{under}` too")
}

/// Counts special points of a kind in words: `no HB`, `1 HB`.
fn counted(found: usize, kind: &str) -> String {
    if found == 0 { format!("no {kind}") } else { format!("{found} {kind}") }
}
