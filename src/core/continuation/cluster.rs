//! Clusters of eigenvalues that pass zero in a short interval of the branch: the positions at which
//! they pass zero, and their types.

use super::arnoldi::{distances, shift_on_finer};
use super::corrector::Corrector;
use super::curve::Curve;
use super::curve_point::CurvePoint;
use super::locator::Locator;
use super::unexplained::REAL;
use crate::core::bifurcation::Critical;
use crate::core::linalg::Spectrum;
use crate::core::numerics::lagrange;
use crate::core::problem::Dynamics;
use std::ops::RangeInclusive;

/// Heuristic: the sample points in an interval, in units of its length. The samples avoid the ends
/// and the middle of the interval, because symmetric problems may be singular at these points.
const SAMPLES: [f64; 5] = [0.03, 0.22, 0.517, 0.76, 0.96];

/// Rounding: a zero of an eigenvalue counts as inside an interval if its position lies in this
/// range, in units of the length of the interval. The range is slightly larger than the interval
/// because an eigenvalue may vanish at an end of the interval itself: the ends are corrected to
/// 1e-10 in arclength, which is 1e-7 of the shortest relevant step.
const ENDS: RangeInclusive<f64> = -1e-6..=1.0 + 1e-6;

/// Rounding: the positions at which two eigenvalues pass zero count as equal if their distance is
/// smaller than this threshold, in units of the interval. Eigenvalues, and their interpolating
/// polynomials in a short interval, are accurate to rounding, 1e-16.
const TOGETHER: f64 = 1e-7;

/// Discretisation: on a mesh, the positions at which two eigenvalues pass zero count as equal if
/// their distance is smaller than this threshold, in scaled arclength. The threshold below which
/// two zeros of eigenvalues count as equal is the discretisation error of usual meshes.
const ON_MESH: f64 = 1e-6;

/// Rounding: a position is accurate if its uncertainty, in scaled arclength, is smaller than this
/// threshold, even in a short interval.
const CERTAIN: f64 = 1e-9;

/// Heuristic: an interval is cut next to the part that contains the zeros of all eigenvalues, if
/// the cut removes at least this fraction of the interval.
const WORTH_CUTTING: f64 = 0.25;

/// Heuristic: two frequencies count as equal if their relative difference is smaller than this
/// threshold.
const SAME_FREQUENCY: f64 = 1e-6;

/// A group of equal eigenvalues, or pairs of eigenvalues, that are critical at the same point.
#[derive(Clone, Copy)]
pub(super) struct Group {
    pub critical: Critical,
    /// The frequency or the angle of the critical pair.
    pub frequency: f64,
    /// The number of eigenvalues, or pairs of eigenvalues, in the group.
    pub count: usize,
}

/// Eigenvalues that pass zero in an interval.
pub(super) struct Cluster {
    /// The corrected points in the interval, with their positions in it.
    pub places: Vec<CurvePoint>,
    abscissae: Vec<f64>,
    length: f64,
    /// The number of eigenvalues that pass zero.
    pub count: usize,
    /// The position at which the mean of the eigenvalues vanishes, computed from the polynomial
    /// through the sampled values of the mean, and the change of this position if the first sample
    /// is omitted.
    pub along: f64,
    pub uncertainty: f64,
    /// The positions at which the individual eigenvalues vanish, in increasing order.
    zeros: Vec<f64>,
}

