//! What decides stability: the spectrum of the linearised motion about a solution.

use crate::core::linalg::Spectrum;
use crate::core::problem::Dynamics;

/// Eigenvalues this near to zero, compared with the largest one, and multipliers this near to the
/// unit circle count as neither stable nor unstable: conserved quantities and continuous symmetries
/// have them there but for rounding.
const NEUTRAL: f64 = 1e-13;

/// The bound of neutral multipliers, which the mesh of an orbit disturbs as well.
const NEUTRAL_MULTIPLIER: f64 = 1e-9;

/// What a spectrum says about stability, and the test functions of bifurcations that it holds.
///
/// ```
/// use tangency::core::bifurcation::Stability;
/// use tangency::core::problem::Dynamics;
/// // Multipliers of an orbit beyond a period doubling.
/// let orbit = Stability::of(Dynamics::Periodic, &[(-1.2, 0.0), (0.1, 0.0)]);
/// assert!(orbit.unstable == 1 && orbit.doubling < 0.0 && orbit.oscillation < 0.0);
/// // Eigenvalues of an equilibrium beyond a Hopf point.
/// let equilibrium = Stability::of(Dynamics::Flow, &[(0.1, 2.0), (0.1, -2.0), (-1.0, 0.0)]);
/// assert!(equilibrium.unstable == 2 && equilibrium.oscillation > 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stability {
    /// How many eigenvalues or multipliers are unstable.
    pub unstable: usize,
    /// A number whose sign changes where a pair `±iω` of eigenvalues, or `e^{±iω}` of multipliers,
    /// crosses (or a neutral saddle, `λ, −λ` or `μ, 1/μ`); 0 where no such motion is meant.
    pub oscillation: f64,
    /// `Π (1 + μ)/(1 + |μ|)` over all multipliers, which vanishes where one is −1; 1 for an
    /// equilibrium. As a product over all it does not depend on telling them apart.
    pub doubling: f64,
}

impl Stability {
    /// The verdict on a spectrum.
    pub fn of(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> Self {
        let neutral = neutral_bound(dynamics, spectrum);
        let periodic = dynamics == Dynamics::Periodic;
        Stability {
            unstable: spectrum.iter().filter(|l| growth(dynamics, l) > neutral).count(),
            oscillation: match dynamics {
                Dynamics::Periodic => pairs(dynamics, spectrum, |a, b| a * b - 1.0),
                Dynamics::Flow => pairs(dynamics, spectrum, |a, b| a + b),
                _ => 0.0,
            },
            doubling: if periodic { spectrum.iter().map(doubling_factor).product() } else { 1.0 },
        }
    }

    /// With test functions that keep their signs where a multiplier passes through infinity.
    pub(crate) fn oriented(self, orientation: f64) -> Self {
        let [oscillation, doubling] = [self.oscillation, self.doubling].map(|t| t * orientation);
        Stability { oscillation, doubling, ..self }
    }
}

/// `(1 + μ)/(1 + |μ|)`, or the square root of its square for one of a complex pair.
fn doubling_factor(mu: &(f64, f64)) -> f64 {
    let size = mu.0.hypot(mu.1);
    match (mu.1 == 0.0, size.is_finite()) {
        (_, false) => mu.0.signum(),
        (true, _) => (1.0 + mu.0) / (1.0 + size),
        (false, _) => (1.0 + mu.0).hypot(mu.1) / (1.0 + size),
    }
}

/// How far an eigenvalue is right of the imaginary axis, or a multiplier outside of the unit
/// circle.
fn growth(dynamics: Dynamics, &(re, im): &(f64, f64)) -> f64 {
    if dynamics == Dynamics::Periodic { re.hypot(im) - 1.0 } else { re }
}

/// The largest size of a growth that counts as none.
fn neutral_bound(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> f64 {
    let largest = || spectrum.iter().fold(0.0, |most: f64, (re, im)| most.max(re.hypot(*im)));
    if dynamics == Dynamics::Periodic { NEUTRAL_MULTIPLIER } else { NEUTRAL * largest() }
}

/// The sign of the product of `real(a, b)` over all pairs of real eigenvalues and of the growth of
/// all complex pairs, without those that are neutral.
fn pairs(dynamics: Dynamics, spectrum: &[(f64, f64)], real: impl Fn(f64, f64) -> f64) -> f64 {
    let neutral = neutral_bound(dynamics, spectrum);
    let mut sign = 1.0_f64;
    let mut count = |value: f64| {
        if value < -neutral {
            sign = -sign;
        }
    };
    let reals = || spectrum.iter().filter(|l| l.1 == 0.0).map(|l| l.0);
    for (i, a) in reals().enumerate() {
        reals().skip(i + 1).for_each(|b| count(real(a, b)));
    }
    spectrum.iter().filter(|l| l.1 > 0.0).for_each(|l| count(growth(dynamics, l)));
    sign
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
