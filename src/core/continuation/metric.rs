//! The scaled norm that defines arclength.

use super::newton::{scale_to_one, scaled_norm};
use crate::core::linalg::{difference, norm};
use crate::core::problem::{Group, Names};

/// The scales that make arclength dimensionless: `‖ΔX‖² = Σ_g (‖Δz_g‖/s_g)² + Σ (Δp/s_p)²`.
///
/// `s_g` is the largest Euclidean norm of the group `g` of unknowns on the branch so far; `s_p` is
/// the length of the range of the parameter `p`. If a group of unknowns is zero at the start, its
/// scale is its change along the tangent when the parameter changes by the length of its range; if
/// the tangent is vertical, the scale of the group is its change over the distance
/// [`StartSizes::reach`] along the tangent. If a parameter has no finite range, its scale is
/// initially its change along the tangent when the unknowns change by their size, and later the
/// distance that the parameter has covered. If a group of unknowns is zero at the start and does
/// not change along the tangent, its scale is computed from the tangent a small step further along
/// the range of the parameter. If the group does not change there either, its scale is its unit or,
/// without a unit, the scale of the largest other group. Hence the computed points do not depend on
/// units, unless a group of unknowns is zero at all points of the tangent at the start. If a group
/// of unknowns that is zero at the start has an unusual size, set its scale
/// ([`Continuation::scale`](super::builder::Continuation::scale)).
///
/// ```
/// use tangency::core::continuation::{Metric, StartSizes};
/// use tangency::core::problem::Names;
/// let names = Names::new([("u", 2), ("v", 1)], ["p"]);
/// // u = (3, 4) has the scale 5; v = 0 its slope times the range of p; p its range.
/// let start = StartSizes {
///     z: &[3.0, 4.0, 0.0],
///     z_tangent: &[0.0, 0.0, 2.0],
///     p: &[0.0],
///     p_tangent: &[1.0],
///     ..StartSizes::default()
/// };
/// let metric = Metric::new(&names, &start, &[[0.0, 10.0]], &[]);
/// assert_eq!(metric.weights(&names), [1.0 / 25.0, 1.0 / 25.0, 1.0 / 400.0, 1.0 / 100.0]);
/// ```
#[derive(Clone, Debug)]
pub struct Metric {
    groups: Vec<f64>,
    /// For each group of unknowns, whether the user has set its scale; such a scale is constant.
    fixed: Vec<bool>,
    /// For each group of unknowns, whether the start of the branch gives no information about the
    /// size of the group.
    unknown: Vec<bool>,
    parameters: Vec<f64>,
    /// For each parameter with an infinite range and no given scale, its value at the start of the
    /// branch; the scale of such a parameter grows along the branch. The entry is `None` for the
    /// other parameters.
    open: Vec<Option<f64>>,
    own: Vec<f64>,
}

/// A point of a branch with its tangent, from which scales are computed.
#[derive(Clone, Copy, Debug, Default)]
pub struct StartSizes<'a> {
    /// The unknowns.
    pub z: &'a [f64],
    /// The derivatives of the unknowns along the tangent.
    pub z_tangent: &'a [f64],
    /// The released parameters.
    pub p: &'a [f64],
    /// The derivatives of the released parameters along the tangent.
    pub p_tangent: &'a [f64],
    /// The distance along a branch with a vertical tangent at which the parameter has changed by
    /// the length of its range, or at which nonlinear terms become significant; `None` if unknown.
    pub reach: Option<f64>,
    /// The typical sizes of the groups of unknowns; empty if unknown.
    pub units: &'a [f64],
}

impl StartSizes<'_> {
    /// Returns the norms of the groups of unknowns and of their derivatives, in units of the
    /// typical sizes of the groups.
    fn groups(&self, names: &Names) -> [Vec<f64>; 2] {
        [self.z, self.z_tangent].map(|v| {
            let mut sizes = group_norms(names, v);
            sizes.iter_mut().zip(self.units).for_each(|(size, unit)| *size /= unit);
            sizes
        })
    }
}

