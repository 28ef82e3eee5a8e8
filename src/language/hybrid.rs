//! Hybrid systems that are given as text.

use super::assembling::{Assembling, elements};
use super::basis::{Basis, measures, monitors_of, scales_of, states_of, undefined, values_of};
use super::events::{Event, ModeScope, add, check_named};
use super::period::Period;
use super::product::modes_of;
use super::scope::Scope;
use super::source::{Fault, ModelError, Source};
use super::statement::{self, Common, HybridEquations};
use super::tape::Tape;
use crate::core::hybrid::{Guard, HybridSystem, Mode, Scales, guard_scale};
use crate::core::ode::NEGATIVE;
use crate::core::problem::{Forcing, Measure, distinct};
use crate::core::scalar::Scalar;

/// A hybrid system that is given as text.
#[derive(Clone, Debug)]
pub struct Hybrid {
    pub(super) basis: Basis,
    statement: HybridEquations,
    stated_modes: Vec<statement::Mode>,
    modes: Vec<Mode>,
    guards: Vec<Guard>,
    /// In each mode.
    rates: Vec<Tape>,
    /// Of each guard, in each mode that ends there.
    events: Vec<Vec<Option<Event>>>,
    period: Period,
    monitor_names: Vec<String>,
    /// In each mode.
    monitors: Vec<Vec<Tape>>,
    measures: Vec<(String, Measure)>,
    scales: Scales,
    in_lanes: bool,
    aperiodic: bool,
}

impl Hybrid {
    /// Understands a statement, for a scene that gives some parameters.
    pub(super) fn new(
        source: &Source,
        statement: HybridEquations,
        given: &[String],
    ) -> Result<Self, ModelError> {
        let common = statement.common();
        let mut basis = Basis::of(source, common, given)?;
        let stated_modes = modes_of(source, &statement)?;
        let (scopes, rates) = understood_modes(&basis, statement.common(), &stated_modes)?;
        refuse_later_starts(source, &statement, &scopes)?;
        basis.begin(common, &scopes[0].scope)?;
        let modes: Vec<Mode> =
            scopes.iter().map(|mode| Mode::new(&mode.name, mode.states.clone())).collect();
        let period = Period::read(&scopes[0].scope, statement.period.as_ref())?;
        let mut guards: Vec<Guard> = Vec::new();
        let mut events = Vec::new();
        for guard in &statement.guards {
            add(source, guard, (&scopes, &period), &mut guards, &mut events)?;
        }
        let of_modes = scopes.iter().map(|mode| monitors_of(&mode.scope, &statement.monitors));
        let of_modes = of_modes.collect::<Result<Vec<_>, _>>()?;
        let monitor_names: Vec<String> = of_modes[0].iter().map(|(name, _)| name.clone()).collect();
        let tapes = |all: Vec<(String, Tape)>| all.into_iter().map(|(_, tape)| tape).collect();
        let monitors = of_modes.into_iter().map(tapes).collect();
        let scopes_only: Vec<&Scope> = scopes.iter().map(|mode| &mode.scope).collect();
        basis.look_for_unused(&scopes_only);
        let aperiodic = period.is_none() && scopes_only.iter().any(|scope| scope.uses("t"));
        let all = distinct(modes.iter().flat_map(|mode| &mode.states));
        let all: Vec<String> = all.into_iter().map(String::from).collect();
        let scales = scales(&scales_of(source, &statement.scales, &all, true)?);
        let functions =
            events.iter().flatten().flatten().filter_map(|event: &Event| event.when.function());
        let in_lanes = !rates.iter().chain(functions).any(Tape::decides);
        let measures = measures(&all, monitor_names.clone());
        Ok(Hybrid {
            basis,
            statement,
            stated_modes,
            modes,
            guards,
            rates,
            events,
            period,
            monitor_names,
            monitors,
            measures,
            scales,
            in_lanes,
            aperiodic,
        })
    }

