//! Errors at the start of a trace.

use super::newton::NewtonError;
use super::settings::SettingError;
use crate::core::failure::debug_is_message;
use crate::core::failure::one_line;
use crate::core::problem::UnknownName;

debug_is_message!(TraceError);

/// Reasons why a trace could not start.
#[derive(Clone, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// A name that does not exist in the problem.
    #[error(transparent)]
    #[diagnostic(transparent)]
    UnknownName(#[from] UnknownName),
    /// A parameter released twice.
    #[error("the parameter `{0}` is released twice")]
    Twice(String),
    /// A start outside a range or bound.
    #[error("the start {name} = {value} is not in the range of {name}, {low} to {high}")]
    #[diagnostic(help("start the branch within the range, or widen the range"))]
    OutOfRange {
        /// The parameter or monitor.
        name: String,
        /// The value at the start.
        value: f64,
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// A range that is empty or NaN.
    #[error("the range of {name}, {low} to {high}, is empty: the lower end must come first")]
    EmptyRange {
        /// The parameter or monitor.
        name: String,
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// A mark or a scale that is not a usable number.
    #[error("{what} of {name} is {value}, but must be {range}")]
    Value {
        /// The kind of number: `the mark`, `the scale`.
        what: &'static str,
        /// The parameter, monitor or group of unknowns.
        name: String,
        /// The value.
        value: f64,
        /// The allowed range.
        range: &'static str,
    },
    /// The number of released parameters does not match the number of held defining systems.
    #[error(
        "{released} parameters are released, but {needed} parameters are needed: one for the \
         curve, and one more for each condition that is held along the curve"
    )]
    Released {
        /// The number of released parameters.
        released: usize,
        /// The number of parameters needed.
        needed: usize,
    },
    /// A kind of special point without a defining system in the library.
    #[error(
        "curves of {0} points ({meaning}) cannot be followed, because the library has no defining \
         system for {0} points",
        meaning = .0.meaning()
    )]
    NotHeld(crate::core::system::Kind),
    /// An event whose test function is a defining system with auxiliary unknowns.
    #[error(
        "the defining system of the event `{0}` has auxiliary unknowns, so it cannot be used as a \
         test function"
    )]
    #[diagnostic(help("give the event a test function with `Event::with_test`"))]
    NoTest(String),
    /// An event for a parameter or monitor whose position is out of range.
    #[error(
        "the event `{event}` refers to the {what} with number {position}, but there are only \
         {count}, numbered from 0"
    )]
    Position {
        /// The event.
        event: String,
        /// `parameter`, `monitor` or `auxiliary unknown`.
        what: &'static str,
        /// The position.
        position: usize,
        /// The number of parameters, monitors or unknowns.
        count: usize,
    },
    /// A monitor without a gradient, which cannot be held.
    #[error("the monitor `{0}` has no gradient, so it cannot be held constant along a curve")]
    #[diagnostic(help("attach the monitor with `smooth_monitor`"))]
    NoGradient(String),
    /// A state of the wrong length.
    #[error(
        "the start has {found} unknowns, but the problem has {expected} unknowns: was the start \
         computed with other settings?"
    )]
    StateLength {
        /// The length of the given state.
        found: usize,
        /// The number of unknowns.
        expected: usize,
    },
    /// A solution with a different number of parameters.
    #[error(
        "the solution at the start has {found} parameters, but the problem has {expected} \
         parameters"
    )]
    ParameterCount {
        /// The number of parameters of the solution.
        found: usize,
        /// The number of parameters of the problem.
        expected: usize,
    },
    /// A label that does not exist on the branch.
    #[error(
        "branch `{branch}` has no special point with the label {label}; its labels are 1 to {last}"
    )]
    Label {
        /// The branch.
        branch: String,
        /// The label.
        label: usize,
        /// The last label that exists.
        last: usize,
    },
    /// A special point that has not converged, at which a branch starts only on explicit request.
    #[error(
        "the special point {kind} with label {label} of branch `{branch}` has not converged (it \
         lies between the parameter values {} and {})", bracket[0], bracket[1]
    )]
    #[diagnostic(help(
        "lower `max_step`, refine the discretisation, or explicitly allow a start at a point that \
         has not converged"
    ))]
    NotConverged {
        /// The branch.
        branch: String,
        /// The label.
        label: usize,
        /// The kind of the point.
        kind: crate::core::system::Kind,
        /// The values of the continued parameter between which the point lies.
        bracket: [f64; 2],
    },
    /// A kind of special point that cannot be held for solutions of the problem.
    #[error("{kind} ({}) cannot be held: {reason}", kind.meaning())]
    NotOfProblem {
        /// The kind.
        kind: crate::core::system::Kind,
        /// The reason why the kind cannot be held.
        reason: String,
    },
    /// Two unknowns, parameters or monitors with the same name.
    #[error("two {what} of the problem have the same name, `{name}`")]
    #[diagnostic(help("choose different names"))]
    SameName {
        /// `unknowns`, `parameters` or `monitors`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A setting out of its range.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Setting(#[from] SettingError),
    /// Several of the errors above.
    #[error("{}", several(.0))]
    Several(Vec<TraceError>),
    /// Newton's method failed at the start.
    #[error("could not compute the starting point of the branch `{branch}` at {place}: {cause}")]
    #[diagnostic(forward(cause))]
    Start {
        /// The branch.
        branch: String,
        /// The values of the released parameters at the start.
        place: String,
        /// Newton's failure.
        #[source]
        cause: Box<NewtonError>,
    },
}

fn several(errors: &[TraceError]) -> String {
    let line = |error: &TraceError| format!("\n- {}", one_line(error));
    let lines: Vec<String> = errors.iter().map(line).collect();
    format!("the branch has {} errors:{}", errors.len(), lines.concat())
}
