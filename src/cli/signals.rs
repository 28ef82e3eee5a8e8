//! Signal handling: a signal before the start of the computation ends the command immediately, for
//! instance while the command reads a FIFO; after the start of the computation, the results
//! obtained so far are saved first.

use super::warning::warn;
use crate::core::cancel::CancelToken;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Once};
use std::time::Duration;

/// The flags that are set when the program receives a signal.
struct Flags {
    /// Whether a signal was received: Ctrl-C, SIGTERM (sent by schedulers before SIGKILL) or
    /// SIGHUP.
    signalled: Arc<AtomicBool>,
    /// Whether the computation is cancelled, either by a signal or because its results cannot be
    /// saved.
    cancelled: Arc<AtomicBool>,
}

static FLAGS: LazyLock<Flags> =
    LazyLock::new(|| Flags { signalled: Arc::default(), cancelled: Arc::default() });

/// Installs the signal handlers: the first signal cancels the computation, and a second signal ends
/// the program immediately.
pub fn handle() {
    static HANDLED: Once = Once::new();
    HANDLED.call_once(register_handlers);
}

fn register_handlers() {
    let Flags { signalled, cancelled } = &*FLAGS;
    #[cfg(unix)]
    let hangup = Some(signal_hook::consts::SIGHUP).filter(|signal| !is_ignored(*signal));
    #[cfg(not(unix))]
    let hangup = None;
    for signal in [SIGINT, SIGTERM].into_iter().chain(hangup) {
        // If registration fails, a signal ends the program without saving partial results.
        let _ = register_conditional_shutdown(signal, 128 + signal, Arc::clone(signalled))
            .and_then(|_| register(signal, Arc::clone(signalled)))
            .and_then(|_| register(signal, Arc::clone(cancelled)));
    }
    let seen = Arc::clone(signalled);
    std::thread::spawn(move || answer(&seen));
}

/// Returns whether a signal was received.
pub fn interrupted() -> bool {
    FLAGS.signalled.load(Ordering::SeqCst)
}

/// Returns the cancellation token, which a signal cancels after [`handle`] was called.
pub fn token() -> CancelToken {
    CancelToken::from(Arc::clone(&FLAGS.cancelled))
}

/// Prints a notice if the program is still running shortly after a signal. Computations in other
/// crates, such as the factorization of a matrix with thousands of rows, cannot be interrupted.
fn answer(interrupted: &AtomicBool) {
    while !interrupted.load(Ordering::SeqCst) {
        std::thread::sleep(SOON);
    }
    std::thread::sleep(SOON);
    warn(
        "the program was interrupted: it ends after the current computation and saves its results; \
         a second interruption ends the program immediately",
    );
}

/// The interval at which the program checks for signals; most computations end within this time
/// after a signal.
const SOON: Duration = Duration::from_millis(200);

/// Returns whether the process ignores a signal; for example, a process started by `nohup` ignores
/// SIGHUP.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
