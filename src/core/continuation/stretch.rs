//! Stretches of a curve of bifurcations in two parameters: parts between special points, with the
//! solutions on the two sides of the curve.

use serde::{Deserialize, Serialize};

/// A stretch (part between special points) of a curve of bifurcations in two parameters, with the
/// solutions near the curve.
///
/// Left and right refer to the direction of the curve from its first point to its last point, in a
/// plot with the first released parameter on the horizontal axis and the second on the vertical
/// axis. Each solution that undergoes the bifurcation is represented by its number of unstable
/// directions. Examples are `[0, 1]` and `[]` on the two sides of a curve of folds, and `[0]` and
/// `[2]` on the two sides of a curve of Hopf points.
///
/// ```
/// use tangency::core::continuation::Continuation;
/// use tangency::core::system::{Dense, Kind};
/// use tangency::prelude::*;
/// zero_problem! {
///     struct Saddle [x; mu, nu] { 0 = mu + nu - x.powi(2); }
/// }
/// let mut system = Dense::new(Saddle);
/// let start = Continuation::new(&mut system).from(&[0.5]).at("mu", 0.25);
/// let branch = start.along("mu", -1.0..=1.0).trace()?;
/// let fold = branch.of_kind(Kind::LP).next().ok_or("no fold")?.label;
/// let curve = Continuation::new(&mut system).restart(&branch, fold).hold(Kind::LP);
/// let curve = curve.along("mu", -1.0..=1.0).along("nu", -1.0..=1.0).trace()?;
/// // Two equilibria above the line ν = −μ, one of them stable, and none below.
/// let [stretch] = &curve.stretches[..] else { panic!("{:?}", curve.stretches) };
/// let [first, last] = stretch.points.map(|k| curve.points[k].parameters[0]);
/// let above = if first < last { &stretch.left } else { &stretch.right };
/// assert_eq!((above, stretch.left.len() + stretch.right.len()), (&vec![0, 1], 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stretch {
    /// The indices of the first and the last point of the stretch (part of a curve between special
    /// points) among the points of the branch.
    pub points: [usize; 2],
    /// The numbers of unstable directions of the solutions on the left of the curve, in increasing
    /// order.
    pub left: Vec<usize>,
    /// The numbers of unstable directions of the solutions on the right of the curve, in increasing
    /// order.
    pub right: Vec<usize>,
}

impl Stretch {
    /// Returns the stretch (part of a curve between special points) for the reversed direction of
    /// the branch.
    pub(super) fn reversed(self) -> Self {
        let Stretch { points: [first, last], left, right } = self;
        Stretch { points: [last, first], left: right, right: left }
    }
}
