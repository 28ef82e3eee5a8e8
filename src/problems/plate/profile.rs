//! Profiles of a plate that are stored with special points: curves along the centre line `y = b/2`.

use super::modes::extreme;
use super::vibration::Vibrates;
use crate::core::problem::Profile;

/// The number of points of a profile; the middle point is the centre of the plate.
pub(super) const POINTS: usize = 51;

/// The centre of the plate counts as a node of a mode if the ratio of the mode's deflection at the
/// centre to its largest deflection is smaller than this value.
const NODE: f64 = 0.01;

/// Evaluates the function `f` at two or more equidistant points from 0 to 1, and returns pairs `(x,
/// f(x))`.
pub(super) fn line(points: usize, f: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let step = 1.0 / points.saturating_sub(1).max(1) as f64;
    (0..points).map(|i| i as f64 * step).map(|x| (x, f(x))).collect()
}

/// Returns two profiles: the deflection with coefficients `z`, and the first mode `shape`, which is
/// scaled to the value 1 at the centre, or at the place of its largest value if the centre is a
/// node of the mode. The function `deflection` evaluates the displacement with given coefficients
/// at the point `x` of the centre line.
pub(super) fn profiles(
    z: &[f64],
    shape: Option<&[f64]>,
    deflection: impl Fn(&[f64], f64) -> f64,
) -> Vec<Profile> {
    let profile = |name: &str, points: Vec<(f64, f64)>, scale: f64| Profile {
        name: name.into(),
        along: "x/a".into(),
        points: points.into_iter().map(|(x, w)| [x, w / scale]).collect(),
    };
    let mut profiles = vec![profile("deflection w/d", line(POINTS, |x| deflection(z, x)), 1.0)];
    if let Some(shape) = shape {
        let points = line(POINTS, |x| deflection(shape, x));
        let largest = extreme(points.iter().map(|(_, w)| *w));
        let centre = points[POINTS / 2].1;
        let scale = if centre.abs() > NODE * largest.abs() { centre } else { largest };
        if scale != 0.0 && points.iter().all(|(_, w)| w.is_finite()) {
            profiles.push(profile("first mode shape", points, scale));
        }
    }
    profiles
}

/// Returns the [`profiles`] of the deflection with coefficients `z` and of the lowest mode of
/// vibration.
pub(super) fn with_lowest_mode<P: Vibrates>(
    problem: &P,
    z: &[f64],
    p: &[f64],
    deflection: impl Fn(&[f64], f64) -> f64,
) -> Vec<Profile> {
    let lowest = problem.lowest(z, p);
    profiles(z, lowest.as_ref().map(|vectors| vectors.right.as_slice()), deflection)
}
