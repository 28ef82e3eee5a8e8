//! What watches a trace.

use super::{Branch, Point, SpecialPoint};
use std::ops::ControlFlow;

/// Sees a branch while it is traced: to print, to show progress, to interrupt.
pub trait Observer {
    /// A branch begins; its names are known, its points are not.
    fn begin(&mut self, _branch: &Branch) {}

    /// A point was reached, the start first. `Break` ends the trace; what there is of the branch is kept.
    fn point(&mut self, _point: &Point) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// A special point was found. Labels are final only when the branch is complete.
    fn special(&mut self, _branch: &Branch, _special: &SpecialPoint) {}
}

/// An observer that sees nothing.
impl Observer for () {}
