//! The errors of scenes: invalid statements, and runs that failed.

use super::expansion::ExpansionError;
use crate::core::attractor::{CycleSearchError, StroboscopicError};
use crate::core::continuation::TraceError;
use crate::core::failure::debug_is_message;
use crate::core::hybrid::HybridError;
use crate::core::local_map::GrazingError;
use crate::core::manifold::ManifoldError;
use crate::core::problem::UnknownName;
use crate::core::spelling::shown;
use crate::core::sweep::PlanError;
use crate::language::ModelError;
use crate::output::{Chosen, FigureError, TableDifference};
use miette::Diagnostic;
use std::sync::Arc;

debug_is_message!(SceneError);

/// The error of a problem that cannot be built from its settings.
#[derive(Clone, Debug, miette::Diagnostic, thiserror::Error)]
#[error("{0}")]
#[diagnostic(forward(0))]
pub struct ProblemError(Arc<dyn Diagnostic + Send + Sync>);

impl ProblemError {
    /// Wraps the error of a problem.
    pub fn new(cause: impl Diagnostic + Send + Sync + 'static) -> Self {
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
#[derive(Clone, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A parameter or state is given both in `--over` and in `--from`, or twice in one of them.
    #[error("`{0}` is given twice")]
    #[diagnostic(help("give each parameter or state only once, in `--over` or in `--from`"))]
    Twice(String),
    /// `--both` is given without exactly one parameter to sweep.
    #[error("`--both` sweeps the values of one parameter upward and downward")]
    #[diagnostic(help("give `--over` exactly once, for a parameter and not for an initial state"))]
    BothWays,
    /// A name that the scene does not have.
    #[error(transparent)]
    #[diagnostic(transparent)]
    UnknownName(#[from] UnknownName),
    /// A value of the wrong form.
    #[error("`{}` cannot be `{}`: {reason}", shown(name), shown(value))]
    Value {
        /// The remedy, unless the reason implies the remedy.
        #[help]
        help: Option<String>,
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
        /// Where and why the setting has no effect.
        reason: String,
        /// The remedy.
        #[help]
        help: Option<String>,
    },
    /// A parameter or setting that a run of the scene sets.
    #[error(
        "a changed value of `{name}` has no effect: the run `{run}` of the scene sets `{name}` to \
         `{value}`"
    )]
    #[diagnostic(help("copy the scene to a file and change the run there"))]
    Varied {
        /// The parameter or setting.
        name: String,
        /// The run that sets the value.
        run: String,
        /// The value set by the run.
        value: String,
    },
    /// A file of equations cannot be read.
    #[error("{path} cannot be read: {cause}")]
    #[diagnostic(help("check the path"))]
    File {
        /// The path of the file.
        path: String,
        /// The message of the operating system.
        cause: String,
    },
    /// A scene has syntax errors, or its equations cannot be parsed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Model(Box<ModelError>),
    /// The scene contains an invalid value.
    #[error("{message}")]
    Invalid {
        /// The place, the value there, and the condition that the value violates.
        message: String,
        /// The remedy, unless the message implies the remedy.
        #[help]
        help: Option<String>,
    },
    /// The problem cannot be built.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Problem(#[from] ProblemError),
    /// The problem lacks a capability that the scene needs.
    #[error("{requirement}, but this problem is {kind}", requirement = .needs)]
    #[diagnostic(help("state the vector field as a hybrid system with one mode"))]
    Unsupported {
        /// The problems that have the capability, in words.
        needs: &'static str,
        /// The kind of the problem.
        kind: &'static str,
    },
    /// Parameters without a value.
    #[error(
        "the problem `{problem}` has no default values for the parameters {}", missing.join(", "
    ))]
    #[diagnostic(help("give the values in `parameters`"))]
    MissingParameters {
        /// The problem.
        problem: &'static str,
        /// The names of the parameters.
        missing: Vec<String>,
    },
    /// The plan of a sweep is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Plan(#[from] PlanError),
    /// The motion cannot be sampled.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Strobe(#[from] StroboscopicError),
    /// The known results belong to another scene.
    #[error("the saved runs of the sweep are from another scene, or from other settings")]
    #[diagnostic(help(
        "remove the file of the saved runs, start again with --afresh, or choose another folder"
    ))]
    OtherScene,
    /// The known results have other tables.
    #[error("the saved runs of the sweep are in tables of another form: {0}")]
    #[diagnostic(help(
        "remove the file of the saved runs, start again with --afresh, or choose another folder"
    ))]
    OtherTables(#[source] TableDifference),
    /// The finest discretisation does not reach the accuracy that a scene requests.
    #[error("{chosen}, which is more")]
    #[diagnostic(help("request a lower accuracy, or state the discretisation"))]
    Unmet {
        /// The finest discretisation and its estimated error.
        chosen: Box<Chosen>,
    },
    /// The plot is invalid for every result.
    #[error("the plot: {0}")]
    #[diagnostic(forward(0))]
    Figure(#[from] FigureError),
    /// The run was cancelled, for example by Ctrl-C.
    #[error(
        "the run `{run}` was interrupted before its first point; all runs before `{run}` are saved"
    )]
    GivenUp {
        /// The name of the run.
        run: String,
    },
    /// A run starts from a point that an earlier run did not find.
    #[error(
        "the run `{run}` starts at {kind} number {} of the branch `{from}`, but this branch has {} \
         ({ends})",
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
        "the simulated motion from the given state does not converge to an attractor: {cause}; a \
         branch cannot start at the given state either: {near}"
    )]
    #[diagnostic(forward(near))]
    NoStart {
        /// The reason why no branch starts at the state.
        near: Box<SceneError>,
        /// The reason why the motion does not converge.
        cause: Box<SceneError>,
    },
    /// A run failed.
    #[error("run `{run}`: {cause}")]
    #[diagnostic(forward(cause))]
    Run {
        /// The name of the run.
        run: String,
        /// The reason for the failure.
        #[source]
        cause: Box<RunError>,
    },
}

