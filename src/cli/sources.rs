//! Where commands find scenes and problems, and how much they read.

use crate::output::SizeLimit;
use crate::scene::Catalogue;

/// Where commands find scenes and problems, and how much they read.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// The problems, and the scenes that have names.
    pub catalogue: &'a Catalogue,
    /// The largest file that is read.
    pub limit: SizeLimit,
}
