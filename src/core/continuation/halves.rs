//! The two halves of a branch, from its start outward.

use super::{Branch, End, Kind, Point, SpecialPoint};

/// One of the two halves of a branch. `after` of its special points counts points from the start, which is 0.
pub(super) struct Half {
    pub points: Vec<Point>,
    pub special: Vec<SpecialPoint>,
    pub end: End,
}

impl Half {
    /// Joins this half, the start and the half ahead into one list from end to end.
    pub fn join(mut self, start: Point, ahead: Half, branch: Branch) -> Branch {
        let before = self.points.len();
        self.points.reverse();
        self.special.reverse();
        for special in &mut self.special {
            // Behind point k from the start means before it from the end; an end stays on its point.
            let on_point = special.after == before || special.kind == Kind::RG;
            special.after = before - special.after - usize::from(!on_point);
            special.bracket.reverse();
            special.tangent.iter_mut().for_each(|t| *t = -*t);
        }
        let further = ahead
            .special
            .into_iter()
            .map(|special| SpecialPoint { after: special.after + before, ..special });
        Branch {
            points: self.points.into_iter().chain([start]).chain(ahead.points).collect(),
            special: self.special.into_iter().chain(further).collect(),
            ends: [self.end, ahead.end],
            ..branch
        }
    }
}
