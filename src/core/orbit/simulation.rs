//! Periodic motions found by simulation: starts for branches of stable orbits.
//!
//! A trajectory is followed past its transient until it repeats. Under a forcing of period `T` it is looked
//! at once in every period, `x(kT)`. Without forcing it is looked at on a section through the point where the
//! transient ended, across the motion there,
//!
//! ```text
//!     ⟨f(x₀), x − x₀⟩ = 0,  growing,
//! ```
//!
//! and the time of return is the period. Where a motion does not return to the point itself within
//! some crossings, a section is laid through the last of them: transients go on dying out meanwhile.

use crate::core::bvp::{BoundarySystem, Method, Number};
use crate::core::field::{Forcing, VectorField};
use crate::core::flow::{Flow, FlowError, Settings, SettingsError, Step};
use crate::core::scalar_field::FieldIn;
use std::ops::ControlFlow;

/// How long a simulation may last, and when it has settled.
///
/// ```
/// use tangency::core::orbit::Simulation;
/// let patient = Simulation { transient: 1000.0, ..Simulation::default() };
/// assert!(patient.tolerance == 1e-6 && patient.returns == 1000);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simulation {
    /// The duration of the transient, before which nothing is looked at.
    pub transient: f64,
    /// A motion repeats when it comes back this near to its start, in units of its diameter: correction
    /// does the rest.
    pub tolerance: f64,
    /// The largest number of returns, or periods of the forcing.
    pub returns: usize,
    /// The longest time to wait for a return; the forcing's period needs no bound.
    pub longest: f64,
    /// The flow's settings.
    pub flow: Settings,
}

impl Default for Simulation {
    /// A transient of 100, 1000 returns, each within a time of 1000, and a tolerance of 1e-6.
    fn default() -> Self {
        let flow = Settings::default();
        Simulation { transient: 100.0, tolerance: 1e-6, returns: 1000, longest: 1000.0, flow }
    }
}

/// A motion that repeats itself.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodicMotion {
    /// A state on it; the one at time 0 (modulo the period) where there is forcing.
    pub state: Vec<f64>,
    /// Its period.
    pub period: f64,
    /// How near it came back, in units of its diameter.
    pub distance: f64,
}

/// Why a simulation has found no periodic motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// A state or parameters of another length than the field's.
    #[error("{found} {what} are given, but the field has {expected}")]
    Length {
        /// What is given: `states` or `parameters`.
        what: &'static str,
        /// How many.
        found: usize,
        /// How many there are.
        expected: usize,
    },
    /// The trajectory ends.
    #[error("the simulation ends: {0}")]
    Flow(#[from] FlowError),
    /// The flow's settings have no meaning.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The trajectory does not repeat.
    #[error(
        "the motion has not repeated in {returns} returns: it came as near as {distance:.1e} of its diameter \
         where {tolerance:.1e} was asked for; simulate longer, or elsewhere if it is not periodic"
    )]
    Unsettled {
        /// The number of returns.
        returns: usize,
        /// The smallest distance, in units of the diameter.
        distance: f64,
        /// The distance asked for.
        tolerance: f64,
    },
    /// The trajectory does not come back to a section across it.
    #[error(
        "the motion has not come back within a time of {longest}: it has settled on an equilibrium, or leaves"
    )]
    NoReturn {
        /// The time waited.
        longest: f64,
    },
}

/// Crossings of one section before another is laid: motions that repeat after so many turns are found.
const CROSSINGS: usize = 16;

