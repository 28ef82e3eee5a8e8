//! Events: what is looked for along a branch.

use super::function::{DualFunction, Equation, OfPoint, TestPoint};
use crate::core::bifurcation::catalogue::{Beyond, Bifurcation, Make, Sighting};
use crate::core::bifurcation::{
    At, ComputeNormalForm, ConditionValue, Critical, DefiningSystem, Excess, Level, Needs,
    OrderOfEvents, Passage, Quantity, Reading, TestFunction, catalogue,
};
use crate::core::failure::Failure;
use crate::core::scalar::Chunk;
use crate::core::system::Kind;
use std::sync::Arc;

/// Makes a fresh condition: one for the branch, one for each refinement.
pub(super) type MakeCondition = Arc<dyn Fn() -> Box<dyn DefiningSystem> + Send + Sync>;

/// Which change of sign counts, going along the branch from its first point to its last, which is
/// the direction in which the (last released) parameter grows at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// Any.
    #[default]
    Either,
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
}

/// Something to be found on a branch: a test function that changes sign, and the condition that
/// defines the point.
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
    /// Its name, which appears with the special point.
    pub name: String,
    /// The kind of special point.
    pub kind: Kind,
    /// The test function.
    pub test: Arc<dyn TestFunction>,
    /// Which change of sign counts.
    pub direction: Direction,
    /// Whether the branch ends there.
    pub terminal: bool,
    /// Makes the condition; without one, the event is located by bracketing on the branch.
    pub(super) condition: Option<MakeCondition>,
    /// Makes the condition that stands in place of those held along the curve, where those are
    /// singular at the event.
    pub(super) instead: Option<MakeCondition>,
    /// The eigenvalues or multipliers that are critical there.
    pub(super) critical: Critical,
    /// The normal form.
    pub(super) normal_form: Option<ComputeNormalForm>,
    /// Whether the curve is its own mirror image beyond the event: then its values are limits.
    pub(super) mirror: bool,
}

/// A condition whose value is a test function.
pub(super) struct Tested {
    pub condition: Box<dyn DefiningSystem>,
    /// Whether what it is stated for is known: where it is not yet, later points ask again.
    pub stated: bool,
}

impl Tested {
    /// Prepares the condition at a point where it has not been stated. What it is stated for need
    /// not be known there.
    pub fn state(&mut self, at: At) -> Result<(), Failure> {
        match self.condition.start(at, &mut []) {
            Err(Failure::Undetermined(_)) => Ok(()),
            outcome => outcome.map(|()| self.stated = true),
        }
    }

    /// The value at a point; `None` where what it is stated for is not known.
    pub fn value(&mut self, at: At) -> Result<Option<f64>, Failure> {
        if !self.stated {
            // It is detected from the next point on; a failure here is none of the branch's.
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
    /// An event with a condition of the user's own, of one equation in `(z, p)`, whose left side is
    /// the test function.
    pub fn new<C: DefiningSystem + 'static>(
        name: impl Into<String>,
        condition: impl Fn() -> C + Send + Sync + 'static,
    ) -> Self {
        let kind = condition().kind();
        Self::with_test(name, kind, ConditionValue, condition)
    }

    /// The bifurcation that a kind of special point stands for, of branches of solutions in this
    /// parameter (a position among the parameters), or of curves of folds, as cusps and
    /// Bogdanov–Takens points are.
    pub fn bifurcation(kind: Kind, parameter: usize) -> Option<Self> {
        let row = catalogue::row_of(kind)?;
        let passed = |it: &&Sighting| matches!(it.beyond, Beyond::Further | Beyond::Through(_));
        let sighting = row.seen.iter().find(passed)?;
        Some(Self::of_catalogue(row, sighting, parameter))
    }

    /// A row of the catalogue, as it is seen on one sort of curve.
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
            // Cycles that shrink onto an equilibrium have one more multiplier 1.
            critical: if mirror { Critical::One } else { row.critical },
            ..Self::without_condition(seen.name, row.kind, (seen.test)())
        }
    }

    /// A parameter or monitor at a level, marked `UZ`.
    pub fn level(name: impl Into<String>, quantity: Quantity, level: f64) -> Self {
        let make = move || Level::new(quantity, level, Kind::UZ);
        Self::with_test(name, Kind::UZ, Excess(quantity, level), make)
    }

    /// Counts one direction only.
    pub fn in_direction(mut self, direction: Direction) -> Self {
        self.direction = direction;
        self
    }

    /// Ends the branch at this event.
    pub fn ending(mut self) -> Self {
        self.terminal = true;
        self
    }

    /// An event with any test function and any condition: what all others are made of. The
    /// condition may have unknowns of its own.
    pub fn with_test<C: DefiningSystem + 'static>(
        name: impl Into<String>,
        kind: Kind,
        test: impl TestFunction + 'static,
        condition: impl Fn() -> C + Send + Sync + 'static,
    ) -> Self {
        let condition: MakeCondition = Arc::new(move || Box::new(condition()));
        Event { condition: Some(condition), ..Self::without_condition(name, kind, Arc::new(test)) }
    }

    /// A change of sign of any function of points, marked `UZ`. It needs no gradient: it is located
    /// by bracketing on the corrected branch. The function should be continuous where it vanishes.
    ///
    /// ```
    /// use tangency::core::continuation::{Continuation, Event};
    /// use tangency::core::system::{Dense, Kind};
    /// use tangency::problems::classic::Hyperbola;
    /// // x² = μ² + 9, and where it meets x μ = 20: x = 5, μ = 4.
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

    /// Where a function `f(z, p)` of the unknowns and all parameters vanishes, marked `UZ`. Stated
    /// on dual numbers it has a gradient, so that Newton's iteration finishes the point.
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

    /// Where an event of an orbit begins to lead elsewhere than the itinerary goes on, which a
    /// system decides without a function: known by bracketing only.
    pub(super) fn of_itinerary() -> Self {
        let test = Arc::new(OrderOfEvents);
        Self::without_condition("an event leads to another mode", Kind::G, test)
    }

    /// An event that is located by bracketing.
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

    /// The condition whose value is the test function.
    pub(super) fn tested(&self) -> Option<Tested> {
        let condition =
            self.condition.as_ref().filter(|_| self.test.needs() == Needs::DefiningSystem);
        condition.map(|make| Tested { condition: make(), stated: false })
    }

    /// Whether the event is passed between two points, on the way that the branch takes or against
    /// that way.
    pub(super) fn passed(&self, ends: [&Reading; 2], backward: bool) -> bool {
        let rises = |passage| (passage == Passage::Rising) != backward;
        match self.direction {
            Direction::Either => self.test.passes(ends).is_some(),
            Direction::Rising => self.test.passes(ends).is_some_and(rises),
            Direction::Falling => self.test.passes(ends).is_some_and(|passage| !rises(passage)),
        }
    }
}
