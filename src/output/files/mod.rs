//! Files: size limits for reading, and atomic writing of results.

mod leftovers;
#[cfg(feature = "cli")]
mod lock;
mod read;
mod target;
mod write;

#[cfg(feature = "cli")]
pub(crate) use lock::Lock;
pub use read::SizeLimit;
#[cfg(feature = "cli")]
pub(crate) use read::text_of;
pub(crate) use read::{read, read_text};
#[cfg(feature = "cli")]
pub(crate) use target::{kind, target};
pub use write::{write_atomically, write_together};
