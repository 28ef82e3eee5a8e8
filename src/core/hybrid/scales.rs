//! What tolerances of a hybrid motion are relative to.

use super::erased::HybridEquations;
use super::system::Mode;
use crate::core::field::Forcing;
use num_dual::Dual64;

/// The scales of a hybrid system: typical sizes of times and states, by order of magnitude. Tolerances are relative to
/// them, so that a device of micrometres and microseconds may be stated in metres and seconds.
///
/// ```
/// use tangency::core::hybrid::Scales;
/// let scales = Scales::default().time(1e-6).state("displacement", 1e-9).state("velocity", 1e-3);
/// assert_eq!((scales.time, scales.states.len()), (Some(1e-6), 2));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scales {
    /// The scale of time; by default that in which the phase of the forcing grows by 1, where it is far from 1.
    pub time: Option<f64>,
    /// Scales of states by name; 1 by default.
    pub states: Vec<(String, f64)>,
}

impl Scales {
    /// Sets the scale of time.
    pub fn time(mut self, scale: f64) -> Self {
        self.time = Some(scale);
        self
    }

    /// Sets the scale of a state.
    pub fn state(mut self, name: impl Into<String>, scale: f64) -> Self {
        self.states.push((name.into(), scale));
        self
    }

    /// The scales of the states of a mode; none if all are 1.
    fn of_mode(&self, mode: &Mode) -> Vec<f64> {
        if self.states.is_empty() {
            return Vec::new();
        }
        let scale = |state: &String| {
            let known = self.states.iter().find(|(name, _)| name == state);
            known.map_or(1.0, |(_, scale)| *scale)
        };
        mode.states.iter().map(scale).collect()
    }
}

/// A scale of time that is not stated is 1 if the forcing's lies within this range: tolerances need no more than an
/// order of magnitude.
const USUAL: std::ops::RangeInclusive<f64> = 1e-2..=1e2;

/// The scale of time of a system.
pub(crate) fn time_scale(system: &dyn HybridEquations, p: &[f64]) -> f64 {
    let of_forcing = || match system.forcing() {
        Forcing::None => 1.0,
        Forcing::Periodic { phase } => system.period(p) / phase,
    };
    let usable = |scale: &f64| scale.is_finite() && *scale > 0.0;
    let unstated = || Some(of_forcing()).filter(|scale| usable(scale) && !USUAL.contains(scale));
    system.scales(p).time.filter(usable).or_else(unstated).unwrap_or(1.0)
}

/// The scales of the states of a mode; none if all are 1.
pub(super) fn state_scales(system: &dyn HybridEquations, mode: usize, p: &[f64]) -> Vec<f64> {
    let scales = system.scales(p);
    if scales.states.is_empty() { Vec::new() } else { scales.of_mode(&system.modes()[mode]) }
}

/// The scale of a guard at a place: how much it changes as time and states change by theirs.
pub(crate) fn guard_scale(
    system: &dyn HybridEquations,
    (guard, mode): (usize, usize),
    (t, x): (f64, &[f64]),
    p: &[f64],
) -> f64 {
    let (time, mut states) = (time_scale(system, p), state_scales(system, mode, p));
    if time == 1.0 && states.is_empty() {
        return 1.0;
    }
    states.resize(x.len(), 1.0);
    let [fixed_x, p] = [x, p].map(|v| v.iter().map(|v| Dual64::from(*v)).collect::<Vec<_>>());
    let change = |t: Dual64, x: &[Dual64]| system.guard(guard, mode, t, x, &p).eps.abs();
    let mut scale = time * change(Dual64::from(t).derivative(), &fixed_x);
    for (i, state) in states.iter().enumerate() {
        let mut x = fixed_x.clone();
        x[i] = x[i].derivative();
        scale += state * change(t.into(), &x);
    }
    if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
}
