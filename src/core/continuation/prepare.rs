//! From what a user asks for to a trace that can run: names resolved, then the start corrected.

use super::event::{Event, MakeCondition};
use super::start::Resolved;
use super::trace::Origin;
use super::{Continuation, Kind, Steps, TraceError};
use crate::core::condition::{Failure, Level, Quantity};
use crate::core::function::Equation;
use crate::core::names::position;
use crate::core::solution::{Adopted, Start};
use crate::core::system_ref::SystemRef;
use crate::core::test_function::Test;
use crate::core::zero::Emanating;
use std::sync::Arc;

impl<'a> Continuation<'a> {
    pub(super) fn prepare(mut self) -> Result<Steps<'a>, TraceError> {
        self.check_names()?;
        if let Some(system) = self.system.discretised() {
            system.set_cancel(&self.settings.cancel);
        }
        let start = self.adopt()?;
        let released = self.resolve_released()?;
        let held = self.resolve_held(released[0])?;
        let bounds = self.gather_events(released[0], &held)?;
        let (scales, settled) = (self.resolve_scales(&released)?, self.resolve_settled()?);
        self.start(Resolved { released, held, bounds, scales, settled }, start)
    }

    /// Refuses names that two quantities of one sort have.
    fn check_names(&self) -> Result<(), TraceError> {
        let names = self.system.names();
        let sorts: [(_, Vec<&str>); 3] = [
            ("unknowns", names.unknowns.iter().map(|group| group.name.as_str()).collect()),
            ("parameters", names.parameters.iter().map(String::as_str).collect()),
            ("monitors", self.monitor_names().collect()),
        ];
        for (what, names) in sorts {
            let again = |k: &usize| names[..*k].contains(&names[*k]);
            if let Some(k) = (0..names.len()).find(again) {
                return Err(TraceError::SameName { what, name: names[k].to_string() });
            }
        }
        Ok(())
    }

    /// Hands the solution that one restarts from to the system, which may change its mesh for it.
    fn adopt(&mut self) -> Result<Start, TraceError> {
        let Origin { solution, switch, kind, condition, .. } = &mut self.origin;
        let (switched, kind, of_curve) = (switch.is_some(), *kind, condition.is_some());
        let Some(mut solution) = solution.take() else {
            return Ok(match switched {
                true => Start::BranchPoint { along: None, one_sided: false },
                false => Start::Point { tangent: None },
            });
        };
        solution.parameters = self.x[self.system.names().dimension()..].to_vec();
        solution.switch = *switch;
        let adopted = self.system.resume_from(&solution);
        let Adopted { z, start } = adopted.map_err(|cause| self.not_started(cause))?;
        self.x = [&z[..], &solution.parameters].concat();
        if let (Kind::G, Some(which), Some(events)) =
            (solution.kind, solution.switch, self.system.events())
        {
            let emanating = events.emanating(&self.x, which);
            let Emanating { system, z, along } =
                emanating.map_err(|cause| self.not_started(cause))?;
            self.x = [&z[..], &solution.parameters].concat();
            self.system = SystemRef::Owned(system);
            return Ok(Start::Birth { along });
        }
        if let (true, Start::Point { .. }, Some(kind)) = (switched, &start, kind)
            && kind != Kind::BP
        {
            return Err(self.not_started(Failure::Mismatch(format!(
                "the point to switch at is a {}, but branches cross at branch points (BP) only",
                kind.meaning()
            ))));
        }
        let is_crossing = switched || kind == Some(Kind::BP) && !of_curve && self.held.is_empty();
        Ok(match start {
            Start::Point { tangent } if is_crossing => {
                Start::BranchPoint { along: tangent, one_sided: false }
            }
            start => start,
        })
    }

    /// Why the curve cannot start from a solution.
    pub(super) fn not_started(&self, cause: Failure) -> TraceError {
        let (branch, place) = (self.name.clone(), "the point to restart from".into());
        TraceError::Start { branch, place, cause: Box::new(cause.into()) }
    }

    /// The position of a parameter.
    pub(super) fn parameter(&self, name: &str) -> Result<usize, TraceError> {
        Ok(position("parameter", name, &self.system.names().parameters)?)
    }

    pub(super) fn quantity(&self, name: &str) -> Result<Quantity, TraceError> {
        let parameters = &self.system.names().parameters;
        let known: Vec<&str> =
            parameters.iter().map(String::as_str).chain(self.monitor_names()).collect();
        let place = position("parameter or monitor", name, &known)?;
        Ok(match place.checked_sub(parameters.len()) {
            None => Quantity::Parameter(place),
            Some(monitor) => Quantity::Monitor(monitor),
        })
    }

    /// The names of the system's monitors, then of those attached.
    pub(super) fn monitor_names(&self) -> impl Iterator<Item = &str> {
        let attached = self.attached.iter().map(|attached| attached.name.as_str());
        self.system.names().monitors.iter().map(String::as_str).chain(attached)
    }

    /// The condition that a parameter or a monitor is at a level; `None` for a monitor without a
    /// gradient.
    pub(super) fn level_condition(
        &self,
        (quantity, level): (Quantity, f64),
        kind: Kind,
    ) -> Option<MakeCondition> {
        let own = self.system.names().monitors.len();
        match quantity {
            Quantity::Monitor(m) if m >= own => {
                let dual = self.attached[m - own].dual.clone()?;
                Some(Arc::new(move || Box::new(Equation::new(dual.clone(), level, kind))))
            }
            _ => Some(Arc::new(move || Box::new(Level::new(quantity, level, kind)))),
        }
    }

    /// A parameter or monitor at a level: located by bracketing without a gradient.
    pub(super) fn level(
        &self,
        kind: Kind,
        name: impl Into<String>,
        (quantity, level): (Quantity, f64),
    ) -> Event {
        let condition = self.level_condition((quantity, level), kind);
        let test = Test::Level(quantity, level);
        Event { condition, ..Event::without_condition(name, kind, test) }
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
            // A point that was saved on a bound may be read back beyond it by rounding.
            let inside = value.clamp(low, high);
            if (inside - value).abs() <= 1e-12 * inside.abs().max(1.0) {
                self.x[n + p] = inside;
            } else {
                return Err(TraceError::OutOfRange { name, value, low, high });
            }
            if released.contains(&p) {
                return Err(TraceError::Twice(name));
            }
            released.push(p);
        }
        Ok(released)
    }

    /// Scales that the user gives: of groups first, then of released parameters.
    fn resolve_scales(&self, released: &[usize]) -> Result<Vec<Option<f64>>, TraceError> {
        let names = self.system.names();
        let groups = names.unknowns.iter().map(|group| group.name.as_str());
        let parameters = released.iter().map(|&p| names.parameters[p].as_str());
        let known: Vec<&str> = groups.chain(parameters).collect();
        let mut scales = vec![None; known.len()];
        for (name, value) in &self.scales {
            let place = position("group of unknowns or released parameter", name, &known)?;
            scales[place] = Some(*value);
        }
        Ok(scales)
    }
}
