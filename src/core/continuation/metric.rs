//! The scaled norm in which arclength is measured.

use crate::core::zero::Names;

/// The scales that make arclength a pure number: `‖ΔX‖² = Σ_g (‖Δz_g‖/s_g)² + Σ (Δp/s_p)²`.
///
/// `s_g` is the largest Euclidean norm that the group of unknowns has had on the branch; `s_p` is the
/// length of the parameter's range. A group that is zero at the start is measured by what the tangent
/// makes of the parameter's range, and a parameter without a finite range by what the tangent needs to
/// change the unknowns by their size; only if both are unknown (or below 1e-12) is 1 used. Hence a change of units
/// changes nothing but the numbers.
#[derive(Clone, Debug)]
pub struct Metric {
    groups: Vec<f64>,
    parameters: Vec<f64>,
    own: Vec<f64>,
}

impl Metric {
    /// Scales at the start of a branch: `z` there, its derivative along the tangent, and the ranges
    /// of the released parameters with theirs. `own` holds the conditions' own unknowns, with `None`
    /// for those that are not measured.
    pub fn new(
        names: &Names,
        z: &[f64],
        z_tangent: &[f64],
        ranges: &[[f64; 2]],
        p_tangent: &[f64],
        own: &[Option<f64>],
    ) -> Self {
        let (sizes, slopes) = (group_norms(names, z), group_norms(names, z_tangent));
        let steepest = sizes
            .iter()
            .zip(&slopes)
            .filter(|(size, slope)| **size > 0.0 && **slope > 0.0)
            .map(|(size, slope)| size / slope)
            .fold(f64::INFINITY, f64::min);
        let mut parameters: Vec<f64> = ranges
            .iter()
            .zip(p_tangent)
            .map(|([low, high], slope)| match high - low {
                range if range.is_finite() => range,
                _ => steepest * slope.abs(),
            })
            .collect();
        // What the tangent reaches over the first range that is known.
        let reach = parameters
            .iter()
            .zip(p_tangent)
            .filter(|(scale, slope)| usable(**scale) && usable(slope.abs()))
            .map(|(scale, slope)| scale / slope.abs())
            .next();
        let groups: Vec<f64> = sizes
            .iter()
            .zip(&slopes)
            .map(|(&size, slope)| match reach.map(|reach| reach * slope) {
                Some(reach) if reach.is_finite() && reach > NOTHING && size <= ZERO * reach => {
                    reach
                }
                _ if size > NOTHING => size,
                _ => 1.0,
            })
            .collect();
        let fallback = groups
            .iter()
            .zip(&slopes)
            .filter(|(_, slope)| usable(**slope))
            .map(|(size, slope)| size / slope)
            .fold(f64::INFINITY, f64::min);
        for (scale, slope) in parameters.iter_mut().zip(p_tangent) {
            if !usable(*scale) {
                let scaled = fallback * slope.abs();
                *scale = if usable(scaled) { scaled } else { 1.0 };
            }
        }
        let own =
            own.iter().map(|y| y.filter(|y| *y != 0.0).map_or(0.0, |y| 1.0 / (y * y))).collect();
        Metric { groups, parameters, own }
    }

    /// Lets the scales grow with the unknowns.
    pub fn grow(&mut self, names: &Names, z: &[f64]) {
        for (scale, size) in self.groups.iter_mut().zip(group_norms(names, z)) {
            *scale = scale.max(size);
        }
    }

    /// The weights of `X = (z, y, p)` for a system with these names, which may be a refinement: its
    /// groups are the same, though longer. `more` own unknowns of a further condition are not
    /// measured.
    pub fn weights(&self, names: &Names, more: usize) -> Vec<f64> {
        let mut weights = Vec::new();
        for (group, scale) in names.unknowns.iter().zip(&self.groups) {
            weights.extend(std::iter::repeat_n(1.0 / (scale * scale), group.length));
        }
        weights.extend(&self.own);
        weights.extend(std::iter::repeat_n(0.0, more));
        weights.extend(self.parameters.iter().map(|scale| 1.0 / (scale * scale)));
        weights
    }
}

/// A group of unknowns this small, compared with what the tangent makes of the parameter's range, is
/// zero but for rounding.
const ZERO: f64 = 1e-9;

/// Unknowns this small in their own units, that the tangent does not change either, are rounding.
const NOTHING: f64 = 1e-12;

fn usable(scale: f64) -> bool {
    scale.is_finite() && scale > 0.0
}

fn group_norms(names: &Names, z: &[f64]) -> Vec<f64> {
    let mut start = 0;
    let norm = |z: &[f64]| z.iter().map(|z| z * z).sum::<f64>().sqrt();
    names
        .unknowns
        .iter()
        .map(|group| {
            let part = &z[start..start + group.length];
            start += group.length;
            norm(part)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_units_scales_the_weights() {
        let names = Names::new([("u", 2), ("v", 1)], ["p"]);
        let metric = |u: f64, p: f64| {
            Metric::new(&names, &[0.0, 0.0, 3.0], &[u, 2.0 * u, 1.0], &[[0.0, 10.0 * p]], &[p], &[])
                .weights(&names, 0)
        };
        let (here, there) = (metric(1.0, 1.0), metric(1e3, 1e-2));
        for (i, factor) in [1e3, 1e3, 1.0, 1e-2].into_iter().enumerate() {
            assert!((here[i] / (there[i] * factor * factor) - 1.0).abs() < 1e-12);
        }
    }
}
