//! Threads for independent pieces of a computation.

use std::env;
use std::num::NonZero;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;

/// The environment variable that limits the number of threads, also of sweeps.
const LIMIT: &str = "RAYON_NUM_THREADS";

/// Returns the number of threads that may run at the same time: the number of processors, or a
/// smaller number in the environment variable [`LIMIT`].
fn available() -> usize {
    // The operating system is asked once, because the answer takes longer than short computations.
    static AVAILABLE: OnceLock<usize> = OnceLock::new();
    *AVAILABLE.get_or_init(|| {
        let processors = thread::available_parallelism().map_or(1, NonZero::get);
        let limit = env::var(LIMIT).ok().and_then(|limit| limit.trim().parse().ok());
        limit.filter(|limit| *limit > 0).map_or(processors, |limit: usize| limit.min(processors))
    })
}

/// Calls a function for each item and its position, on as many threads as there are items and
/// processors. The order of the calls is arbitrary.
pub(in crate::core) fn side_by_side<T: Send>(items: &mut [T], call: impl Fn(usize, &mut T) + Sync) {
    let threads = available().min(items.len());
    if threads < 2 {
        items.iter_mut().enumerate().for_each(|(k, item)| call(k, item));
        return;
    }
    let queue = Mutex::new(items.iter_mut().enumerate());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = || {
        while let Some((k, item)) = next() {
            call(k, item);
        }
    };
    thread::scope(|scope| {
        (1..threads).for_each(|_| drop(scope.spawn(work)));
        work();
    });
}
