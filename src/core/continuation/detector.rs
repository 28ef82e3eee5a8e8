//! Test functions at points of a curve, and which of them change sign between two points.

use super::curve::{CurvePoint, Interval};
use super::event::{Event, Tested};
use super::recorder::Recorded;
use crate::core::condition::{At, Failure, Quantity};
use crate::core::extended::Extended;
use crate::core::function::TestPoint;
use crate::core::test_function::Test;

/// Whether a sign changes.
pub(super) fn turns(before: Option<f64>, after: Option<f64>) -> bool {
    matches!((before, after), (Some(before), Some(after)) if before * after < 0.0)
}

/// The events that are looked for along a curve.
pub(super) struct Detector {
    pub events: Vec<Event>,
    /// Conditions whose values are test functions, one for each event that needs it.
    tested: Vec<Option<Tested>>,
}

impl Detector {
    pub fn new(events: Vec<Event>) -> Self {
        Detector { tested: events.iter().map(Event::tested).collect(), events }
    }

    /// States the conditions whose values are test functions at the start of a curve.
    pub fn start(&mut self, equations: &mut Extended) -> Result<(), Failure> {
        self.tested.iter_mut().flatten().try_for_each(|tested| tested.state(equations.at()))
    }

    /// Whether a test function needs the matrix of the very point.
    pub fn needs_matrix(&self) -> bool {
        self.tested.iter().flatten().any(|tested| tested.stated && tested.condition.assembles())
    }

    /// The position of the event that looks for branch points.
    pub fn branch_points(&self) -> Option<usize> {
        self.events.iter().position(|event| event.test == Test::BranchPoint)
    }

    /// Whether the branch point is passed between two points.
    pub fn passes_branch_point(&self, Interval { from, to, .. }: Interval) -> bool {
        self.branch_points().is_some_and(|index| turns(from.tests[index], to.tests[index]))
    }

    /// The values of the events' test functions at the point recorded, with its unknowns and
    /// tangent.
    pub fn values(
        &mut self,
        equations: &mut Extended,
        (unknowns, tangent): (&[f64], &[f64]),
        determinant: f64,
        recorded: &Recorded,
    ) -> Result<Vec<Option<f64>>, Failure> {
        let (n, first) = (equations.dimension(), equations.parameters_at());
        let asked = |test: Test| self.events.iter().any(|event| event.test == test);
        let leads = if asked(Test::Itinerary) { order_of_events(equations)? } else { None };
        let amplitude = || mirrored(equations, Test::Amplitude, unknowns);
        let amplitude = asked(Test::Amplitude).then(amplitude).flatten();
        let Recorded { point, spectrum, stability } = recorded;
        let orientation = equations.system().orientation();
        let stability = stability.map(|stability| stability.oriented(orientation));
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
                    Some(tested) => tested.value(equations.at())?,
                    None => None,
                },
                Test::Function => event.value(&TestPoint {
                    state: &equations.at().x[..n],
                    parameters: &point.parameters,
                    monitors: &point.monitors,
                    eigenvalues: spectrum.as_deref().unwrap_or_default(),
                }),
            });
        }
        Ok(tests)
    }

    /// The same point, seen in the other direction.
    pub fn reverse(&self, place: &mut CurvePoint) {
        place.tangent.iter_mut().for_each(|t| *t = -*t);
        for (test, event) in place.tests.iter_mut().zip(&self.events) {
            if event.test.is_odd() {
                *test = test.map(|test| -test);
            }
        }
    }

    /// Whether an event's change of sign between two points means nothing; `scale` is the size of a
    /// unit of the continued parameter, at this position.
    pub fn is_noise(
        &self,
        index: usize,
        Interval { from, to, .. }: Interval,
        (parameter, scale): (usize, f64),
    ) -> bool {
        let slopes = [from, to].map(|place| place.tangent[parameter] * scale);
        let same = from.point.unstable == to.point.unstable;
        let spectra = [from, to].map(|place| place.spectrum.as_ref());
        self.events[index].test.is_noise(slopes, same, spectra)
    }
}

/// Whether the orbit loaded has its events in the prescribed order, as a sign; `None` if solutions
/// have no events.
fn order_of_events(equations: &mut Extended) -> Result<Option<f64>, Failure> {
    let At { system, x, .. } = equations.at();
    match system.events().map(|events| events.check(x)) {
        None => Ok(None),
        Some(Ok(())) => Ok(Some(1.0)),
        Some(Err(failure @ Failure::OutOfDomain(_))) => Err(failure),
        Some(Err(_)) => Ok(Some(-1.0)),
    }
}

/// The value of a test function in which a curve is its own mirror image: an own unknown, or the
/// amplitude of a cycle.
pub(super) fn mirrored(equations: &mut Extended, test: Test, unknowns: &[f64]) -> Option<f64> {
    if let Some((unknown, level)) = test.own() {
        return Some(unknowns[equations.dimension() + unknown] - level);
    }
    let x = equations.load(unknowns).to_vec();
    equations.system().cycles()?.amplitude(&x)
}
