//! Errors that prevent the start of a continuation.

use super::newton::NewtonError;
use super::settings::SettingError;
use crate::core::failure::debug_is_message;
use crate::core::failure::one_line;
use crate::core::problem::UnknownName;

debug_is_message!(TraceError);

/// Reasons why the continuation of a curve could not start.
#[derive(Clone, PartialEq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// A name of a parameter, monitor or group of unknowns does not exist in the problem.
    #[error(transparent)]
    #[diagnostic(transparent)]
    UnknownName(#[from] UnknownName),
    /// A parameter is released twice.
    #[error("the parameter `{0}` is released twice")]
    Twice(String),
    /// The start lies outside the range or bounds of a parameter or monitor.
    #[error("the start {name} = {value} is not in the range of {name}, {low} to {high}")]
    #[diagnostic(help("start the branch within the range, or widen the range"))]
    OutOfRange {
        /// The name of the parameter or monitor.
        name: String,
        /// The value of the parameter or monitor at the start.
        value: f64,
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// The range of a parameter or monitor is empty or contains NaN.
    #[error("the range of {name}, {low} to {high}, is empty: the lower end must come first")]
    EmptyRange {
        /// The name of the parameter or monitor.
        name: String,
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// The number given as a mark or as a scale is not allowed.
    #[error("{what} of {name} is {value}, but must be {range}")]
    Value {
        /// The role of the number: `the mark` or `the scale`.
        what: &'static str,
        /// The name of the parameter, monitor or group of unknowns.
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
        /// The number of parameters that must be released.
        needed: usize,
    },
    /// The library does not contain a defining system for a kind of special point.
    #[error(
        "curves of {0} points ({meaning}) cannot be followed, because the library has no defining \
         system for {0} points",
        meaning = .0.meaning()
    )]
    NotHeld(crate::core::system::Kind),
    /// A curve of solutions at a limit of admissible solutions starts at a solution that is not at
    /// a limit.
    #[error(
        "no curve of {0} points ({meaning}) starts here: no monitor that vanishes at {0} points is \
         zero at the start",
        meaning = .0.meaning()
    )]
    #[diagnostic(help("start at a special point of the kind {0}"))]
    NotAtLimit(crate::core::system::Kind),
    /// The defining system of an event has auxiliary unknowns, so that its left side cannot serve
    /// as the test function.
    #[error(
        "the defining system of the event `{0}` has auxiliary unknowns, so it cannot be used as a \
         test function"
    )]
    #[diagnostic(help("give the event a test function with `Event::with_test`"))]
    NoTest(String),
    /// An event refers to a parameter, monitor or auxiliary unknown whose index is out of range.
    #[error(
        "the event `{event}` refers to the {what} with number {position}, but there are only \
         {count}, numbered from 0"
    )]
    Position {
        /// The event.
        event: String,
        /// The type of the quantity: `parameter`, `monitor` or `auxiliary unknown`.
        what: &'static str,
        /// The position.
        position: usize,
        /// The number of parameters, monitors or auxiliary unknowns.
        count: usize,
    },
    /// A monitor cannot be held at a level, because it has no gradient.
    #[error("the monitor `{0}` has no gradient, so it cannot be held constant along a curve")]
    #[diagnostic(help("attach the monitor with `smooth_monitor`"))]
    NoGradient(String),
    /// The start has the wrong number of unknowns.
    #[error(
        "the start has {found} unknowns, but the problem has {expected} unknowns: was the start \
         computed with other settings?"
    )]
    StateLength {
        /// The number of unknowns of the given start.
        found: usize,
        /// The number of unknowns of the problem.
        expected: usize,
    },
    /// The solution at which the curve starts has a different number of parameters than the
    /// problem.
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
    /// The branch has no special point with the requested label.
    #[error(
        "branch `{branch}` has no special point with the label {label}; its labels are 1 to {last}"
    )]
    Label {
        /// The branch.
        branch: String,
        /// The label.
        label: usize,
        /// The largest label on the branch.
        last: usize,
    },
    /// The special point at which the curve starts has not converged. A curve starts at an
    /// unconverged point only on explicit request.
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
        /// The kind of the special point.
        kind: crate::core::system::Kind,
        /// The values of the continued parameter between which the special point lies.
        bracket: [f64; 2],
    },
    /// A kind of special point cannot be held for solutions of the problem.
    #[error("{kind} ({}) cannot be held: {reason}", kind.meaning())]
    NotOfProblem {
        /// The kind.
        kind: crate::core::system::Kind,
        /// The reason why the kind cannot be held.
        reason: String,
    },
    /// Two unknowns, parameters or monitors have the same name.
    #[error("two {what} of the problem have the same name, `{name}`")]
    #[diagnostic(help("choose different names"))]
    SameName {
        /// The type of the quantities with the same name: `unknowns`, `parameters` or `monitors`.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// The value of a setting is out of range.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Setting(#[from] SettingError),
    /// A curve of special points starts at a special point of another kind.
    #[error(
        "a curve of {held} points ({}) cannot start at a point of the kind {start} ({})",
        held.meaning(), start.meaning()
    )]
    #[diagnostic(help("start at a point of the kind {held}, or hold {start}"))]
    OtherKind {
        /// The held kind.
        held: crate::core::system::Kind,
        /// The kind of the special point at the start.
        start: crate::core::system::Kind,
    },
    /// Several errors, each described by another variant of this type.
    #[error("{}", several(.0))]
    Several(Vec<TraceError>),
    /// Newton's method failed at the start of the curve.
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
