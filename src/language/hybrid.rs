//! Hybrid systems given as text.

use super::assembling::{Program, elements};
use super::basis::{Basis, Kind, names_of, program_of, states_of};
use super::duration::Duration;
use super::events::{Event, ModeScope, add, check_named};
use super::observed::Scalable;
use super::product::modes_of;
use super::scope::Scope;
use super::source::{Fault, ModelError, Source};
use super::statement::{self, Common, HybridEquations};
use super::tape::Tape;
use crate::core::hybrid::{Guard, HybridSystem, Mode, Scales, guard_scale};
use crate::core::ode::NEGATIVE;
use crate::core::problem::{Forcing, Measure};
use crate::core::scalar::{LaneWidth, Scalar};

/// A hybrid system given as text.
#[derive(Clone, Debug)]
pub struct Hybrid {
    basis: Basis,
    modes: Vec<Mode>,
    guards: Vec<Guard>,
    /// The rates of the states in each mode.
    rates: Vec<Program>,
    /// The events of each guard, one for each mode; `None` in modes that do not have this guard.
    events: Vec<Vec<Option<Event>>>,
    in_lanes: bool,
}

/// Assembles the statement of a hybrid system, for a scene that gives values to some parameters.
pub(super) fn understood(
    source: &Source,
    statement: &HybridEquations,
    given: &[String],
) -> Result<Hybrid, ModelError> {
    let common = statement.common();
    let mut basis = Basis::of(source, common, given)?;
    let (scopes, rates) = understood_modes(&basis, common, &modes_of(source, statement)?)?;
    refuse_later_starts(source, statement, &scopes)?;
    basis.begin(common, &scopes[0].scope)?;
    basis.states = scopes[0].states.clone();
    let modes = scopes.iter().map(|mode| Mode::new(&mode.name, mode.states.clone())).collect();
    let period = Duration::read(&scopes[0].scope, "the period", statement.period.as_ref())?;
    let mut guards: Vec<Guard> = Vec::new();
    let mut events = Vec::new();
    for guard in &statement.guards {
        add(source, guard, (&scopes, &period), &mut guards, &mut events)?;
    }
    let scopes: Vec<&Scope> = scopes.iter().map(|mode| &mode.scope).collect();
    basis.finish(common, &scopes, period, true)?;
    let functions =
        events.iter().flatten().flatten().filter_map(|event: &Event| event.when.function());
    let in_lanes = !rates.iter().map(|rates| &**rates).chain(functions).any(Tape::decides);
    Ok(Hybrid { basis, modes, guards, rates, events, in_lanes })
}

impl Kind for Hybrid {
    fn basis(&self) -> &Basis {
        &self.basis
    }

    /// Checks that the rates are finite in the initial mode.
    fn undefined(&self, x: &[f64], p: &[f64]) -> Option<ModelError> {
        self.rates[self.initial_mode(0, 0.0, x, p)].undefined(&self.basis.source, (0.0, x, p))
    }

    /// Returns the names of the guards whose functions are discontinuous, such as the phase of a
    /// clock: where such a function jumps over zero, its event is missed.
    fn jumping_guards(&self) -> Vec<&str> {
        let jumps = |all: &Vec<Option<Event>>| {
            all.iter().flatten().filter_map(|event| event.when.function()).any(Tape::jumps)
        };
        let all = self.guards.iter().zip(&self.events).filter(|(_, events)| jumps(events));
        all.map(|(guard, _)| &guard.name[..]).collect()
    }

    fn may_jump(&self) -> bool {
        self.rates.iter().any(|rates| rates.may_jump())
    }
}

impl Scalable for Hybrid {
    fn basis_mut(&mut self) -> &mut Basis {
        &mut self.basis
    }
}

impl Hybrid {
    /// Returns whether the guard's event in a mode occurs at the zeros of a function.
    fn vanishes(&self, guard: usize, mode: usize) -> bool {
        self.event(guard, mode).is_some_and(|event| event.when.function().is_some())
    }

    fn event(&self, guard: usize, mode: usize) -> Option<&Event> {
        self.events[guard][mode].as_ref()
    }
}

/// Assembles all modes, with the rates of their states.
fn understood_modes(
    basis: &Basis,
    common: Common,
    modes: &[statement::Mode],
) -> Result<(Vec<ModeScope>, Vec<Program>), ModelError> {
    let (mut scopes, mut rates): (Vec<ModeScope>, Vec<Program>) = Default::default();
    for mode in modes {
        let name = mode.name.text.clone();
        if scopes.iter().any(|known| known.name == name) {
            return Err(basis.source.fault_of(&mode.name, Fault::Twice { name, first: "a mode" }));
        }
        let states = states_of(basis, common, &mode.states, "state in every mode")?;
        let own = Common { definitions: &mode.definitions, ..common };
        let own = basis.scope(own, &states)?.definitions.len();
        let definitions = [&mode.definitions[..], common.definitions].concat();
        let scope = basis.scope(Common { definitions: &definitions, ..common }, &states)?;
        rates.push(program_of(&scope, &states)?);
        let states = names_of(&states);
        scopes.push(ModeScope { name, states, scope, own });
    }
    check_named(&scopes)?;
    Ok((scopes, rates))
}

/// Returns an error if an initial value is given to a state that the initial mode does not have.
fn refuse_later_starts(
    source: &Source,
    statement: &HybridEquations,
    scopes: &[ModeScope],
) -> Result<(), ModelError> {
    let [first, later @ ..] = scopes else { return Ok(()) };
    for (name, _) in &statement.initial {
        for state in elements(&first.scope, name)?.names() {
            let has = |mode: &&ModeScope| mode.states.contains(&state);
            if let (None, Some(mode)) = (first.scope.meaning(&state), later.iter().find(has)) {
                let what =
                    format!("the initial value of `{state}` belongs to mode `{}`", mode.name);
                let reason = format!(
                    "the motion begins in the first mode, `{}`, which does not have this state",
                    first.name
                );
                return Err(source.fault_of(name, Fault::Misplaced { what, reason }).with_help(
                    format!("omit the initial value, or list mode `{}` first", mode.name),
                ));
            }
        }
    }
    Ok(())
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
            // No event leads to this mode.
            None => after.fill(T::constant(f64::NAN)),
        }
    }

    /// Returns the given mode if all its guards are positive; otherwise returns the first mode with
    /// the same states in which all guards are positive.
    fn initial_mode(&self, mode: usize, t: f64, x: &[f64], p: &[f64]) -> usize {
        // A guard that is not finite is reported when motion begins.
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

    fn in_lanes(&self) -> Option<LaneWidth> {
        self.in_lanes.then(LaneWidth::widest)
    }

    fn forcing(&self) -> Forcing {
        self.basis.duration.forcing()
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        self.basis.duration.value(p)
    }

    fn scales(&self, _p: &[f64]) -> Scales {
        self.basis.scales.clone()
    }

    fn monitors(&self) -> Vec<String> {
        self.basis.monitor_names()
    }

    fn monitor<T: Scalar>(&self, monitor: usize, mode: usize, t: T, x: &[T], p: &[T]) -> T {
        self.basis.monitor(monitor, mode, t, x, p)
    }

    fn measures(&self) -> Vec<(String, Measure)> {
        self.basis.measures.clone()
    }
}
