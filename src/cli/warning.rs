//! Warnings on the error stream.

use crate::output::printable;
use std::io::Write;

/// Prints a warning. Errors in writing the warning are ignored.
pub fn warn(what: &str) {
    let _ = writeln!(std::io::stderr(), "warning: {}", printable(what));
}
