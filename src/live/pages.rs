//! The open pages, with the running trace and the last result of each page.

use crate::core::cancel::CancelToken;
use crate::core::continuation::Branch;
use crate::output::Document;
use crate::scene::{Correctable, Scene, SceneError};
use serde::Serialize;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The maximum number of pages whose results are kept; beyond this number, the result of the page
/// that was unused for the longest time is dropped.
const MOST: usize = 16;

/// The maximum number of simulated histories that are kept with a result.
const HISTORIES: usize = 100;

/// A message from the server to a page, which is one line of JSON.
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

/// The last result of a page, which the server keeps.
#[derive(Clone)]
pub(super) struct Kept {
    /// The name of the result, which is also the name of the files in which the result is saved.
    pub name: String,
    /// The scene whose result is kept, including all runs that were traced.
    pub scene: Arc<Scene>,
    pub document: Arc<Document>,
    /// The time in which the result was computed.
    pub duration: Duration,
    /// The branches of the result at a few points, corrected for the last changed values.
    pub correctable: Arc<Correctable>,
    /// The columns on the axes of the diagram; `None` for the default columns.
    pub axes: [Option<String>; 2],
    /// The extremes of simulated histories at points of the result, each with the number of its
    /// simulation.
    pub histories: Vec<(u64, Branch)>,
}

impl Kept {
    /// Returns the scene without runs, with the parameter values of a branch; the given values
    /// replace some of these values. The token cancels computations with the returned scene.
    pub fn alone(
        &self,
        branch: &Branch,
        own: &[(String, f64)],
        cancel: &CancelToken,
    ) -> Result<Scene, SceneError> {
        let mut scene = Scene {
            runs: Vec::new(),
            sweeps: Vec::new(),
            accuracy: None,
            ..Scene::clone(&self.scene)
        };
        scene.settings.cancel = cancel.clone();
        let of_branch = branch.points.first().map_or(&[][..], |point| &point.parameters);
        let known: Vec<String> =
            scene.problem.parameters().into_iter().map(|(name, _)| name).collect();
        let values = branch.parameters.iter().cloned().zip(of_branch.iter().copied());
        let values = values.filter(|(name, _)| known.contains(name)).chain(own.iter().cloned());
        let values: Vec<(String, String)> =
            values.map(|(name, value)| (name, value.to_string())).collect();
        scene.set_all(&values)?;
        Ok(scene)
    }
}

/// Computations in the background of pages: at most one for each page, with a limit on the number
/// that run simultaneously.
pub(super) struct Tasks {
    pub pages: Pages,
    pub slots: Slots,
}

impl Tasks {
    /// Creates an empty list of computations.
    pub fn new() -> Self {
        Tasks { pages: Pages::default(), slots: Slots::new() }
    }
}

/// A page, with the number of its last trace (computation of branches), the token that cancels this
/// computation, and the last result.
struct Page {
    id: String,
    turn: u64,
    cancel: CancelToken,
    kept: Option<Arc<Kept>>,
}

/// The open pages, with the most recently used page at the end.
#[derive(Default)]
pub(super) struct Pages(Mutex<Vec<Page>>);

impl Pages {
    fn all(&self) -> MutexGuard<'_, Vec<Page>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Cancels the computation that is running for a page, and returns the cancellation token of
    /// the new computation; `None` if an even newer computation has already begun.
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

    /// Keeps the result of a computation for a page, unless a newer computation has begun.
    pub fn keep(&self, id: &str, turn: u64, kept: Kept) {
        let mut all = self.all();
        if let Some(page) = all.iter_mut().find(|page| page.id == id && page.turn == turn) {
            page.kept = Some(Arc::new(kept));
        }
    }

    /// Keeps branches that were corrected for changed values with the last result of a page, unless
    /// the page has another result by now.
    pub fn keep_corrected(&self, id: &str, result: &Kept, corrected: Correctable) {
        self.change(id, result, |kept| kept.correctable = Arc::new(corrected));
    }

    /// Cancels the computation that is running for a page.
    pub fn cancel(&self, id: &str) {
        self.all().iter().filter(|page| page.id == id).for_each(|page| page.cancel.cancel());
    }

    /// Changes the columns on the axes of the last result of a page, and returns the result.
    pub fn turn_axes(&self, id: &str, axes: [Option<String>; 2]) -> Option<Arc<Kept>> {
        let mut all = self.all();
        let page = all.iter_mut().find(|page| page.id == id)?;
        let kept = Kept { axes, ..(**page.kept.as_ref()?).clone() };
        page.kept = Some(Arc::new(kept));
        page.kept.clone()
    }

    /// Adds a simulated history to the last result of a page, and returns the result; `None` if the
    /// page has another result by now.
    pub fn add_history(
        &self,
        id: &str,
        result: &Kept,
        history: (u64, Branch),
    ) -> Option<Arc<Kept>> {
        self.change(id, result, |kept| {
            if kept.histories.len() >= HISTORIES {
                kept.histories.remove(0);
            }
            kept.histories.push(history);
        })
    }

    /// Changes the last result of a page, and returns the result; `None` if the page has another
    /// result by now.
    fn change(&self, id: &str, result: &Kept, change: impl FnOnce(&mut Kept)) -> Option<Arc<Kept>> {
        let mut all = self.all();
        let page = all.iter_mut().find(|page| page.id == id)?;
        let last = page.kept.as_ref()?;
        if !Arc::ptr_eq(&last.document, &result.document) {
            return None;
        }
        let mut kept = (**last).clone();
        change(&mut kept);
        page.kept = Some(Arc::new(kept));
        page.kept.clone()
    }

    /// Returns the last result of a page, or `None` if the page has no result.
    pub fn kept(&self, id: &str) -> Option<Arc<Kept>> {
        self.all().iter().find(|page| page.id == id)?.kept.clone()
    }
}

/// The slots that limit how many computations for pages run simultaneously.
pub(super) struct Slots {
    free: Mutex<usize>,
    freed: Condvar,
}

/// A slot that a computation uses; the slot becomes free when this value is dropped.
pub(super) struct Slot<'a>(&'a Slots);

impl Slots {
    /// Creates one slot for each processor, but at least two slots; each slot allows one computation.
    pub fn new() -> Self {
        let processors = std::thread::available_parallelism().map_or(2, |count| count.get());
        Slots { free: Mutex::new(processors.max(2)), freed: Condvar::new() }
    }

    /// Waits for a free slot; returns `None` if the work is cancelled before a slot is free.
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
