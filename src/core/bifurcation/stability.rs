//! What decides stability: the spectrum of the linearised motion about a solution.

use crate::core::linalg::Spectrum;
use crate::core::problem::Dynamics;

/// Eigenvalues this near to zero, compared with the largest one, and multipliers this near to the
/// unit circle count as neither stable nor unstable: conserved quantities and continuous symmetries
/// have them there but for rounding.
const NEUTRAL: f64 = 1e-13;

/// The bound of neutral multipliers, which the mesh of an orbit disturbs as well.
const NEUTRAL_MULTIPLIER: f64 = 1e-9;

/// The counts of unstable eigenvalues or multipliers, by which bifurcations are noticed.
///
/// ```
/// use tangency::core::bifurcation::Stability;
/// use tangency::core::problem::Dynamics;
/// // Multipliers of an orbit beyond a period doubling.
/// let orbit = Stability::of(Dynamics::Periodic, &[(-1.2, 0.0), (0.1, 0.0)]);
/// assert_eq!((orbit.unstable, orbit.flipped, orbit.odd_pairs), (1, 1, false));
/// // Eigenvalues of an equilibrium beyond a Hopf point.
/// let equilibrium = Stability::of(Dynamics::Flow, &[(0.1, 2.0), (0.1, -2.0), (-1.0, 0.0)]);
/// assert_eq!((equilibrium.unstable, equilibrium.complex, equilibrium.odd_pairs), (2, 2, true));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stability {
    /// How many eigenvalues or multipliers are unstable.
    pub unstable: usize,
    /// How many of the unstable ones are not real.
    pub complex: usize,
    /// How many multipliers are real and less than −1; 0 for an equilibrium.
    pub flipped: usize,
    /// The number of real negative multipliers, stable ones among them.
    pub negative: usize,
    /// Whether an odd number of pairs of eigenvalues have a positive sum, or of multipliers a product
    /// larger than 1: the sign of the bialternate product, which changes at Hopf and torus points and at
    /// neutral saddles, and not at folds. The rightmost eigenvalues suffice.
    pub odd_pairs: bool,
}

