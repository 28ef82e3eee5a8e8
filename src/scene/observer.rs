//! What watches the runs of a scene.

use super::error::SceneError;
use crate::core::continuation::{Observer, SpecialPoint};
use std::time::Duration;

/// Sees the runs of a scene.
pub trait SceneObserver: Observer {
    /// The run of this name begins; whether its branch is shown.
    fn run(&mut self, _run: &str, _shown: bool) {}

    /// The work that the run of this name is about to do, and the longest time that it may take.
    fn work(&mut self, _run: &str, _what: &str, _longest: Duration) {}

    /// The run of this name, which would have gone on from a special point, is left out.
    fn left_out(&mut self, _run: &str, _why: &SceneError) {}

    /// The run of this name follows one of the branches that begin at a special point at which
    /// several pairs of eigenvalues are critical: its equations do not determine the others.
    fn one_of_several(&mut self, _run: &str, _point: &SpecialPoint) {}
}

impl SceneObserver for () {}