impl Metric {
    /// Computes the scales at the start of a branch, with the ranges of the released parameters.
    /// `own` contains the sizes of the auxiliary unknowns; an unknown without a weight has the size
    /// `None`.
    pub fn new(
        names: &Names,
        start: &StartSizes,
        ranges: &[[f64; 2]],
        own: &[Option<f64>],
    ) -> Self {
        let StartSizes { p, p_tangent, units, .. } = *start;
        let [sizes, slopes] = start.groups(names);
        let steepest = least_ratio(&sizes, &slopes, |size, slope| size > 0.0 && slope > 0.0);
        let by_range = |(([low, high], slope), p): ((&[f64; 2], &f64), &f64)| match high - low {
            range if range.is_finite() => range,
            _ => {
                Some(steepest * slope.abs()).filter(|scale| *scale > STILL * p.abs()).unwrap_or(0.0)
            }
        };
        let parameters = ranges.iter().zip(p_tangent).zip(p);
        let mut parameters: Vec<f64> = parameters.map(by_range).collect();
        // The distance along the tangent over the first known range, unless the tangent is vertical
        // there.
        let steepness = steepness(&sizes, &slopes);
        let mut reaches =
            parameters.iter().zip(p_tangent).map(|(scale, slope)| scale / slope.abs());
        let known = |reach: &f64| is_scale(*reach) && VERTICAL * steepness * reach < 1.0;
        let by_range = reaches.find(known).filter(|reach| !is_near_fold(&sizes, &slopes, *reach));
        let reach = by_range.or(start.reach);
        let nothing = match (units.is_empty(), p.len()) {
            (true, _) => 0.0,
            (false, 1) => NOTHING,
            (false, _) => NOTHING_ON_CURVES,
        };
        let found = group_scales(&sizes, &slopes, reach, nothing);
        let unknown = found.iter().map(|scale| scale.is_none() && units.is_empty()).collect();
        let mut groups = with_fallback(&found, !units.is_empty());
        groups.iter_mut().zip(units).for_each(|(scale, unit)| *scale *= unit);
        let raw: Vec<f64> = group_norms(names, start.z_tangent);
        let fallback = least_ratio(&groups, &raw, |_, slope| slope > 0.0);
        for ((scale, slope), p) in parameters.iter_mut().zip(p_tangent).zip(p) {
            if !is_scale(*scale) {
                let scaled = fallback * slope.abs();
                *scale = if is_scale(scaled) && scaled > STILL * p.abs() { scaled } else { 1.0 };
            }
        }
        let is_open =
            |([low, high], p): (&[f64; 2], &f64)| (high - low).is_infinite().then_some(*p);
        let open = ranges.iter().zip(p).map(is_open).collect();
        let weight = |y: &Option<f64>| y.filter(|y| *y != 0.0).map_or(0.0, |y| 1.0 / (y * y));
        let own = own.iter().map(weight).collect();
        Metric { fixed: vec![false; groups.len()], unknown, groups, parameters, open, own }
    }

    /// Whether some group of unknowns has no given scale, and the start gives no information about
    /// its size.
    pub(super) fn is_uncertain(&self) -> bool {
        self.unknown.iter().zip(&self.fixed).any(|(unknown, fixed)| *unknown && !fixed)
    }

    /// Replaces the unknown scales of groups of unknowns by the scales of the same groups at
    /// another point of the curve, as far as these scales are known there.
    pub(super) fn with_unknown_from(mut self, other: &Metric) -> Self {
        for k in 0..self.groups.len() {
            if self.unknown[k] && !self.fixed[k] && !other.unknown[k] {
                (self.groups[k], self.unknown[k]) = (other.groups[k], false);
            }
        }
        self
    }

    /// Replaces scales by the given scales; the scales of the groups come first, followed by the
    /// scales of the released parameters.
    pub fn with_scales(mut self, scales: &[Option<f64>]) -> Self {
        let (groups, parameters) = scales.split_at(self.groups.len().min(scales.len()));
        for ((scale, fixed), given) in self.groups.iter_mut().zip(&mut self.fixed).zip(groups) {
            *scale = given.unwrap_or(*scale);
            *fixed = given.is_some();
        }
        for ((scale, open), given) in self.parameters.iter_mut().zip(&mut self.open).zip(parameters)
        {
            *scale = given.unwrap_or(*scale);
            *open = open.filter(|_| given.is_none());
        }
        self
    }

