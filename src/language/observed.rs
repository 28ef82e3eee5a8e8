//! The scales of models with events whose texts do not state scales.

use crate::core::hybrid::{HybridSystem, Scales, observed_scales};

/// A model with events, whose tolerances depend on its scales.
pub(super) trait WithEvents: HybridSystem + Clone {
    /// Returns the scales, which are empty if the text states no scales.
    fn scales_mut(&mut self) -> &mut Scales;
}

/// The largest number of simulations from which the scales of a motion are estimated.
const SIMULATIONS: usize = 4;

/// Returns the system with the scales of its motion, which starts in the given states of the first
/// mode (all other states are zero); `None` if the text states scales, or if the motion has usual
/// sizes.
pub(super) fn with_observed_scales<S: WithEvents>(
    system: &S,
    start: &[(String, f64)],
    p: &[f64],
) -> Option<S> {
    let mut scaled = system.clone();
    if *scaled.scales_mut() != Scales::default() {
        return None;
    }
    let value =
        |state: &String| start.iter().find(|(name, _)| name == state).map_or(0.0, |it| it.1);
    let states = system.modes().swap_remove(0).states;
    let start: Vec<f64> = states.iter().map(value).collect();
    // Each simulation has the tolerances of the previous estimate.
    for _ in 0..SIMULATIONS {
        let seen = observed_scales(&scaled, &start, p);
        if *scaled.scales_mut() == seen {
            break;
        }
        *scaled.scales_mut() = seen;
    }
    (*scaled.scales_mut() != Scales::default()).then_some(scaled)
}
