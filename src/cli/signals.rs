//! Signals that end a command: at once before its work begins, for instance while it waits for a
//! FIFO, and afterwards with the results so far saved.

use super::warning::warn;
use crate::core::cancel::CancelToken;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Once};
use std::time::Duration;

/// What signals set.
struct Flags {
    /// A signal came: Ctrl-C, SIGTERM, which schedulers send before they kill, or SIGHUP.
    signalled: Arc<AtomicBool>,
    /// The work is cancelled, by a signal or because its results cannot be saved.
    cancelled: Arc<AtomicBool>,
}

static FLAGS: LazyLock<Flags> =
    LazyLock::new(|| Flags { signalled: Arc::default(), cancelled: Arc::default() });

/// Handles signals from now on: the first one cancels the work, and a second one ends the program at
/// once.
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
        // Without a handler a signal ends the program: partial results are lost, nothing worse.
        let _ = register_conditional_shutdown(signal, 128 + signal, Arc::clone(signalled))
            .and_then(|_| register(signal, Arc::clone(signalled)))
            .and_then(|_| register(signal, Arc::clone(cancelled)));
    }
    let seen = Arc::clone(signalled);
    std::thread::spawn(move || answer(&seen));
}

/// Whether a signal asked for the end.
pub fn interrupted() -> bool {
    FLAGS.signalled.load(Ordering::SeqCst)
}

/// The token that a signal cancels, once signals are handled.
pub fn token() -> CancelToken {
    CancelToken::from(Arc::clone(&FLAGS.cancelled))
}

/// Answers a signal that does not end the program soon: what another crate computes, as the factors
/// of a matrix with thousands of rows, is not interrupted.
fn answer(interrupted: &AtomicBool) {
    while !interrupted.load(Ordering::SeqCst) {
        std::thread::sleep(SOON);
    }
    std::thread::sleep(SOON);
    warn(
        "interrupted; the program ends with the computation under way, and saves what is done: a second signal ends it at once",
    );
}

/// How often signals are looked for, and how soon the program ends as a rule.
const SOON: Duration = Duration::from_millis(200);

/// Whether a signal is ignored, as SIGHUP is under `nohup`: a run that is to outlive its terminal
/// does.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}