impl Cluster {
    /// Computes the cluster of eigenvalues that pass zero in an interval over which the number of
    /// unstable eigenvalues changes by `change`.
    pub fn of(locator: &mut Locator, change: usize) -> Option<Self> {
        let places = samples(locator)?;
        let length = locator.interval.length;
        let abscissae: Vec<f64> = SAMPLES.iter().map(|s| s * length).collect();
        let (count, growth) = vanishing(locator.curve, &places, length, change)?;
        let mean = |all: &Vec<f64>| all.iter().sum::<f64>() / count as f64;
        let means: Vec<f64> = growth.iter().map(mean).collect();
        let along = root(&abscissae, &means, length)?;
        let rougher = root(&abscissae[1..], &means[1..], length)?;
        let each = (0..count).filter_map(|k| {
            let values: Vec<f64> = growth.iter().map(|all| all[k]).collect();
            root(&abscissae, &values, length)
        });
        let mut zeros: Vec<f64> = each.collect();
        zeros.sort_by(f64::total_cmp);
        let uncertainty = (along - rougher).abs();
        Some(Cluster { places, abscissae, length, count, along, uncertainty, zeros })
    }

    /// Returns the largest distance between a position at which one of the eigenvalues vanishes and
    /// the position at which their mean vanishes.
    pub fn spread(&self) -> f64 {
        self.zeros.iter().fold(0.0, |most: f64, zero| most.max((zero - self.along).abs()))
    }

    /// Whether all eigenvalues of the cluster vanish at the same position, up to rounding and the
    /// discretisation error.
    pub fn coincides(&self, corrector: &mut Corrector) -> bool {
        self.zeros.len() == self.count && self.spread() <= self.allowed(corrector)
    }

    /// Whether the position at which the mean of the eigenvalues vanishes is accurate up to rounding
    /// and the discretisation error. In a long interval, other eigenvalues may be nearer to zero at
    /// some of the samples.
    pub fn is_certain(&self, corrector: &mut Corrector) -> bool {
        self.uncertainty <= self.allowed(corrector).max(CERTAIN)
    }

    /// Returns the distance below which two positions are equal.
    fn allowed(&self, corrector: &mut Corrector) -> f64 {
        let mesh = corrector.equations.system().representation().mesh;
        if mesh.is_empty() { TOGETHER * self.length } else { ON_MESH }
    }

    /// Returns the position at which to cut the interval. If all eigenvalues vanish in a small part
    /// of the interval, the cut lies next to this part; if not, it lies in the widest gap between
    /// two zeros.
    pub fn cut(&self) -> f64 {
        let [Some(first), Some(last)] = [self.zeros.first(), self.zeros.last()] else {
            return self.middle();
        };
        let reach = (last - first).max(4.0 * self.uncertainty);
        let [before, after] = [first - reach, last + reach];
        let cut = if before > WORTH_CUTTING * self.length {
            before
        } else if after < (1.0 - WORTH_CUTTING) * self.length {
            after
        } else {
            let gaps = self.zeros.windows(2).map(|gap| (gap[1] - gap[0], 0.5 * (gap[0] + gap[1])));
            gaps.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(self.middle(), |gap| gap.1)
        };
        if (0.0..self.length).contains(&cut) && cut > 0.0 { cut } else { self.middle() }
    }

    /// A position close to the middle of the interval. The exact middle of the interval is avoided,
    /// because symmetric problems may be singular in the middle.
    fn middle(&self) -> f64 {
        SAMPLES[2] * self.length
    }

    /// Returns the unknowns at the position where the mean of the eigenvalues vanishes,
    /// interpolated by polynomials through the samples. The unknowns are interpolated because the
    /// equations may be singular where the mean of the eigenvalues vanishes, but are regular at the
    /// sample points.
    pub fn unknowns(&self) -> Vec<f64> {
        let component = |i: usize| {
            let values: Vec<f64> = self.places.iter().map(|place| place.unknowns[i]).collect();
            interpolated(&self.abscissae, &values, self.along)
        };
        (0..self.places[0].unknowns.len()).map(component).collect()
    }

