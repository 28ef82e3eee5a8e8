//! Values of test functions at points of a curve.

use super::Point;
use super::stepper::{Place, Stepper};
use crate::core::condition::{At, Failure, Quantity};
use crate::core::function::TestPoint;
use crate::core::motion::Stability;
use crate::core::test_function::Test;
use crate::core::zero::Spectrum;

/// Whether a sign changes.
pub(super) fn turns(before: Option<f64>, after: Option<f64>) -> bool {
    matches!((before, after), (Some(before), Some(after)) if before * after < 0.0)
}

impl Stepper<'_> {
    /// The event that looks for branch points.
    pub fn branch_points(&self) -> Option<usize> {
        self.events.iter().position(|event| event.test == Test::BranchPoint)
    }

    /// The values of the events' test functions at the point recorded.
    pub fn tests(
        &mut self,
        unknowns: &[f64],
        tangent: &[f64],
        determinant: f64,
        spectrum: Option<&Spectrum>,
        point: &Point,
    ) -> Result<Vec<Option<f64>>, Failure> {
        let (n, first) = (self.equations.dimension(), self.equations.parameters_at());
        let leads = self.leads()?;
        let system = self.equations.system();
        let (dynamics, orientation) = (system.dynamics(), system.orientation());
        let stability = spectrum.map(|all| Stability::of(dynamics, all).oriented(orientation));
        let amplitude = self.amplitude(unknowns);
        let mut tests = Vec::with_capacity(self.events.len());
        for (event, tested) in self.events.iter().zip(&mut self.tested) {
            tests.push(match event.test {
                Test::Fold => Some(tangent[first]),
                Test::BranchPoint => Some(determinant),
                Test::Hopf => stability.map(|stability| stability.oscillation),
                Test::PeriodDoubling => stability.map(|stability| stability.doubling),
                Test::Level(Quantity::Parameter(p), level) => Some(point.parameters[p] - level),
                Test::Level(Quantity::Monitor(m), level) => {
                    Some(point.monitors[m] - level).filter(|value| !value.is_nan())
                }
                Test::Own { unknown, level } => Some(unknowns[n + unknown] - level),
                Test::Amplitude => amplitude,
                Test::Itinerary => leads,
                Test::Condition => match tested {
                    Some(tested) => tested.value(self.equations.at())?,
                    None => None,
                },
                Test::Function => event.value(&TestPoint {
                    state: &self.equations.at().x[..n],
                    parameters: &point.parameters,
                    monitors: &point.monitors,
                    eigenvalues: spectrum.map_or(&[], |all| all),
                }),
            });
        }
        Ok(tests)
    }

    /// Whether events lead on at the point recorded, as a sign, if an event asks for it.
    fn leads(&mut self) -> Result<Option<f64>, Failure> {
        let asked = self.events.iter().any(|event| event.test == Test::Itinerary);
        let At { system, x, .. } = self.equations.at();
        match system.events().filter(|_| asked).map(|events| events.check(x)) {
            None => Ok(None),
            Some(Ok(())) => Ok(Some(1.0)),
            Some(Err(failure @ Failure::OutOfDomain(_))) => Err(failure),
            Some(Err(_)) => Ok(Some(-1.0)),
        }
    }

    /// The oscillation of a cycle, if an event asks for it.
    fn amplitude(&mut self, unknowns: &[f64]) -> Option<f64> {
        let asked = self.events.iter().any(|event| event.test == Test::Amplitude);
        asked.then(|| self.mirrored(Test::Amplitude, unknowns)).flatten()
    }

    /// The value of a test function in which a curve is its own mirror image: an own unknown, or
    /// the amplitude.
    pub fn mirrored(&mut self, test: Test, unknowns: &[f64]) -> Option<f64> {
        if let Some((unknown, level)) = test.own() {
            return Some(unknowns[self.equations.dimension() + unknown] - level);
        }
        let x = self.equations.load(unknowns).to_vec();
        self.equations.system().cycles()?.amplitude(&x)
    }

    /// The value of a smooth function with the zeros of a test function, where one is known.
    pub fn smooth_test(&mut self, index: usize, place: &Place) -> Option<f64> {
        let test = self.events[index].test;
        let dynamics = self.equations.system().dynamics();
        test.smooth(place.tests[index], place.spectrum.as_ref(), dynamics)
    }
}
