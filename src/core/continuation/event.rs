//! Events: points that are detected and located along a branch.

use super::extended::Extended;
use super::function::{DualFunction, Equation, OfPoint, TestPoint};
use crate::core::bifurcation::catalogue::{Beyond, Bifurcation, Make, Sighting};
use crate::core::bifurcation::{
    At, ComputeNormalForm, ConditionValue, Critical, DefiningSystem, Excess, Level, Needs,
    OrderOfEvents, Passage, PointValues, Quantity, Reading, TestFunction, catalogue,
};
use crate::core::failure::Failure;
use crate::core::scalar::Chunk;
use crate::core::system::Kind;
use std::sync::Arc;

/// A function that creates a new defining system; it is called once for the branch and once for
/// each refinement.
pub(super) type MakeCondition = Arc<dyn Fn() -> Box<dyn DefiningSystem> + Send + Sync>;

/// The direction of the sign changes that count as events. The direction refers to the branch from
/// its first point to its last; in this direction, the parameter that was released last increases
/// at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// Sign changes in both directions count as events.
    #[default]
    Either,
    /// Only sign changes from negative to positive count as events.
    Rising,
    /// Only sign changes from positive to negative count as events.
    Falling,
}

/// An event on a branch, given by a test function that changes sign at the event, and a defining
/// system of the event point.
///
/// ```
/// use tangency::core::bifurcation::Quantity;
/// use tangency::core::continuation::{Direction, Event};
/// use tangency::core::system::Kind;
/// let event = Event::level("load = 2", Quantity::Parameter(0), 2.0)
///     .in_direction(Direction::Rising)
///     .ending();
/// assert_eq!((event.kind, event.terminal), (Kind::UZ, true));
/// ```
#[derive(Clone)]
pub struct Event {
    /// The name of the event, which is stored with the special point.
    pub name: String,
    /// The kind of special point at the event.
    pub kind: Kind,
    /// The test function, which changes sign at the event.
    pub test: Arc<dyn TestFunction>,
    /// The direction of the sign changes that count as events.
    pub direction: Direction,
    /// Whether the branch ends at the event.
    pub terminal: bool,
    /// Creates the defining system of the event; if `None`, the event is located by bracketing on
    /// the branch.
    pub(super) condition: Option<MakeCondition>,
    /// Creates the defining system that replaces the defining systems held along the curve, if
    /// these are singular at the event.
    pub(super) instead: Option<MakeCondition>,
    /// The eigenvalues or multipliers that are critical at the event.
    pub(super) critical: Critical,
    /// The normal form.
    pub(super) normal_form: Option<ComputeNormalForm>,
    /// Whether the curve beyond the event is the mirror image of the curve before it. At such an
    /// event, values are computed as limits.
    pub(super) mirror: bool,
}

/// A defining system whose left side serves as a test function.
pub(super) struct Tested {
    pub condition: Box<dyn DefiningSystem>,
    /// Whether the defining system has been set up; if not, the setup is attempted again at later
    /// points.
    pub stated: bool,
}

impl Tested {
    /// Sets up the defining system at a point. If the defining system is undetermined at the point,
    /// no error is returned.
    pub fn state(&mut self, at: At) -> Result<(), Failure> {
        match self.condition.start(at, &mut []) {
            Err(Failure::Undetermined(_)) => Ok(()),
            outcome => outcome.map(|()| self.stated = true),
        }
    }

    /// Returns the left side of the defining system at a point; `None` if the defining system is
    /// undetermined at the point.
    pub fn value(&mut self, at: At) -> Result<Option<f64>, Failure> {
        if !self.stated {
            // Detection begins at the next point; a failure here does not affect the branch.
            let _ = self.state(at);
            return Ok(None);
        }
        let mut value = [0.0];
        match self.condition.values(at, &[], &mut value) {
            Err(Failure::Undetermined(_)) => Ok(None),
            outcome => {
                outcome?;
                self.condition.adapt();
                Ok(Some(value[0]))
            }
        }
    }
}

