//! Labels of the regions beside a bifurcation curve in two parameters: the numbers of unstable
//! directions on the two sides of the curve.

use crate::core::continuation::{Branch, Stretch};

/// The labels on both sides of a stretch of a curve in the plane of two columns.
pub(super) struct Region {
    /// The indices, on the branch, of the first and the last point of the stretch.
    pub points: [usize; 2],
    /// The texts on the left and on the right of the curve, as seen in the direction from the first
    /// point to the last.
    pub sides: [String; 2],
}

/// The explanation, in the legend, of the texts on the sides of curves.
pub(super) const MEANING: &str = "(n)\u{2002}unstable directions, (0+1) of two solutions, (–) none";

/// Returns the labelled stretches of a bifurcation curve, if the two axes show the two parameters
/// of the curve.
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

/// Returns the text for one side of a curve, such as `(0+1)`: the numbers of unstable directions of
/// the solutions on this side.
fn text(counts: &[usize]) -> String {
    if counts.is_empty() {
        return "(–)".into();
    }
    let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
    format!("({})", counts.join("+"))
}
