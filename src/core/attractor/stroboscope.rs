//! Hybrid systems looked at once in every period.

use super::error::StrobeError;
use super::period::{Period, Recorder};
use super::{Layout, Strobed};
use crate::core::field::Forcing;
use crate::core::hybrid::{HybridEquations, HybridFlow, HybridSettings, HybridState, Measure};
use num_dual::Dual64;

/// The motion of a hybrid system, looked at once in every period of its forcing.
///
/// ```
/// use tangency::core::attractor::{Settling, Strobed, Stroboscope};
/// use tangency::core::hybrid::{HybridSettings, HybridState};
/// use tangency::problems::classic::ImpactOscillator;
/// let mut oscillator = Stroboscope::of(&ImpactOscillator, HybridSettings::default(), &[])?;
/// // One impact in every period of the forcing, and what it is attracted with:
/// let p = [5.0, 2.2, 0.8, 0.1, 1.0];
/// let start = HybridState { mode: ImpactOscillator::FLIGHT, time: 0.0, x: vec![0.0, 0.0] };
/// let settled = Settling::default().follow(&mut oscillator, start, &p)?;
/// assert_eq!((settled.periods, settled.count("impact")), (Some(1), 1.0));
/// // Damping and restitution leave |μ|² = e² exp(−c·2π/ω).
/// let exact = (0.8_f64.powi(2) * (-0.1 * std::f64::consts::TAU / 2.2).exp()).ln() / 2.0;
/// assert!((settled.exponent.expect("an exponent").value - exact).abs() < 1e-9);
/// # Ok::<(), tangency::core::attractor::StrobeError>(())
/// ```
pub struct Stroboscope<'a> {
    real: HybridFlow<'a, f64>,
    dual: HybridFlow<'a, Dual64>,
    layout: Layout,
    /// Numbers of events by guard.
    numbers: Vec<usize>,
    measures: Vec<Measure>,
    tangent: HybridState<Dual64>,
    p: Vec<Dual64>,
}

impl<'a> Stroboscope<'a> {
    /// The motion of a system, of which these measures are taken: its own, and its
    /// [`penetration`](Measure::Penetration).
    ///
    /// # Errors
    /// [`StrobeError::NoMeasure`] if the system has no such measure, [`StrobeError::Hybrid`] if a setting has
    /// no meaning.
    pub fn of(
        system: &'a dyn HybridEquations,
        settings: HybridSettings,
        measures: &[String],
    ) -> Result<Self, StrobeError> {
        let mut known = system.measures();
        known.push((Measure::PENETRATION.into(), Measure::Penetration));
        let measure = |name: &String| {
            let found = known.iter().find(|(known, _)| known == name);
            found.map(|(_, measure)| measure.clone()).ok_or_else(|| StrobeError::NoMeasure {
                name: name.clone(),
                known: known.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", "),
            })
        };
        let (mut events, mut numbers) = (Vec::<String>::new(), Vec::new());
        for guard in system.guards() {
            let number = events.iter().position(|event| *event == guard.name);
            numbers.push(number.unwrap_or(events.len()));
            if number.is_none() {
                events.push(guard.name);
            }
        }
        Ok(Stroboscope {
            real: HybridFlow::new(system, settings)?,
            dual: HybridFlow::new(system, settings)?,
            layout: Layout { modes: system.modes(), events, measures: measures.to_vec() },
            numbers,
            measures: measures.iter().map(measure).collect::<Result<_, _>>()?,
            tangent: HybridState { mode: 0, time: Dual64::from(0.0), x: Vec::new() },
            p: Vec::new(),
        })
    }

    fn period(&self, p: &[f64]) -> Result<f64, StrobeError> {
        let system = self.real.system();
        match system.forcing() {
            Forcing::Periodic { .. } => Ok(system.period(p)),
            Forcing::None => Err(StrobeError::NoPeriod),
        }
    }
}

impl Strobed for Stroboscope<'_> {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn advance(&mut self, state: &mut HybridState<f64>, p: &[f64]) -> Result<(), StrobeError> {
        let (period, phase) = (self.period(p)?, state.time);
        self.real.advance(state, period, p, &mut ())?;
        // From the same time in every period: long times have fewer digits.
        state.time = phase;
        Ok(())
    }

    fn record(&mut self, state: &mut HybridState<f64>, p: &[f64]) -> Result<Period, StrobeError> {
        let (period, start) = (self.period(p)?, state.clone());
        let Stroboscope { real, layout, measures, numbers, .. } = self;
        let mut recorder = Recorder::new(real.system(), &layout.modes, measures, numbers, state);
        real.advance(state, period, p, &mut recorder)?;
        let recorded = recorder.finish(start, state, p);
        state.time = recorded.start.time;
        Ok(recorded)
    }

    fn push_forward(
        &mut self,
        state: &mut HybridState<f64>,
        tangent: &mut Vec<f64>,
        p: &[f64],
    ) -> Result<(), StrobeError> {
        let period = self.period(p)?;
        let Stroboscope { dual, tangent: moving, p: parameters, .. } = self;
        parameters.clear();
        parameters.extend(p.iter().map(|p| Dual64::from(*p)));
        (moving.mode, moving.time) = (state.mode, state.time.into());
        moving.x.clear();
        moving.x.extend(state.x.iter().zip(&*tangent).map(|(x, v)| Dual64::new(*x, *v)));
        dual.advance(moving, period.into(), parameters, &mut ())?;
        state.mode = moving.mode;
        state.x.clear();
        state.x.extend(moving.x.iter().map(|x| x.re));
        tangent.clear();
        tangent.extend(moving.x.iter().map(|x| x.eps));
        Ok(())
    }
}
