//! From what a user asks for to a trace that can run: names resolved, then the start corrected.

use super::run::Tracer;
use super::start::Resolved;
use super::{Continuation, TraceError};
use crate::core::condition::{Failure, Quantity};
use crate::core::names::UnknownName;
use crate::core::solution::{Adopted, Leaving};

impl<'a> Continuation<'a> {
    pub(super) fn prepare(mut self) -> Result<Tracer<'a>, TraceError> {
        self.check_names()?;
        let how = self.adopt()?;
        let released = self.resolve_released()?;
        let held = self.resolve_held(released[0])?;
        let bounds = self.gather_events(released[0], &held)?;
        let (scales, settled) = (self.resolve_scales(&released)?, self.resolve_settled()?);
        self.start(Resolved { released, held, bounds, scales, settled }, how)
    }

    /// Refuses names that two quantities of one sort have.
    fn check_names(&self) -> Result<(), TraceError> {
        let names = self.system.names();
        let unknowns: Vec<&String> = names.unknowns.iter().map(|group| &group.name).collect();
        let sorts = [
            ("unknowns", unknowns),
            ("parameters", names.parameters.iter().collect()),
            ("monitors", names.monitors.iter().collect()),
        ];
        for (what, names) in sorts {
            let again = |k: &usize| names[..*k].contains(&names[*k]);
            if let Some(k) = (0..names.len()).find(again) {
                return Err(TraceError::SameName { what, name: names[k].clone() });
            }
        }
        Ok(())
    }

    /// Hands the solution that one restarts from to the system, which may change its mesh for it.
    fn adopt(&mut self) -> Result<Leaving, TraceError> {
        let Some(mut solution) = self.origin.solution.take() else { return Ok(Leaving::Along) };
        solution.parameters = self.x[self.system.names().dimension()..].to_vec();
        solution.switch = self.origin.switched;
        let adopted = self.system.resume_from(&solution);
        let Adopted { z, tangent, leaving } = adopted.map_err(|cause| self.not_started(cause))?;
        self.x = [&z[..], &solution.parameters].concat();
        self.origin.tangent = tangent;
        self.origin.is_branch_point |= leaving == Leaving::BranchPoint;
        if leaving == Leaving::Switched {
            (self.origin.switched, self.origin.is_birth) = (false, true);
            return Ok(Leaving::Along);
        }
        Ok(leaving)
    }

    /// Why the curve cannot start from a solution.
    pub(super) fn not_started(&self, cause: Failure) -> TraceError {
        TraceError::Start {
            branch: self.name.clone(),
            place: "the point to restart from".into(),
            cause: Box::new(cause.into()),
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
            scales[place] = Some(*value);
        }
        Ok(scales)
    }
}
