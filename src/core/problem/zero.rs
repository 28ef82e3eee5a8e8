//! Zero problems as a user states them: `F(z, p) = 0`.
//!
//! A **[`ZeroProblem`]** is a residual generic over [`Scalar`], with named unknowns `z ∈ ℝⁿ` and
//! parameters `p ∈ ℝᵐ`. Nothing in it differentiates.

use super::names::{Group, Names};
use crate::core::failure::OutOfDomain;
use crate::core::scalar::Scalar;

/// What the residual says about motion near an equilibrium, which decides what "stable" means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Dynamics {
    /// `z' = F(z, p)`: stable where every eigenvalue of `F_z` has a negative real part.
    #[default]
    Flow,
    /// `F = ∇Π`, the gradient of a potential: stable where the Hessian `F_z` is positive definite.
    Potential,
    /// `M(z) z'' = −F(z, p)` with a mass near a positive definite matrix that makes `F` nearly the
    /// gradient of a potential: stable where every eigenvalue of `F_z` has a positive real part.
    SecondOrder,
    /// The unknowns are a periodic orbit: stable where every multiplier, but for the trivial one,
    /// lies inside the unit circle.
    Periodic,
    /// No motion is meant: stability is not reported.
    None,
}

/// A zero problem as a user states it: `F(z, p) = 0`, stated once, differentiated nowhere.
/// [`zero_problem!`](crate::zero_problem) states one by formulas of its unknowns.
///
/// ```
/// use tangency::core::problem::{Names, ZeroProblem};
/// use tangency::core::scalar::Scalar;
/// /// Parallel-plate actuator: pulls in at u = 1/3, load = 4/27.
/// struct ParallelPlate;
/// impl ZeroProblem for ParallelPlate {
///     fn names(&self) -> Names {
///         Names::new(["u"], ["load"])
///     }
///     fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
///         r[0] = p[0] / (T::one() - u[0]).powi(2) - u[0];
///     }
/// }
/// let mut r = [0.0_f64];
/// ParallelPlate.residual(&[1.0 / 3.0], &[4.0 / 27.0], &mut r);
/// assert!(r[0].abs() < 1e-16);
/// ```
pub trait ZeroProblem: Send + Sync {
    /// The names of unknowns, parameters and monitors; their number is the problem's size.
    fn names(&self) -> Names;

    /// The default values of all parameters, in order; empty if there are none.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The residual `F(z, p)`, written into `r` (as long as `z`).
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]);

    /// The monitors, written into `values` in the order of [`Names::monitors`].
    fn monitors<T: Scalar>(&self, _z: &[T], _p: &[T], _values: &mut [T]) {}

    /// Typical sizes of the groups of unknowns, in their order: to be stated where unknowns may be
    /// zero and their sizes are far from those of the others. By default they are found at the
    /// start of a branch.
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Refuses values at which the equations have no meaning.
    ///
    /// # Errors
    /// [`OutOfDomain`] with the quantity, its value and the domain. A residual that is not finite
    /// is refused in any case.
    fn domain(&self, _z: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }

    /// What the residual says about motion near an equilibrium.
    fn dynamics(&self) -> Dynamics {
        Dynamics::Flow
    }

    /// Curves that are kept with special points and drawn for them.
    fn profiles(&self, _z: &[f64], _p: &[f64]) -> Vec<Profile> {
        Vec::new()
    }
}

/// A curve that belongs to a solution and is drawn for special points: a mode shape along a line, a
/// field, a time history.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// What it shows, for example `mode shape`.
    pub name: String,
    /// The name of its abscissa, for example `x/a`.
    pub along: String,
    /// Points (abscissa, ordinate).
    pub points: Vec<[f64; 2]>,
}

/// (H) Arrays with fewer components are read as a list.
const LEAST: usize = 8;

impl Profile {
    /// The abscissa of arrays of unknowns.
    pub const INDEX: &'static str = "index";
    /// What the names of phase responses begin with, before the name of the state that is kicked.
    pub const PHASE_RESPONSE: &'static str = "phase_response_";

