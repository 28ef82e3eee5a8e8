//! Stretches of a curve in two parameters between special points, with the solutions on the two
//! sides.

use serde::{Deserialize, Serialize};

/// A stretch of a curve of bifurcations in two parameters, with the solutions near it.
///
/// Left and right refer to the direction from the first point of the branch to the last one, with
/// the first released parameter to the right and the second one upwards. A solution that meets
/// others on the curve is represented by its number of unstable directions: `[0, 1]` and `[]` next
/// to a fold, `[0]` and `[2]` next to a Hopf point.
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
    /// The positions of the first and the last point of the stretch among the points of the branch.
    pub points: [usize; 2],
    /// The numbers of unstable directions of the solutions on the left, in increasing order.
    pub left: Vec<usize>,
    /// The numbers of unstable directions of the solutions on the right, in increasing order.
    pub right: Vec<usize>,
}

impl Stretch {
    /// Reverses the direction of the branch.
    pub(super) fn reversed(self) -> Self {
        let Stretch { points: [first, last], left, right } = self;
        Stretch { points: [last, first], left: right, right: left }
    }
}
