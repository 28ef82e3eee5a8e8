//! Errors as the page shows them: at their place in the text, or at a field.

use crate::core::failure::one_line;
use crate::language::ModelError;
use crate::scene::SceneError;
use serde::Serialize;

/// An error with its place.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Trouble {
    /// The message.
    message: String,
    /// The line of the text, from 1.
    line: Option<usize>,
    /// The column of the line, from 1.
    column: usize,
    /// The number of columns.
    width: usize,
    /// The parameter or setting whose value is wrong.
    name: Option<String>,
    /// The run that failed.
    run: Option<String>,
}

impl From<&SceneError> for Trouble {
    fn from(cause: &SceneError) -> Self {
        let message = one_line(cause);
        match cause {
            SceneError::Model(error) => match error.place.line {
                Some(_) => Trouble {
                    message: said(error),
                    line: error.place.line,
                    column: error.place.column,
                    width: error.place.width,
                    ..Trouble::default()
                },
                None => Trouble { message, ..Trouble::default() },
            },
            SceneError::Value { name, .. }
            | SceneError::NoEffect { name, .. }
            | SceneError::Varied { name, .. } => {
                Trouble { message, name: Some(name.clone()), ..Trouble::default() }
            }
            SceneError::Run { run, .. } | SceneError::NoSuchPoint { run, .. } => {
                Trouble { message, run: Some(run.clone()), ..Trouble::default() }
            }
            _ => Trouble { message, ..Trouble::default() },
        }
    }
}

/// Returns the fault of an error in equations and the remedy; the page shows the place.
fn said(error: &ModelError) -> String {
    match &error.help {
        Some(help) => format!("{}; {help}", error.fault),
        None => error.fault.to_string(),
    }
}

impl Trouble {
    /// Creates an error without a place.
    pub fn plain(message: impl Into<String>) -> Self {
        Trouble { message: message.into(), ..Trouble::default() }
    }

    /// Returns the error of a run.
    pub fn of_run(run: &str, cause: &SceneError) -> Self {
        Trouble { run: Some(run.into()), ..Trouble::from(cause) }
    }
}