/// The reason for the failure of a run, or of a sweep of a local map.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// There is no local map.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Local(#[from] GrazingError),
    /// No curve emanates from the grazing of a local map.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Expansion(#[from] ExpansionError),
    /// A simulation ended early.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Simulation(#[from] HybridError),
    /// A simulation found no periodic motion to start from.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Unsettled(#[from] CycleSearchError),
    /// There is no saddle whose manifolds could be computed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Manifold(#[from] ManifoldError),
    /// A trace could not start.
    #[error(transparent)]
    #[diagnostic(transparent)]
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
        let (name, value, reason) = (name.into(), value.into(), reason.into());
        SceneError::Value { name, value, reason, help: None }
    }

    /// Returns the error for a setting that has no effect while another setting has a given value.
    pub(super) fn no_effect_under(name: &str, under: &str, value: &str) -> Self {
        let reason = format!("where `{under}` is `{value}`");
        let help = Some(format!("omit `{name}`, or also set `{under}` to another value"));
        SceneError::NoEffect { name: name.into(), reason, help }
    }

    /// Returns the error for an invalid statement, which the message describes.
    pub(super) fn invalid(message: impl Into<String>) -> Self {
        SceneError::Invalid { message: message.into(), help: None }
    }

    /// Returns the error for a setting that has no effect, with the reason; the remedy omits the
    /// setting.
    pub(super) fn idle(name: &str, reason: impl Into<String>) -> Self {
        let help = Some(format!("omit `{name}`"));
        SceneError::NoEffect { name: name.into(), reason: reason.into(), help }
    }

    /// Adds a remedy to an error of an invalid statement, value or setting.
    pub(super) fn with_help(mut self, remedy: impl Into<String>) -> Self {
        if let SceneError::Invalid { help, .. }
        | SceneError::Value { help, .. }
        | SceneError::NoEffect { help, .. } = &mut self
        {
            *help = Some(remedy.into());
        }
        self
    }

    /// Adds the remedy of a cause, if the cause has a remedy.
    pub(super) fn with_help_of(self, cause: &dyn Diagnostic) -> Self {
        match cause.help() {
            Some(help) => self.with_help(help.to_string()),
            None => self,
        }
    }
}

/// Counts special points of a kind in words: `no HB`, `1 HB`.
fn counted(found: usize, kind: &str) -> String {
    if found == 0 { format!("no {kind}") } else { format!("{found} {kind}") }
}
