//! The scaled norm in which arclength is measured.

use super::newton::{scale_to_one, scaled_norm};
use crate::core::linalg::{difference, largest, norm};
use crate::core::problem::{Group, Names};

/// The scales that make arclength a pure number: `‖ΔX‖² = Σ_g (‖Δz_g‖/s_g)² + Σ (Δp/s_p)²`.
///
/// `s_g` is the largest Euclidean norm that the group of unknowns has had on the branch; `s_p` is
/// the length of the parameter's range. A group that is zero at the start is measured by what the
/// tangent makes of the parameter's range, and a parameter without a finite range by what the
/// tangent needs to change the unknowns by their size, later by what it has covered; only if
/// neither is known (or a tangent decides by rounding) is 1 used. Hence a change of units changes
/// nothing but the numbers, unless a group vanishes all along the start's tangent: such a group, if
/// its unit is unusual, is best given a scale
/// ([`Continuation::scale`](super::builder::Continuation::scale)).
///
/// ```
/// use tangency::core::continuation::Metric;
/// use tangency::core::problem::Names;
/// let names = Names::new([("u", 2), ("v", 1)], ["p"]);
/// // u = (3, 4) is measured by 5; v = 0 by its slope times the range of p; p by its range.
/// let metric =
///     Metric::new(&names, &[3.0, 4.0, 0.0], &[0.0, 0.0, 2.0], &[[0.0, 10.0]], &[0.0], &[1.0], &[]);
/// assert_eq!(metric.weights(&names), [1.0 / 25.0, 1.0 / 25.0, 1.0 / 400.0, 1.0 / 100.0]);
/// ```
#[derive(Clone, Debug)]
pub struct Metric {
    groups: Vec<f64>,
    /// Groups whose scale the user has given, so that it does not grow.
    fixed: Vec<bool>,
    parameters: Vec<f64>,
    /// Values at the start of those parameters whose range is open and whose scale is not given:
    /// their scales grow.
    open: Vec<Option<f64>>,
    own: Vec<f64>,
}

impl Metric {
    /// Scales at the start of a branch: `z` there, its derivative along the tangent, and the ranges
    /// of the released parameters with theirs. `own` holds the conditions' auxiliary unknowns, with
    /// `None` for those that are not measured.
    pub fn new(
        names: &Names,
        z: &[f64],
        z_tangent: &[f64],
        ranges: &[[f64; 2]],
        p: &[f64],
        p_tangent: &[f64],
        own: &[Option<f64>],
    ) -> Self {
        let (sizes, slopes) = (group_norms(names, z), group_norms(names, z_tangent));
        let steepest = least_ratio(&sizes, &slopes, |size, slope| size > 0.0 && slope > 0.0);
        let by_range = |([low, high], slope): (&[f64; 2], &f64)| match high - low {
            range if range.is_finite() => range,
            _ => steepest * slope.abs(),
        };
        let mut parameters: Vec<f64> = ranges.iter().zip(p_tangent).map(by_range).collect();
        // What the tangent reaches over the first range that is known, unless it is vertical there.
        let steep = largest(z_tangent);
        let known = |((scale, slope), range): &((&f64, &f64), &[f64; 2])| {
            // Along a short range the slope is as small as the range.
            let least =
                if is_range(range) { VERTICAL * steep * scale.min(1.0) } else { VERTICAL * steep };
            (usable(**scale) || is_range(range)) && slope.abs() > least
        };
        let reach =
            parameters.iter().zip(p_tangent).zip(ranges).find(known).map(|(reach, _)| reach);
        let groups = group_scales(&sizes, &slopes, reach.map(|(scale, slope)| scale / slope.abs()));
        let fallback = least_ratio(&groups, &slopes, |_, slope| usable(slope));
        for ((scale, slope), range) in parameters.iter_mut().zip(p_tangent).zip(ranges) {
            if !usable(*scale) && !is_range(range) {
                let scaled = fallback * slope.abs();
                *scale = if usable(scaled) { scaled } else { 1.0 };
            }
        }
        let is_open =
            |([low, high], p): (&[f64; 2], &f64)| (high - low).is_infinite().then_some(*p);
        let open = ranges.iter().zip(p).map(is_open).collect();
        let weight = |y: &Option<f64>| y.filter(|y| *y != 0.0).map_or(0.0, |y| 1.0 / (y * y));
        let own = own.iter().map(weight).collect();
        Metric { fixed: vec![false; groups.len()], groups, parameters, open, own }
    }

    /// The scales of unknowns that were given in these units, group by group.
    pub(super) fn of_units(mut self, units: &[f64]) -> Self {
        self.groups.iter_mut().zip(units).for_each(|(scale, unit)| *scale *= unit);
        self
    }

    /// Replaces scales by those that are given: of groups, then of released parameters.
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

    /// Lets the scales grow with the unknowns, and those of parameters without a range with what
    /// they have covered.
    pub fn grow(&mut self, names: &Names, z: &[f64], p: &[f64]) {
        let sizes = group_norms(names, z);
        for ((scale, fixed), size) in self.groups.iter_mut().zip(&self.fixed).zip(sizes) {
            *scale = if *fixed { *scale } else { scale.max(size) };
        }
        for ((scale, open), p) in self.parameters.iter_mut().zip(&self.open).zip(p) {
            *scale = open.map_or(*scale, |start| scale.max((p - start).abs()));
        }
    }

