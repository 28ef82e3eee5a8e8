//! The open pages: the work and the last result of each.

use crate::core::cancel::CancelToken;
use crate::output::Document;
use crate::scene::Scene;
use serde::Serialize;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The maximum number of pages with a result; the result of the page that is unused for the longest
/// time is dropped.
const MOST: usize = 16;

/// A message to a page: one line of JSON.
pub(super) struct Message(String);

impl Message {
    /// Creates a message.
    pub fn of(content: &impl Serialize) -> Self {
        // Messages have string keys only, so serialization cannot fail.
        Message(serde_json::to_string(content).unwrap_or_default() + "\n")
    }

    /// Returns the line.
    pub fn line(&self) -> &[u8] {
        self.0.as_bytes()
    }
}

/// The last result of a page.
#[derive(Clone)]
pub(super) struct Kept {
    /// The name for files.
    pub name: String,
    /// The scene with all traced runs.
    pub scene: Arc<Scene>,
    pub document: Arc<Document>,
    /// The columns on the axes, if chosen.
    pub axes: [Option<String>; 2],
}

/// A page: the number of its last trace, the token that cancels the trace, and the last result.
struct Page {
    id: String,
    turn: u64,
    cancel: CancelToken,
    kept: Option<Arc<Kept>>,
}

/// The open pages, the last used one at the end.
#[derive(Default)]
pub(super) struct Pages(Mutex<Vec<Page>>);

impl Pages {
    fn all(&self) -> MutexGuard<'_, Vec<Page>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Cancels the earlier trace of a page and returns the token of the next one; `None` if a later
    /// trace has begun.
    pub fn begin(&self, id: &str, turn: u64) -> Option<CancelToken> {
        let mut all = self.all();
        let known = all.iter().position(|page| page.id == id);
        let kept = match known {
            Some(place) if all[place].turn >= turn => return None,
            Some(place) => {
                let page = all.remove(place);
                page.cancel.cancel();
                page.kept
            }
            None => None,
        };
        if all.len() >= MOST {
            all.remove(0).cancel.cancel();
        }
        let cancel = CancelToken::default();
        all.push(Page { id: id.into(), turn, cancel: cancel.clone(), kept });
        Some(cancel)
    }

    /// Keeps the result of a trace, unless a later one has begun.
    pub fn keep(&self, id: &str, turn: u64, kept: Kept) {
        let mut all = self.all();
        if let Some(page) = all.iter_mut().find(|page| page.id == id && page.turn == turn) {
            page.kept = Some(Arc::new(kept));
        }
    }

    /// Cancels the trace of a page.
    pub fn cancel(&self, id: &str) {
        self.all().iter().filter(|page| page.id == id).for_each(|page| page.cancel.cancel());
    }

    /// Chooses other axes for the last result of a page, and returns the result.
    pub fn turn_axes(&self, id: &str, axes: [Option<String>; 2]) -> Option<Arc<Kept>> {
        let mut all = self.all();
        let page = all.iter_mut().find(|page| page.id == id)?;
        let kept = Kept { axes, ..(**page.kept.as_ref()?).clone() };
        page.kept = Some(Arc::new(kept));
        page.kept.clone()
    }

    /// Returns the last result of a page.
    pub fn kept(&self, id: &str) -> Option<Arc<Kept>> {
        self.all().iter().find(|page| page.id == id)?.kept.clone()
    }
}

/// The number of traces that run at the same time.
pub(super) struct Slots {
    free: Mutex<usize>,
    freed: Condvar,
}

/// A slot in use.
pub(super) struct Slot<'a>(&'a Slots);

impl Slots {
    /// Creates as many slots as there are processors, at least two.
    pub fn new() -> Self {
        let processors = std::thread::available_parallelism().map_or(2, |count| count.get());
        Slots { free: Mutex::new(processors.max(2)), freed: Condvar::new() }
    }

    /// Waits for a slot; `None` if the work is cancelled before.
    pub fn take(&self, cancel: &CancelToken) -> Option<Slot<'_>> {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        while *free == 0 && !cancel.is_cancelled() {
            let wait = self.freed.wait_timeout(free, Duration::from_millis(20));
            free = wait.unwrap_or_else(PoisonError::into_inner).0;
        }
        if cancel.is_cancelled() {
            return None;
        }
        *free -= 1;
        Some(Slot(self))
    }
}

impl Drop for Slot<'_> {
    fn drop(&mut self) {
        *self.0.free.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        self.0.freed.notify_one();
    }
}