    /// Returns the frequency or the angle of the critical pairs near a given frequency, interpolated at
    /// the position where the mean of the eigenvalues vanishes, and its error. The error of the
    /// continued parameter there, and the place of this parameter among the unknowns, are given.
    pub fn frequency(
        &self,
        (near, dynamics): (f64, Dynamics),
        (error, parameter): (f64, usize),
    ) -> [f64; 2] {
        let of = |place: &CurvePoint| {
            let pairs = place.spectrum.iter().flatten().filter(|(_, im)| *im > 0.0);
            let mut pairs: Vec<&(f64, f64)> = pairs.collect();
            pairs.sort_by(|a, b| rate(a, dynamics).abs().total_cmp(&rate(b, dynamics).abs()));
            pairs.truncate(self.count / 2);
            let frequencies = pairs.iter().map(|(re, im)| match dynamics {
                Dynamics::Periodic => im.atan2(*re),
                _ => *im,
            });
            let farther = |a: &f64, b: &f64| (a - near).abs().total_cmp(&(b - near).abs());
            frequencies.min_by(farther).unwrap_or(near)
        };
        let values: Vec<f64> = self.places.iter().map(of).collect();
        let value = interpolated(&self.abscissae, &values, self.along);
        let rougher = interpolated(&self.abscissae[1..], &values[1..], self.along);
        let last = values.len() - 1;
        let [before, after] = [0, last].map(|k| self.places[k].unknowns[parameter]);
        let slope = (values[last] - values[0]) / (after - before);
        // If the parameter does not change, the frequency has no known digits.
        let by_parameter = (slope.abs() * error).min(value.abs());
        [value, (value - rougher).abs() + by_parameter + 4.0 * f64::EPSILON * value]
    }

    /// Estimates the discretisation error of the continued parameter at the position where the mean
    /// of the eigenvalues vanishes, given the slope of the parameter.
    pub fn mesh_share(&self, curve: &mut Curve, unknowns: &[f64], slope: f64) -> Option<f64> {
        let (first, refines) = (&self.places[0], curve.refiner.accuracy > 0.0);
        Some(match first.spectrum {
            Some(_) => curve.corrector.mesh_share(unknowns),
            None => slope * shift_on_finer(&mut curve.corrector, refines, first, self.count)?,
        })
    }

