//! Labels of regions: the numbers of unstable directions on the two sides of curves in two
//! parameters.

use crate::core::continuation::{Branch, Stretch};

/// The labels of a stretch of a curve in two columns.
pub(super) struct Region {
    /// The positions of the first and the last point on the branch.
    pub points: [usize; 2],
    /// The texts on the left and on the right, in the direction from the first point to the last.
    pub sides: [String; 2],
}

/// The meaning of the texts.
pub(super) const MEANING: &str = "(n)\u{2002}unstable directions, (0+1) of two solutions, (–) none";

/// Returns the regions of a curve, if the columns of both axes are its two parameters.
pub(super) fn regions(branch: &Branch, columns: [usize; 2]) -> Vec<Region> {
    let released: Vec<Option<usize>> =
        branch.released.iter().map(|name| branch.column(name)).collect();
    let [first, second] = columns.map(Some);
    let mirrored = released == [second, first];
    if branch.condition.is_none() || !(mirrored || released == [first, second]) {
        return Vec::new();
    }
    let region = |stretch: &Stretch| {
        let mut sides = [&stretch.left, &stretch.right].map(|counts| text(counts));
        if mirrored {
            sides.reverse();
        }
        Region { points: stretch.points, sides }
    };
    branch.stretches.iter().map(region).collect()
}

/// Returns the numbers of unstable directions of the solutions on one side, such as `(0+1)`.
fn text(counts: &[usize]) -> String {
    if counts.is_empty() {
        return "(–)".into();
    }
    let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
    format!("({})", counts.join("+"))
}
