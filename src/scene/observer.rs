//! Observers of the runs of a scene, for example to show progress.

use crate::core::continuation::Observer;
use std::time::Duration;

/// An observer of the runs of a scene.
pub trait SceneObserver: Observer {
    /// Called when a run begins; `shown` states whether its branch is shown.
    fn run(&mut self, _run: &str, _shown: bool) {}

    /// Called before long work of the named run, with the longest time that it may take.
    fn work(&mut self, _run: &str, _what: &str, _longest: Duration) {}
}

impl SceneObserver for () {}