impl Stability {
    /// The counts of a spectrum.
    pub fn of(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> Self {
        let neutral = neutral_bound(dynamics, spectrum);
        let unstable = || spectrum.iter().filter(|l| growth(dynamics, l) > neutral);
        let flips = |l: &&(f64, f64)| l.1 == 0.0 && l.0 < 0.0;
        Stability {
            unstable: unstable().count(),
            complex: unstable().filter(|l| l.1 != 0.0).count(),
            flipped: if dynamics == Dynamics::Periodic {
                unstable().filter(flips).count()
            } else {
                0
            },
            negative: match dynamics {
                Dynamics::Periodic => spectrum.iter().filter(flips).count(),
                _ => 0,
            },
            odd_pairs: has_odd_pairs(dynamics, spectrum, neutral),
        }
    }
}

/// Whether an odd number of pairs have a positive sum, or a product larger than 1. Pairs of real
/// values and pairs of conjugates decide; of all others there is an even number. Neutral values are
/// left out.
fn has_odd_pairs(dynamics: Dynamics, spectrum: &[(f64, f64)], neutral: f64) -> bool {
    let grows = |a: f64, b: f64| match dynamics {
        Dynamics::Flow => a + b > 0.0,
        Dynamics::Periodic => a * b > 1.0,
        _ => false,
    };
    let decided = || spectrum.iter().filter(|l| growth(dynamics, l).abs() > neutral);
    let conjugates = decided().filter(|l| l.1 > 0.0).filter(|&&(re, im)| match dynamics {
        Dynamics::Periodic => grows(re.hypot(im), re.hypot(im)),
        _ => grows(re, re),
    });
    let mut pairs = conjugates.count();
    let real: Vec<f64> = decided().filter(|l| l.1 == 0.0).map(|l| l.0).collect();
    for (k, &a) in real.iter().enumerate() {
        pairs += real[k + 1..].iter().filter(|&&b| grows(a, b)).count();
    }
    pairs % 2 == 1
}

/// How far an eigenvalue is right of the imaginary axis, or a multiplier outside of the unit
/// circle.
fn growth(dynamics: Dynamics, &(re, im): &(f64, f64)) -> f64 {
    if dynamics == Dynamics::Periodic { re.hypot(im) - 1.0 } else { re }
}

/// The largest size of a growth that counts as none.
fn neutral_bound(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> f64 {
    if dynamics == Dynamics::Periodic { NEUTRAL_MULTIPLIER } else { NEUTRAL * largest(spectrum) }
}

/// The largest modulus of an eigenvalue.
fn largest(spectrum: &[(f64, f64)]) -> f64 {
    spectrum.iter().fold(0.0, |most: f64, (re, im)| most.max(re.hypot(*im)))
}

/// The smallest distance of an eigenvalue from the imaginary axis, compared with the largest
/// eigenvalue, or of a multiplier from the unit circle.
pub(in crate::core) fn nearest_to_critical(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> f64 {
    let size = if dynamics == Dynamics::Periodic { 1.0 } else { largest(spectrum) };
    let distances = spectrum.iter().map(|l| growth(dynamics, l).abs() / size);
    distances.fold(f64::INFINITY, f64::min)
}

/// How many eigenvalues are neither stable nor unstable.
pub(in crate::core) fn neutral(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> usize {
    let bound = neutral_bound(dynamics, spectrum);
    spectrum.iter().filter(|l| growth(dynamics, l).abs() <= bound).count()
}

/// Which eigenvalues or multipliers are critical at a special point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Critical {
    /// Unknown.
    None,
    /// An eigenvalue 0, or a multiplier 1.
    One,
    /// A multiplier −1.
    MinusOne,
    /// A pair `±iω`, or `e^{±iθ}`.
    Pair,
}

impl Critical {
    /// How many there are.
    pub fn count(self) -> usize {
        match self {
            Critical::None => 0,
            Critical::One | Critical::MinusOne => 1,
            Critical::Pair => 2,
        }
    }

    /// By how much they can change the number of unstable ones; empty if they are unknown.
    pub fn changes(self) -> &'static [isize] {
        match self {
            Critical::None => &[],
            Critical::One | Critical::MinusOne => &[-1, 0, 1],
            Critical::Pair => &[-2, 0, 2],
        }
    }

    /// How far an eigenvalue or multiplier is from being one of them.
    pub fn distance(self, dynamics: Dynamics, &(re, im): &(f64, f64)) -> f64 {
        let periodic = dynamics == Dynamics::Periodic;
        match self {
            Critical::None => f64::INFINITY,
            Critical::One if periodic => (re - 1.0).hypot(im),
            Critical::One => re.hypot(im),
            Critical::MinusOne => (re + 1.0).hypot(im),
            Critical::Pair if im == 0.0 => f64::INFINITY,
            Critical::Pair => growth(dynamics, &(re, im)).abs(),
        }
    }
}

/// A spectrum without the `count` eigenvalues of the smallest `distance`.
pub(in crate::core) fn without_critical(
    spectrum: &[(f64, f64)],
    count: usize,
    distance: impl Fn(&(f64, f64)) -> f64,
) -> Spectrum {
    let mut order: Vec<usize> = (0..spectrum.len()).collect();
    order.sort_by(|&a, &b| distance(&spectrum[a]).total_cmp(&distance(&spectrum[b])));
    let critical = &order[..count.min(order.len())];
    (0..spectrum.len()).filter(|k| !critical.contains(k)).map(|k| spectrum[k]).collect()
}

/// (H) An eigenvalue that is farther from the axis than the critical ones by this factor is on a
/// certain side. The distance of the critical ones, which are on the axis, is their error.
const CERTAIN: f64 = 100.0;

/// (R) An eigenvalue this far from the axis, compared with the largest one, or a multiplier this far
/// from the unit circle, is on a certain side.
const FAR: [f64; 2] = [1e-9, 1e-7];

/// (H) Critical eigenvalues this far from the axis, compared with the largest one, or multipliers this
/// far from the unit circle, are errors or others: nothing is certain then.
const NEAR: [f64; 2] = [1e-5, 1e-2];

/// The number of unstable eigenvalues without those that are critical at a special point; `None`
/// where the error of the critical ones leaves the sign of another one open, or is large.
pub(in crate::core) fn certain_count(
    dynamics: Dynamics,
    spectrum: &[(f64, f64)],
    critical: Critical,
) -> Option<usize> {
    let distance = |l: &(f64, f64)| critical.distance(dynamics, l);
    let others = without_critical(spectrum, critical.count(), distance);
    let mut distances: Vec<f64> = spectrum.iter().map(distance).collect();
    distances.sort_by(f64::total_cmp);
    let error = *distances.get(critical.count().checked_sub(1)?)?;
    let [far, near] = match dynamics {
        Dynamics::Periodic => [FAR[1], NEAR[1]],
        _ => [FAR[0], NEAR[0]].map(|part| part * largest(spectrum)),
    };
    let neutral = neutral_bound(dynamics, spectrum);
    let certain = |l: &(f64, f64)| {
        let growth = growth(dynamics, l).abs();
        growth <= neutral || growth > far + CERTAIN * error
    };
    let certain = error <= near && others.iter().all(certain);
    certain.then(|| Stability::of(dynamics, &others).unstable)
}

/// Beyond this size eigenvalues are infinite but for rounding.
const INFINITE: f64 = 1e8;

/// The first eigenvalues of a spectrum by falling real parts, so that each of them is continuous
/// along a branch; none if one is infinite.
pub(in crate::core) fn deciding(spectrum: &[(f64, f64)], count: usize) -> Spectrum {
    let mut first: Spectrum = spectrum.iter().take(count).copied().collect();
    if !first.iter().all(|(real, imaginary)| real.hypot(*imaginary) < INFINITE) {
        return Spectrum::new();
    }
    first.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
    first
}
