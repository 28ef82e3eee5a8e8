//! Stroboscopic maps of hybrid systems under forcing.

use super::error::StroboscopicError;
use super::period::{Layout, Period, Recorder, Seen};
use super::stroboscopic::{EachPeriod, EachTangent, Outcomes, StroboscopicMap};
use crate::core::hybrid::{
    Event, EventNumber, Fleet, FleetObserver, HybridEquations, HybridFlow, HybridObserver,
    HybridSettings, HybridState, HybridStatistics, Member,
};
use crate::core::ode::Step;
use crate::core::problem::{FieldIn, Forcing};
use num_dual::Dual64;
use std::ops::ControlFlow;

/// The motion of a hybrid system, sampled once every forcing period.
///
/// A [`Fleet`] simulates many trajectories in parallel.
///
/// ```
/// use tangency::core::attractor::{AttractorSearch, StroboscopicMap, PeriodMap};
/// use tangency::core::hybrid::{HybridSettings, HybridState};
/// use tangency::problems::classic::ImpactOscillator;
/// let mut oscillator = PeriodMap::of(&ImpactOscillator, HybridSettings::default(), &[])?;
/// // One impact per forcing period, and the Lyapunov exponent:
/// let p = [5.0, 2.2, 0.8, 0.1, 1.0];
/// let start = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 0.0] };
/// let settled = AttractorSearch::default().follow(&mut oscillator, start, &p)?;
/// assert_eq!((settled.periods, settled.count("impact")), (Some(1), 1.0));
/// // Damping and restitution give |μ|² = e² exp(−c·2π/ω).
/// let exact = (0.8_f64.powi(2) * (-0.1 * std::f64::consts::TAU / 2.2).exp()).ln() / 2.0;
/// assert!((settled.exponent.expect("an exponent").value - exact).abs() < 1e-9);
/// # Ok::<(), tangency::core::attractor::StroboscopicError>(())
/// ```
pub struct PeriodMap<'a> {
    real: HybridFlow<'a, f64>,
    dual: HybridFlow<'a, Dual64>,
    fleet: Fleet<'a, f64>,
    dual_fleet: Fleet<'a, Dual64>,
    seen: Seen<'a>,
}

impl<'a> PeriodMap<'a> {
    /// Creates the map of a system that records the named measures: measures of the system, or
    /// [`penetration`](crate::core::problem::Measure::Penetration).
    ///
    /// # Errors
    /// [`StroboscopicError::NoMeasure`] if the system has no measure of a given name, or if a
    /// measure refers to a scalar that the system does not have; [`StroboscopicError::Hybrid`] if a
    /// setting is invalid.
    pub fn of(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
        measures: &[String],
    ) -> Result<Self, StroboscopicError> {
        let seen = Seen::of(system, measures)?;
        Ok(PeriodMap {
            real: HybridFlow::new(system, settings.clone())?,
            dual: HybridFlow::new(system, settings.clone())?,
            fleet: Fleet::new(system, settings.clone())?,
            dual_fleet: Fleet::new(system, settings)?,
            seen,
        })
    }
}

/// Returns the period of the forcing.
fn period<T: EventNumber>(system: &dyn HybridEquations, p: &[T]) -> Result<T, StroboscopicError> {
    match system.forcing() {
        Forcing::Periodic { .. } => Ok(system.period(p)),
        Forcing::None => Err(StroboscopicError::NoPeriod),
    }
}

