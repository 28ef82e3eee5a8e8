//! Observers of the runs of a scene, for example to show progress.

use crate::core::continuation::Observer;
use std::time::Duration;

/// An observer of the runs of a scene.
pub trait SceneObserver: Observer {
    /// Called when a run begins; `shown` states whether the branch of the run is shown.
    fn run(&mut self, _run: &str, _shown: bool) {}

    /// Called before a computation of the named run that may take a long time, with an upper
    /// estimate of its duration.
    fn work(&mut self, _run: &str, _what: &str, _longest: Duration) {}
}

impl SceneObserver for () {}
