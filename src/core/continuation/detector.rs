//! Evaluation of the test functions at points of a curve.

use super::curve_point::{CurvePoint, Interval};
use super::event::{Event, Tested};
use super::extended::Extended;
use super::recorder::Recorded;
use crate::core::bifurcation::PointValues;
use crate::core::failure::Failure;
use crate::core::system::Kind;

/// Whether two numbers have opposite signs.
pub(super) fn turns(before: Option<f64>, after: Option<f64>) -> bool {
    matches!((before, after), (Some(before), Some(after)) if before * after < 0.0)
}

/// The events that are monitored along a curve, and the evaluation of their test functions.
pub(super) struct Detector {
    pub events: Vec<Event>,
    /// The defining systems whose left sides serve as test functions, one for each event that needs
    /// a defining system.
    tested: Vec<Option<Tested>>,
}

impl Detector {
    pub fn new(events: Vec<Event>) -> Self {
        Detector { tested: events.iter().map(Event::tested).collect(), events }
    }

    /// Prepares, at the start of a curve, the defining systems whose left sides serve as test
    /// functions.
    pub fn start(&mut self, equations: &mut Extended) -> Result<(), Failure> {
        self.tested.iter_mut().flatten().try_for_each(|tested| tested.state(equations.at()))
    }

    /// Evaluates again, at a point, the defining systems whose left sides serve as test functions,
    /// since the signs of null vectors may have changed.
    pub fn restate(&mut self, equations: &mut Extended, place: &mut CurvePoint) {
        equations.load(&place.unknowns);
        for (tested, value) in self.tested.iter_mut().zip(&mut place.tests) {
            if let Some(tested) = tested {
                *value = tested
                    .state(equations.at())
                    .and_then(|()| tested.value(equations.at()))
                    .unwrap_or_default();
            }
        }
    }

    /// Whether some test function needs the matrix at the point itself, not the matrix of an
    /// earlier Newton iteration.
    pub fn needs_matrix(&self) -> bool {
        self.tested.iter().flatten().any(|tested| tested.stated && tested.condition.assembles())
    }

    /// Whether the sign of the test function of an event is arbitrary, because it depends on the
    /// sign of a determinant or of null vectors.
    pub fn is_sign_free(&self, index: usize) -> bool {
        self.tested[index].is_some() || self.branch_points() == Some(index)
    }

    /// Returns the index of the event that detects branch points.
    pub fn branch_points(&self) -> Option<usize> {
        self.events.iter().position(|event| event.kind == Kind::BP && event.condition.is_some())
    }

    /// Whether the step between two points passes a branch point.
    pub fn passes_branch_point(&self, Interval { from, to, .. }: Interval) -> bool {
        self.branch_points().is_some_and(|index| turns(from.tests[index], to.tests[index]))
    }

    /// Evaluates the test functions of all events at a recorded point with its tangent.
    pub fn values(
        &mut self,
        equations: &mut Extended,
        tangent: &[f64],
        determinant: f64,
        Recorded { point, spectrum, .. }: &Recorded,
    ) -> Result<Vec<Option<f64>>, Failure> {
        let known = PointValues {
            slope: tangent[equations.parameters_at()],
            determinant,
            spectrum: spectrum.as_deref(),
            monitors: &point.monitors,
        };
        let values = self.events.iter().zip(&mut self.tested).map(|(event, tested)| match tested {
            Some(tested) => tested.value(equations.at()),
            None => event.test.value(&mut equations.at(), &known),
        });
        values.collect()
    }

    /// Reverses the direction of the curve at a point: changes the signs of its tangent and of the
    /// test functions that depend on the direction.
    pub fn reverse(&self, place: &mut CurvePoint) {
        place.tangent.iter_mut().for_each(|t| *t = -*t);
        place.determinant = -place.determinant;
        for (test, event) in place.tests.iter_mut().zip(&self.events) {
            if event.test.is_odd() {
                *test = test.map(|test| -test);
            }
        }
    }
}