impl StroboscopicMap for PeriodMap<'_> {
    fn layout(&self) -> &Layout {
        &self.seen.layout
    }

    fn initial(&self, state: HybridState<f64>, p: &[f64]) -> HybridState<f64> {
        self.real.initial(state, p)
    }

    fn scales(&self, mode: usize, p: &[f64]) -> Vec<f64> {
        self.seen.system.scales_of(mode, p)
    }

    fn advance(&mut self, Member { state, p }: &mut Member<f64>) -> Result<(), StroboscopicError> {
        let (period, phase) = (period(self.seen.system, p)?, state.time);
        self.real.advance(state, period, p, &mut ())?;
        // Time restarts at the same value in every period, because large times lose digits.
        state.time = phase;
        Ok(())
    }

    fn record(&mut self, member: &mut Member<f64>) -> Result<Period, StroboscopicError> {
        let Member { state, p } = member;
        let period = period(self.seen.system, p)?;
        let PeriodMap { real, seen, .. } = self;
        let mut recorder = Recorder::new(seen, state);
        real.advance(state, period, p, &mut recorder)?;
        let recorded = recorder.finish(state, p);
        state.time = recorded.start.time;
        Ok(recorded)
    }

    fn push_forward(&mut self, member: &mut Member<Dual64>) -> Result<(), StroboscopicError> {
        let Member { state, p } = member;
        let (period, phase) = (period(self.seen.system, p)?, state.time);
        self.dual.advance(state, period, p, &mut ())?;
        state.time = phase;
        Ok(())
    }

    fn advance_all(
        &mut self,
        members: &mut [Member<f64>],
        recorded: bool,
        each: &mut EachPeriod,
    ) -> Outcomes {
        if self.seen.system.forcing() == Forcing::None {
            return members.iter().map(|_| Err(StroboscopicError::NoPeriod)).collect();
        }
        let PeriodMap { fleet, seen, .. } = self;
        let sample = |Member { state, p }: &Member<f64>| Sampled {
            phase: state.time,
            p: p.clone(),
            recorder: recorded.then(|| Recorder::new(seen, state)),
        };
        let sees_steps = recorded && !seen.measures.is_empty();
        let sampled = members.iter().map(sample).collect();
        let mut sampler = Sampler { seen, sees_steps, sampled, each };
        let period = |member: &Member<f64>| seen.system.period(&member.p);
        let results = fleet.advance(members, period, &mut sampler);
        results.into_iter().map(|result| Ok(result?)).collect()
    }

    fn push_forward_all(
        &mut self,
        members: &mut [Member<Dual64>],
        each: &mut EachTangent,
    ) -> Outcomes {
        let system = self.seen.system;
        if system.forcing() == Forcing::None {
            return members.iter().map(|_| Err(StroboscopicError::NoPeriod)).collect();
        }
        let phases = members.iter().map(|member| member.state.time).collect();
        let period = |member: &Member<Dual64>| system.period(&member.p);
        let results =
            self.dual_fleet.advance(members, period, &mut TangentSampler { phases, each });
        results.into_iter().map(|result| Ok(result?)).collect()
    }
}

/// A trajectory in the fleet during a forcing period.
struct Sampled<'a> {
    /// The time at which each period begins.
    phase: f64,
    p: Vec<f64>,
    recorder: Option<Recorder<'a>>,
}

/// An observer of the periods of many trajectories.
struct Sampler<'a, 'e> {
    seen: &'a Seen<'a>,
    /// Whether a measure must be updated in every integration step.
    sees_steps: bool,
    sampled: Vec<Sampled<'a>>,
    each: &'e mut EachPeriod<'e>,
}

impl FleetObserver<f64> for Sampler<'_, '_> {
    fn sees_steps(&self) -> bool {
        self.sees_steps
    }

    fn step<F: FieldIn<f64>>(
        &mut self,
        member: usize,
        mode: usize,
        step: &mut Step<F, f64>,
        end: f64,
    ) {
        if let Some(recorder) = &mut self.sampled[member].recorder {
            recorder.step(mode, step, end);
        }
    }

    fn event(&mut self, member: usize, event: &Event<f64>) {
        if let Some(recorder) = &mut self.sampled[member].recorder {
            // A recorder never ends the motion.
            let _ = recorder.event(event);
        }
    }

    fn arrived(
        &mut self,
        member: usize,
        state: &mut HybridState<f64>,
        _statistics: &HybridStatistics,
    ) -> ControlFlow<()> {
        let Sampled { phase, p, recorder } = &mut self.sampled[member];
        let period = recorder.take().map(|recorder| recorder.finish(state, p));
        state.time = *phase;
        *recorder = period.as_ref().map(|_| Recorder::new(self.seen, state));
        (self.each)(member, period, state)
    }
}

/// An observer of the tangent vectors of many trajectories.
struct TangentSampler<'e> {
    phases: Vec<Dual64>,
    each: &'e mut EachTangent<'e>,
}

impl FleetObserver<Dual64> for TangentSampler<'_> {
    fn arrived(
        &mut self,
        member: usize,
        state: &mut HybridState<Dual64>,
        _statistics: &HybridStatistics,
    ) -> ControlFlow<()> {
        state.time = self.phases[member];
        (self.each)(member, state)
    }
}
