//! Where an attractor is lost.

use super::Strobed;
use super::error::StrobeError;
use super::settling::Settling;
use crate::core::hybrid::HybridState;

/// Where an attractor that is no cycle is lost as a parameter goes on: in a crisis, motion leaves it for good.
#[derive(Clone, Debug, PartialEq)]
pub struct Crisis {
    /// The parameter at which motion was still on it after the transient, and that at which it had left.
    pub between: [f64; 2],
    /// The last state on the attractor.
    pub state: HybridState<f64>,
    /// The cycle on which motion settled beyond, by its number of periods; `None` if motion ended there.
    pub beyond: Option<usize>,
}

impl Settling {
    /// Halves the interval between a parameter at which motion from a state does not settle on a cycle, and one at which
    /// it does, or ends, until it is no longer than `tolerance`. The transient is how long an attractor must last to count:
    /// beyond a crisis motion stays near it for a time that grows without bound towards the crisis.
    ///
    /// `None` if both ends are of one kind.
    ///
    /// ```
    /// use tangency::core::attractor::{Settling, StrobeError, Strobed, Stroboscope};
    /// use tangency::core::hybrid::{HybridSettings, HybridState};
    /// use tangency::problems::mita::Actuator;
    /// // Chaos at ω = 0.5 ends where orbits with two impacts a period begin: at their fold, V = 0.717840.
    /// let mut motion = Stroboscope::of(&Actuator, HybridSettings::default(), &[])?;
    /// let settling = Settling { transient: 300, recorded: 100, exponent: 0, ..Settling::default() };
    /// let start = HybridState { mode: 0, time: 0.0, x: vec![0.1, -0.2] };
    /// let crisis = settling.crisis(&mut motion, start, &Actuator::DEFAULTS, 0, [0.71, 0.73], 1e-3)?;
    /// let [chaos, cycle] = crisis.expect("a crisis").between;
    /// assert!(chaos < 0.71784 + 1e-3 && cycle > 0.71784);
    /// # Ok::<(), StrobeError>(())
    /// ```
    ///
    /// # Errors
    /// [`StrobeError`] if the motion ends where the attractor should be.
    pub fn crisis(
        &self,
        motion: &mut dyn Strobed,
        start: HybridState<f64>,
        p: &[f64],
        parameter: usize,
        between: [f64; 2],
        tolerance: f64,
    ) -> Result<Option<Crisis>, StrobeError> {
        let (mut p, mut between) = (p.to_vec(), between);
        p[parameter] = between[0];
        let alive = self.follow(motion, start, &p)?;
        p[parameter] = between[1];
        let mut lost = self.follow(motion, alive.end.clone(), &p);
        let is_lost = |settled: &Result<super::Settled, StrobeError>| {
            settled.as_ref().map_or(true, |settled| settled.periods.is_some())
        };
        if alive.periods.is_some() || !is_lost(&lost) {
            return Ok(None);
        }
        let mut state = alive.end;
        while (between[1] - between[0]).abs() > tolerance {
            let middle = 0.5 * (between[0] + between[1]);
            p[parameter] = middle;
            let settled = self.follow(motion, state.clone(), &p);
            if is_lost(&settled) {
                (between[1], lost) = (middle, settled);
            } else {
                between[0] = middle;
                state = settled?.end;
            }
        }
        let beyond = lost.ok().and_then(|settled| settled.periods);
        Ok(Some(Crisis { between, state, beyond }))
    }
}
