//! Cancellation of long computations from outside, for example by Ctrl-C.
//!
//! A [`CancelToken`] belongs to the settings of flows, searches and branches. Flows check it before
//! every step, systems of equations before every assembly, every interval and every block of a
//! factorisation, and sweeps between periods, on all threads. Cancelled work fails immediately with
//! [`Cancelled`]; a branch keeps its points and ends with
//! [`End::Interrupted`](crate::core::continuation::End::Interrupted).

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request to stop, shared by all clones of the token.
///
/// ```
/// use tangency::core::cancel::{CancelToken, Cancelled};
/// use tangency::core::failure::FlowError;
/// use tangency::core::ode::{Flow, Settings};
/// use tangency::problems::classic::Lure;
/// let cancel = CancelToken::default();
/// let mut flow = Flow::<f64>::new(Settings { cancel: cancel.clone(), ..Settings::default() })?;
/// let mut flowed = || flow.advance(&Lure, 0.0, 2.0, &mut [0.1, 0.0, 0.0], &[0.8, 1.0]);
/// assert!(flowed().is_ok());
/// cancel.cancel();
/// assert_eq!(flowed(), Err(FlowError::Cancelled(Cancelled)));
/// # Ok::<(), tangency::core::ode::SettingsError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

/// The work was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl CancelToken {
    /// Cancels permanently all work that holds a clone of this token.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the work was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Returns an error if the work was cancelled.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

/// Creates a token from a flag that, for example, a signal handler sets.
impl From<Arc<AtomicBool>> for CancelToken {
    fn from(flag: Arc<AtomicBool>) -> Self {
        CancelToken(flag)
    }
}

/// All tokens compare equal, so that settings that differ only in their tokens are equal.
impl PartialEq for CancelToken {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}
