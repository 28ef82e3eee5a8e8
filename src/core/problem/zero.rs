//! Zero problems `F(z, p) = 0` as users define them.
//!
//! A **[`ZeroProblem`]** is a residual generic over [`Scalar`], with named unknowns `z ∈ ℝⁿ` and
//! parameters `p ∈ ℝᵐ`. Derivatives of the residual come from automatic differentiation.

use super::names::{Group, Names};
use crate::core::failure::OutOfDomain;
use crate::core::scalar::Scalar;

/// The dynamics that the residual represents near an equilibrium; they determine the criterion of
/// stability.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Dynamics {
    /// The flow `z' = F(z, p)`: an equilibrium is stable if every eigenvalue of `F_z` has a
    /// negative real part.
    #[default]
    Flow,
    /// The flow `M(z, p) z' = F(z, p)`, whose mass matrix `M` is given by
    /// [`ZeroProblem::mass_product`] and can be singular: an equilibrium is stable if every finite
    /// eigenvalue `λ` of `F_z v = λ M v` has a negative real part. Infinite eigenvalues, which
    /// belong to algebraic equations, are left out.
    Implicit,
    /// The gradient of a potential, `F = ∇Π`: an equilibrium is stable if the Hessian `F_z` is
    /// positive definite.
    Potential,
    /// The second-order dynamics `M(z) z'' = −F(z, p)`, where `M` is close to a positive definite
    /// matrix for which `F` is nearly the gradient of a potential: an equilibrium is stable if
    /// every eigenvalue of `F_z` has a positive real part.
    SecondOrder,
    /// The unknowns represent a periodic orbit, which is stable if every Floquet multiplier except
    /// the trivial one lies inside the unit circle.
    Periodic,
    /// The residual does not represent any dynamics, so that stability is not reported.
    None,
}

impl Dynamics {
    /// Whether the residual contains the rates of a flow, with or without a mass matrix.
    ///
    /// ```
    /// use tangency::core::problem::Dynamics;
    /// assert!(Dynamics::Flow.is_flow() && Dynamics::Implicit.is_flow());
    /// assert!(!Dynamics::Potential.is_flow());
    /// ```
    pub fn is_flow(self) -> bool {
        matches!(self, Dynamics::Flow | Dynamics::Implicit)
    }
}

/// A zero problem `F(z, p) = 0` as users define it, written once for all scalar types; derivatives
/// come from automatic differentiation. [`zero_problem!`](crate::zero_problem) defines a zero
/// problem by formulas.
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
    /// Returns the names of the unknowns, parameters and monitors; the number of unknowns is the
    /// dimension.
    fn names(&self) -> Names;

    /// Returns the default values of all parameters, in order; an empty list if the problem has no
    /// default values.
    fn defaults(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Computes the residual `F(z, p)` and writes it into `r`, which has the same length as `z`.
    fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]);

    /// Computes the monitors and writes them into `values`, in the order of [`Names::monitors`].
    fn monitors<T: Scalar>(&self, _z: &[T], _p: &[T], _values: &mut [T]) {}

    /// Returns the typical sizes of the groups of unknowns, in the order of the groups; the sizes
    /// must be given if unknowns can be zero and the sizes of the groups differ strongly. By
    /// default the sizes of the unknowns are determined at the start of a branch.
    fn scales(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Returns an error for unknowns and parameters outside the domain of the equations.
    ///
    /// # Errors
    /// [`OutOfDomain`] with the name of the quantity, its value and the domain. A residual that is
    /// not finite always counts as outside the domain.
    fn domain(&self, _z: &[f64], _p: &[f64]) -> Result<(), OutOfDomain> {
        Ok(())
    }

    /// Returns the dynamics that the residual represents near an equilibrium.
    fn dynamics(&self) -> Dynamics {
        Dynamics::Flow
    }

    /// Computes the products `M(z, p) z'` of the mass matrix with the rates `z'` and writes them
    /// into `products`, for [`Dynamics::Implicit`]. The products must be linear in the rates. An
    /// algebraic equation has the product 0. By default, `M` is the identity matrix.
    ///
    /// ```
    /// use tangency::prelude::*;
    /// use tangency::core::problem::Dynamics;
    /// use tangency::core::scalar::Scalar;
    /// /// `2 x' = a x − y − x³`, `y' + x' = x`, `0 = s − x − y`.
    /// struct Circuit;
    /// impl ZeroProblem for Circuit {
    ///     fn names(&self) -> Names {
    ///         Names::new(["x", "y", "s"], ["a"])
    ///     }
    ///     fn residual<T: Scalar>(&self, z: &[T], p: &[T], r: &mut [T]) {
    ///         let [x, y, s] = *z else { return };
    ///         r.copy_from_slice(&[p[0] * x - y - x.powi(3), x, s - x - y]);
    ///     }
    ///     fn dynamics(&self) -> Dynamics {
    ///         Dynamics::Implicit
    ///     }
    ///     fn mass_product<T: Scalar>(&self, _z: &[T], _p: &[T], rates: &[T], products: &mut [T]) {
    ///         products.copy_from_slice(&[rates[0] * 2.0, rates[1] + rates[0], T::zero()]);
    ///     }
    /// }
    /// // The eigenvalues of `2 λ² − (a + 1) λ + 1 = 0` are ±i/√2 at a = −1.
    /// let mut circuit = Dense::new(Circuit);
    /// let start = Continuation::new(&mut circuit).from(&[0.0; 3]).at("a", -2.0);
    /// let branch = start.along("a", -2.0..=0.0).trace()?;
    /// let hopf = branch.of_kind(Kind::HB).next().expect("a Hopf point");
    /// assert!((hopf.parameters[0] + 1.0).abs() < 1e-12);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    fn mass_product<T: Scalar>(&self, _z: &[T], _p: &[T], rates: &[T], products: &mut [T]) {
        products.copy_from_slice(rates);
    }

    /// Returns the curves that are stored with special points and drawn for them.
    fn profiles(&self, _z: &[f64], _p: &[f64]) -> Vec<Profile> {
        Vec::new()
    }
}

