//! The tag of documents.

/// The tag of documents, with the version of the format.
pub const FORMAT: &str = "tangency/1";
