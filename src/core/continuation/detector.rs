//! Test functions at points of a curve, and which of them change sign between two points.

use super::curve::{CurvePoint, Interval};
use super::event::{Event, Tested};
use super::extended::Extended;
use super::function::TestPoint;
use super::recorder::Recorded;
use crate::core::bifurcation::{Sight, Test};
use crate::core::failure::Failure;

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
        let Recorded { point, spectrum, stability } = recorded;
        let orientation = equations.system().orientation();
        let stability = stability.map(|stability| stability.oriented(orientation));
        let mut tests = Vec::with_capacity(self.events.len());
        for (event, tested) in self.events.iter().zip(&mut self.tested) {
            tests.push(match (tested, &event.function) {
                (Some(tested), _) => tested.value(equations.at())?,
                (None, Some(function)) => Some(function(&TestPoint {
                    state: &equations.at().x[..n],
                    parameters: &point.parameters,
                    monitors: &point.monitors,
                    eigenvalues: spectrum.as_deref().unwrap_or_default(),
                }))
                .filter(|value| !value.is_nan()),
                (None, None) => event.test.value(&mut Sight {
                    at: equations.at(),
                    held: &unknowns[n..first],
                    slope: tangent[first],
                    determinant,
                    stability,
                    monitors: &point.monitors,
                })?,
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

    /// Whether an event's change of sign between two points means nothing, with the slopes of the
    /// continued parameter there.
    pub fn is_noise(
        &self,
        index: usize,
        Interval { from, to, .. }: Interval,
        slopes: [f64; 2],
    ) -> bool {
        let same = from.point.unstable == to.point.unstable;
        let spectra = [from, to].map(|place| place.spectrum.as_ref());
        self.events[index].test.is_noise(slopes, same, spectra)
    }
}
