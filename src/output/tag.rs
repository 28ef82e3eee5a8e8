//! The tag of documents.

/// The tag by which a document is known, with the version of its format.
pub const FORMAT: &str = "tangency/1";
