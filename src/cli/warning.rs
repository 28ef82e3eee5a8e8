//! Warnings on the error stream.

use crate::output::printable;
use std::io::Write;

/// Prints a warning. Nobody may read the error stream: that ends no work.
pub fn warn(what: &str) {
    let _ = writeln!(std::io::stderr(), "warning: {}", printable(what));
}
