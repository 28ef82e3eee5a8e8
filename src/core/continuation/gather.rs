//! What is held along a curve, and the events that are looked for.

use super::bounds::Bound;
use super::event::{Event, MakeCondition};
use super::recorder::VANISHES;
use super::{Continuation, Kind, Settings, TraceError};
use crate::core::bifurcation::catalogue::{self, CATALOGUE};
use crate::core::condition::Quantity;
use crate::core::test_function::Test;

impl Continuation<'_> {
    /// Makers of the conditions that are held along the curve.
    pub(super) fn resolve_held(
        &mut self,
        parameter: usize,
    ) -> Result<Vec<MakeCondition>, TraceError> {
        if self.held.iter().any(|(kind, make)| *kind == Kind::G && make.is_none()) {
            self.grazing = self.vanishing()?;
        }
        self.check_held()?;
        let grazing = |&m: &usize| self.graze_at(m).condition;
        self.held
            .iter()
            .map(|(kind, make)| {
                let known = || match *kind {
                    Kind::G => self.grazing.first().and_then(grazing),
                    _ => Event::bifurcation(*kind, parameter).and_then(|event| event.condition),
                };
                make.clone().or_else(known).ok_or(TraceError::NotHeld(*kind))
            })
            .collect()
    }

    /// Refuses kinds that solutions of the problem do not have, and those that need another one.
    fn check_held(&self) -> Result<(), TraceError> {
        let dynamics = self.system.dynamics();
        let held: Vec<Kind> = self.held.iter().map(|(kind, _)| *kind).collect();
        let known = self.held.iter().filter(|(_, make)| make.is_none());
        let mut rows = known.filter_map(|(kind, _)| catalogue::row(*kind));
        let refused = rows.find_map(|row| Some((row.kind, row.why_not_held(dynamics, &held)?)));
        match refused {
            Some((kind, reason)) => Err(TraceError::NotOfProblem { kind, reason }),
            None => Ok(()),
        }
    }

    /// The monitors that vanish at the start, of those that vanish where a solution grazes: several
    /// do where an event comes with a leg of no length.
    fn vanishing(&mut self) -> Result<Vec<usize>, TraceError> {
        let (system, x) = (&mut *self.system, &self.x);
        let mut values = vec![0.0; system.names().monitors.len()];
        if let Err(cause) = system.monitors(x, &mut values) {
            return Err(self.not_started(cause));
        }
        let (mut vanishing, p) = (system.limits(), &x[system.names().dimension()..]);
        vanishing.retain(|m| values[*m].abs() < VANISHES * system.limit_scale(*m, p));
        Ok(vanishing)
    }

    /// Where a monitor that is positive on admissible solutions vanishes.
    fn graze_at(&self, monitor: usize) -> Event {
        let name = self.system.names().monitors[monitor].clone();
        self.level(Kind::G, name, (Quantity::Monitor(monitor), 0.0))
    }

    /// Grazings, but for the one that is held.
    fn grazings(&mut self) -> Vec<Event> {
        let monitors = self.system.limits().into_iter();
        monitors.filter(|m| !self.grazing.contains(m)).map(|m| self.graze_at(m)).collect()
    }

    /// Bounds, which end the branch.
    fn bounding(&self) -> Result<(Vec<Event>, Vec<Bound>), TraceError> {
        let (mut events, mut bounds) = (Vec::new(), Vec::new());
        for (name, range) in self.released.iter().chain(&self.bounds) {
            let quantity = self.quantity(name)?;
            for (level, side) in range.iter().zip([-1.0, 1.0]) {
                if level.is_finite() {
                    events.push(self.level(Kind::EP, name, (quantity, *level)).ending());
                    bounds.push(Bound { side, range: *range });
                }
            }
        }
        Ok((events, bounds))
    }

    /// Bifurcations of the solutions or special points that the curve is made of; first the ends,
    /// of which others may be images.
    fn bifurcations(&self, parameter: usize) -> Vec<Event> {
        let dynamics = self.system.dynamics();
        let held: Vec<Kind> = self.held.iter().map(|(kind, _)| *kind).collect();
        let Settings { detect, stability, .. } = &self.settings;
        let wanted = |event: &Event| {
            let asked = detect.is_empty() || detect.contains(&event.kind);
            event.terminal || asked && (*stability || !event.test.needs_eigenvalues())
        };
        let sightings = CATALOGUE.iter().flat_map(|row| row.seen.iter().map(move |it| (row, it)));
        let here = sightings.filter(|(_, it)| it.held == held && it.of.are(dynamics));
        let events = here.map(|(row, it)| Event::of_catalogue(row, it, parameter)).filter(wanted);
        let (ends, others): (Vec<Event>, Vec<Event>) = events.partition(|event| event.terminal);
        [ends, others].concat()
    }

    /// Gathers the events, the bounds first, so that a branch ends before anything beyond, and
    /// returns those.
    pub(super) fn gather_events(
        &mut self,
        parameter: usize,
        held: &[MakeCondition],
    ) -> Result<Vec<Bound>, TraceError> {
        let (mut events, mut bounds) = self.bounding()?;
        let grazings = self.grazings();
        if !self.beyond {
            let bound = |_| Bound { side: -1.0, range: [0.0, f64::INFINITY] };
            bounds.extend(grazings.iter().map(bound));
            events.extend(grazings.iter().cloned().map(Event::ending));
        }
        for (name, level, kind) in &self.marks {
            let quantity = self.quantity(name)?;
            events.push(self.level(*kind, format!("{name} = {level}"), (quantity, *level)));
        }
        if self.beyond {
            events.extend(grazings);
        }
        // Along a curve of grazings rounding decides.
        if !self.system.words().is_empty() && self.grazing.is_empty() {
            events.push(Event { terminal: !self.beyond, ..Event::of_itinerary() });
        }
        events.extend(self.bifurcations(parameter));
        events.append(&mut self.events);
        let own = held.iter().map(|make| make().unknowns()).sum();
        events.iter().try_for_each(|event| self.check(event, own))?;
        self.events = events;
        Ok(bounds)
    }

    /// Refuses an event without a test function, and one at a position that does not exist.
    fn check(&self, event: &Event, own: usize) -> Result<(), TraceError> {
        let untested = event.condition.as_ref().is_none_or(|make| make().unknowns() > 0);
        if event.test == Test::Condition && untested {
            return Err(TraceError::NoTest(event.name.clone()));
        }
        let names = self.system.names();
        let (what, position, count) = match event.test {
            Test::Level(Quantity::Parameter(p), _) => ("parameter", p, names.parameters.len()),
            Test::Level(Quantity::Monitor(m), _) => {
                ("monitor", m, names.monitors.len() + self.attached.len())
            }
            Test::Own { unknown, .. } => ("own unknown", unknown, own),
            _ => return Ok(()),
        };
        if position < count {
            return Ok(());
        }
        Err(TraceError::Position { event: event.name.clone(), what, position, count })
    }
}