    /// The guards that jump, as phases of a clock do: where one jumps away from zero, no event is
    /// seen.
    pub(super) fn jumping(&self) -> impl Iterator<Item = &str> {
        let jumps = |all: &Vec<Option<Event>>| {
            all.iter().flatten().filter_map(|event| event.when.function()).any(Tape::jumps)
        };
        let all = self.guards.iter().zip(&self.events);
        all.filter(move |(_, events)| jumps(events)).map(|(guard, _)| &guard.name[..])
    }

    /// Whether time enters, but not with a period: there are no periodic orbits then.
    pub fn is_aperiodic(&self) -> bool {
        self.aperiodic
    }

    /// The error of a period that is not positive for some parameters.
    pub(super) fn refused_duration(&self, p: &[f64]) -> Option<ModelError> {
        self.period.refused(&self.basis.source, p)
    }

    /// The formula of the first mode that has no finite value at `(t, x, p)`, if one has none.
    pub(super) fn undefined(&self, t: f64, x: &[f64], p: &[f64]) -> Option<ModelError> {
        let begins = &self.stated_modes[self.initial_mode(0, t, x, p)];
        let definitions = [&begins.definitions[..], &self.statement.definitions].concat();
        let common = Common { definitions: &definitions, ..self.statement.common() };
        undefined(&self.basis, common, &begins.states, (t, x, p))
    }

    /// Whether a mode ends where the function of a guard vanishes.
    fn vanishes(&self, guard: usize, mode: usize) -> bool {
        self.event(guard, mode).is_some_and(|event| event.when.function().is_some())
    }

    fn event(&self, guard: usize, mode: usize) -> Option<&Event> {
        self.events[guard][mode].as_ref()
    }
}

/// The modes, and the rates of their states.
fn understood_modes(
    basis: &Basis,
    common: Common,
    modes: &[statement::Mode],
) -> Result<(Vec<ModeScope>, Vec<Tape>), ModelError> {
    let (mut scopes, mut rates): (Vec<ModeScope>, Vec<Tape>) = Default::default();
    for mode in modes {
        let name = mode.name.text.clone();
        if scopes.iter().any(|known| known.name == name) {
            return Err(basis.source.fault_of(&mode.name, Fault::Twice { name, first: "a mode" }));
        }
        let (states, formulas) = states_of(basis, common, &mode.states, "state in every mode")?;
        let own = Common { definitions: &mode.definitions, ..common };
        let own = basis.scope(own, &states)?.definitions.len();
        let definitions = [&mode.definitions[..], common.definitions].concat();
        let scope = basis.scope(Common { definitions: &definitions, ..common }, &states)?;
        let mut assembling = Assembling::new(&scope);
        let values = values_of(&mut assembling, &formulas)?;
        rates.push(assembling.tape(&values));
        let states = states.into_iter().map(|(_, name)| name).collect();
        scopes.push(ModeScope { name, states, scope, own });
    }
    check_named(&scopes)?;
    Ok((scopes, rates))
}

/// Refuses initial values of states that the first mode, in which motion begins, has not.
fn refuse_later_starts(
    source: &Source,
    statement: &HybridEquations,
    scopes: &[ModeScope],
) -> Result<(), ModelError> {
    let [first, later @ ..] = scopes else { return Ok(()) };
    for (name, _) in &statement.initial {
        for (state, _) in elements(&first.scope, name)? {
            let has = |mode: &&ModeScope| mode.states.contains(&state);
            if let (None, Some(mode)) = (first.scope.meaning(&state), later.iter().find(has)) {
                let what = format!("`{state}` is a state of mode `{}`", mode.name);
                let reason = format!(
                    "motion begins in mode `{}`, the first one, which has not this state: leave it out, or state `{}` first",
                    first.name, mode.name
                );
                return Err(source.fault_of(name, Fault::Misplaced { what, reason }));
            }
        }
    }
    Ok(())
}

