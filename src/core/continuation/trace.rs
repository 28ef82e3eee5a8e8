//! Tracing a branch: from a start, both ways, through its events, to its ends.

use super::event::{Event, MakeCondition, Test, condition_of};
use super::run::Tracer;
use super::start::{Starting, other_branch, with_own};
use super::stepper::Stepper;
use super::{Branch, End, Kind, Point, SettingError, Settings, SpecialPoint};
use crate::core::bifurcation::branches_at;
use crate::core::condition::{Condition, EvaluationError, Quantity};
use crate::core::extended::Extended;
use crate::core::newton::{Newton, NewtonError, Tolerances};
use crate::core::zero::{Dynamics, System};
use std::ops::{ControlFlow, RangeInclusive};
use std::rc::Rc;

/// Why a trace could not begin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// A name that the problem does not have.
    #[error("there is no parameter or monitor `{name}`; there are {known}")]
    UnknownName {
        /// The name.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// A range that is empty or not a number, or a start outside it.
    #[error("the start {name} = {value} is not in its range {low} to {high}")]
    OutOfRange {
        /// The parameter.
        name: String,
        /// Where the branch starts.
        value: f64,
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
    /// The number of released parameters does not fit the number of conditions.
    #[error(
        "{released} parameters are released, but {needed} are needed: one, and one more for each condition held"
    )]
    Released {
        /// How many are released.
        released: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A state of the wrong length.
    #[error(
        "the start has {found} unknowns, the problem {expected}: was it made with other settings?"
    )]
    StateLength {
        /// The length of the state given.
        found: usize,
        /// The number of unknowns.
        expected: usize,
    },
    /// No special point with this label, or not of a kind that fits.
    #[error("{0}")]
    Label(String),
    /// A setting out of its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// Newton's iteration failed at the start.
    #[error("no start of the branch `{branch}` at {place}: {cause}")]
    Start {
        /// The branch.
        branch: String,
        /// Values of the released parameters there.
        place: String,
        /// Newton's failure.
        #[source]
        cause: NewtonError,
    },
}

/// Sees a branch while it is traced: to print, to show progress, to interrupt.
pub trait Observer {
    /// A branch begins; its names are known, its points are not.
    fn begin(&mut self, _branch: &Branch) {}

    /// A point was reached. `Break` ends the trace; what there is of the branch is kept.
    fn point(&mut self, _point: &Point) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// A special point was found, and labelled.
    fn special(&mut self, _branch: &Branch, _special: &SpecialPoint) {}
}

/// An observer that sees nothing.
impl Observer for () {}

/// A curve to be traced: a builder.
///
/// ```
/// use tangency::core::continuation::{Continuation, Kind};
/// use tangency::core::{dense::Dense, scalar::Scalar, zero::{Names, ZeroProblem}};
/// struct ParallelPlate;
/// impl ZeroProblem for ParallelPlate {
///     fn names(&self) -> Names {
///         Names::new(["u"], ["load"])
///     }
///     fn residual<T: Scalar>(&self, u: &[T], p: &[T], r: &mut [T]) {
///         r[0] = p[0] / (T::one() - u[0]).powi(2) - u[0];
///     }
/// }
/// let mut plate = Dense::new(ParallelPlate);
/// let branch = Continuation::of(&mut plate).along("load", 0.0..=1.0).trace()?;
/// let fold = branch.of_kind(Kind::LP).next().unwrap();
/// assert!((fold.parameters[0] - 4.0 / 27.0).abs() < 1e-15);
/// assert!((fold.state[0] - 1.0 / 3.0).abs() < 1e-12);
/// # Ok::<(), tangency::core::continuation::TraceError>(())
/// ```
pub struct Continuation<'a> {
    system: &'a mut dyn System,
    name: String,
    x: Vec<f64>,
    tangent: Option<Vec<f64>>,
    released: Vec<(String, [f64; 2])>,
    bounds: Vec<(String, [f64; 2])>,
    marks: Vec<(String, f64)>,
    events: Vec<Event>,
    held: Vec<(Kind, Option<MakeCondition>)>,
    settings: Settings,
    switched: bool,
    from_special: bool,
    forward: bool,
    backward: bool,
    errors: Vec<TraceError>,
}

