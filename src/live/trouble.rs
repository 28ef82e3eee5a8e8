//! Errors in the form in which the page shows them: at their place in the text, or at a field of
//! the page.

use crate::core::failure::one_line;
use crate::language::ModelError;
use crate::scene::SceneError;
use serde::Serialize;

/// An error to show on the page, with its place.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Trouble {
    /// The message.
    message: String,
    /// The number of the line with the error in the text, counted from 1.
    line: Option<usize>,
    /// The number of the first marked column in the line, counted from 1.
    column: usize,
    /// The number of columns to mark.
    width: usize,
    /// The name of the parameter or setting whose value is wrong.
    name: Option<String>,
    /// The name of the run that failed.
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

/// Returns the message and the remedy of an error in equations, but not its place, which the page
/// shows separately.
fn said(error: &ModelError) -> String {
    match &error.help {
        Some(help) => format!("{}; {help}", error.fault),
        None => error.fault.to_string(),
    }
}

impl Trouble {
    /// Creates an error that has no place.
    pub fn plain(message: impl Into<String>) -> Self {
        Trouble { message: message.into(), ..Trouble::default() }
    }

    /// Returns the error of a failed run, with the name of the run.
    pub fn of_run(run: &str, cause: &SceneError) -> Self {
        Trouble { run: Some(run.into()), ..Trouble::from(cause) }
    }

    /// Returns the error of the only run of a scene, without the name of the run.
    pub fn without_run(mut self) -> Self {
        let run = self.run.take().map(|run| format!("run `{run}`: "));
        if let Some(rest) = run.and_then(|run| self.message.strip_prefix(&run).map(String::from)) {
            self.message = rest;
        }
        self
    }
}