impl Simulation {
    /// Follows a field from a state at time 0 until its motion repeats.
    ///
    /// ```
    /// use tangency::core::orbit::Simulation;
    /// use tangency::problems::classic::Lure;
    /// let motion = Simulation::default().follow(&Lure, &[0.1, 0.0, 0.0], &[0.8, 1.0])?;
    /// assert!((motion.period - 6.3).abs() < 0.1 && motion.distance < 1e-6);
    /// # Ok::<(), tangency::core::orbit::SimulationError>(())
    /// ```
    ///
    /// # Errors
    /// [`SimulationError`] if the trajectory ends, does not return, or does not repeat.
    pub fn follow<F: VectorField>(
        &self,
        field: &F,
        start: &[f64],
        p: &[f64],
    ) -> Result<PeriodicMotion, SimulationError> {
        let names = field.names();
        let lengths = [
            ("states", start.len(), names.dimension()),
            ("parameters", p.len(), names.parameters.len()),
        ];
        if let Some(&(what, found, expected)) = lengths.iter().find(|l| l.1 != l.2) {
            return Err(SimulationError::Length { what, found, expected });
        }
        let mut run = Run { field, p, flow: Flow::new(self.flow)?, simulation: self };
        let period = match field.forcing() {
            Forcing::Periodic { .. } => Some(field.period(p)),
            Forcing::None => None,
        };
        run.follow(start, period)
    }
}

/// A simulation under way.
struct Run<'a, F> {
    field: &'a F,
    p: &'a [f64],
    flow: Flow<f64>,
    simulation: &'a Simulation,
}

/// A crossing of a section.
struct Crossing {
    time: f64,
    state: Vec<f64>,
    /// The distance from the section's base, in units of the trajectory's diameter.
    distance: f64,
}