    /// The state that is kicked, of a phase response.
    ///
    /// ```
    /// use tangency::core::problem::Profile;
    /// let (name, along) = ("phase_response_v".into(), "time".into());
    /// assert_eq!(Profile { name, along, points: Vec::new() }.kicked(), Some("v"));
    /// ```
    pub fn kicked(&self) -> Option<&str> {
        self.name.strip_prefix(Self::PHASE_RESPONSE)
    }

    /// The arrays of one index among some unknowns over their index, and groups of several
    /// components without indices over their position, from 1: what a discretised field looks like. Of
    /// more than a thousand components every second, third, … is kept.
    ///
    /// ```
    /// use tangency::core::problem::{Group, Profile};
    /// let groups = [Group::from("c"), Group::from(("u", 9))];
    /// let z = [2.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.4, 0.3, 0.2, 0.1];
    /// let profiles = Profile::of_arrays(&groups, &z);
    /// assert_eq!((profiles.len(), profiles[0].name.as_str()), (1, "u"));
    /// assert_eq!(profiles[0].points[..2], [[1.0, 0.1], [2.0, 0.2]]);
    /// ```
    pub fn of_arrays(groups: &[Group], mut z: &[f64]) -> Vec<Profile> {
        let mut profiles = Vec::new();
        for group in groups {
            let (values, rest) = z.split_at(group.length.min(z.len()));
            z = rest;
            let first = match group.indices[..] {
                [] => 1,
                [[first, _]] if group.count() == values.len() => first,
                _ => continue,
            };
            if values.len() >= LEAST {
                let at = |k: usize| [(first + k as i64) as f64, values[k]];
                let points = thinned(values.len(), MOST).map(at).collect();
                profiles.push(Profile {
                    name: group.name.clone(),
                    along: Self::INDEX.into(),
                    points,
                });
            }
        }
        profiles
    }
}

/// An array of two indices that belongs to a solution, and is drawn as a map for special points.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneField {
    /// The name of the array.
    pub name: String,
    /// The values of the first and of the second index that are kept.
    pub along: [Vec<i64>; 2],
    /// The values there: the second index changes first.
    pub values: Vec<f64>,
}

impl PlaneField {
    /// The arrays of two indices among some unknowns. Of more than 64 values of an index every
    /// second, third, … is kept, and the last.
    ///
    /// ```
    /// use tangency::core::problem::{Group, PlaneField};
    /// let u = Group { indices: vec![[0, 1], [1, 3]], ..Group::new("u", 6) };
    /// let fields = PlaneField::of_arrays(&[u], &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
    /// assert_eq!(fields[0].along, [vec![0, 1], vec![1, 2, 3]]);
    /// assert_eq!(fields[0].values[3], 0.4);
    /// ```
    pub fn of_arrays(groups: &[Group], mut z: &[f64]) -> Vec<PlaneField> {
        let mut fields = Vec::new();
        for group in groups {
            let (values, rest) = z.split_at(group.length.min(z.len()));
            z = rest;
            let [first @ [low, high], second @ [left, right]] = group.indices[..] else { continue };
            if group.count() != values.len() {
                continue;
            }
            let kept = [(high - low) as usize + 1, (right - left) as usize + 1]
                .map(|count| thinned(count, MOST_IN_PLANE));
            let width = (right - left) as usize + 1;
            let [rows, columns] = kept.clone();
            let at = |i: usize| columns.clone().map(move |j| values[i * width + j]);
            let values = rows.flat_map(at).collect();
            let [rows, columns] = kept;
            let along = [
                rows.map(|i| first[0] + i as i64).collect(),
                columns.map(|j| second[0] + j as i64).collect(),
            ];
            fields.push(PlaneField { name: group.name.clone(), along, values });
        }
        fields
    }
}

/// (H) A field keeps no more values of an index than this.
const MOST_IN_PLANE: usize = 64;

/// (H) A profile of an array keeps no more components than this.
const MOST: usize = 1000;

/// At most `most` of `count` positions: the first, others at equal distances, and the last.
fn thinned(count: usize, most: usize) -> impl Iterator<Item = usize> + Clone {
    let step = count.saturating_sub(1).div_ceil(most.max(2) - 1).max(1);
    let last = (count > 0 && !(count - 1).is_multiple_of(step)).then(|| count - 1);
    (0..count).step_by(step).chain(last)
}
