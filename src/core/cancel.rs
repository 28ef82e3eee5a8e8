//! Cancels long computations from outside, for example by Ctrl-C.
//!
//! A [`CancelToken`] belongs to the settings of flows, searches and branches. Flows check the token
//! before every step; systems of equations check it before every assembly, every interval and every
//! block of a factorisation; sweeps check it between periods, on all threads. A cancelled
//! computation fails immediately with [`Cancelled`]; a cancelled branch keeps its points and ends
//! with [`End::Interrupted`](crate::core::continuation::End::Interrupted).
//!
//! ```
//! use tangency::core::continuation::{Continuation, End, Settings, Traced};
//! use tangency::core::{cancel::CancelToken, system::{Dense, Kind}};
//! use tangency::problems::classic::ParallelPlate;
//! let (mut plate, cancel) = (Dense::new(ParallelPlate), CancelToken::default());
//! let settings = Settings { cancel: cancel.clone(), ..Settings::default() };
//! let curve = Continuation::new(&mut plate).along("load", 0.0..=1.0).settings(settings);
//! let mut steps = curve.steps()?;
//! for found in steps.by_ref() {
//!     if matches!(found, Traced::Point(point) if point.parameters[0] > 0.1) {
//!         cancel.cancel(); // Usually on another thread.
//!     }
//! }
//! // The branch ends before the fold at the load 4/27.
//! let branch = steps.finish();
//! assert!(branch.ends[1] == End::Interrupted && branch.of_kind(Kind::LP).next().is_none());
//! # Ok::<(), tangency::core::continuation::TraceError>(())
//! ```

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request to stop a computation, shared by all clones of the token.
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

/// The error of a computation that its [`CancelToken`] cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl CancelToken {
    /// Cancels permanently all computations that hold a clone of this token.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the computation was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Returns an error if the computation was cancelled.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

/// Creates a token from a flag, for example a flag that a signal handler sets.
impl From<Arc<AtomicBool>> for CancelToken {
    fn from(flag: Arc<AtomicBool>) -> Self {
        CancelToken(flag)
    }
}

/// All tokens compare equal, so that two settings are equal if only their tokens differ.
impl PartialEq for CancelToken {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}
