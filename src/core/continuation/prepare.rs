//! From what a user asks for to a trace that can run: names resolved, events gathered, the start
//! corrected.

use super::event::{Event, MakeCondition, Test, condition_of};
use super::run::Tracer;
use super::start::{Starting, branch_along, with_own};
use super::stepper::{Matrix, Stepper};
use super::{Branch, Continuation, End, Kind, TraceError};
use crate::core::bifurcation::{Fold, branches_at};
use crate::core::condition::{At, EvaluationError, Quantity};
use crate::core::extended::Extended;
use crate::core::names::UnknownName;
use crate::core::newton::{Newton, NewtonError, Tolerances};
use crate::core::solution::{Adopted, Leaving};
use crate::core::zero::Dynamics;
use std::cmp::Ordering;

/// The sides of the levels that bound a branch: −1 for a lower bound, 1 for an upper one. They belong
/// to the first events.
type Sides = Vec<f64>;

/// A monitor vanishes at a start if it is smaller: a saved grazing is exact to rounding.
const VANISHES: f64 = 1e-6;

impl<'a> Continuation<'a> {
    pub(super) fn prepare(mut self) -> Result<Tracer<'a>, TraceError> {
        let leaving = self.adopt()?;
        let released = self.resolve_released()?;
        let held = self.resolve_held(released[0])?;
        let sides = self.resolve_events(&released, &held)?;
        let scales = self.resolve_scales(&released)?;
        self.start(&released, held, sides, &scales, leaving)
    }

    /// Hands the solution that one restarts from to the system, which may change its mesh for it.
    fn adopt(&mut self) -> Result<Leaving, TraceError> {
        let Some(mut solution) = self.solution.take() else { return Ok(Leaving::Along) };
        solution.parameters = self.x[self.system.names().dimension()..].to_vec();
        solution.switch = self.switched;
        let adopted = self.system.adopt(&solution);
        let Adopted { z, tangent, leaving } = adopted.map_err(|cause| self.not_started(cause))?;
        self.x = [&z[..], &solution.parameters].concat();
        self.tangent = tangent;
        self.at_branch_point |= leaving == Leaving::BranchPoint;
        if leaving == Leaving::Switched {
            (self.switched, self.born) = (false, true);
            return Ok(Leaving::Along);
        }
        Ok(leaving)
    }

    /// Why the curve cannot start from a solution.
    fn not_started(&self, cause: EvaluationError) -> TraceError {
        TraceError::Start {
            branch: self.name.clone(),
            place: "the point to restart from".into(),
            cause: Box::new(NewtonError::from_evaluation(0, cause)),
        }
    }

    /// The position of a parameter.
    pub(super) fn parameter(&self, name: &str) -> Result<usize, TraceError> {
        let names = self.system.names();
        let known = names.parameters.iter().map(String::as_str);
        names.parameter(name).ok_or_else(|| UnknownName::new("parameter", name, known).into())
    }

    pub(super) fn quantity(&self, name: &str) -> Result<Quantity, TraceError> {
        let names = self.system.names();
        let known = names.parameters.iter().chain(&names.monitors).map(String::as_str);
        let parameter = names.parameter(name).map(Quantity::Parameter);
        parameter
            .or_else(|| names.monitor(name).map(Quantity::Monitor))
            .ok_or_else(|| UnknownName::new("parameter or monitor", name, known).into())
    }

    /// The columns of points that settings name.
    fn resolve_settled(&self) -> Result<Vec<usize>, TraceError> {
        let parameters = self.system.names().parameters.len();
        let column = |name: &String| match self.quantity(name)? {
            Quantity::Parameter(p) => Ok(p),
            Quantity::Monitor(m) => Ok(parameters + m),
        };
        self.settings.settle.iter().map(column).collect()
    }

    fn resolve_released(&mut self) -> Result<Vec<usize>, TraceError> {
        let needed = 1 + self.held.len();
        if self.released.len() != needed {
            return Err(TraceError::Released { released: self.released.len(), needed });
        }
        let n = self.system.names().dimension();
        let mut released = Vec::new();
        for (name, [low, high]) in self.released.clone() {
            let p = self.parameter(&name)?;
            let value = self.x[n + p];
            if low.partial_cmp(&high) != Some(Ordering::Less) {
                return Err(TraceError::EmptyRange { name, low, high });
            }
            // A point that was saved on a bound may be read back beyond it by rounding.
            let inside = value.clamp(low, high);
            if (inside - value).abs() <= 1e-12 * inside.abs().max(1.0) {
                self.x[n + p] = inside;
            } else {
                return Err(TraceError::OutOfRange { name, value, low, high });
            }
            if released.contains(&p) {
                return Err(TraceError::Twice { name });
            }
            released.push(p);
        }
        Ok(released)
    }

    fn resolve_held(&mut self, parameter: usize) -> Result<Vec<MakeCondition>, TraceError> {
        if self.held.iter().any(|(kind, make)| *kind == Kind::G && make.is_none()) {
            self.grazing = self.vanishing()?;
        }
        let grazing = self.grazing.first().map(|&m| {
            let event = Event::level_of_kind(Kind::G, "grazing", Quantity::Monitor(m), 0.0);
            event.condition
        });
        self.held
            .iter()
            .map(|(kind, make)| {
                let known = || match kind {
                    Kind::G => grazing.clone(),
                    _ => condition_of(*kind, parameter),
                };
                make.clone().or_else(known).ok_or(TraceError::NotHeld { kind: *kind })
            })
            .collect()
    }

    /// The monitors that vanish at the start, of those that vanish where a solution grazes: several do where an
    /// event comes with a leg of no length.
    fn vanishing(&mut self) -> Result<Vec<usize>, TraceError> {
        let (system, x) = (&mut *self.system, &self.x);
        let mut values = vec![0.0; system.names().monitors.len()];
        let outcome = system.monitors(x, &mut values);
        outcome.map_err(|left| self.not_started(left.into()))?;
        let (system, p) = (&*self.system, &self.x[self.system.names().dimension()..]);
        let vanishes = |m: &&usize| values[**m].abs() < VANISHES * system.grazing_scale(**m, p);
        Ok(system.grazings().iter().filter(vanishes).copied().collect())
    }

    /// Grazings: where a monitor that is positive on admissible solutions vanishes, but for the one that is
    /// held.
    fn grazings(&self) -> Vec<Event> {
        let monitors = self.system.grazings().iter().filter(|m| !self.grazing.contains(m));
        let event = |&m: &usize| {
            let name = self.system.names().monitors[m].clone();
            Event::level_of_kind(Kind::G, name, Quantity::Monitor(m), 0.0)
        };
        monitors.map(event).collect()
    }

    /// Gathers the events, the bounds first, so that a branch ends before anything beyond.
    fn resolve_events(
        &mut self,
        released: &[usize],
        held_makes: &[MakeCondition],
    ) -> Result<Sides, TraceError> {
        let (mut events, mut sides) = (Vec::new(), Vec::new());
        for (name, [low, high]) in self.released.iter().chain(&self.bounds) {
            let quantity = self.quantity(name)?;
            if low.partial_cmp(high) != Some(Ordering::Less) {
                return Err(TraceError::EmptyRange { name: name.clone(), low: *low, high: *high });
            }
            for (level, side) in [(*low, -1.0), (*high, 1.0)] {
                if level.is_finite() {
                    let event = Event::level(name.clone(), quantity, level).ending();
                    events.push(Event { kind: Kind::EP, ..event });
                    sides.push(side);
                }
            }
        }
        let grazings = self.grazings();
        if !self.beyond {
            sides.extend(grazings.iter().map(|_| -1.0));
            events.extend(grazings.iter().cloned().map(Event::ending));
        }
        for (name, level, kind) in &self.marks {
            let quantity = self.quantity(name)?;
            if !level.is_finite() {
                let (name, value, range) = (name.clone(), *level, "finite");
                return Err(TraceError::Value { what: "the mark", name, value, range });
            }
            events.push(Event::level_of_kind(*kind, format!("{name} = {level}"), quantity, *level));
        }
        if self.beyond {
            events.extend(grazings);
        }
        let dynamics = self.system.dynamics();
        let held: Vec<Kind> = self.held.iter().map(|(kind, _)| *kind).collect();
        match held[..] {
            [] => {
                events.push(Event::branch_point(released[0]));
                events.push(Event::fold());
                match dynamics {
                    Dynamics::Flow => events.push(Event::hopf()),
                    Dynamics::Periodic => {
                        events.extend([Event::period_doubling(), Event::torus()]);
                    }
                    _ => {}
                }
            }
            [Kind::LP] => {
                events.push(Event::cusp());
                if dynamics == Dynamics::Flow {
                    events.push(Event::bogdanov_takens());
                }
            }
            [Kind::HB] => events.push(Event::vanishing_frequency()),
            [Kind::G] => {
                events.push(Event::new("fold", Fold::default));
                if dynamics == Dynamics::Periodic {
                    events.push(Event::new("period doubling", Fold::antiperiodic));
                }
            }
            _ => {}
        }
        events.append(&mut self.events);
        let untested =
            |event: &&Event| event.test == Test::Condition && (event.condition)().unknowns() > 0;
        if let Some(event) = events.iter().find(untested) {
            return Err(TraceError::NoTest { event: event.name.clone() });
        }
        let own = held_makes.iter().map(|make| make().unknowns()).sum();
        events.iter().try_for_each(|event| self.check_position(event, own))?;
        self.events = events;
        Ok(sides)
    }

    /// Refuses an event at a position that there is not.
    fn check_position(&self, event: &Event, own: usize) -> Result<(), TraceError> {
        let names = self.system.names();
        let (what, position, count) = match event.test {
            Test::Level(Quantity::Parameter(p), _) => ("parameter", p, names.parameters.len()),
            Test::Level(Quantity::Monitor(m), _) => ("monitor", m, names.monitors.len()),
            Test::Own(j) => ("own unknown", j, own),
            _ => return Ok(()),
        };
        if position < count {
            return Ok(());
        }
        Err(TraceError::Position { event: event.name.clone(), what, position, count })
    }

    /// Scales that the user gives: of groups first, then of released parameters.
    fn resolve_scales(&self, released: &[usize]) -> Result<Vec<Option<f64>>, TraceError> {
        let names = self.system.names();
        let known: Vec<&str> = names
            .unknowns
            .iter()
            .map(|group| group.name.as_str())
            .chain(released.iter().map(|&p| names.parameters[p].as_str()))
            .collect();
        let mut scales = vec![None; known.len()];
        for (name, value) in &self.scales {
            let what = "group of unknowns or released parameter";
            let place = known
                .iter()
                .position(|known| known == name)
                .ok_or_else(|| UnknownName::new(what, name, known.iter().copied()))?;
            if !(value.is_finite() && *value > 0.0) {
                let (name, value, range) = (name.clone(), *value, "finite and more than 0");
                return Err(TraceError::Value { what: "the scale", name, value, range });
            }
            scales[place] = Some(*value);
        }
        Ok(scales)
    }

    /// The direction in which to leave a branch point: along the branch that one comes from, or along
    /// the other one. `None` if the start is no branch point.
    fn leaving(
        &mut self,
        released: &[usize],
        how: Leaving,
    ) -> Result<Option<Vec<f64>>, EvaluationError> {
        if how == Leaving::Direction {
            return Ok(self.tangent.clone());
        }
        let at_branch_point = self.at_branch_point && self.held.is_empty();
        if self.switched
            && how == Leaving::Along
            && let Some(kind) = self.restarted_at.filter(|kind| *kind != Kind::BP)
        {
            return Err(EvaluationError::NotApplicable(format!(
                "the point to switch at is a {}, but branches cross at branch points (BP) only",
                kind.meaning()
            )));
        }
        if !(self.switched || at_branch_point) {
            return Ok(None);
        }
        let at = At { system: &mut *self.system, x: &self.x, released };
        match branches_at(at, released[0]) {
            Ok(tangents) => {
                Ok(Some(branch_along(tangents, self.tangent.as_deref(), self.switched)))
            }
            Err(cause) if self.switched || self.tangent.is_none() => Err(cause),
            Err(_) => Ok(self.tangent.clone()),
        }
    }

    /// Corrects the start, finds the tangent and the scales.
    fn start(
        mut self,
        released: &[usize],
        held: Vec<MakeCondition>,
        sides: Sides,
        scales: &[Option<f64>],
        how: Leaving,
    ) -> Result<Tracer<'a>, TraceError> {
        let names = self.system.names().clone();
        let n = names.dimension();
        let place: Vec<String> = released
            .iter()
            .map(|&p| format!("{} = {}", names.parameters[p], self.x[n + p]))
            .collect();
        let (branch, place) = (self.name.clone(), place.join(", "));
        let failed = |cause| TraceError::Start {
            branch: branch.clone(),
            place: place.clone(),
            cause: Box::new(cause),
        };
        let evaluation = |cause: EvaluationError| failed(NewtonError::from_evaluation(0, cause));
        let leaving = self.leaving(released, how).map_err(evaluation)?;
        let correct = leaving.is_none();
        let same_curve = self.restarted_on == self.held.first().map(|(kind, _)| *kind);
        let direction = leaving.or(self.tangent.take().filter(|_| same_curve));
        let branch = self.branch(&names);
        let settled = self.resolve_settled()?;
        let ranges: Vec<[f64; 2]> = self.released.iter().map(|r| r.1).collect();
        let mut equations = Extended::new(self.system, &self.x, released.to_vec());
        let mut unknowns = equations.unload(&self.x);
        let direction = direction.map(|t| equations.unload(&t));
        for make in &held {
            unknowns = equations.hold(make(), &unknowns).map_err(evaluation)?;
        }
        let direction = direction.map(|t| with_own(&t, n, unknowns.len()));
        let mut starting = Starting {
            equations: &mut equations,
            newton: Newton::default(),
            tolerances: Tolerances {
                tolerance: self.settings.tolerance,
                max_iterations: self.settings.max_iterations,
            },
            ranges: &ranges,
            scales,
        };
        let (metric, tangent) =
            starting.begin(&names, &mut unknowns, direction, correct).map_err(failed)?;
        let weights = metric.weights(equations.names());
        let tested = self
            .events
            .iter()
            .map(|event| (event.test == Test::Condition).then(|| (event.condition)()))
            .collect();
        let mut stepper = Stepper {
            equations,
            newton: Newton::default(),
            settings: self.settings,
            metric,
            weights,
            events: self.events,
            held,
            tested,
            settled,
        };
        stepper.prepare_tests(&unknowns).map_err(evaluation)?;
        let start = if correct {
            let row = stepper.covector(&tangent);
            stepper.arrive(unknowns, &row, Matrix::Unknown)
        } else {
            stepper.arrive_at_branch_point(unknowns, tangent)
        };
        let mut start = start.map_err(evaluation)?;
        let monitors = &start.point.monitors;
        let equations = &mut stepper.equations;
        let (system, p) = (equations.system(), &start.point.parameters);
        let clear = |&m: &usize| monitors[m] > VANISHES * system.grazing_scale(m, p);
        if system.grazings().iter().all(clear) {
            equations.load(&start.unknowns);
            let at = equations.at();
            at.system.check_start(at.x).map_err(|left| evaluation(left.into()))?;
        }
        if how != Leaving::Along {
            stepper.forget_stability_at(&mut start);
        }
        let slopes = stepper.forget_levels_at(&mut start, self.born).map_err(evaluation)?;
        if correct {
            stepper.equations.follow(&mut start.unknowns, &mut [&mut start.tangent]);
        }
        let tracer = Tracer {
            stepper,
            branch,
            start,
            sides,
            slopes,
            // Both sides are the same where a branch of periodic orbits is born.
            directions: match how {
                Leaving::Along | Leaving::Switched => [self.backward, self.forward],
                Leaving::BranchPoint | Leaving::Direction => [false, true],
            },
            from_branch_point: !correct,
            labels: 0,
        };
        tracer.check_bounds()?;
        Ok(tracer)
    }

    /// The branch without its points.
    fn branch(&self, names: &crate::core::zero::Names) -> Branch {
        Branch {
            name: self.name.clone(),
            condition: self.held.first().map(|(kind, _)| *kind),
            itinerary: self.system.itinerary(),
            unknowns: names.unknowns.clone(),
            parameters: names.parameters.clone(),
            released: self.released.iter().map(|r| r.0.clone()).collect(),
            monitors: names.monitors.clone(),
            points: Vec::new(),
            special: Vec::new(),
            ends: [End::Start, End::Start],
            settings: self.settings.clone(),
        }
    }
}
