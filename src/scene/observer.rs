//! What watches the runs of a scene.

use crate::core::continuation::Observer;
use std::time::Duration;

/// Sees the runs of a scene.
pub trait SceneObserver: Observer {
    /// The run of this name begins; whether its branch is shown.
    fn run(&mut self, _run: &str, _shown: bool) {}

    /// The work that the run of this name is about to do, and the longest time that it may take.
    fn work(&mut self, _run: &str, _what: &str, _longest: Duration) {}
}

impl SceneObserver for () {}
