//! Events: what is looked for along a branch.

use super::Kind;
use crate::core::bifurcation::{BranchPoint, DegenerateFold, Fold, Hopf};
use crate::core::condition::{Condition, Level, Quantity};
use std::f64::consts::PI;
use std::sync::Arc;

/// Makes a fresh condition: one for the branch, one for each refinement.
pub type MakeCondition = Arc<dyn Fn() -> Box<dyn Condition> + Send + Sync>;

/// Which change of sign counts, going along the branch from its first point to its last, which is the
/// direction in which the (last released) parameter grows at the start.
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

/// What a test function of the user's own is given of a point on a branch.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TestPoint<'a> {
    /// The unknowns.
    pub state: &'a [f64],
    /// All parameters.
    pub parameters: &'a [f64],
    /// All monitors.
    pub monitors: &'a [f64],
    /// The eigenvalues or multipliers as (real part, imaginary part); empty where they are not computed.
    pub eigenvalues: &'a [(f64, f64)],
}

/// A test function of the user's own.
pub type TestFunction = Arc<dyn Fn(&TestPoint) -> f64 + Send + Sync>;

/// The function whose change of sign says that an event lies between two points of a branch.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Test {
    /// The component of the tangent along the continued parameter.
    Fold,
    /// The determinant of the Jacobian bordered by the tangent.
    BranchPoint,
    /// The sign of the product of all sums of two eigenvalues, or of all products of two multipliers
    /// less 1.
    Hopf,
    /// The product of all multipliers plus 1.
    PeriodDoubling,
    /// A parameter or monitor less a level.
    Level(Quantity, f64),
    /// An auxiliary unknown of the conditions held along the curve, less a level.
    Own {
        /// Its position among the auxiliary unknowns.
        unknown: usize,
        /// The level.
        level: f64,
    },
    /// The oscillation of a cycle about its mean, compared with that of the cycle before.
    Amplitude,
    /// The first equation of the condition itself.
    Condition,
    /// The event's own [`function`](Event::function).
    Function,
}

impl Test {
    /// Whether the sign changes where a curve is seen in the other direction.
    pub(super) fn is_odd(self) -> bool {
        matches!(self, Test::Fold | Test::BranchPoint)
    }

    /// Whether only eigenvalues or multipliers tell it.
    pub(super) fn needs_eigenvalues(self) -> bool {
        matches!(self, Test::Hopf | Test::PeriodDoubling)
    }
}

/// Something to be found on a branch: a test function that changes sign, and the condition that
/// defines the point.
///
/// ```
/// use tangency::core::condition::Quantity;
/// use tangency::core::continuation::{Direction, Event, Kind};
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
    pub test: Test,
    /// Which change of sign counts.
    pub direction: Direction,
    /// Whether the branch ends there.
    pub terminal: bool,
    /// Makes the condition; without one, the event is located by bracketing on the branch.
    pub condition: Option<MakeCondition>,
    /// The test function, where it is the user's own.
    pub function: Option<TestFunction>,
    /// Makes the condition that stands in place of those held along the curve, where those are singular
    /// at the event.
    pub instead: Option<MakeCondition>,
    /// Whether the curve is its own mirror image beyond the event: then its values are limits.
    pub(super) mirror: bool,
}