impl Event {
    /// Creates an event with a user-defined defining system of one equation in `(z, p)`, whose left
    /// side is the test function.
    pub fn new<C: DefiningSystem + 'static>(
        name: impl Into<String>,
        condition: impl Fn() -> C + Send + Sync + 'static,
    ) -> Self {
        let kind = condition().kind();
        Self::with_test(name, kind, ConditionValue, condition)
    }

    /// Creates the event of a bifurcation on branches of solutions; the continued parameter is
    /// given by its index. For cusps and Bogdanov–Takens points, the event is created for curves of
    /// folds.
    pub fn bifurcation(kind: Kind, parameter: usize) -> Option<Self> {
        let row = catalogue::row_of(kind)?;
        let passed = |it: &&Sighting| matches!(it.beyond, Beyond::Further | Beyond::Through(_));
        let sighting = row.seen.iter().find(passed)?;
        Some(Self::of_catalogue(row, sighting, parameter))
    }

    /// Creates the event of a bifurcation of the catalogue, for one type of curve.
    pub(super) fn of_catalogue(row: &Bifurcation, seen: &Sighting, parameter: usize) -> Self {
        let made = |make: Make| -> MakeCondition { Arc::new(move || make(parameter)) };
        let mirror = matches!(seen.beyond, Beyond::Mirror);
        let instead = match seen.beyond {
            Beyond::End(make) | Beyond::Through(make) => Some(made(make)),
            _ => None,
        };
        Event {
            terminal: matches!(seen.beyond, Beyond::Mirror | Beyond::End(_)),
            condition: seen.defined_by.map(made),
            instead,
            mirror,
            normal_form: row.normal_form.filter(|_| !mirror),
            // Cycles that shrink to an equilibrium have an additional multiplier 1.
            critical: if mirror { Critical::One } else { row.critical },
            ..Self::without_condition(seen.name, row.kind, (seen.test)())
        }
    }

    /// Returns the value of the test function at a point of the curve; `None` if the value is undefined.
    pub(super) fn value_at(&self, equations: &mut Extended, unknowns: &[f64]) -> Option<f64> {
        equations.load(unknowns);
        self.test.value(&mut equations.at(), &PointValues::default()).ok()?
    }

    /// Creates the event at which a parameter or monitor takes a given level, with the kind `UZ`.
    pub fn level(name: impl Into<String>, quantity: Quantity, level: f64) -> Self {
        let make = move || Level::new(quantity, level, Kind::UZ);
        Self::with_test(name, Kind::UZ, Excess(quantity, level), make)
    }

    /// Restricts the event to sign changes of the test function in one direction.
    pub fn in_direction(mut self, direction: Direction) -> Self {
        self.direction = direction;
        self
    }

    /// Makes the event terminal, so that the branch ends at it.
    pub fn ending(mut self) -> Self {
        self.terminal = true;
        self
    }

    /// Creates an event with any test function and any defining system, which may have auxiliary
    /// unknowns. The other constructors of events are special cases of this one.
    pub fn with_test<C: DefiningSystem + 'static>(
        name: impl Into<String>,
        kind: Kind,
        test: impl TestFunction + 'static,
        condition: impl Fn() -> C + Send + Sync + 'static,
    ) -> Self {
        let condition: MakeCondition = Arc::new(move || Box::new(condition()));
        Event { condition: Some(condition), ..Self::without_condition(name, kind, Arc::new(test)) }
    }

    /// Creates an event at the sign changes of a function of points, with the kind `UZ`. The
    /// function needs no gradient, since the event is located by bracketing on the corrected
    /// branch. The function should be continuous at its zeros.
    ///
    /// ```
    /// use tangency::core::continuation::{Continuation, Event};
    /// use tangency::core::system::{Dense, Kind};
    /// use tangency::problems::classic::Hyperbola;
    /// // x² = μ² + 9 meets x μ = 20 at x = 5, μ = 4.
    /// let mut hyperbola = Dense::new(Hyperbola);
    /// let curve = Continuation::new(&mut hyperbola).from(&[3.0]).at("epsilon", 3.0);
    /// let product = Event::when("x μ = 20", |at| at.state[0] * at.parameters[0] - 20.0);
    /// let branch = curve.along("mu", 0.0..=9.0).event(product).trace()?;
    /// let found = branch.of_kind(Kind::UZ).next().unwrap();
    /// assert!((found.parameters[0] - 4.0).abs() < found.error && found.error < 1e-8);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn when(
        name: impl Into<String>,
        function: impl Fn(&TestPoint) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self::without_condition(name, Kind::UZ, Arc::new(OfPoint(function)))
    }

    /// Creates an event at the zeros of a function `f(z, p)` of the unknowns and all parameters,
    /// with the kind `UZ`. The function is written for dual numbers, from which its gradient is
    /// computed; the event is located by Newton's method.
    ///
    /// ```
    /// use tangency::core::continuation::{Continuation, Event};
    /// use tangency::core::system::{Dense, Kind};
    /// use tangency::problems::classic::Hyperbola;
    /// let mut hyperbola = Dense::new(Hyperbola);
    /// let curve = Continuation::new(&mut hyperbola).from(&[3.0]).at("epsilon", 3.0);
    /// let product = Event::zero_of("x μ = 20", |x, p| x[0] * p[0] - 20.0);
    /// let branch = curve.along("mu", 0.0..=9.0).event(product).trace()?;
    /// let found = branch.of_kind(Kind::UZ).next().unwrap();
    /// assert!((found.parameters[0] - 4.0).abs() < 1e-13);
    /// # Ok::<(), tangency::core::continuation::TraceError>(())
    /// ```
    pub fn zero_of(
        name: impl Into<String>,
        function: impl Fn(&[Chunk], &[Chunk]) -> Chunk + Send + Sync + 'static,
    ) -> Self {
        let function: DualFunction = Arc::new(function);
        Self::new(name, move || Equation::new(function.clone(), 0.0, Kind::UZ))
    }

    /// Creates an event of a branch of orbits: the point beyond which one of the events of the
    /// orbit leads to another mode than the itinerary prescribes. The mode that follows an event of
    /// the orbit is not a continuous function, so the point at which it changes is located by
    /// bracketing only.
    pub(super) fn of_itinerary() -> Self {
        let test = Arc::new(OrderOfEvents);
        Self::without_condition("an event leads to another mode", Kind::G, test)
    }

    /// Creates an event that is located by bracketing.
    pub(super) fn without_condition(
        name: impl Into<String>,
        kind: Kind,
        test: Arc<dyn TestFunction>,
    ) -> Self {
        Event {
            name: name.into(),
            kind,
            test,
            direction: Direction::Either,
            terminal: false,
            condition: None,
            instead: None,
            mirror: false,
            normal_form: None,
            critical: Critical::None,
        }
    }

    /// Returns the defining system whose left side is the test function, if the test function needs
    /// one.
    pub(super) fn tested(&self) -> Option<Tested> {
        let condition =
            self.condition.as_ref().filter(|_| self.test.needs() == Needs::DefiningSystem);
        condition.map(|make| Tested { condition: make(), stated: false })
    }

    /// Whether the curve passes the event between two points, which are given in the direction of
    /// the branch, or, if `backward` is set, in the opposite direction.
    pub(super) fn passed(&self, ends: [&Reading; 2], backward: bool) -> bool {
        let rises = |passage| (passage == Passage::Rising) != backward;
        match self.direction {
            Direction::Either => self.test.passes(ends).is_some(),
            Direction::Rising => self.test.passes(ends).is_some_and(rises),
            Direction::Falling => self.test.passes(ends).is_some_and(|passage| !rises(passage)),
        }
    }
}
