//! Interruption of long work from outside, as by Ctrl-C.
//!
//! Flows ask before every step, and systems of equations before they are assembled, whether the
//! work that this thread does is still to go on. If not, they fail at once with [`Interrupted`],
//! and so does all that is computed from them: a branch keeps the points it has, and ends there.
//! Long computations of a plug-in may ask as well.

use std::cell::Cell;

thread_local! {
    /// Whether what this thread does is to go on.
    static GOES_ON: Cell<fn() -> bool> = const { Cell::new(|| true) };
}

/// Work was interrupted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("interrupted, as was asked")]
pub struct Interrupted;

/// Does some work in this thread, which is interrupted as soon as `goes_on` is false.
///
/// ```
/// use tangency::core::flow::{Flow, FlowError, Settings};
/// use tangency::core::interruption::{Interrupted, interruptible};
/// use tangency::problems::classic::Lure;
/// let mut flow = Flow::<f64>::new(Settings::default())?;
/// let flowed = |flow: &mut Flow<f64>| flow.advance(&Lure, 0.0, 2.0, &mut [0.1, 0.0, 0.0], &[0.8, 1.0]);
/// let given_up = interruptible(|| false, || flowed(&mut flow));
/// assert_eq!(given_up, Err(FlowError::Interrupted(Interrupted)));
/// assert!(flowed(&mut flow).is_ok());
/// # Ok::<(), tangency::core::flow::SettingsError>(())
/// ```
pub fn interruptible<R>(goes_on: fn() -> bool, work: impl FnOnce() -> R) -> R {
    /// Gives the outer work its own question back, also if the inner one panics.
    struct Outer(fn() -> bool);
    impl Drop for Outer {
        fn drop(&mut self) {
            GOES_ON.set(self.0);
        }
    }
    let _outer = Outer(GOES_ON.replace(goes_on));
    work()
}

/// Whether the work that this thread does is interrupted.
pub fn interrupted() -> bool {
    !GOES_ON.get()()
}

/// Refuses to go on with work that is interrupted.
///
/// # Errors
/// [`Interrupted`].
pub fn check() -> Result<(), Interrupted> {
    if interrupted() { Err(Interrupted) } else { Ok(()) }
}
