//! The stroboscopic maps of Mita's actuator, without impacts and with one impact per period, in any
//! scalar type.

use nalgebra::{Matrix2, Vector2};
use num_dual::Dual;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use tangency::core::failure::one_line;
use tangency::core::hybrid::{
    EventNumber, GuardOf, HybridFlow, HybridSettings, HybridState, InMode,
};
use tangency::core::ode::{Extrema, Flow, Scheme, Settings};
use tangency::core::problem::{State, Watchable};
use tangency::core::scalar::Scalar;
use tangency::problems::mita::Actuator;

/// The period of the forcing at ω = 0.5.
pub(super) const PERIOD: f64 = TAU;

/// The number of forcing periods after which the motion from rest is close to its attractor.
const TRANSIENT: usize = 150;

/// The vector field of the mode in which the frame sticks.
const STICK: InMode<Actuator> = InMode { system: &Actuator, mode: Actuator::STICK };

/// The parameters of Mita's actuator.
pub(super) type Parameters<T = f64> = [T; Actuator::DEFAULTS.len()];

/// Returns the parameters of Mita's actuator at a voltage, for ω = 0.5.
pub(super) const fn parameters(voltage: f64) -> Parameters {
    let mut p = Actuator::DEFAULTS;
    p[0] = voltage;
    p
}

/// The stroboscopic map over one forcing period; the two components of its state are the
/// displacement and the velocity, since the frame sticks at the times of sampling.
#[derive(Clone, Copy)]
pub(super) struct Period<T = f64> {
    /// Whether the actuator has a stopper, which causes impacts and slip phases.
    pub impacts: bool,
    pub p: Parameters<T>,
    /// The tolerance of the integration.
    pub tolerance: f64,
}

impl<T: Scalar> Period<T> {
    /// Returns a copy of the map with other parameters.
    pub fn at<U: Scalar>(self, p: Parameters<U>) -> Period<U> {
        Period { impacts: self.impacts, p, tolerance: self.tolerance }
    }
}

impl<T: EventNumber> Period<T>
where
    GuardOf<'static>: Watchable<T>,
{
    /// Returns the image of a state after one forcing period.
    pub fn image(self, x: [T; 2]) -> Result<Vector2<T>, String> {
        let flow = Settings::new(Scheme::DormandPrince8, self.tolerance);
        let (mut x, p, begin, period) = (x.to_vec(), self.p, T::zero(), T::constant(PERIOD));
        if self.impacts {
            let settings = HybridSettings { flow, ..HybridSettings::default() };
            let mut flow = HybridFlow::new(&Actuator, settings).map_err(|e| one_line(&e))?;
            let mut state = HybridState { mode: Actuator::STICK, time: begin, x };
            let advanced = flow.advance(&mut state, period, &p, &mut ());
            advanced.map_err(|cause| one_line(&cause))?;
            x = state.x;
        } else {
            let mut flow = Flow::<T>::new(flow).map_err(|cause| one_line(&cause))?;
            let advanced = flow.advance(&STICK, begin, period, &mut x, &p);
            advanced.map_err(|cause| one_line(&cause))?;
        }
        match x[..] {
            [displacement, velocity] => Ok(Vector2::new(displacement, velocity)),
            _ => Err("the frame slips at the end of the period".into()),
        }
    }
}

impl<T: Scalar> Period<T>
where
    Dual<T>: EventNumber,
    GuardOf<'static>: Watchable<Dual<T>>,
{
    /// Computes the Jacobian matrix of the map with respect to the state, by dual numbers.
    pub fn derivative(self, x: [T; 2]) -> Result<Matrix2<T>, String> {
        let wide = self.at(self.p.map(Dual::from_re));
        let column = |k: usize| {
            let mut x = x.map(Dual::from_re);
            x[k] = x[k].derivative();
            Ok(wide.image(x)?.map(|image| image.eps))
        };
        let columns: Result<Vec<Vector2<T>>, String> = (0..2).map(column).collect();
        Ok(Matrix2::from_columns(&columns?))
    }
}

impl Period {
    /// Returns the approximate state to which the motion from rest converges.
    pub fn settled(self) -> Result<[f64; 2], String> {
        let mut x = Vector2::zeros();
        for _ in 0..TRANSIENT {
            x = Period { tolerance: 1e-6, ..self }.image(x.into())?;
        }
        self.fixed_point(x.into())
    }

    /// Computes the fixed point of the map near a given state, by Newton's method.
    pub fn fixed_point(self, near: [f64; 2]) -> Result<[f64; 2], String> {
        let mut x = Vector2::from(near);
        for _ in 0..20 {
            let miss = self.image(x.into())? - x;
            let matrix = self.derivative(x.into())? - Matrix2::identity();
            let step = matrix.lu().solve(&miss).ok_or("the orbit has the multiplier 1")?;
            x -= step;
            if step.norm() < 1e-11_f64.max(self.tolerance) {
                return Ok(x.into());
            }
        }
        Err(format!("Newton's method finds no orbit at the voltage {}", self.p[0]))
    }

    /// Returns the largest displacement, without the stopper, of the motion that begins in a given
    /// state and lasts one period: the exact maximum, or the maximum over a mesh with a given
    /// number of intervals.
    pub fn largest(self, x: [f64; 2], mesh: Option<usize>) -> Result<f64, String> {
        let settings = Settings::new(Scheme::DormandPrince8, self.tolerance);
        let mut flow = Flow::<f64>::new(settings).map_err(|cause| one_line(&cause))?;
        let (mut extrema, mut most) = (Extrema::default(), f64::NEG_INFINITY);
        let (mut x, mut between) = (x.to_vec(), [0.0; 2]);
        let flowed = flow.observe(&STICK, 0.0, PERIOD, &mut x, &self.p, |step| {
            match mesh {
                None => extrema.search(&State(0), step, |found| most = most.max(found.value)),
                Some(parts) => {
                    let ((start, end), n) = (step.span(), parts as f64);
                    for k in (start * n).ceil() as usize..=(end * n).floor() as usize {
                        let fraction = (k as f64 / n - start) / (end - start);
                        step.interpolate(fraction, &mut between);
                        most = most.max(between[0]);
                    }
                }
            }
            ControlFlow::Continue(())
        });
        flowed.map_err(|cause| one_line(&cause))?;
        Ok(most)
    }
}
