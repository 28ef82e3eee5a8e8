//! Stable and unstable manifolds as data, and the settings of their computation.

use super::curve::{Curve, Side};
use super::error::ManifoldError;
use super::growth::{Growth, Limits, Node};
use super::invariance::deviation;
use super::local::Local;
use super::planar::{PlanarMap, Scaled, Vector};
use super::saddle::{corrected, multipliers, require_inverse};
use crate::core::cancel::CancelToken;
use crate::core::continuation::End;
use crate::core::problem::DiscreteMap;
use std::sync::Arc;

/// Settings of the growth of manifolds. Lengths are in units of the states' scales
/// ([`DiscreteMap::scales`]); the default scales are 1.
#[derive(Clone, Debug)]
pub struct ManifoldSettings {
    /// The longest arclength of each half, above 0.
    pub length: f64,
    /// The maximal number of points of each half, at least 3.
    pub max_points: usize,
    /// The resolution: the largest distance between the curve and the chord between two successive
    /// points, above 0. Bends of the curve that are sharper than the resolution are cut off.
    pub resolution: f64,
    /// The smallest and the largest allowed value of each state, in the units of the states.
    pub bounds: [[f64; 2]; 2],
    /// The token that cancels the growth; after a cancellation, the curves end at the last computed
    /// point.
    pub cancel: CancelToken,
}

impl Default for ManifoldSettings {
    fn default() -> Self {
        ManifoldSettings {
            length: 20.0,
            max_points: 20_000,
            resolution: 1e-4,
            bounds: [[f64::NEG_INFINITY, f64::INFINITY]; 2],
            cancel: CancelToken::default(),
        }
    }
}

/// One manifold at one point of a saddle cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifold {
    /// The kind of manifold: stable or unstable.
    pub side: Side,
    /// The point of the saddle cycle.
    pub saddle: [f64; 2],
    /// The multiplier of the cycle along this manifold.
    pub multiplier: f64,
    /// The multiplier of the cycle along the manifold of the other kind.
    pub other: f64,
    /// The number of iterates of the map that map each half onto itself: the number of iterates of
    /// the cycle, or twice this number if the multiplier is negative.
    pub iterates: usize,
    /// The error of the local manifold: the largest distance between `g(W(s))` and `W(λ s)`, in units
    /// of the states' scales.
    pub local_error: f64,
    /// Both halves of the manifold; along the first half, the first state decreases near the
    /// saddle.
    pub halves: [Half; 2],
}

/// One half of a manifold, from the saddle (which is not one of its points) to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Half {
    /// The points.
    pub points: Vec<ManifoldPoint>,
    /// The reason why the half of the manifold ends.
    pub end: End,
    /// The largest distance between the images of the points and the piecewise cubic curve through
    /// the points, in units of the states' scales; `None` if the half is too short to contain an
    /// image.
    pub deviation: Option<f64>,
}

/// A point of a manifold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ManifoldPoint {
    /// The states.
    pub at: [f64; 2],
    /// The arclength of the curve from the saddle to the point, in units of the states' scales.
    pub arclength: f64,
}

impl Half {
    /// Returns the arclength of the half.
    pub fn length(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.arclength)
    }
}