impl<'a> Continuation<'a> {
    /// A curve of zeros of this system, from `z = 0` and `p = 0` unless told otherwise.
    pub fn of(system: &'a mut dyn System) -> Self {
        let x = vec![0.0; system.names().length()];
        Continuation {
            system,
            name: "branch".into(),
            x,
            tangent: None,
            released: Vec::new(),
            bounds: Vec::new(),
            marks: Vec::new(),
            events: Vec::new(),
            held: Vec::new(),
            settings: Settings::default(),
            switched: false,
            from_special: false,
            forward: true,
            backward: true,
            errors: Vec::new(),
        }
    }

    /// The branch's name.
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Settings of the stepper and of Newton's iteration.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = settings;
        self
    }

    /// The unknowns `z` at the start (a guess, corrected with the parameters as given).
    pub fn from(mut self, z: &[f64]) -> Self {
        let n = self.system.names().dimension();
        if z.len() == n {
            self.x[..n].copy_from_slice(z);
        } else {
            self.errors.push(TraceError::StateLength { found: z.len(), expected: n });
        }
        self
    }

    /// A parameter's value at the start.
    pub fn at(mut self, parameter: &str, value: f64) -> Self {
        let n = self.system.names().dimension();
        match self.system.names().parameter(parameter) {
            Some(p) => self.x[n + p] = value,
            None => self.errors.push(self.unknown(parameter)),
        }
        self
    }

    /// Starts at a special point of a branch: its state, parameters and direction.
    pub fn restart(mut self, branch: &Branch, label: usize) -> Self {
        match branch.labelled(label) {
            Some(special) => self.restart_at(branch, special),
            None => {
                let labels = branch.special.len();
                self.errors.push(TraceError::Label(format!(
                    "branch `{}` has no label {label}; its labels are 1 to {labels}",
                    branch.name
                )));
                self
            }
        }
    }

    fn restart_at(mut self, branch: &Branch, special: &SpecialPoint) -> Self {
        for (name, value) in branch.parameters.iter().zip(&special.parameters) {
            self = self.at(name, *value);
        }
        self = self.from(&special.state);
        self.from_special = true;
        let n = self.system.names().dimension();
        if branch.condition.is_none() && special.tangent.len() == n + branch.released.len() {
            let mut tangent = vec![0.0; self.x.len()];
            tangent[..n].copy_from_slice(&special.tangent[..n]);
            for (name, value) in branch.released.iter().zip(&special.tangent[n..]) {
                if let Some(p) = self.system.names().parameter(name) {
                    tangent[n + p] = *value;
                }
            }
            self.tangent = Some(tangent);
        }
        self
    }

    /// Releases a parameter within a range: the continued one first. The range's length is the
    /// parameter's scale; an end may be infinite.
    pub fn along(mut self, parameter: &str, range: RangeInclusive<f64>) -> Self {
        self.released.push((parameter.into(), [*range.start(), *range.end()]));
        self
    }

    /// Bounds a parameter or a monitor: the branch ends there.
    pub fn bound(mut self, name: &str, range: RangeInclusive<f64>) -> Self {
        self.bounds.push((name.into(), [*range.start(), *range.end()]));
        self
    }

    /// Marks where a parameter or a monitor takes a value, as `UZ`.
    pub fn mark(mut self, name: &str, level: f64) -> Self {
        self.marks.push((name.into(), level));
        self
    }

    /// Looks for a further event.
    pub fn event(mut self, event: Event) -> Self {
        self.events.push(event);
        self
    }

    /// Holds the condition of a kind of special point along the curve; one more parameter must be
    /// released. `LP`, `BP` and `HB` are known to the core.
    pub fn hold(mut self, kind: Kind) -> Self {
        self.held.push((kind, None));
        self
    }

    /// Holds a condition of the user's own.
    pub fn hold_condition<C: Condition + 'static>(
        mut self,
        condition: impl Fn() -> C + 'static,
    ) -> Self {
        let kind = condition().kind();
        self.held.push((kind, Some(Rc::new(move || Box::new(condition())))));
        self
    }

    /// Leaves the branch point where the curve starts along the *other* branch.
    pub fn switch(mut self) -> Self {
        self.switched = true;
        self
    }

    /// Traces only in the direction in which the (last released) parameter grows.
    pub fn forward(mut self) -> Self {
        self.backward = false;
        self
    }

    /// Traces only in the direction in which the (last released) parameter falls.
    pub fn backward(mut self) -> Self {
        self.forward = false;
        self
    }

    /// Traces the curve.
    ///
    /// # Errors
    /// [`TraceError`] if it cannot begin. Whatever happens later ends the branch with a reason
    /// ([`Branch::ends`]) and keeps what there is.
    pub fn trace(self) -> Result<Branch, TraceError> {
        self.trace_with(&mut ())
    }

    /// Traces the curve under the eyes of an observer.
    ///
    /// # Errors
    /// As [`trace`](Continuation::trace).
    pub fn trace_with(mut self, observer: &mut dyn Observer) -> Result<Branch, TraceError> {
        self.settings.check()?;
        if !self.errors.is_empty() {
            return Err(self.errors.swap_remove(0));
        }
        let released = self.resolve_released()?;
        let held = self.resolve_held(released[0])?;
        self.resolve_events(&released, &held)?;
        Ok(self.start(&released, held)?.run(observer))
    }

    fn unknown(&self, name: &str) -> TraceError {
        let names = self.system.names();
        let known: Vec<_> = names.parameters.iter().chain(&names.monitors).cloned().collect();
        TraceError::UnknownName { name: name.into(), known: known.join(", ") }
    }

    fn quantity(&self, name: &str) -> Result<Quantity, TraceError> {
        let names = self.system.names();
        let parameter = names.parameter(name).map(Quantity::Parameter);
        parameter
            .or_else(|| names.monitor(name).map(Quantity::Monitor))
            .ok_or_else(|| self.unknown(name))
    }

    fn resolve_released(&self) -> Result<Vec<usize>, TraceError> {
        let needed = 1 + self.held.len();
        if self.released.len() != needed {
            return Err(TraceError::Released { released: self.released.len(), needed });
        }
        let n = self.system.names().dimension();
        let mut released = Vec::new();
        for (name, [low, high]) in &self.released {
            let p = self.system.names().parameter(name).ok_or_else(|| self.unknown(name))?;
            let value = self.x[n + p];
            if !(*low < *high && (*low..=*high).contains(&value)) {
                let name = name.clone();
                return Err(TraceError::OutOfRange { name, value, low: *low, high: *high });
            }
            released.push(p);
        }
        Ok(released)
    }

    fn resolve_held(&self, parameter: usize) -> Result<Vec<MakeCondition>, TraceError> {
        self.held
            .iter()
            .map(|(kind, make)| {
                make.clone().or_else(|| condition_of(*kind, parameter)).ok_or_else(|| {
                    TraceError::Label(format!(
                        "a {} cannot be held along a curve; LP, BP and HB can",
                        kind.meaning()
                    ))
                })
            })
            .collect()
    }

    /// Events in the order of the bounds first, so that a branch ends before anything beyond.
    fn resolve_events(
        &mut self,
        released: &[usize],
        held: &[MakeCondition],
    ) -> Result<(), TraceError> {
        let mut events = Vec::new();
        for (name, [low, high]) in self.released.iter().chain(&self.bounds) {
            let quantity = self.quantity(name)?;
            for level in [*low, *high].into_iter().filter(|level| level.is_finite()) {
                let mut event = Event::level(name.clone(), quantity, level).ending();
                event.kind = Kind::EP;
                events.push(event);
            }
        }
        for (name, level) in &self.marks {
            let quantity = self.quantity(name)?;
            events.push(Event::level(format!("{name} = {level}"), quantity, *level));
        }
        let flow = self.system.dynamics() == Dynamics::Flow;
        if held.is_empty() {
            events.push(Event::branch_point(released[0]));
            events.push(Event::fold());
            if flow {
                events.push(Event::hopf());
            }
        } else if self.held[0].0 == Kind::LP && held.len() == 1 {
            events.push(Event::cusp());
            if flow {
                events.push(Event::bogdanov_takens());
            }
        }
        events.append(&mut self.events);
        self.events = events;
        Ok(())
    }

    /// Corrects the start, finds the tangent and the scales.
    fn start(self, released: &[usize], held: Vec<MakeCondition>) -> Result<Tracer<'a>, TraceError> {
        let names = self.system.names().clone();
        let n = names.dimension();
        let place: Vec<String> = released
            .iter()
            .map(|&p| format!("{} = {}", names.parameters[p], self.x[n + p]))
            .collect();
        let failed = |cause: NewtonError| TraceError::Start {
            branch: self.name.clone(),
            place: place.join(", "),
            cause,
        };
        let evaluation = |cause: EvaluationError| failed(NewtonError::from_evaluation(0, cause));
        let switched = if self.switched {
            let at = crate::core::condition::At { system: &mut *self.system, x: &self.x, released };
            let tangents = branches_at(at, released[0]).map_err(evaluation)?;
            Some(other_branch(tangents, self.tangent.as_deref()))
        } else {
            None
        };
        let start = switched.as_ref().or(self.tangent.as_ref());
        let mut equations = Extended::new(self.system, &self.x, released.to_vec());
        let mut unknowns = equations.unload(&self.x);
        let direction = start.map(|t| equations.unload(t));
        for make in &held {
            unknowns = equations.hold(make(), &unknowns).map_err(evaluation)?;
        }
        let direction = direction.map(|t| with_own(&t, n, unknowns.len()));
        let ranges: Vec<[f64; 2]> = self.released.iter().map(|r| r.1).collect();
        let mut starting = Starting {
            equations: &mut equations,
            newton: Newton::default(),
            tolerances: Tolerances {
                tolerance: self.settings.tolerance,
                max_iterations: self.settings.max_iterations,
            },
            ranges: &ranges,
            released: released.len(),
        };
        let correct = !self.switched;
        let (metric, tangent) =
            starting.begin(&names, &mut unknowns, direction, correct).map_err(failed)?;
        let weights = metric.weights(equations.names(), 0);
        let tested = self
            .events
            .iter()
            .map(|event| (event.test == Test::Condition).then(|| (event.condition)()))
            .collect();
        let branch = Branch {
            name: self.name.clone(),
            condition: self.held.first().map(|(kind, _)| *kind),
            unknowns: names.unknowns.clone(),
            parameters: names.parameters.clone(),
            released: self.released.iter().map(|r| r.0.clone()).collect(),
            monitors: names.monitors.clone(),
            points: Vec::new(),
            special: Vec::new(),
            ends: [End::Start, End::Start],
            settings: self.settings.clone(),
        };
        let mut stepper = Stepper {
            equations,
            newton: Newton::default(),
            settings: self.settings.clone(),
            metric,
            weights,
            events: self.events.clone(),
            held,
            tested,
        };
        stepper.prepare_tests(&unknowns).map_err(evaluation)?;
        let mut place = if self.switched {
            stepper.arrive_at_branch_point(unknowns, tangent).map_err(evaluation)?
        } else {
            let row = stepper.covector(&tangent);
            stepper.arrive(unknowns, &row).map_err(evaluation)?
        };
        stepper.forget_levels_at(&mut place);
        Ok(Tracer {
            stepper,
            branch,
            start: place,
            skip_first: self.switched || self.from_special,
            directions: [self.backward, self.forward],
            labels: 0,
        })
    }
}
