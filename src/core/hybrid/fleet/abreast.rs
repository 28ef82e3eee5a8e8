//! Batched integration steps of several motions, generic in the vector registers.

use crate::core::hybrid::erased::{EventNumber, FieldNumber, GuardNumber, HybridEquations};
use crate::core::hybrid::leg::GuardOf;
use crate::core::ode::{BatchStepper, EventForecast, LaneSteps, Settings};
use crate::core::scalar::{
    Avx2, Avx512, Baseline, DualLanes, InLanes, LaneWidth, MOST_LANES, Register, Scalar,
};

/// A scalar type for the simulation of many motions: `f64`, or `Dual64` with derivatives.
pub trait FleetNumber: EventNumber {
    /// Creates a batch of flows for an explicit method, in vector registers of a given width;
    /// `None` if the processor does not have these registers.
    fn abreast(width: LaneWidth, settings: &Settings) -> Option<Box<dyn Abreast<Self>>>;
}

impl<T: EventNumber> FleetNumber for T
where
    T: InLanes<Baseline, Wide: FieldNumber>
        + InLanes<Avx2, Wide: FieldNumber>
        + InLanes<Avx512, Wide: FieldNumber>,
{
    fn abreast(width: LaneWidth, settings: &Settings) -> Option<Box<dyn Abreast<T>>> {
        Some(match width {
            LaneWidth::Baseline => Box::new(BatchStepper::<T, Baseline>::new(settings)?),
            LaneWidth::Avx2 => Box::new(BatchStepper::<T, Avx2>::new(settings)?),
            LaneWidth::Avx512 => Box::new(BatchStepper::<T, Avx512>::new(settings)?),
        })
    }
}

/// A batch of flows that are computed together, each in a mode of a hybrid system.
pub trait Abreast<T>: LaneSteps<T> {
    /// Tries an integration step of the flows in the lanes, all in one mode. Returns the error of
    /// each flow, in units of the tolerance, and writes the forecasts of the zeros of guards into
    /// `forecasts`.
    fn attempt(
        &mut self,
        system: (&dyn HybridEquations, usize),
        guards: &[usize],
        settings: &Settings,
        forecasts: &mut Vec<EventForecast>,
    ) -> [f64; MOST_LANES];
}

impl<T: InLanes<R, Wide: FieldNumber>, R: Register> Abreast<T> for BatchStepper<T, R>
where
    DualLanes<R>: GuardNumber,
{
    fn attempt(
        &mut self,
        (system, mode): (&dyn HybridEquations, usize),
        guards: &[usize],
        settings: &Settings,
        forecasts: &mut Vec<EventForecast>,
    ) -> [f64; MOST_LANES] {
        let field = T::Wide::in_mode(system, mode, T::Wide::constant(0.0));
        let errors = BatchStepper::attempt(self, &field, settings);
        forecasts.clear();
        forecasts.extend(
            guards
                .iter()
                .map(|guard| self.forecast(&GuardOf { system, guard: *guard, mode, scale: 1.0 })),
        );
        errors
    }
}
