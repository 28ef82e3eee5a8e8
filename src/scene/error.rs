//! What can be wrong with a scene.

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

/// Why a problem cannot be built from its settings: the problem's own error.
#[derive(Clone, Debug, thiserror::Error)]
#[error(transparent)]
pub struct ProblemError(Arc<dyn Error + Send + Sync>);

impl ProblemError {
    /// The error of a problem.
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

/// An error of a scene, or of a request to it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A value that would have no effect.
    #[error("`{0}` is given twice: state each parameter or state once, in `--over` or in `--from`")]
    Twice(String),
    /// Sweeps both ways without an order.
    #[error(
        "`--both` goes through the values of one parameter: state one `--over`, of a parameter"
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
    /// A setting that changes nothing.
    #[error("`{name}` has no effect {reason}")]
    NoEffect {
        /// The parameter or setting.
        name: String,
        /// Where and why, and the remedy.
        reason: String,
    },
    /// A name that the scene varies by itself.
    #[error(
        "`{name}` is varied by the scene: the run `{run}` sets it to `{value}`; copy the scene to a file to change that"
    )]
    Varied {
        /// The parameter or setting.
        name: String,
        /// The run.
        run: String,
        /// Its value.
        value: String,
    },
    /// A file of equations cannot be read.
    #[error("{path} cannot be read: {cause}; check the path")]
    File {
        /// Its path.
        path: String,
        /// The system's message.
        cause: String,
    },
    /// A scene is not written as scenes are, or its equations cannot be understood.
    #[error(transparent)]
    Model(Box<ModelError>),
    /// Something that a scene must not hold.
    #[error("{place} is {}, but {rule}", shown(found))]
    Invalid {
        /// The place, for example "run `plate`, mark `load`".
        place: String,
        /// The present value.
        found: String,
        /// The condition that it must meet.
        rule: String,
    },
    /// The problem cannot be built.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The problem cannot do what the scene needs.
    #[error(
        "{needs}, and this problem is {kind}; state a field as a hybrid system of one mode to use it so"
    )]
    Unsupported {
        /// Which problems can do it.
        needs: &'static str,
        /// The kind of the problem.
        kind: &'static str,
    },
    /// Parameters without a value.
    #[error("`{problem}` has no default values for {}: give them in `parameters`", missing.join(", "))]
    MissingParameters {
        /// The problem.
        problem: &'static str,
        /// The parameters.
        missing: Vec<String>,
    },
    /// A sweep has no meaning.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// There is no motion to be looked at.
    #[error("{}", spelled(.0))]
    Strobe(#[from] StroboscopicError),
    /// The known results belong to another scene.
    #[error(
        "the runs that are done were made by another scene, or with other settings: remove their file, begin afresh, or \
         name another folder"
    )]
    OtherScene,
    /// The known results have other tables.
    #[error(
        "the runs that are done are in other tables: {0}; remove their file, begin afresh, or name another folder"
    )]
    OtherTables(#[source] TableDifference),
    /// The accuracy that a scene asks for is not met by the finest discretisation.
    #[error("{chosen}, which is more: ask for less, or state the discretisation")]
    Unmet {
        /// The finest one, and its estimated error.
        chosen: Box<Chosen>,
    },
    /// A picture that cannot be drawn, whatever is traced.
    #[error("the plot: {0}")]
    Figure(#[from] FigureError),
    /// Ctrl-C.
    #[error("the run `{run}` was interrupted before it had a point; those before it are kept")]
    GivenUp {
        /// The run.
        run: String,
    },
    /// A run starts from a point that an earlier run did not find.
    #[error(
        "the run `{run}` starts from point {nth} of kind {kind} of `{from}`, which has {found} of that kind ({ends})"
    )]
    NoSuchPoint {
        /// The run.
        run: String,
        /// The run it starts from.
        from: String,
        /// The kind.
        kind: String,
        /// Which one.
        nth: usize,
        /// How many there are.
        found: usize,
        /// Why that run ended.
        ends: String,
    },
    /// Neither a state nor where motion settles from there is a start.
    #[error("motion does not settle from the given state: {cause}; no branch starts there: {near}")]
    NoStart {
        /// Why no branch starts there.
        near: Box<SceneError>,
        /// Why motion does not settle.
        cause: Box<SceneError>,
    },
    /// A run failed.
    #[error("run `{run}`: {}", spelled(&**cause))]
    Run {
        /// The run.
        run: String,
        /// Why.
        #[source]
        cause: Box<RunError>,
    },
}

/// Why a run, or a sweep of a local map, failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[error("{0}")]
pub enum RunError {
    /// There is no local map to follow.
    Local(#[from] GrazingError),
    /// No curve begins at the grazing of a local map.
    Expansion(#[from] ExpansionError),
    /// A simulation ended before its time.
    Simulation(#[from] HybridError),
    /// A simulation found no periodic motion to start from.
    Unsettled(#[from] CycleSearchError),
    /// There is no saddle whose manifolds could be grown.
    Manifold(#[from] ManifoldError),
    /// A trace could not begin.
    Trace(#[from] TraceError),
}

impl SceneError {
    /// Whether it names the file that it is about: one of equations, in place of the scene's.
    pub fn names_file(&self) -> bool {
        match self {
            SceneError::File { .. } => true,
            SceneError::Model(error) => !error.file.is_empty(),
            _ => false,
        }
    }

    /// Whether another start of a run in which parameters are released may mend it: no solution is
    /// there, or one that is out of bounds.
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

    /// A setting that changes nothing while another one has a value.
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

/// Why a setting has no effect while another one has a value, with the remedy.
pub(super) fn under_setting(under: &str, value: &str) -> String {
    format!("where `{under}` is `{value}`: leave it out, or set `{under}` too")
}
