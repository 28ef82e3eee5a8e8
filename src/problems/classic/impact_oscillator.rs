//! The forced linear impact oscillator.

use crate::core::failure::OutOfDomain;
use crate::core::hybrid::{Guard, HybridSystem, Mode};
use crate::core::problem::Forcing;
use crate::core::scalar::Scalar;
use std::f64::consts::TAU;

/// The forced linear impact oscillator (S. W. Shaw and P. J. Holmes, *J. Sound Vib.* 90:129, 1983):
/// a mass on a spring with a stop. In the mode *flight* (motion away from the stop), its
/// displacement `x ≤ d` and velocity `v` satisfy the following equations:
///
/// ```text
///     x' = v,    v' = A cos ωt − x − c v;    v⁺ = −e v⁻ at x = d
/// ```
///
/// Accumulating impacts lead to the mode *contact*, in which the mass rests against the stop while
/// the contact force `A cos ωt − d` is positive.
///
/// The states are `displacement` and `velocity` (in flight only); the parameters are `amplitude` A,
/// `frequency` ω, `restitution` e, `damping` c and `clearance` d; the guards are `impact` and
/// `leave`.
///
/// ```
/// use tangency::core::hybrid::HybridSystem;
/// use tangency::problems::classic::ImpactOscillator;
/// let p = ImpactOscillator::DEFAULTS;
/// let mut f = [0.0; 2];
/// ImpactOscillator.field(ImpactOscillator::FLIGHT, 0.0, &[0.5, 1.0], &p, &mut f);
/// assert_eq!(f, [1.0, 0.05 - 0.5 - 0.1]);
/// let (impact, flight) = (ImpactOscillator::IMPACT, ImpactOscillator::FLIGHT);
/// // The stop is 0.5 away; an impact keeps 0.8 of the speed.
/// assert_eq!(ImpactOscillator.guard(impact, flight, 0.0, &[0.5, 1.0], &p), 0.5);
/// let mut after = [0.0; 2];
/// ImpactOscillator.reset(impact, (flight, flight), 0.0, &[1.0, 2.0], &p, &mut after);
/// assert_eq!(after, [1.0, -1.6]);
/// // The motion without impacts has the largest displacement A/√((1 − ω²)² + (cω)²) = 0.5.
/// assert_eq!(p[0] / ((1.0 - p[1] * p[1]).hypot(p[3] * p[1])), 0.5);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ImpactOscillator;

impl ImpactOscillator {
    /// The default values of the oscillator's parameters.
    pub const DEFAULTS: [f64; 5] = [0.05, 1.0, 0.8, 0.1, 1.0];
    /// The mode in which the mass moves away from the stop, without contact.
    pub const FLIGHT: usize = 0;
    /// The mode in which the mass rests against the stop.
    pub const CONTACT: usize = 1;
    /// The guard of the mode *flight*: the impact on the stop.
    pub const IMPACT: usize = 0;
    /// The guard of the mode *contact*: the end of the contact.
    pub const LEAVE: usize = 1;
}

impl HybridSystem for ImpactOscillator {
    fn modes(&self) -> Vec<Mode> {
        vec![
            Mode::new("flight", ["displacement", "velocity"]),
            Mode::new("contact", ["displacement"]),
        ]
    }

    fn guards(&self) -> Vec<Guard> {
        vec![
            Guard::new("impact", [Self::FLIGHT]).accumulating_to(Self::CONTACT),
            Guard::new("leave", [Self::CONTACT]),
        ]
    }

    fn parameters(&self) -> Vec<String> {
        ["amplitude", "frequency", "restitution", "damping", "clearance"].map(String::from).into()
    }

    fn defaults(&self) -> Vec<f64> {
        Self::DEFAULTS.into()
    }

    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        if mode == Self::CONTACT {
            f[0] = T::zero();
            return;
        }
        let [amplitude, frequency, damping] = [p[0], p[1], p[3]];
        f[0] = x[1];
        f[1] = amplitude * (frequency * t).cos() - x[0] - damping * x[1];
    }

    fn guard<T: Scalar>(&self, guard: usize, _mode: usize, t: T, x: &[T], p: &[T]) -> T {
        let [amplitude, frequency, clearance] = [p[0], p[1], p[4]];
        match guard {
            Self::IMPACT => clearance - x[0],
            _ => amplitude * (frequency * t).cos() - x[0],
        }
    }

    fn reset<T: Scalar>(
        &self,
        guard: usize,
        (_, next): (usize, usize),
        _t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        after[0] = x[0];
        if next == Self::FLIGHT {
            after[1] = if guard == Self::IMPACT { -p[2] * x[1] } else { T::zero() };
        }
    }

    fn next_mode(&self, _guard: usize, _mode: usize, _t: f64, _x: &[f64], _p: &[f64]) -> usize {
        Self::FLIGHT
    }

    fn forcing(&self) -> Forcing {
        Forcing::Periodic { phase: TAU }
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        p[1].recip() * TAU
    }

    fn domain(&self, _mode: usize, _x: &[f64], p: &[f64]) -> Result<(), OutOfDomain> {
        if p[1] <= 0.0 {
            return Err(OutOfDomain::new("frequency", p[1], "the frequency must be positive"));
        }
        Ok(())
    }
}
