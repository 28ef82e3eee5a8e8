//! The format tag of documents.

/// The format tag of documents, which contains the version of the format.
pub const FORMAT: &str = "tangency/1";