    /// Lets the scales follow groups that have become longer or shorter, on another mesh: norms grow
    /// as the square root of the number of values.
    pub(super) fn resample(&mut self, before: &[usize], after: &[usize]) {
        let lengths = before.iter().zip(after);
        for (scale, (before, after)) in self.groups.iter_mut().zip(lengths) {
            *scale *= (*after as f64 / *before as f64).sqrt();
        }
    }

    /// The weights of `X = (z, y, p)` for a system with these names, which may be a refinement: its
    /// groups are the same, though longer.
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

/// The scaled norm of a curve.
pub(super) struct ScaledNorm {
    pub metric: Metric,
    /// The weights of `X`.
    pub weights: Vec<f64>,
}

impl ScaledNorm {
    pub fn new(metric: Metric, names: &Names) -> Self {
        ScaledNorm { weights: metric.weights(names), metric }
    }

    /// The covector of a direction: `rowᵢ = wᵢ tᵢ`.
    pub fn covector(&self, direction: &[f64]) -> Vec<f64> {
        direction.iter().zip(&self.weights).map(|(t, w)| t * w).collect()
    }

    /// Scales a direction to length 1; the length that it had.
    pub fn rescale(&self, direction: &mut [f64]) -> f64 {
        scale_to_one(direction, &self.weights)
    }

    /// The length of a direction.
    pub fn of(&self, direction: &[f64]) -> f64 {
        scaled_norm(direction, &self.weights)
    }

    /// The distance of two points.
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.of(&difference(a, b))
    }

    /// A component, at this position, in units of its scale.
    pub fn scaled(&self, component: usize, value: f64) -> f64 {
        value * self.weights[component].sqrt()
    }
}

/// (R) A group of unknowns this small, compared with what the tangent makes of the parameter's
/// range, is zero but for rounding: starts are solutions to 1e-10.
const ZERO: f64 = 1e-9;

/// (D) A group that is this much smaller than others are, likewise compared, is zero but for the
/// error of the start: that of the discretisation where a curve emanates.
const SMALL: f64 = 1e-5;

/// (R) Scales smaller than √ε, or larger than its inverse, come from a tangent that lies in a level
/// set of a parameter or an unknown but for rounding.
const TINY: f64 = 1e-8;

/// (R) Unknowns this small in their own units, that the tangent does not change either, are
/// rounding: starts are solutions to 1e-10.
const NOTHING: f64 = 1e-9;

/// (R) A parameter's part of the tangent this small, compared with the unknowns' part, is rounding:
/// about 1e4 ε, for matrices with a condition up to that.
const VERTICAL: f64 = 1e-12;

fn usable(scale: f64) -> bool {
    (TINY..1.0 / TINY).contains(&scale)
}

/// Whether a range has a length that can measure its parameter: the square and its inverse are
/// finite.
fn is_range([low, high]: &[f64; 2]) -> bool {
    (1e-150..1e150).contains(&(high - low))
}

/// The smallest ratio of a size to a slope, of those that count.
fn least_ratio(sizes: &[f64], slopes: &[f64], counts: impl Fn(f64, f64) -> bool) -> f64 {
    let pairs = sizes.iter().zip(slopes).filter(|(size, slope)| counts(**size, **slope));
    pairs.map(|(size, slope)| size / slope).fold(f64::INFINITY, f64::min)
}

/// The scales of groups of these sizes, which change at these slopes over what the tangent reaches.
fn group_scales(sizes: &[f64], slopes: &[f64], reach: Option<f64>) -> Vec<f64> {
    let both = || sizes.iter().zip(slopes);
    // Near a fold the tangent says too much of all groups alike.
    let known = |reach: f64| {
        let parts = both().map(|(size, slope)| size / (reach * slope));
        parts.filter(|part| part.is_finite()).fold(0.0, f64::max).min(1.0)
    };
    let zero = reach.map_or(ZERO, |reach| (SMALL * known(reach)).max(ZERO));
    let scale = |(&size, slope): (&f64, &f64)| match reach.map(|reach| reach * slope) {
        Some(reach) if usable(reach) && size <= zero * reach => reach,
        _ if size > NOTHING => size,
        _ => 1.0,
    };
    both().map(scale).collect()
}

/// Unknowns in units of their groups, which are 1 if there are none.
pub(super) fn in_units(names: &Names, units: &[f64], z: &[f64]) -> Vec<f64> {
    let (mut z, mut start) = (z.to_vec(), 0);
    for (group, unit) in names.unknowns.iter().zip(units) {
        let end = start + group.length;
        z[start..end].iter_mut().for_each(|z| *z /= unit);
        start = end;
    }
    z
}

fn group_norms(names: &Names, mut z: &[f64]) -> Vec<f64> {
    let norm_of = |group: &Group| {
        let (part, rest) = z.split_at(group.length);
        z = rest;
        norm(part)
    };
    names.unknowns.iter().map(norm_of).collect()
}
