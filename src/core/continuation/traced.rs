//! What comes next along a branch.

use super::{Point, SpecialPoint};

/// What comes next along a branch that is traced.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Traced {
    /// A point was reached, the start first.
    Point(Point),
    /// A special point was found, before the next point.
    Special(Box<SpecialPoint>),
}
