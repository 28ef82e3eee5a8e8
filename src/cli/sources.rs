//! The catalogue from which commands take scenes and problems, and the size limit of input files.

use crate::output::SizeLimit;
use crate::scene::Catalogue;

/// The catalogue from which commands take scenes and problems, and the size limit of input files.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// The catalogue of problems and built-in scenes.
    pub catalogue: &'a Catalogue,
    /// The maximum size of an input file.
    pub limit: SizeLimit,
}