/// Typical sizes of states and of time.
pub(super) fn scales(sizes: &[(String, f64)]) -> Scales {
    let scales = Scales::default();
    sizes.iter().fold(scales, |scales, (name, size)| match name.as_str() {
        "t" => scales.time(*size),
        _ => scales.state(name.clone(), *size),
    })
}

impl HybridSystem for Hybrid {
    fn modes(&self) -> Vec<Mode> {
        self.modes.clone()
    }

    fn guards(&self) -> Vec<Guard> {
        self.guards.clone()
    }

    fn parameters(&self) -> Vec<String> {
        self.basis.parameters.clone()
    }

    fn defaults(&self) -> Vec<f64> {
        self.basis.defaults.clone()
    }

    #[inline]
    fn field<T: Scalar>(&self, mode: usize, t: T, x: &[T], p: &[T], f: &mut [T]) {
        self.rates[mode].evaluate(t, x, p, f);
    }

    fn guard<T: Scalar>(&self, guard: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        self.event(guard, mode).map_or(T::one(), |event| event.when.value(t, x, p))
    }

    fn reset<T: Scalar>(
        &self,
        guard: usize,
        (mode, next): (usize, usize),
        t: T,
        x: &[T],
        p: &[T],
        after: &mut [T],
    ) {
        let resets = self.event(guard, mode).map(|event| &event.resets);
        match resets.and_then(|resets| resets.iter().find(|(to, _)| *to == next)) {
            Some((_, tape)) => tape.evaluate(t, x, p, after),
            // No event leads there.
            None => after.fill(T::constant(f64::NAN)),
        }
    }

    /// The mode that is given, if its guards hold there; else the first one with the same states of
    /// which the guards do.
    fn initial_mode(&self, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        // A guard that is not finite is reported where motion begins.
        let fallen = |guard: usize, mode: usize| {
            let scale = guard_scale(self, (guard, mode), (t, x), p);
            self.guard(guard, mode, t, x, p) < -NEGATIVE * scale
        };
        let holds = |mode: &usize| {
            let mut guards = (0..self.guards.len()).filter(|guard| self.vanishes(*guard, *mode));
            self.modes[*mode].states.len() == x.len() && !guards.any(|guard| fallen(guard, *mode))
        };
        let same = |other: &usize| self.modes[*other].states == self.modes[mode].states;
        let others = (0..self.modes.len()).filter(same);
        [mode].into_iter().chain(others).find(holds).unwrap_or(mode)
    }

    fn may_follow(&self, guard: usize, mode: usize) -> Vec<usize> {
        self.event(guard, mode).map_or(Vec::new(), |event| event.next.modes().to_vec())
    }

    fn decision<T: Scalar>(
        &self,
        position: usize,
        guard: usize,
        mode: usize,
        t: T,
        x: &[T],
        p: &[T],
    ) -> T {
        let function = self.event(guard, mode).map(|event| event.next.function(position));
        function.map_or(T::constant(f64::NAN), |function| function.value(t, x, p))
    }

    fn next_mode(&self, guard: usize, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        self.event(guard, mode).map_or(mode, |event| event.next.at(t, x, p))
    }

    fn mode_after_accumulation(
        &self,
        guard: usize,
        mode: usize,
        t: f64,
        x: &[f64],
        p: &[f64],
    ) -> Option<usize> {
        Some(self.event(guard, mode)?.accumulates_to.as_ref()?.at(t, x, p))
    }

    fn in_lanes(&self) -> bool {
        self.in_lanes
    }

    fn forcing(&self) -> Forcing {
        self.period.forcing()
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        self.period.value(p)
    }

    fn scales(&self, _p: &[f64]) -> Scales {
        self.scales.clone()
    }

    fn monitors(&self) -> Vec<String> {
        self.monitor_names.clone()
    }

    fn monitor<T: Scalar>(&self, monitor: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        self.monitors[mode][monitor].value(t, x, p)
    }

    fn measures(&self) -> Vec<(String, Measure)> {
        self.measures.clone()
    }
}