impl Event {
    /// An event with a condition of the user's own, of one equation in `(z, p)`, whose left side is
    /// the test function.
    pub fn new<C: Condition + 'static>(
        name: impl Into<String>,
        condition: impl Fn() -> C + Send + Sync + 'static,
    ) -> Self {
        let kind = condition().kind();
        Self::with_test(name, kind, Test::Condition, condition)
    }

    /// The bifurcation that a kind of special point stands for, of branches in this parameter (a position among
    /// the parameters): folds, branch points, Hopf points of equilibria; period doublings and torus points of
    /// periodic orbits; cusps and Bogdanov–Takens points of curves of folds.
    pub fn bifurcation(kind: Kind, parameter: usize) -> Option<Self> {
        Some(match kind {
            Kind::LP => Self::with_test("fold", kind, Test::Fold, Fold::default),
            Kind::BP => {
                let make = move || BranchPoint::new(parameter);
                Self::with_test("branch point", kind, Test::BranchPoint, make)
            }
            Kind::HB => Self::with_test("Hopf point", kind, Test::Hopf, Hopf::of_equilibria),
            Kind::TR => Self::with_test("torus point", kind, Test::Hopf, Hopf::of_orbits),
            Kind::PD => {
                let test = Test::PeriodDoubling;
                Self::with_test("period doubling", kind, test, Fold::antiperiodic)
            }
            Kind::CP => Self::new("cusp", DegenerateFold::cusp),
            Kind::BT => Self::new("Bogdanov–Takens point", DegenerateFold::bogdanov_takens),
            _ => return None,
        })
    }

    /// The end of a curve of Hopf points, where their frequency, its own unknown, vanishes: a
    /// Bogdanov–Takens point, which is a double zero on a curve of folds. (Beyond it the curve would be
    /// traced back with negative frequency.)
    pub(super) fn vanishing_frequency() -> Self {
        let point = Self::new("Bogdanov–Takens point", DegenerateFold::bogdanov_takens);
        let fold = Self::new("fold", Fold::default);
        let test = Test::Own { unknown: 0, level: 0.0 };
        Event { test, instead: fold.condition, ..point }.ending()
    }

    /// Ends of curves of periodic orbits, beyond which they go back over themselves: where cycles shrink onto an
    /// equilibrium, at a Hopf point (a generalised one, on a curve of folds), and where the angle of the multipliers of a
    /// torus point is 0 or π.
    pub(super) fn mirrors(held: &[Kind]) -> Vec<Self> {
        let mirror = |name: &str, kind: Kind, test: Test| {
            Event { mirror: true, ..Self::without_condition(name, kind, test) }.ending()
        };
        let amplitude = |name, kind| vec![mirror(name, kind, Test::Amplitude)];
        let angle = |level| Test::Own { unknown: 0, level };
        match held {
            [] => amplitude("Hopf point: the cycles shrink onto an equilibrium", Kind::HB),
            [Kind::LP] => {
                amplitude("generalised Hopf point: the cycles shrink onto an equilibrium", Kind::GH)
            }
            [Kind::TR] => vec![
                mirror("resonance 1:1", Kind::R1, angle(0.0)),
                mirror("resonance 1:2", Kind::R2, angle(PI)),
            ],
            _ => Vec::new(),
        }
    }

    /// A parameter or monitor at a level, marked `UZ`.
    pub fn level(name: impl Into<String>, quantity: Quantity, level: f64) -> Self {
        Self::level_of_kind(Kind::UZ, name, quantity, level)
    }

    /// A parameter or monitor at a level that means a kind of special point.
    pub(super) fn level_of_kind(
        kind: Kind,
        name: impl Into<String>,
        quantity: Quantity,
        level: f64,
    ) -> Self {
        let make = move || Level::new(quantity, level, kind);
        Self::with_test(name, kind, Test::Level(quantity, level), make)
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

    /// An event with any test function and any condition: what all others are made of. The condition
    /// may have unknowns of its own.
    pub fn with_test<C: Condition + 'static>(
        name: impl Into<String>,
        kind: Kind,
        test: Test,
        condition: impl Fn() -> C + Send + Sync + 'static,
    ) -> Self {
        let condition: MakeCondition = Arc::new(move || Box::new(condition()));
        Event { condition: Some(condition), ..Self::without_condition(name, kind, test) }
    }

    /// A change of sign of any function of points, marked `UZ`. It needs no gradient: it is located by bracketing on the
    /// corrected branch. The function should be continuous where it vanishes.
    ///
    /// ```
    /// use tangency::core::continuation::{Continuation, Event, Kind};
    /// use tangency::core::dense::Dense;
    /// use tangency::problems::classic::Hyperbola;
    /// // x² = μ² + 9, and where it meets x μ = 20: x = 5, μ = 4.
    /// let mut hyperbola = Dense::new(Hyperbola);
    /// let curve = Continuation::of(&mut hyperbola).from(&[3.0]).at("epsilon", 3.0);
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
        let function: TestFunction = Arc::new(function);
        let event = Self::without_condition(name, Kind::UZ, Test::Function);
        Event { function: Some(function), ..event }
    }

    fn without_condition(name: impl Into<String>, kind: Kind, test: Test) -> Self {
        Event {
            name: name.into(),
            kind,
            test,
            direction: Direction::Either,
            terminal: false,
            condition: None,
            function: None,
            instead: None,
            mirror: false,
        }
    }

    /// The value of the user's own test function.
    pub(super) fn value(&self, at: &TestPoint) -> f64 {
        self.function.as_ref().map_or(f64::NAN, |function| function(at))
    }

    /// The condition whose value is the test function.
    pub(super) fn tested(&self) -> Option<Box<dyn Condition>> {
        let condition = self.condition.as_ref().filter(|_| self.test == Test::Condition);
        condition.map(|make| make())
    }

    /// Whether a test function that goes from `before` to `after` passes this event, on the way that
    /// the branch takes or against it.
    pub(super) fn passed(&self, before: f64, after: f64, backward: bool) -> bool {
        let rising = before < 0.0 && after >= 0.0;
        let falling = before > 0.0 && after <= 0.0;
        let (rising, falling) = if backward { (falling, rising) } else { (rising, falling) };
        match self.direction {
            Direction::Either => rising || falling,
            Direction::Rising => rising,
            Direction::Falling => falling,
        }
    }
}
