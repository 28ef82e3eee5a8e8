//! References to systems that are either borrowed or owned.

use super::System;
use std::ops::{Deref, DerefMut};

/// The caller's system, or a derived system that can be modified without affecting the caller's
/// system.
pub(crate) enum SystemRef<'a> {
    /// The caller's system.
    Borrowed(&'a mut (dyn System + 'a)),
    /// An owned system.
    Owned(Box<dyn System + 'a>),
}

impl SystemRef<'_> {
    /// Replaces a borrowed system by a copy, if the system supports copies.
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
