//! The errors of scenes: invalid statements, and runs that failed.

use super::expansion::ExpansionError;
use crate::core::attractor::{CycleSearchError, StroboscopicError};
use crate::core::continuation::TraceError;
use crate::core::failure::debug_is_message;
use crate::core::hybrid::HybridError;
use crate::core::hybrid::NotPeriodic;
use crate::core::local_map::GrazingError;
use crate::core::manifold::ManifoldError;
use crate::core::problem::UnknownName;
use crate::core::spelling::shown;
use crate::core::sweep::PlanError;
use crate::core::system::Kind;
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
    /// Wraps the error that occurred when a problem was built.
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

/// The error of a scene, or of a request that is applied to a scene.
#[derive(Clone, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A parameter or a state occurs in both `--over` and `--from`, or twice in one of these
    /// options.
    #[error("`{0}` is given twice")]
    #[diagnostic(help("give each parameter or state only once, in `--over` or in `--from`"))]
    Twice(String),
    /// The option `--both` is given, but the number of parameters to sweep is zero or more than
    /// one.
    #[error("`--both` sweeps the values of one parameter upward and downward")]
    #[diagnostic(help("give `--over` exactly once, for a parameter and not for an initial state"))]
    BothWays,
    /// A name of a parameter, setting or run that does not exist in the scene.
    #[error(transparent)]
    #[diagnostic(transparent)]
    UnknownName(#[from] UnknownName),
    /// A value that does not have the form required by the parameter or setting to which it is
    /// assigned.
    #[error("`{}` cannot be `{}`: {reason}", shown(name), shown(value))]
    Value {
        /// The remedy for the error; omitted if the reason for the error implies the remedy.
        #[help]
        help: Option<String>,
        /// The name of the parameter or setting whose value is wrong.
        name: String,
        /// The value.
        value: String,
        /// The expected form.
        reason: String,
    },
    /// A changed setting that has no effect.
    #[error("`{name}` has no effect {reason}")]
    NoEffect {
        /// The name of the parameter or setting that has no effect.
        name: String,
        /// A phrase that states where the setting has no effect, and why.
        reason: String,
        /// The remedy.
        #[help]
        help: Option<String>,
    },
    /// A parameter or setting that cannot be changed because a run of the scene sets its value.
    #[error(
        "a changed value of `{name}` has no effect: the run `{run}` of the scene sets `{name}` to \
         `{value}`"
    )]
    #[diagnostic(help("copy the scene to a file and change the run there"))]
    Varied {
        /// The name of the parameter or setting.
        name: String,
        /// The name of the run that sets the value.
        run: String,
        /// The value that the run sets.
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
    /// The scene contains a syntax error, or its equations are invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Model(Box<ModelError>),
    /// The scene contains an invalid or inconsistent value.
    #[error("{message}")]
    Invalid {
        /// A message that states the place in the scene, the value at this place, and the condition
        /// that the value violates.
        message: String,
        /// The remedy for the error; omitted if the message implies the remedy.
        #[help]
        help: Option<String>,
    },
    /// The problem cannot be built from its settings.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Problem(#[from] ProblemError),
    /// The problem does not support a computation that the scene requests.
    #[error("{requirement}, but this problem is {kind}", requirement = .needs)]
    #[diagnostic(help("{remedy}"))]
    Unsupported {
        /// A description of the problems that support the requested computation.
        needs: &'static str,
        /// The kind of the problem, which does not support the requested computation.
        kind: &'static str,
        /// The remedy.
        remedy: &'static str,
    },
    /// Some parameters of the problem have no value.
    #[error(
        "the problem `{problem}` has no default values for the parameters {}", missing.join(", "
    ))]
    #[diagnostic(help("give the values in `parameters`"))]
    MissingParameters {
        /// The problem.
        problem: &'static str,
        /// The names of the parameters that have no value.
        missing: Vec<String>,
    },
    /// The plan of a sweep, that is, of its axes and runs, is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Plan(#[from] PlanError),
    /// The motion cannot be sampled once in every period.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Strobe(#[from] StroboscopicError),
    /// The equations do not have the stated period.
    #[error(transparent)]
    #[diagnostic(help(
        "state the period of the forcing, as in `period: \"2*pi/w\"` for `cos(w*t)`"
    ))]
    NotPeriodic(#[from] NotPeriodic),
    /// The results of earlier runs were computed with another scene.
    #[error("the saved runs of the sweep are from another scene, or from other settings")]
    #[diagnostic(help(
        "remove the file of the saved runs, start again with --afresh, or choose another folder"
    ))]
    OtherScene,
    /// The tables with the results of earlier runs do not have the form of the sweep's tables.
    #[error("the saved runs of the sweep are in tables of another form: {0}")]
    #[diagnostic(help(
        "remove the file of the saved runs, start again with --afresh, or choose another folder"
    ))]
    OtherTables(#[source] TableDifference),
    /// The finest available discretisation does not reach the accuracy that the scene requests.
    #[error("{chosen}, which is more")]
    #[diagnostic(help("request a lower accuracy, or state the discretisation"))]
    Unmet {
        /// A description of the finest discretisation, and the error that was estimated with it.
        chosen: Box<Chosen>,
    },
    /// The plot of the scene is invalid, independently of the results.
    #[error("the plot: {0}")]
    #[diagnostic(forward(0))]
    Figure(#[from] FigureError),
    /// A run was cancelled by the user, for example by Ctrl-C.
    #[error(
        "the run `{run}` was interrupted before its first point; all runs before `{run}` are saved"
    )]
    GivenUp {
        /// The name of the cancelled run.
        run: String,
    },
    /// A run should start at a special point of an earlier run, but the earlier run did not find
    /// the special point.
    #[error(
        "the run `{run}` starts at {kind} number {} of the branch `{from}`, but this branch has {} \
         ({ends})",
        nth + 1, counted(*found, kind)
    )]
    #[diagnostic(help("{}", to_pass_through(kind, from)))]
    NoSuchPoint {
        /// The name of the run that cannot start because the special point is missing.
        run: String,
        /// The name of the earlier run, whose branch should contain the special point.
        from: String,
        /// The kind of the special point at which the run should start.
        kind: String,
        /// The index of the missing special point among the special points of this kind.
        nth: usize,
        /// The number of special points of this kind that the earlier run found.
        found: usize,
        /// The reasons why the branch of the earlier run ended.
        ends: String,
    },
    /// No branch starts at the given state, and the motion that starts in this state does not
    /// converge to an attractor.
    #[error(
        "the simulated motion from the given state does not converge to an attractor: {cause}; a \
         branch cannot start at the given state either: {near}"
    )]
    #[diagnostic(forward(near))]
    NoStart {
        /// The reason why no branch starts at the state.
        near: Box<SceneError>,
        /// The reason why the motion that starts in the state does not converge.
        cause: Box<SceneError>,
    },
    /// A run failed.
    #[error("run `{run}`: {cause}")]
    #[diagnostic(forward(cause))]
    Run {
        /// The name of the run that failed.
        run: String,
        /// The reason why the run failed.
        #[source]
        cause: Box<RunError>,
    },
    /// A run failed at its start, after the request had changed the first value of the parameter
    /// that varies along the run.
    #[error("{cause}")]
    #[diagnostic(help(
        "replace `--set {name}={value}` by `--mark {name}={value}`: the branch then starts at the value of \
         `{name}` in the scene, and has a labelled point at the marked value"
    ))]
    Moved {
        /// The parameter that varies along the run.
        name: String,
        /// The changed value with which the parameter starts.
        value: String,
        /// The reason why the run failed.
        cause: Box<SceneError>,
    },
}