    /// Classifies the eigenvalues that pass zero into groups: real eigenvalues, multipliers −1, and
    /// pairs by frequency.
    pub fn groups(&self, dynamics: Dynamics) -> Vec<Group> {
        let distance = |k: &usize| (self.abscissae[*k] - self.along).abs();
        let nearest = (0..SAMPLES.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let spectrum = nearest.and_then(|k| self.places[k].spectrum.as_ref());
        let Some(spectrum) = spectrum else {
            return vec![Group { critical: Critical::One, frequency: 0.0, count: self.count }];
        };
        let mut order: Spectrum = spectrum.clone();
        order.sort_by(|a, b| rate(a, dynamics).abs().total_cmp(&rate(b, dynamics).abs()));
        order.truncate(self.count);
        // Rounding may make two equal real eigenvalues complex.
        let farthest = order.iter().map(|l| Critical::One.distance(dynamics, l));
        let real = 1e-3 * farthest.fold(1e-6, f64::max);
        let is_negative = |re: f64| dynamics == Dynamics::Periodic && re < 0.0;
        let negative = order.iter().filter(|(re, _)| is_negative(*re));
        let farthest = negative.map(|l| Critical::MinusOne.distance(dynamics, l));
        let negative = (1e-3 * farthest.fold(0.0, f64::max)).max(REAL);
        let mut groups: Vec<Group> = Vec::new();
        for (re, im) in order {
            let (kind, limit) = match is_negative(re) {
                true => (Critical::MinusOne, negative),
                false => (Critical::One, real),
            };
            let (critical, frequency) = match dynamics {
                _ if im.abs() <= limit => (kind, 0.0),
                _ if im < 0.0 => continue,
                Dynamics::Periodic => (Critical::Pair, im.atan2(re)),
                _ => (Critical::Pair, im),
            };
            let same = |it: &&mut Group| {
                it.critical == critical
                    && (it.frequency - frequency).abs() <= SAME_FREQUENCY * frequency
            };
            match groups.iter_mut().find(same) {
                Some(group) => group.count += 1,
                None => groups.push(Group { critical, frequency, count: 1 }),
            }
        }
        groups
    }
}

/// Returns the number of eigenvalues that pass zero in the interval, and, at each sample point, the
/// values of functions that vanish where an eigenvalue passes zero. The returned functions are
/// growth rates of eigenvalues or, if eigenvalues are not computed, distances to singular matrices
/// in the interval.
fn vanishing(
    curve: &mut Curve,
    places: &[CurvePoint],
    length: f64,
    change: usize,
) -> Option<(usize, Vec<Vec<f64>>)> {
    let dynamics = curve.corrector.equations.system().dynamics();
    if places[0].spectrum.is_some() {
        let rates = places
            .iter()
            .map(|place| nearest(place.spectrum.as_deref().unwrap_or_default(), change, dynamics));
        return (change > 0).then(|| (change, rates.collect()));
    }
    let all = places.iter().map(|place| distances(&mut curve.corrector, place));
    let mut distances = all.collect::<Option<Vec<Vec<f64>>>>()?;
    let inside = |d: &&f64| ENDS.contains(&(SAMPLES[0] + *d / length));
    let count = distances[0].iter().filter(inside).count();
    for at in &mut distances {
        if at.len() < count {
            return None;
        }
        at.truncate(count);
        at.sort_by(f64::total_cmp);
    }
    (count > 0).then_some((count, distances))
}

/// Computes corrected points of the branch in an interval.
fn samples(locator: &mut Locator) -> Option<Vec<CurvePoint>> {
    let stability = locator.curve.recorder.wants_stability();
    let point = |share: f64| {
        let guess = locator.interval.chord(share);
        let (unknowns, _) = locator.corrected(guess, share * locator.interval.length).ok()?;
        locator.arrive((unknowns, f64::INFINITY), stability).ok()
    };
    SAMPLES.into_iter().map(point).collect()
}

/// Returns the growth rate: the real part of an eigenvalue, or the logarithm of the modulus of a
/// multiplier.
pub(super) fn rate(&(re, im): &(f64, f64), dynamics: Dynamics) -> f64 {
    if dynamics == Dynamics::Periodic { re.hypot(im).ln() } else { re }
}

/// Returns the `count` growth rates nearest to zero, in increasing order.
fn nearest(spectrum: &[(f64, f64)], count: usize, dynamics: Dynamics) -> Vec<f64> {
    let mut rates: Vec<f64> = spectrum.iter().map(|l| rate(l, dynamics)).collect();
    rates.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    rates.resize(count, 0.0);
    rates.sort_by(f64::total_cmp);
    rates
}

/// Evaluates the Lagrange polynomial through the given values at a point.
pub(super) fn interpolated(abscissae: &[f64], values: &[f64], at: f64) -> f64 {
    values.iter().enumerate().map(|(k, value)| lagrange(abscissae, k, at) * value).sum()
}

/// Computes a zero of the polynomial through sampled values, in a step of the given length, by the
/// secant method. The first and the last value must differ in sign.
fn root(abscissae: &[f64], values: &[f64], length: f64) -> Option<f64> {
    let line = |a: f64, fa: f64, b: f64, fb: f64| a - fa * (b - a) / (fb - fa);
    let last = values.len() - 1;
    let (mut a, mut fa) = (abscissae[0], values[0]);
    let mut b = line(a, fa, abscissae[last], values[last]);
    for _ in 0..30 {
        let fb = interpolated(abscissae, values, b);
        if fb == 0.0 || (b - a).abs() <= 1e-15 * length {
            break;
        }
        (a, fa, b) = (b, fb, line(a, fa, b, fb));
    }
    ENDS.contains(&(b / length)).then_some(b)
}