    /// Whether some scale is so much smaller than in another metric that a solution within the
    /// tolerance of the other metric may not satisfy the same tolerance in this metric.
    pub(super) fn is_finer_than(&self, other: &Metric) -> bool {
        self.groups.iter().zip(&other.groups).any(|(own, other)| own < &(FINER * other))
    }

    /// Increases the scale of each group of unknowns to the present size of the group, and the
    /// scale of each parameter without a finite range to the distance that the parameter has
    /// covered.
    pub fn grow(&mut self, names: &Names, z: &[f64], p: &[f64]) {
        let sizes = group_norms(names, z);
        for ((scale, fixed), size) in self.groups.iter_mut().zip(&self.fixed).zip(sizes) {
            *scale = if *fixed { *scale } else { scale.max(size) };
        }
        for ((scale, open), p) in self.parameters.iter_mut().zip(&self.open).zip(p) {
            *scale = open.map_or(*scale, |start| scale.max((p - start).abs()));
        }
    }

    /// Adapts the scales to the number of unknowns in each group on another mesh: norms grow like
    /// the square root of this number.
    pub(super) fn resample(&mut self, before: &[usize], after: &[usize]) {
        let lengths = before.iter().zip(after);
        for (scale, (before, after)) in self.groups.iter_mut().zip(lengths) {
            *scale *= (*after as f64 / *before as f64).sqrt();
        }
    }

    /// Returns the weights of `X = (z, y, p)` for a system with the given names. The system may be
    /// a finer discretisation of the same problem, whose groups contain more unknowns.
    pub fn weights(&self, names: &Names) -> Vec<f64> {
        let mut weights = Vec::new();
        for (group, scale) in names.unknowns.iter().zip(&self.groups) {
            weights.extend(std::iter::repeat_n(1.0 / (scale * scale), group.length));
        }
        weights.extend(&self.own);
        weights.extend(self.parameters.iter().map(|scale| 1.0 / (scale * scale)));
        weights
    }
}

/// The scaled norm that defines the arclength of a curve.
pub(super) struct ScaledNorm {
    pub metric: Metric,
    /// The weights of the components of `X`.
    pub weights: Vec<f64>,
}

impl ScaledNorm {
    pub fn new(metric: Metric, names: &Names) -> Self {
        ScaledNorm { weights: metric.weights(names), metric }
    }

    /// Returns the covector of a direction: `rowᵢ = wᵢ tᵢ`.
    pub fn covector(&self, direction: &[f64]) -> Vec<f64> {
        direction.iter().zip(&self.weights).map(|(t, w)| t * w).collect()
    }

    /// Scales a direction to length 1, and returns its former length.
    pub fn rescale(&self, direction: &mut [f64]) -> f64 {
        scale_to_one(direction, &self.weights)
    }

    /// Returns a direction in which all components that consist only of rounding or discretisation
    /// errors, relative to the largest component, are set to zero.
    pub fn without_rounding(&self, direction: &[f64], on_mesh: bool) -> Vec<f64> {
        let least = if on_mesh { VERTICAL_ON_MESH } else { VERTICAL };
        let sizes = direction.iter().zip(&self.weights).map(|(t, w)| t.abs() * w.sqrt());
        let most = sizes.clone().fold(0.0, f64::max);
        let kept = |(t, size): (&f64, f64)| if size > least * most { *t } else { 0.0 };
        direction.iter().zip(sizes).map(kept).collect()
    }

    /// Sets those components of a point and a direction to zero that were exactly zero before the
    /// correction and have the size of rounding errors after it.
    pub fn without_residue(
        &self,
        [point, direction]: [Vec<f64>; 2],
        before: &[f64],
    ) -> [Vec<f64>; 2] {
        let without = |all: Vec<f64>, size: f64| {
            let is_residue = |k: usize, x: f64| before[k] == 0.0 && self.scaled(k, x.abs()) < size;
            let kept = |(k, x): (usize, f64)| if is_residue(k, x) { 0.0 } else { x };
            all.into_iter().enumerate().map(kept).collect()
        };
        let length = self.of(&direction);
        [without(point, RESIDUE), without(direction, RESIDUE * length)]
    }

