//! What is held along a curve, and the events that are looked for.

use super::event::{Event, MakeCondition, Test, condition_of};
use super::start::VANISHES;
use super::{Continuation, Kind, TraceError};
use crate::core::bifurcation::Fold;
use crate::core::condition::Quantity;
use crate::core::zero::Dynamics;

impl Continuation<'_> {
    /// Makers of the conditions that are held along the curve.
    pub(super) fn resolve_held(
        &mut self,
        parameter: usize,
    ) -> Result<Vec<MakeCondition>, TraceError> {
        if self.held.iter().any(|(kind, make)| *kind == Kind::G && make.is_none()) {
            self.grazing = self.vanishing()?;
        }
        let grazing = |&m: &usize| self.graze_at(m).condition;
        self.held
            .iter()
            .map(|(kind, make)| {
                let known = || match kind {
                    Kind::G => self.grazing.first().map(grazing),
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

    /// Where a monitor that is positive on admissible solutions vanishes.
    fn graze_at(&self, monitor: usize) -> Event {
        let name = self.system.names().monitors[monitor].clone();
        Event::level_of_kind(Kind::G, name, Quantity::Monitor(monitor), 0.0)
    }

    /// Grazings, but for the one that is held.
    fn grazings(&self) -> Vec<Event> {
        let monitors = self.system.grazings().iter().filter(|m| !self.grazing.contains(m));
        monitors.map(|&m| self.graze_at(m)).collect()
    }

    /// Bounds, which end the branch, and their sides.
    fn bounding(&self) -> Result<(Vec<Event>, Vec<f64>), TraceError> {
        let (mut events, mut sides) = (Vec::new(), Vec::new());
        for (name, [low, high]) in self.released.iter().chain(&self.bounds) {
            let quantity = self.quantity(name)?;
            for (level, side) in [(*low, -1.0), (*high, 1.0)] {
                if level.is_finite() {
                    events.push(Event::level_of_kind(Kind::EP, name, quantity, level).ending());
                    sides.push(side);
                }
            }
        }
        Ok((events, sides))
    }

    /// Bifurcations of the solutions or special points that the curve is made of.
    fn bifurcations(&self, parameter: usize) -> Vec<Event> {
        let dynamics = self.system.dynamics();
        let held: Vec<Kind> = self.held.iter().map(|(kind, _)| *kind).collect();
        match (&held[..], dynamics) {
            ([], _) => {
                let motion = match dynamics {
                    Dynamics::Flow => vec![Event::hopf()],
                    Dynamics::Periodic => vec![Event::period_doubling(), Event::torus()],
                    _ => Vec::new(),
                };
                [vec![Event::branch_point(parameter), Event::fold()], motion].concat()
            }
            ([Kind::LP], Dynamics::Flow) => vec![Event::cusp(), Event::bogdanov_takens()],
            ([Kind::LP], _) => vec![Event::cusp()],
            ([Kind::HB], _) => vec![Event::vanishing_frequency()],
            ([Kind::G], _) => {
                let doubling = Event::new("period doubling", Fold::antiperiodic);
                let doubling = Some(doubling).filter(|_| dynamics == Dynamics::Periodic);
                [Event::new("fold", Fold::default)].into_iter().chain(doubling).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Gathers the events, the bounds first, so that a branch ends before anything beyond, and returns the sides
    /// of the bounds.
    pub(super) fn gather_events(
        &mut self,
        parameter: usize,
        held: &[MakeCondition],
    ) -> Result<Vec<f64>, TraceError> {
        let (mut events, mut sides) = self.bounding()?;
        let grazings = self.grazings();
        if !self.beyond {
            sides.extend(grazings.iter().map(|_| -1.0));
            events.extend(grazings.iter().cloned().map(Event::ending));
        }
        for (name, level, kind) in &self.marks {
            let quantity = self.quantity(name)?;
            events.push(Event::level_of_kind(*kind, format!("{name} = {level}"), quantity, *level));
        }
        if self.beyond {
            events.extend(grazings);
        }
        events.extend(self.bifurcations(parameter));
        events.append(&mut self.events);
        let own = held.iter().map(|make| make().unknowns()).sum();
        events.iter().try_for_each(|event| self.check(event, own))?;
        self.events = events;
        Ok(sides)
    }

    /// Refuses an event without a test function, and one at a position that does not exist.
    fn check(&self, event: &Event, own: usize) -> Result<(), TraceError> {
        if event.test == Test::Condition && (event.condition)().unknowns() > 0 {
            return Err(TraceError::NoTest { event: event.name.clone() });
        }
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
}
