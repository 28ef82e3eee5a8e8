//! Systems that are borrowed, or owned by the one who works with them.

use super::System;
use std::ops::{Deref, DerefMut};

/// A system to work with: the caller's, or one made from it that may change without changing the
/// caller's.
pub(crate) enum SystemRef<'a> {
    /// The caller's.
    Borrowed(&'a mut (dyn System + 'a)),
    /// One's own.
    Owned(Box<dyn System + 'a>),
}

impl SystemRef<'_> {
    /// Replaces a borrowed system by a duplicate, where it can be duplicated.
    pub fn duplicated(self) -> Self {
        match self {
            SystemRef::Borrowed(system) => {
                match system.discretised().and_then(|system| system.duplicate()) {
                    Some(own) => SystemRef::Owned(own),
                    None => SystemRef::Borrowed(system),
                }
            }
            SystemRef::Owned(_) => self,
        }
    }
}

impl<'a> Deref for SystemRef<'a> {
    type Target = dyn System + 'a;

    fn deref(&self) -> &Self::Target {
        match self {
            SystemRef::Borrowed(system) => *system,
            SystemRef::Owned(system) => &**system,
        }
    }
}

impl DerefMut for SystemRef<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            SystemRef::Borrowed(system) => *system,
            SystemRef::Owned(system) => &mut **system,
        }
    }
}