impl<F: FieldIn<f64>> Run<'_, F> {
    fn follow(
        &mut self,
        start: &[f64],
        period: Option<f64>,
    ) -> Result<PeriodicMotion, SimulationError> {
        match period {
            Some(period) => self.strobed(start, period),
            None => self.returning(start),
        }
    }

    /// Looks at the trajectory once in every period of the forcing.
    fn strobed(&mut self, start: &[f64], period: f64) -> Result<PeriodicMotion, SimulationError> {
        let Simulation { transient, tolerance, returns, .. } = *self.simulation;
        let mut x = start.to_vec();
        let mut nearest = f64::INFINITY;
        let skipped = (transient / period).max(0.0) as usize;
        for k in 0..skipped.saturating_add(returns) {
            let before = x.clone();
            let mut diameter = 0.0_f64;
            self.flow.observe(self.field, 0.0, period, &mut x, self.p, |step| {
                diameter = diameter.max(distance(step.end(), &before));
                ControlFlow::Continue(())
            })?;
            let distance = distance(&x, &before) / diameter.max(f64::MIN_POSITIVE);
            nearest = nearest.min(distance);
            if k >= skipped && distance <= tolerance {
                return Ok(PeriodicMotion { state: x, period, distance });
            }
        }
        Err(SimulationError::Unsettled { returns, distance: nearest, tolerance })
    }

    /// Looks at the trajectory where it returns to sections across it.
    fn returning(&mut self, start: &[f64]) -> Result<PeriodicMotion, SimulationError> {
        let Simulation { transient, tolerance, returns, .. } = *self.simulation;
        let mut x = start.to_vec();
        self.flow.advance(self.field, 0.0, transient, &mut x, self.p)?;
        let mut nearest = f64::INFINITY;
        let mut left = returns;
        while left > 0 {
            let most = CROSSINGS.min(left);
            let crossing = self.cross(&x, most)?;
            left -= most;
            nearest = nearest.min(crossing.distance);
            x = crossing.state;
            if crossing.distance <= tolerance {
                return Ok(PeriodicMotion {
                    state: x,
                    period: crossing.time,
                    distance: crossing.distance,
                });
            }
        }
        Err(SimulationError::Unsettled { returns, distance: nearest, tolerance })
    }

    /// The first crossing of the section through a point that comes near enough to it, or the last one
    /// of so many.
    fn cross(&mut self, base: &[f64], most: usize) -> Result<Crossing, SimulationError> {
        let Simulation { tolerance, longest, .. } = *self.simulation;
        let mut normal = vec![0.0; base.len()];
        self.field.slope(0.0, base, self.p, &mut normal);
        let height = |x: &[f64]| -> f64 {
            x.iter().zip(base).zip(&normal).map(|((x, b), n)| (x - b) * n).sum()
        };
        let (mut x, mut before, mut diameter, mut count) = (base.to_vec(), 0.0, 0.0_f64, 0);
        let mut found: Option<Crossing> = None;
        let length = longest * most as f64;
        self.flow.observe(self.field, 0.0, length, &mut x, self.p, |step| {
            diameter = diameter.max(distance(step.end(), base));
            let after = height(step.end());
            let crosses = before < 0.0 && after >= 0.0;
            before = after;
            if crosses {
                count += 1;
                let (time, state) = crossing_in(step, &height);
                let distance = distance(&state, base) / diameter.max(f64::MIN_POSITIVE);
                found = Some(Crossing { time, state, distance });
                if distance <= tolerance || count == most {
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        })?;
        found.ok_or(SimulationError::NoReturn { longest: length })
    }
}

/// Where a height, negative at the start of a step and not so at its end, vanishes: time and state. States
/// are those of shorter steps of the method, so that both have the accuracy of the flow.
fn crossing_in<F: FieldIn<f64>>(
    step: &mut Step<F, f64>,
    height: &impl Fn(&[f64]) -> f64,
) -> (f64, Vec<f64>) {
    let (mut low, mut high) = ((0.0, height(step.start())), (1.0, height(step.end())));
    let mut x = step.end().to_vec();
    let mut place = 1.0;
    // Illinois' variant of the false position (M. Dowell and P. Jarratt, 1971).
    for _ in 0..60 {
        let next: f64 = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
        let settled = !next.is_finite() || (next - place).abs() <= 4.0 * f64::EPSILON;
        if settled {
            break;
        }
        place = next;
        step.state(place, &mut x);
        let value = height(&x);
        if (value < 0.0) == (high.1 < 0.0) {
            low.1 *= 0.5;
        } else {
            low = high;
        }
        high = (place, value);
    }
    (step.time(place), x)
}

/// The Euclidean distance of two states.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

impl<M: Method> BoundarySystem<M> {
    /// The unknowns `z` of a stable orbit, found by simulation from a state (at time 0): a start for a
    /// branch.
    ///
    /// ```
    /// use tangency::core::bvp::Collocation;
    /// use tangency::core::continuation::Continuation;
    /// use tangency::core::orbit::{Simulation, by_collocation};
    /// use tangency::problems::classic::Lure;
    /// let mut orbits = by_collocation(Lure, 20, Collocation::new(4)?)?;
    /// let z = orbits.simulated(&Simulation::default(), &[0.1, 0.0, 0.0], &[0.8, 1.0])?;
    /// let branch = Continuation::of(&mut orbits)
    ///     .from(&z)
    ///     .at("alpha", 0.8)
    ///     .at("beta", 1.0)
    ///     .along("alpha", 0.75..=0.85)
    ///     .trace()?;
    /// assert!(branch.points.iter().all(|point| point.unstable == Some(0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Simulation::follow`].
    pub fn simulated(
        &self,
        simulation: &Simulation,
        start: &[f64],
        p: &[f64],
    ) -> Result<Vec<f64>, SimulationError> {
        let autonomous = self.problem().phase();
        let q = [p, if autonomous { &[0.0][..] } else { &[] }].concat();
        let equations = f64::residual(&**self.problem());
        let (field, forcing) = (&equations.on_segment(0, &q), equations.duration_in(0, &q));
        let p = &q[..];
        let mut run = Run { field, p, flow: Flow::new(simulation.flow)?, simulation };
        let PeriodicMotion { state, period, .. } =
            run.follow(start, (!autonomous).then_some(forcing))?;
        let extras: &[f64] = if autonomous { &[period] } else { &[] };
        let mut flow = Flow::new(simulation.flow)?;
        let (mut x, mut place, mut outcome) = (state.clone(), 0.0, Ok(()));
        let z = self.sampled(extras, |_, tau, out| {
            if tau < place {
                x.copy_from_slice(&state);
                place = 0.0;
            }
            if tau > place && outcome.is_ok() {
                let (t, length) = (place * period, (tau - place) * period);
                outcome = flow.advance(field, t, length, &mut x, p).map(|_| ());
                place = tau;
            }
            out.copy_from_slice(&x);
        });
        outcome?;
        Ok(z)
    }
}
