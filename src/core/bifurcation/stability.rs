//! Stability of solutions from the spectrum of the linearised motion.

use crate::core::linalg::Spectrum;
use crate::core::problem::Dynamics;

/// Eigenvalues whose real part is smaller than this threshold, relative to the largest eigenvalue,
/// count as neither stable nor unstable: conserved quantities and continuous symmetries cause
/// eigenvalues that are zero up to rounding.
const NEUTRAL: f64 = 1e-13;

/// Multipliers whose distance from the unit circle is less than this threshold count as neither
/// stable nor unstable. This threshold is larger than the threshold for eigenvalues because
/// multipliers contain the discretisation error of orbits.
const NEUTRAL_MULTIPLIER: f64 = 1e-9;

/// The numbers of unstable eigenvalues or multipliers of several types, from which bifurcations are
/// detected.
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
    /// The number of unstable eigenvalues or multipliers.
    pub unstable: usize,
    /// The number of unstable eigenvalues or multipliers that are not real.
    pub complex: usize,
    /// The number of real multipliers less than −1; 0 for an equilibrium.
    pub flipped: usize,
    /// The number of real negative multipliers, both stable and unstable.
    pub negative: usize,
    /// Whether the number of pairs of eigenvalues with a positive sum, or of pairs of multipliers
    /// with a product larger than 1, is odd. The parity of the number of such pairs is the sign of
    /// the determinant of the bialternate product, which changes at Hopf and torus points and at
    /// neutral saddles, but not at folds. The parity can be computed from the rightmost
    /// eigenvalues.
    pub odd_pairs: bool,
}

impl Stability {
    /// Counts the unstable eigenvalues or multipliers of a spectrum.
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

/// Whether the number of pairs of eigenvalues with a positive sum, or of pairs of multipliers with
/// a product larger than 1, is odd. Only pairs of real values and pairs of conjugates are counted,
/// since the number of other such pairs is even. Neutral eigenvalues and multipliers are excluded.
fn has_odd_pairs(dynamics: Dynamics, spectrum: &[(f64, f64)], neutral: f64) -> bool {
    let grows = |a: f64, b: f64| match dynamics {
        Dynamics::Flow | Dynamics::Implicit => a + b > 0.0,
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

/// Returns the signed distance of an eigenvalue from the imaginary axis, or of a multiplier from
/// the unit circle; the distance is positive if the eigenvalue or multiplier is unstable.
fn growth(dynamics: Dynamics, &(re, im): &(f64, f64)) -> f64 {
    if dynamics == Dynamics::Periodic { re.hypot(im) - 1.0 } else { re }
}

/// Returns the largest distance from the imaginary axis, or from the unit circle, at which an
/// eigenvalue or multiplier counts as neutral.
fn neutral_bound(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> f64 {
    if dynamics == Dynamics::Periodic { NEUTRAL_MULTIPLIER } else { NEUTRAL * largest(spectrum) }
}

/// Returns the largest modulus of all eigenvalues in a spectrum.
fn largest(spectrum: &[(f64, f64)]) -> f64 {
    spectrum.iter().fold(0.0, |most: f64, (re, im)| most.max(re.hypot(*im)))
}

/// Returns the smallest distance of an eigenvalue from the imaginary axis, relative to the largest
/// eigenvalue, or of a multiplier from the unit circle.
pub(in crate::core) fn nearest_to_critical(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> f64 {
    let size = if dynamics == Dynamics::Periodic { 1.0 } else { largest(spectrum) };
    let distances = spectrum.iter().map(|l| growth(dynamics, l).abs() / size);
    distances.fold(f64::INFINITY, f64::min)
}

/// Returns the number of eigenvalues or multipliers that count as neither stable nor unstable.
pub(in crate::core) fn neutral(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> usize {
    let bound = neutral_bound(dynamics, spectrum);
    spectrum.iter().filter(|l| growth(dynamics, l).abs() <= bound).count()
}

/// The critical eigenvalues or multipliers of a special point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Critical {
    /// Unknown.
    None,
    /// A critical eigenvalue 0, or a critical multiplier 1.
    One,
    /// A multiplier −1.
    MinusOne,
    /// A critical pair of eigenvalues `±iω`, or of multipliers `e^{±iθ}`.
    Pair,
}

impl Critical {
    /// The number of critical eigenvalues or multipliers.
    pub fn count(self) -> usize {
        match self {
            Critical::None => 0,
            Critical::One | Critical::MinusOne => 1,
            Critical::Pair => 2,
        }
    }

    /// The possible changes of the number of unstable eigenvalues or multipliers at the special
    /// point; empty if unknown.
    pub fn changes(self) -> &'static [isize] {
        match self {
            Critical::None => &[],
            Critical::One | Critical::MinusOne => &[-1, 0, 1],
            Critical::Pair => &[-2, 0, 2],
        }
    }

    /// Returns the distance of an eigenvalue or multiplier from its critical value.
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

/// Returns a spectrum without the `count` eigenvalues for which the function `distance` has the
/// smallest values.
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

/// Returns the number of unstable eigenvalues or multipliers at a special point; its critical
/// eigenvalues or multipliers are not counted.
pub(in crate::core) fn unstable_besides(
    critical: Critical,
    dynamics: Dynamics,
    spectrum: &[(f64, f64)],
) -> usize {
    let distance = |l: &(f64, f64)| critical.distance(dynamics, l);
    let others = without_critical(spectrum, critical.count(), distance);
    Stability::of(dynamics, &others).unstable
}

/// Heuristic: a noncritical eigenvalue counts as certainly stable or unstable if its distance from
/// the imaginary axis exceeds the numerical error by this factor. The numerical error is estimated
/// by the computed distance of the critical eigenvalues from the axis, which is zero in theory.
const CERTAIN: f64 = 100.0;

/// Rounding: a noncritical eigenvalue counts as certainly stable or unstable only if its distance
/// from the imaginary axis, relative to the largest eigenvalue, exceeds the first number; a
/// noncritical multiplier counts as certainly stable or unstable only if its distance from the unit
/// circle exceeds the second number.
const FAR: [f64; 2] = [1e-9, 1e-7];

/// Heuristic: the stability of all eigenvalues counts as uncertain if the distance of the critical
/// eigenvalues from the imaginary axis, relative to the largest eigenvalue, exceeds the first
/// number; the stability of all multipliers counts as uncertain if the distance of the critical
/// multipliers from the unit circle exceeds the second number.
const NEAR: [f64; 2] = [1e-5, 1e-2];

/// Counts the unstable noncritical eigenvalues or multipliers at a special point; `None` if the
/// error of the critical eigenvalues is large, or too large to determine the stability of another
/// eigenvalue.
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

/// The modulus above which an eigenvalue or multiplier counts as infinite.
const INFINITE: f64 = 1e8;

/// Returns the first `count` eigenvalues of a spectrum, sorted by decreasing real part so that each
/// eigenvalue is continuous along a branch; empty if one of them is infinite.
pub(in crate::core) fn deciding(spectrum: &[(f64, f64)], count: usize) -> Spectrum {
    let mut first: Spectrum = spectrum.iter().take(count).copied().collect();
    if !first.iter().all(|(real, imaginary)| real.hypot(*imaginary) < INFINITE) {
        return Spectrum::new();
    }
    first.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
    first
}