/// The reason why a run, or a sweep of a local map, failed.
#[derive(Clone, Debug, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The local map that a run or sweep requests does not exist.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Local(#[from] GrazingError),
    /// No curve of special points emanates from the grazing of a local map.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Expansion(#[from] ExpansionError),
    /// A simulation ended before its end time.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Simulation(#[from] HybridError),
    /// A simulation did not converge to a periodic motion from which a branch could start.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Unsettled(#[from] CycleSearchError),
    /// No saddle was found whose stable and unstable manifolds could be computed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Manifold(#[from] ManifoldError),
    /// The continuation of a branch could not start from the given solution.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Trace(#[from] TraceError),
}

impl SceneError {
    /// Returns whether the error names a file of equations; if so, messages name this file instead
    /// of the scene's file.
    pub fn names_file(&self) -> bool {
        match self {
            SceneError::File { .. } => true,
            SceneError::Model(error) => !error.file.is_empty(),
            _ => false,
        }
    }

    /// Returns whether a run that varies parameters might succeed from another start, because the
    /// run found either no solution at its start or a solution that is out of bounds.
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

    /// Returns the error for a setting that has no effect because another setting has its present
    /// value.
    pub(super) fn no_effect_under(name: &str, under: &str, value: &str) -> Self {
        let reason = format!("where `{under}` is `{value}`");
        let help = Some(format!("omit `{name}`, or keep it and change `{under}`"));
        SceneError::NoEffect { name: name.into(), reason, help }
    }

    /// Returns the error for an invalid text of a scene, with the given message.
    pub(super) fn invalid(message: impl Into<String>) -> Self {
        SceneError::Invalid { message: message.into(), help: None }
    }

    /// Returns the error for a setting that has no effect, with the given reason; the error
    /// suggests omitting the setting.
    pub(super) fn idle(name: &str, reason: impl Into<String>) -> Self {
        let help = Some(format!("omit `{name}`"));
        SceneError::NoEffect { name: name.into(), reason: reason.into(), help }
    }

    /// Adds a remedy to an error about an invalid statement, value or setting.
    pub(super) fn with_help(mut self, remedy: impl Into<String>) -> Self {
        if let SceneError::Invalid { help, .. }
        | SceneError::Value { help, .. }
        | SceneError::NoEffect { help, .. } = &mut self
        {
            *help = Some(remedy.into());
        }
        self
    }

    /// Adds a remedy to the error: the remedy of its cause, if the cause has a remedy.
    pub(super) fn with_help_of(self, cause: &dyn Diagnostic) -> Self {
        match cause.help() {
            Some(help) => self.with_help(help.to_string()),
            None => self,
        }
    }
}

/// Returns the remedy for a branch without special points of a given kind.
fn to_pass_through(kind: &str, from: &str) -> String {
    let on_orbits = [Kind::PD, Kind::TR, Kind::HOM].iter().any(|it| it.letters() == kind);
    let orbits = match on_orbits {
        false => String::new(),
        true => format!(
            "; if `{from}` is a branch of equilibria, first trace the orbits that emanate from Hopf \
             points with `--switch HB`, and then start at their {kind} point with `--start FILE:LABEL`"
        ),
    };
    format!(
        "change the range, the start or the varied parameter of `{from}` so that the branch passes \
         through a point of the kind {kind}; the first `--along` names the parameter that varies \
         along the branch{orbits}"
    )
}

/// Formats the number of special points of a given kind, for example `no HB` or `1 HB`.
fn counted(found: usize, kind: &str) -> String {
    if found == 0 { format!("no {kind}") } else { format!("{found} {kind}") }
}
