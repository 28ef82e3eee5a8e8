//! Prints errors and warnings to the standard error stream.

use crate::output::printable;
use miette::Diagnostic;
use std::io::Write;

/// Prints a warning. Failures to write the warning are ignored.
pub fn warn(what: &str) {
    let _ = writeln!(std::io::stderr(), "warning: {}", printable(what));
}

/// Prints an error, and the help for the error on a separate line. Failures to write the error
/// message are ignored.
pub fn complain(error: &dyn Diagnostic) {
    let mut lines = format!("error: {}", printable(&error.to_string()));
    if let Some(help) = error.help() {
        lines += &format!("\nhelp: {}", printable(&help.to_string()));
    }
    let _ = writeln!(std::io::stderr(), "{lines}");
}