/// A curve that belongs to a solution and is drawn for special points, such as a mode shape along a
/// line, a discretised field, or a time history.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// The name of the curve, for example `mode shape`.
    pub name: String,
    /// The name of the abscissa, for example `x/a`.
    pub along: String,
    /// Points (abscissa, ordinate).
    pub points: Vec<[f64; 2]>,
}

/// Heuristic: the least number of components of an array that is drawn; shorter arrays are listed.
const LEAST: usize = 8;

impl Profile {
    /// The name of the abscissa for arrays of unknowns, which are drawn over their index.
    pub const INDEX: &'static str = "index";
    /// The prefix of the names of phase responses, which precedes the name of the perturbed state.
    pub const PHASE_RESPONSE: &'static str = "phase_response_";

    /// Returns the name of the perturbed state if the curve is a phase response.
    ///
    /// ```
    /// use tangency::core::problem::Profile;
    /// let (name, along) = ("phase_response_v".into(), "time".into());
    /// assert_eq!(Profile { name, along, points: Vec::new() }.kicked(), Some("v"));
    /// ```
    pub fn kicked(&self) -> Option<&str> {
        self.name.strip_prefix(Self::PHASE_RESPONSE)
    }

    /// Returns the curves of discretised fields: an array with one index is drawn over this index,
    /// and a group of several components without indices is drawn over the position of the
    /// component, counted from 1. If a curve has more than a thousand components, only every
    /// second, third, … component is kept.
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

/// An array with two indices that belongs to a solution, and is drawn as a map for special points.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneField {
    /// The name of the array.
    pub name: String,
    /// The stored values of the first index and of the second index.
    pub along: [Vec<i64>; 2],
    /// The stored values of the array; the second index varies fastest.
    pub values: Vec<f64>,
}

impl PlaneField {
    /// Returns the arrays with two indices among the given groups of unknowns. If an index has more
    /// than 64 values, only every second, third, … value and the last value are kept.
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

/// Heuristic: the largest number of values of an index that a field stores.
const MOST_IN_PLANE: usize = 64;

/// Heuristic: the largest number of components that a profile of an array stores.
const MOST: usize = 1000;

/// Selects at most `most` of `count` positions: the first and the last position, and positions at
/// equal distances between them.
fn thinned(count: usize, most: usize) -> impl Iterator<Item = usize> + Clone {
    let step = count.saturating_sub(1).div_ceil(most.max(2) - 1).max(1);
    let last = (count > 0 && !(count - 1).is_multiple_of(step)).then(|| count - 1);
    (0..count).step_by(step).chain(last)
}