    /// Returns the length of a direction in the scaled norm.
    pub fn of(&self, direction: &[f64]) -> f64 {
        scaled_norm(direction, &self.weights)
    }

    /// Returns the distance between two points in the scaled norm.
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.of(&difference(a, b))
    }

    /// Returns the component with the given index, in units of its scale.
    pub fn scaled(&self, component: usize, value: f64) -> f64 {
        value * self.weights[component].sqrt()
    }
}

/// Rounding: a group of unknowns smaller than this threshold, relative to its change along the
/// tangent over the range of the parameter, is zero up to rounding; the start of a curve is
/// accurate to 1e-10.
const ZERO: f64 = 1e-9;

/// Discretisation: a group of unknowns that is smaller than other groups by this factor, relative
/// to its change along the tangent, is zero up to the error of the start. The error of the start is
/// the discretisation error if the curve emanates from a special point.
const SMALL: f64 = 1e-5;

/// Rounding: unknowns and their changes along the tangent that are smaller than this threshold, in
/// the given units, are zero up to rounding; the start of a curve is accurate to 1e-10.
const NOTHING: f64 = 1e-9;

/// Rounding: the threshold that replaces [`NOTHING`] on curves of special points, whose tangents are
/// accurate to about 1e-8.
const NOTHING_ON_CURVES: f64 = 1e-7;

/// Rounding: the parameter component of a tangent is zero up to rounding if it is smaller than this
/// threshold, relative to the component along the unknowns, both in units of their scales. The
/// bound is about 1e4 ε, for matrices with a condition number up to 1e4.
const VERTICAL: f64 = 1e-12;

/// Rounding: the threshold that replaces [`VERTICAL`] on a mesh, on which tangents are accurate to
/// about √ε.
const VERTICAL_ON_MESH: f64 = 1e-8;

/// Heuristic: a group of unknowns smaller than this fraction of the largest group may be a rounding
/// error.
const DOUBTFUL: f64 = 1e-6;

/// Rounding: a component that was zero before a correction counts as a rounding error if it is
/// smaller than this threshold, in units of its scale. The same bound applies to the components of
/// a unit tangent.
const RESIDUE: f64 = 1e-14;

/// Rounding: a parameter is constant, up to rounding, if it changes by less than this fraction of
/// its value while the unknowns change by their sizes.
const STILL: f64 = 1e-8;

/// Rounding: the start is near a fold if all groups of unknowns are smaller than this threshold,
/// relative to their changes along the tangent over the range of the parameter; if all groups are
/// smaller than [`ORIGIN`], the start is at the origin.
const FOLD: f64 = 1e-8;

/// Rounding: the start is at the origin if all groups of unknowns are smaller than this threshold,
/// relative to their changes along the tangent (see [`FOLD`]).
const ORIGIN: f64 = 1e-14;

/// Heuristic: the start must be corrected again if a new scale is smaller than the former scale by
/// more than this factor.
const FINER: f64 = 1e-2;

/// Rounding: the size of a group of unknowns is a rounding error if the size is smaller than this
/// fraction of the size of another group. Sizes in SI units, such as a density of 1e25 per cubic metre
/// beside a phase, have larger ratios.
const NEGLIGIBLE: f64 = 1e-32;

/// Whether a number can be a scale: its square and the inverse of its square are finite and
/// nonzero.
fn is_scale(scale: f64) -> bool {
    (1e-150..1e150).contains(&scale)
}

/// Returns the smallest ratio of the size of a group of unknowns to its slope along the tangent,
/// among the pairs of size and slope for which `counts` is true.
fn least_ratio(sizes: &[f64], slopes: &[f64], counts: impl Fn(f64, f64) -> bool) -> f64 {
    let pairs = sizes.iter().zip(slopes).filter(|(size, slope)| counts(**size, **slope));
    pairs.map(|(size, slope)| size / slope).fold(f64::INFINITY, f64::min)
}