/// Computes one of the two manifolds of a saddle cycle of a map in the plane, at each point of the
/// cycle. The states of the cycle are given iterate by iterate, and are first corrected by Newton's
/// method.
///
/// ```
/// use std::sync::Arc;
/// use tangency::core::manifold::{ManifoldSettings, Side, manifold};
/// use tangency::core::problem::{DiscreteMap, Names};
/// use tangency::core::scalar::Scalar;
/// /// `x ↦ 2x`, `y ↦ (y − x²)/2 + 4x²`: the parabola `y = x²` is the unstable manifold of 0.
/// struct Parabola;
/// impl DiscreteMap for Parabola {
///     fn names(&self) -> Names {
///         Names::new(["x", "y"], Vec::<String>::new())
///     }
///     fn next<T: Scalar>(&self, x: &[T], _p: &[T], next: &mut [T]) {
///         next[0] = x[0] * 2.0;
///         next[1] = (x[1] - x[0] * x[0]) * 0.5 + x[0] * x[0] * 4.0;
///     }
/// }
/// let settings = ManifoldSettings { length: 5.0, ..ManifoldSettings::default() };
/// let [curve] = &manifold(&Arc::new(Parabola), &[0.0, 0.0], &[], Side::Unstable, &settings)?[..] else {
///     panic!("one curve for a fixed point")
/// };
/// assert!((curve.multiplier - 2.0).abs() < 1e-14);
/// for half in &curve.halves {
///     assert!((half.length() - 5.0).abs() < 1e-9 && half.deviation.is_some_and(|d| d < 1e-4));
///     assert!(half.points.iter().all(|point| (point.at[1] - point.at[0].powi(2)).abs() < 1e-13));
/// }
/// # Ok::<(), tangency::core::manifold::ManifoldError>(())
/// ```
///
/// # Errors
/// [`ManifoldError`] if the map does not have two states, if Newton's method does not converge to a
/// cycle, if the cycle is not a saddle, if a multiplier is too close to the unit circle, or, for a
/// stable manifold, if its multiplier is zero.
pub fn manifold<M: DiscreteMap + 'static>(
    map: &Arc<M>,
    states: &[f64],
    p: &[f64],
    side: Side,
    settings: &ManifoldSettings,
) -> Result<Vec<Manifold>, ManifoldError> {
    let names = map.names();
    let states_of = names.elements().collect::<Vec<_>>();
    let [x, y] = &states_of[..] else {
        return Err(ManifoldError::NotPlanar { states: names.dimension() });
    };
    if states.is_empty() || !states.len().is_multiple_of(2) {
        return Err(ManifoldError::States { found: states.len() });
    }
    settings.check()?;
    let scales: Vector = map.scales(p).try_into().unwrap_or([1.0; 2]);
    let in_scales = |at: Vector| [at[0] / scales[0], at[1] / scales[1]];
    let cycle: Vec<Vector> =
        corrected(map, states, p, scales)?.into_iter().map(in_scales).collect();
    let limits = settings.limits([x.clone(), y.clone()], scales);
    let scaled = Scaled::new(&**map, p, scales);
    let both = multipliers(&scaled, &cycle)?;
    if side == Side::Stable {
        require_inverse(both)?;
    }
    (0..cycle.len())
        .map(|k| {
            settings.cancel.check()?;
            let turned = [&cycle[k..], &cycle[..k]].concat();
            grown(&scaled, &turned, both, side, &limits)
        })
        .collect()
}

/// Computes the manifold at the first point of a cycle.
fn grown(
    map: &dyn PlanarMap,
    cycle: &[Vector],
    multipliers: Vector,
    side: Side,
    limits: &Limits,
) -> Result<Manifold, ManifoldError> {
    let in_units = |at: Vector| [0, 1].map(|i| at[i] * limits.scales[i]);
    if let Some(axis) = limits.outside(cycle[0]) {
        let (name, value) = (limits.names[axis].clone(), in_units(cycle[0])[axis]);
        return Err(ManifoldError::OutOfBounds { name, value });
    }
    let [multiplier, other] = match side {
        Side::Unstable => multipliers,
        Side::Stable => [multipliers[1], multipliers[0]],
    };
    let local = Local::new(map, cycle, multiplier, limits.length)?;
    let times = if multiplier < 0.0 { 2 } else { 1 };
    let iterates = times * cycle.len();
    let rate = times as f64 * multiplier.abs().ln().abs();
    let half = |sign: f64| {
        let curve = Curve { map, local: &local, side, sign, iterates, rate };
        let (nodes, end) = match Growth::new(&curve, limits) {
            Ok(growth) => growth.run(),
            Err(lost) => {
                let cause = lost.in_units(limits.scales).to_string();
                (Vec::new(), End::StepTooSmall { step: limits.resolution, cause, failure: None })
            }
        };
        let deviation = deviation(&curve, &nodes);
        let point =
            |node: &Node| ManifoldPoint { at: in_units(node.at), arclength: node.arclength };
        Half { points: nodes.iter().map(point).collect(), end, deviation }
    };
    let halves = [half(-1.0), half(1.0)];
    let (saddle, local_error) = (in_units(cycle[0]), local.error);
    Ok(Manifold { side, saddle, multiplier, other, iterates, local_error, halves })
}

impl ManifoldSettings {
    /// Rejects invalid settings.
    fn check(&self) -> Result<(), ManifoldError> {
        let positive = [("length", self.length), ("resolution", self.resolution)];
        let rule = "the value of the setting must be finite and above 0";
        for (name, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ManifoldError::Setting { name, value, rule });
            }
        }
        if self.max_points < 3 {
            let (name, value) = ("max_points", self.max_points as f64);
            return Err(ManifoldError::Setting {
                name,
                value,
                rule: "the value of the setting must be at least 3",
            });
        }
        Ok(())
    }

    fn limits(&self, names: [String; 2], scales: Vector) -> Limits {
        Limits {
            length: self.length,
            points: self.max_points,
            resolution: self.resolution,
            bounds: [0, 1].map(|i| self.bounds[i].map(|end| end / scales[i])),
            names,
            scales,
            cancel: self.cancel.clone(),
        }
    }
}
