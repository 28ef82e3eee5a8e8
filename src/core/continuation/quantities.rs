//! Parameters and monitors by name, and the events at which they take given levels.

use super::admissible::AT_LIMIT;
use super::error::TraceError;
use super::event::{Event, MakeCondition};
use super::function::{Attached, Equation};
use crate::core::bifurcation::{Excess, Level, Needs, Quantity};
use crate::core::problem::{Names, columns_showing, position};
use crate::core::system::{HOMOCLINIC_GAP, HOMOCLINIC_TESTS, Kind};
use std::sync::Arc;

/// The parameters and monitors of a problem, including user-defined monitors.
pub(super) struct Quantities<'c> {
    names: &'c Names,
    attached: &'c [Attached],
}

impl<'c> Quantities<'c> {
    pub fn new(names: &'c Names, attached: &'c [Attached]) -> Self {
        Quantities { names, attached }
    }

    /// Returns the names of the monitors of the system, followed by the names of user-defined
    /// monitors.
    pub fn monitors(&self) -> impl Iterator<Item = &'c str> {
        let attached = self.attached.iter().map(|attached| attached.name.as_str());
        self.names.monitors.iter().map(String::as_str).chain(attached)
    }

    /// Returns an error if two unknowns, parameters or monitors have the same name.
    pub fn check(&self) -> Result<(), TraceError> {
        let sorts: [(_, Vec<&str>); 3] = [
            ("unknowns", self.names.unknowns.iter().map(|group| group.name.as_str()).collect()),
            ("parameters", self.names.parameters.iter().map(String::as_str).collect()),
            ("monitors", self.monitors().collect()),
        ];
        for (what, names) in sorts {
            let again = |k: &usize| names[..*k].contains(&names[*k]);
            if let Some(k) = (0..names.len()).find(again) {
                return Err(TraceError::SameName { what, name: names[k].to_string() });
            }
        }
        Ok(())
    }

    /// Returns the index of the column of a parameter or monitor; the columns of parameters come
    /// first.
    pub fn column(&self, name: &str) -> Result<usize, TraceError> {
        let parameters = self.names.parameters.iter().map(String::as_str);
        let known: Vec<&str> = parameters.chain(self.monitors()).collect();
        Ok(position("parameter or monitor", name, &known)?)
    }

    /// Returns the names of the columns that show a quantity: the parameter or monitor itself, or,
    /// for a state of an orbit, its maximum and minimum. An unknown name is returned unchanged.
    pub fn showing(&self, name: &str) -> Vec<String> {
        let columns = columns_showing(name, |column| self.column(column).is_ok());
        if columns.is_empty() { vec![name.into()] } else { columns }
    }

    /// Returns the parameter or monitor with the given name.
    pub fn find(&self, name: &str) -> Result<Quantity, TraceError> {
        let column = self.column(name)?;
        Ok(match column.checked_sub(self.names.parameters.len()) {
            None => Quantity::Parameter(column),
            Some(monitor) => Quantity::Monitor(monitor),
        })
    }

    /// Returns the defining system of a parameter or a monitor at a level; `None` for a monitor
    /// without a gradient.
    pub fn condition(
        &self,
        (quantity, level): (Quantity, f64),
        kind: Kind,
    ) -> Option<MakeCondition> {
        let own = self.names.monitors.len();
        match quantity {
            Quantity::Monitor(m) if m >= own => {
                let dual = self.attached[m - own].dual.clone()?;
                Some(Arc::new(move || Box::new(Equation::new(dual.clone(), level, kind))))
            }
            _ => Some(Arc::new(move || Box::new(Level::new(quantity, level, kind)))),
        }
    }

    /// Creates the event at which a parameter or monitor takes a given level. The event is located
    /// by bracketing if the monitor has no gradient.
    pub fn event(
        &self,
        kind: Kind,
        name: impl Into<String>,
        (quantity, level): (Quantity, f64),
    ) -> Event {
        let condition = self.condition((quantity, level), kind);
        let test = Arc::new(Excess(quantity, level));
        Event { condition, ..Event::without_condition(name, kind, test) }
    }

    /// Creates the event at which the monitor of a limit of admissible solutions vanishes.
    pub fn limit(&self, monitor: usize) -> Event {
        let name = self.names.monitors[monitor].clone();
        self.event(AT_LIMIT, name, (Quantity::Monitor(monitor), 0.0))
    }

    /// Creates the event of a vanishing gap between the two invariant manifolds that an orbit
    /// connects; `None` if the solutions of the problem have no gap.
    pub fn homoclinic(&self) -> Option<Event> {
        let monitor = self.names.monitors.iter().position(|name| name == HOMOCLINIC_GAP)?;
        let words = Kind::HOM.meaning();
        Some(self.event(Kind::HOM, words, (Quantity::Monitor(monitor), 0.0)))
    }

    /// Creates the events of codimension-two points on curves of homoclinic orbits.
    pub fn on_homoclinic_curves(&self) -> impl Iterator<Item = Event> {
        HOMOCLINIC_TESTS.into_iter().filter_map(|(name, kind)| {
            let monitor = self.names.monitors.iter().position(|own| own == name)?;
            Some(self.event(kind, kind.meaning(), (Quantity::Monitor(monitor), 0.0)))
        })
    }

    /// Returns an error if an event has no test function, or refers to a parameter, monitor or
    /// auxiliary unknown that does not exist; `own` is the number of auxiliary unknowns along the
    /// curve.
    pub fn check_event(&self, event: &Event, own: usize) -> Result<(), TraceError> {
        let untested = event.condition.as_ref().is_none_or(|make| make().unknowns() > 0);
        if event.test.needs() == Needs::DefiningSystem && untested {
            return Err(TraceError::NoTest(event.name.clone()));
        }
        let (what, position, count) = match (event.test.level(), event.test.auxiliary()) {
            (Some((Quantity::Parameter(p), _)), _) => ("parameter", p, self.names.parameters.len()),
            (Some((Quantity::Monitor(m), _)), _) => ("monitor", m, self.monitors().count()),
            (None, Some((unknown, _))) => ("auxiliary unknown", unknown, own),
            (None, None) => return Ok(()),
        };
        if position < count {
            return Ok(());
        }
        Err(TraceError::Position { event: event.name.clone(), what, position, count })
    }
}
