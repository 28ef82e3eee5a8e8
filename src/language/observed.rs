//! The scales of models whose texts do not state scales, and whose branches start from simulations.

use super::basis::Basis;
use crate::core::hybrid::{HybridSystem, Scales, observed_scales};

/// A model that can be simulated; the tolerances of the simulation depend on the model's scales.
pub(super) trait Scalable: HybridSystem + Clone {
    /// Returns the basis of the model, whose scales are empty if the text states no scales.
    fn basis_mut(&mut self) -> &mut Basis;
}

/// Heuristic: the largest number of states for which a motion is simulated to estimate scales.
const MOST_STATES: usize = 1000;

/// The largest number of simulations from which the scales of a motion are estimated.
const SIMULATIONS: usize = 4;

/// Returns the system with the scales of its motion, which starts in the given states of the first
/// mode (all other states are zero); `None` if the text states scales, or if the motion has usual
/// sizes.
pub(super) fn with_observed_scales<S: Scalable>(
    system: &S,
    start: &[(String, f64)],
    p: &[f64],
) -> Option<S> {
    let mut scaled = system.clone();
    let states = system.modes().swap_remove(0).states;
    if scaled.basis_mut().scales != Scales::default() || states.len() > MOST_STATES {
        return None;
    }
    let value =
        |state: &String| start.iter().find(|(name, _)| name == state).map_or(0.0, |it| it.1);
    let start: Vec<f64> = states.iter().map(value).collect();
    // Each simulation has the tolerances of the previous estimate.
    for _ in 0..SIMULATIONS {
        let seen = observed_scales(&scaled, &start, p);
        if scaled.basis_mut().scales == seen {
            break;
        }
        scaled.basis_mut().set_scales(seen);
    }
    (scaled.basis_mut().scales != Scales::default()).then_some(scaled)
}