/// Returns the largest ratio of the slope of a group of unknowns along the tangent to the size of
/// the group; the size of a zero group is taken as 1.
fn steepness(sizes: &[f64], slopes: &[f64]) -> f64 {
    let size = |size: f64| if size > 0.0 { size } else { 1.0 };
    sizes.iter().zip(slopes).map(|(s, slope)| slope / size(*s)).fold(0.0, f64::max)
}

/// Returns the largest ratio of the size of a group of unknowns to its change over the distance
/// `reach` along the tangent, but at most 1.
fn largest_known(sizes: &[f64], slopes: &[f64], reach: f64) -> f64 {
    let parts = sizes.iter().zip(slopes).map(|(size, slope)| size / (reach * slope));
    parts.filter(|part| part.is_finite()).fold(0.0, f64::max).min(1.0)
}

/// Whether the start is near a fold, where the tangent overestimates the changes of all groups. The
/// start is near a fold if the distance along the tangent over which the parameter changes by its
/// range is very large.
fn is_near_fold(sizes: &[f64], slopes: &[f64], reach: f64) -> bool {
    (ORIGIN..FOLD).contains(&largest_known(sizes, slopes, reach))
}

/// Computes the scales of groups from their sizes and from their changes over the distance `reach`
/// along the tangent; `None` for groups whose size and change are at most `nothing`.
fn group_scales(
    sizes: &[f64],
    slopes: &[f64],
    reach: Option<f64>,
    nothing: f64,
) -> Vec<Option<f64>> {
    let known = |reach| largest_known(sizes, slopes, reach);
    let zero = reach.map_or(ZERO, |reach| (SMALL * known(reach)).max(ZERO));
    let scale = |(&size, slope): (&f64, &f64)| match reach.map(|reach| reach * slope) {
        Some(reach) if is_scale(reach) && reach > nothing && size <= zero * reach => Some(reach),
        _ => Some(size).filter(|size| *size > nothing && is_scale(*size)),
    };
    let scales: Vec<Option<f64>> = sizes.iter().zip(slopes).map(scale).collect();
    let most = scales.iter().flatten().fold(0.0, |most: f64, scale| most.max(*scale));
    scales.into_iter().map(|scale| scale.filter(|scale| *scale > NEGLIGIBLE * most)).collect()
}

/// Sets each scale that is not yet known: to 1 if the sizes of the groups of unknowns are measured
/// in given typical sizes, and otherwise to the largest known scale of the other groups.
fn with_fallback(scales: &[Option<f64>], given: bool) -> Vec<f64> {
    let others = scales.iter().flatten().fold(0.0, |most: f64, scale| most.max(*scale));
    let unknown = if given || others == 0.0 { 1.0 } else { others };
    scales.iter().map(|scale| scale.unwrap_or(unknown)).collect()
}

/// Divides unknowns by the units of their groups; if no units are given, all units are 1.
pub(super) fn in_units(names: &Names, units: &[f64], z: &[f64]) -> Vec<f64> {
    let (mut z, mut start) = (z.to_vec(), 0);
    for (group, unit) in names.unknowns.iter().zip(units) {
        let end = start + group.length;
        z[start..end].iter_mut().for_each(|z| *z /= unit);
        start = end;
    }
    z
}

/// Whether a nonzero group is so much smaller than the largest group that it may be a rounding error.
pub(super) fn has_small_group(names: &Names, v: &[f64]) -> bool {
    let sizes = group_norms(names, v);
    let most = sizes.iter().copied().fold(0.0, f64::max);
    sizes.iter().any(|size| *size > 0.0 && *size < DOUBTFUL * most)
}

/// Whether a nonzero group is so much smaller than before that it may be a rounding error.
pub(super) fn has_shrunk(names: &Names, v: &[f64], before: &[f64]) -> bool {
    let sizes = group_norms(names, v).into_iter().zip(group_norms(names, before));
    sizes.into_iter().any(|(size, before)| size > 0.0 && size < DOUBTFUL * before)
}

fn group_norms(names: &Names, mut z: &[f64]) -> Vec<f64> {
    let norm_of = |group: &Group| {
        let (part, rest) = z.split_at(group.length);
        z = rest;
        norm(part)
    };
    names.unknowns.iter().map(norm_of).collect()
}
