//! The source of the scenes and problems of commands, and the size limit of input files.

use crate::output::SizeLimit;
use crate::scene::Catalogue;

/// The source of scenes and problems, and the size limit of input files.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// The problems and the built-in scenes.
    pub catalogue: &'a Catalogue,
    /// The maximum size of an input file.
    pub limit: SizeLimit,
}
