//! What decides stability: the spectrum of the linearised motion about a solution.

use super::zero::{Dynamics, Spectrum};

/// What a spectrum says about stability, and the test functions of bifurcations that it holds.
///
/// ```
/// use tangency::core::{motion::Stability, zero::Dynamics};
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
    /// A number whose sign changes where a pair `±iω` of eigenvalues, or `e^{±iω}` of multipliers, crosses
    /// (or a neutral saddle, `λ, −λ` or `μ, 1/μ`); 0 where no such motion is meant.
    pub oscillation: f64,
    /// `Π (1 + μ)/(1 + |μ|)` over all multipliers, which vanishes where one is −1; 1 for an equilibrium.
    /// As a product over all it does not depend on telling them apart.
    pub doubling: f64,
}

impl Stability {
    /// The verdict on a spectrum.
    pub fn of(dynamics: Dynamics, spectrum: &[(f64, f64)]) -> Self {
        let periodic = dynamics == Dynamics::Periodic;
        let outside =
            |(re, im): &(f64, f64)| if periodic { re.hypot(*im) > 1.0 } else { *re > 0.0 };
        Stability {
            unstable: spectrum.iter().filter(|value| outside(value)).count(),
            oscillation: match dynamics {
                Dynamics::Periodic => {
                    pairs(spectrum, |a, b| a * b - 1.0, |re, im| re.hypot(im) - 1.0)
                }
                Dynamics::Flow => pairs(spectrum, |a, b| a + b, |re, _| re),
                _ => 0.0,
            },
            doubling: if periodic { spectrum.iter().map(doubling_factor).product() } else { 1.0 },
        }
    }

    /// With test functions that keep their signs where a multiplier passes through infinity.
    pub fn oriented(self, orientation: f64) -> Self {
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

/// The sign of the product of `real(a, b)` over all pairs of real eigenvalues and of `complex(re, im)` over
/// all complex pairs.
fn pairs(
    spectrum: &[(f64, f64)],
    real: impl Fn(f64, f64) -> f64,
    complex: impl Fn(f64, f64) -> f64,
) -> f64 {
    let mut sign = 1.0_f64;
    let reals = || spectrum.iter().filter(|l| l.1 == 0.0).map(|l| l.0);
    for (i, a) in reals().enumerate() {
        for b in reals().skip(i + 1) {
            sign *= real(a, b).signum();
        }
    }
    spectrum.iter().filter(|l| l.1 > 0.0).fold(sign, |sign, l| sign * complex(l.0, l.1).signum())
}

/// Beyond this size eigenvalues are infinite but for rounding.
const INFINITE: f64 = 1e8;

/// The first eigenvalues of a spectrum by falling real parts, so that each of them is continuous along a branch;
/// none if one is infinite.
pub(super) fn deciding(spectrum: &[(f64, f64)], count: usize) -> Spectrum {
    let mut first: Spectrum = spectrum.iter().take(count).copied().collect();
    if !first.iter().all(|(real, imaginary)| real.hypot(*imaginary) < INFINITE) {
        return Spectrum::new();
    }
    first.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
    first
}
