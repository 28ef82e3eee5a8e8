//! Hybrid systems that are given as text.

use super::basis::{
    Basis, measures, monitors_of, plain, scales_of, states_of, undefined, values_of,
};
use super::scope::{Assembling, Scope};
use super::smooth::period_of;
use super::source::{Fault, ModelError, Phrase, Source};
use super::statement::{self, HybridEquations, Next};
use super::syntax::Formula;
use super::tape::Tape;
use crate::core::field::Forcing;
use crate::core::hybrid::{Guard, HybridSystem, Mode, Scales};
use crate::core::measure::Measure;
use crate::core::names::{distinct, position};
use crate::core::scalar::Scalar;
use std::f64::consts::TAU;

/// A hybrid system that is given as text.
#[derive(Clone, Debug)]
pub struct Hybrid {
    pub(super) basis: Basis,
    statement: HybridEquations,
    modes: Vec<Mode>,
    guards: Vec<Guard>,
    /// In each mode.
    rates: Vec<Tape>,
    /// Of each guard, in each mode that ends there.
    events: Vec<Vec<Option<Event>>>,
    period: Option<Tape>,
    monitor_names: Vec<String>,
    /// In each mode.
    monitors: Vec<Vec<Tape>>,
    measures: Vec<(String, Measure)>,
    scales: Scales,
    in_lanes: bool,
    aperiodic: bool,
}

/// A guard in one of its modes.
#[derive(Clone, Debug)]
struct Event {
    function: Tape,
    next: Choice,
    accumulates_to: Option<Choice>,
    /// The states after it, for each mode that may follow.
    resets: Vec<(usize, Tape)>,
}

/// The modes that may follow, and the functions of which the first positive one decides.
#[derive(Clone, Debug)]
struct Choice {
    modes: Vec<usize>,
    functions: Tape,
}

impl Choice {
    /// The mode that follows at `(t, x, p)`: the last one if no function is positive.
    fn at(&self, t: f64, x: &[f64], p: &[f64]) -> usize {
        let mut values = vec![0.0; self.modes.len()];
        self.functions.evaluate(t, x, p, &mut values);
        let positive = values.iter().position(|value| *value > 0.0);
        self.modes[positive.unwrap_or(self.modes.len() - 1)]
    }
}

/// A mode of a statement that is being understood.
struct ModeScope {
    name: String,
    states: Vec<String>,
    scope: Scope,
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
        if statement.modes.is_empty() {
            let (what, needed) = ("the equations".into(), "there must be one mode or more".into());
            return Err(source.fault_of(&Phrase::default(), Fault::Missing { what, needed }));
        }
        let (mut scopes, mut rates): (Vec<ModeScope>, Vec<Tape>) = Default::default();
        for mode in &statement.modes {
            let name = plain(source, &mode.name)?;
            if scopes.iter().any(|known| known.name == name) {
                return Err(source.fault_of(&mode.name, Fault::Twice { name, first: "a mode" }));
            }
            let (states, formulas) =
                states_of(&basis, common, &mode.states, "state in every mode")?;
            let scope = basis.scope(common, &states)?;
            let mut assembling = Assembling::new(&scope);
            let values = values_of(&mut assembling, &formulas)?;
            rates.push(assembling.tape(&values));
            let states = states.into_iter().map(|(_, name)| name).collect();
            scopes.push(ModeScope { name, states, scope });
        }
        check_definitions(&scopes)?;
        basis.begin(common, &scopes[0].scope)?;
        let modes: Vec<Mode> =
            scopes.iter().map(|mode| Mode::new(&mode.name, mode.states.clone())).collect();
        let mut guards: Vec<Guard> = Vec::new();
        let mut events = Vec::new();
        for guard in &statement.guards {
            add(source, guard, &scopes, &mut guards, &mut events)?;
        }
        let period = statement
            .period
            .as_ref()
            .map(|period| period_of(&scopes[0].scope, period))
            .transpose()?;
        let of_modes = scopes.iter().map(|mode| monitors_of(&mode.scope, &statement.monitors));
        let of_modes = of_modes.collect::<Result<Vec<_>, _>>()?;
        let monitor_names: Vec<String> = of_modes[0].iter().map(|(name, _)| name.clone()).collect();
        let monitors = of_modes
            .into_iter()
            .map(|all| all.into_iter().map(|(_, tape)| tape).collect())
            .collect();
        let scopes_only: Vec<&Scope> = scopes.iter().map(|mode| &mode.scope).collect();
        basis.look_for_unused(&scopes_only);
        let aperiodic = period.is_none() && scopes_only.iter().any(|scope| scope.uses("t"));
        let all = distinct(modes.iter().flat_map(|mode| &mode.states));
        let all: Vec<String> = all.into_iter().map(String::from).collect();
        let scales = scales(&scales_of(source, &statement.scales, &all, true)?);
        let functions = events.iter().flatten().flatten().map(|event: &Event| &event.function);
        let in_lanes = !rates.iter().chain(functions).any(Tape::decides);
        let measures = measures(&all, monitor_names.clone());
        Ok(Hybrid {
            basis,
            statement,
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

    /// Whether time enters, but not with a period: there are no periodic orbits then.
    pub fn is_aperiodic(&self) -> bool {
        self.aperiodic
    }

    /// The formula of the first mode that has no finite value at `(t, x, p)`, if one has none.
    pub(super) fn undefined(&self, t: f64, x: &[f64], p: &[f64]) -> Option<ModelError> {
        undefined(&self.basis, self.statement.common(), &self.statement.modes[0].states, (t, x, p))
    }

    fn event(&self, guard: usize, mode: usize) -> Option<&Event> {
        self.events[guard][mode].as_ref()
    }
}

fn scales(sizes: &[(String, f64)]) -> Scales {
    let scales = Scales::default();
    sizes.iter().fold(scales, |scales, (name, size)| match name.as_str() {
        "t" => scales.time(*size),
        _ => scales.state(name.clone(), *size),
    })
}

/// Refuses a definition that has no meaning in any mode.
fn check_definitions(scopes: &[ModeScope]) -> Result<(), ModelError> {
    let checks = scopes.iter().map(|mode| Assembling::new(&mode.scope).definition_errors());
    let of_modes: Vec<Vec<Option<ModelError>>> = checks.collect();
    for k in 0..of_modes[0].len() {
        if of_modes.iter().all(|errors| errors[k].is_some()) {
            return of_modes[0][k].clone().map_or(Ok(()), Err);
        }
    }
    Ok(())
}

/// Adds a guard, or the modes in which one of the same name has other functions.
fn add(
    source: &Source,
    stated: &statement::Guard,
    scopes: &[ModeScope],
    guards: &mut Vec<Guard>,
    events: &mut Vec<Vec<Option<Event>>>,
) -> Result<(), ModelError> {
    let name = plain(source, &stated.name)?;
    let (guard, of_modes) = understood(source, name, stated, scopes)?;
    let Some(known) = guards.iter().position(|known| known.name == guard.name) else {
        guards.push(guard);
        events.push(of_modes);
        return Ok(());
    };
    if guard.modes.iter().any(|mode| guards[known].modes.contains(mode)) {
        let fault = Fault::Twice { name: guard.name, first: "a guard in one of these modes" };
        return Err(source.fault_of(&stated.name, fault));
    }
    guards[known].modes.extend(&guard.modes);
    guards[known].accumulates_to = guards[known].accumulates_to.or(guard.accumulates_to);
    for (event, new) in events[known].iter_mut().zip(of_modes) {
        *event = event.take().or(new);
    }
    Ok(())
}

/// A guard, and its event in each of its modes.
fn understood(
    source: &Source,
    name: String,
    guard: &statement::Guard,
    scopes: &[ModeScope],
) -> Result<(Guard, Vec<Option<Event>>), ModelError> {
    let modes = match (&guard.modes[..], scopes.len()) {
        ([], 1) => vec![0],
        ([], _) => {
            let what = format!("the guard `{name}` is in no mode");
            let needed = "name those that end there, as in `modes: [\"flight\"]`".into();
            return Err(source.fault_of(&guard.name, Fault::Missing { what, needed }));
        }
        (names, _) => {
            names.iter().map(|name| mode_of(source, name, scopes)).collect::<Result<Vec<_>, _>>()?
        }
    };
    let mut events: Vec<Option<Event>> = vec![None; scopes.len()];
    let mut accumulates = None;
    for &mode in &modes {
        let scope = &scopes[mode].scope;
        let next = choice(source, &guard.next, scopes, mode)?.unwrap_or(Choice {
            modes: vec![mode],
            functions: Assembling::new(scope).tape(&[super::assembly::Value::number(0.0)]),
        });
        let accumulates_to = choice(source, &guard.accumulates_to, scopes, mode)?;
        accumulates = accumulates_to.as_ref().map(|choice| choice.modes[0]).or(accumulates);
        let mut assembling = Assembling::new(scope);
        let value = assembling.read(&guard.function)?;
        let function = assembling.tape(&[value]);
        let mut resets: Vec<(usize, Tape)> = Vec::new();
        for &after in
            next.modes.iter().chain(accumulates_to.iter().flat_map(|choice| &choice.modes))
        {
            if !resets.iter().any(|(known, _)| *known == after) {
                resets.push((after, reset(source, guard, scopes, (mode, after))?));
            }
        }
        events[mode] = Some(Event { function, next, accumulates_to, resets });
    }
    let stated = Guard::new(name, modes);
    Ok((accumulates.map_or(stated.clone(), |mode| stated.accumulating_to(mode)), events))
}

fn mode_of(source: &Source, name: &Phrase, scopes: &[ModeScope]) -> Result<usize, ModelError> {
    position("mode", &name.text, scopes.iter().map(|mode| &mode.name))
        .map_err(|unknown| source.fault_of(name, Fault::Unknown(unknown)))
}

/// The modes that may follow, if any are named.
fn choice(
    source: &Source,
    next: &Next,
    scopes: &[ModeScope],
    mode: usize,
) -> Result<Option<Choice>, ModelError> {
    if next.0.is_empty() {
        return Ok(None);
    }
    let mut assembling = Assembling::new(&scopes[mode].scope);
    let (mut modes, mut values) = (Vec::new(), Vec::new());
    for (name, function) in &next.0 {
        modes.push(mode_of(source, name, scopes)?);
        values.push(match function {
            Some(function) => assembling.read(function)?,
            None => super::assembly::Value::number(1.0),
        });
    }
    Ok(Some(Choice { modes, functions: assembling.tape(&values) }))
}

/// The states with which a mode begins that follows another one.
fn reset(
    source: &Source,
    guard: &statement::Guard,
    scopes: &[ModeScope],
    (before, after): (usize, usize),
) -> Result<Tape, ModelError> {
    let (before, after) = (&scopes[before], &scopes[after]);
    let mut assembling = Assembling::new(&before.scope);
    for (state, _) in &guard.reset {
        // A reset may be of a state that only some of the modes have which may follow.
        let known = scopes.iter().flat_map(|mode| &mode.states);
        position("state", &state.text, distinct(known))
            .map_err(|unknown| source.fault_of(state, Fault::Unknown(unknown)))?;
    }
    let mut values = Vec::new();
    for state in &after.states {
        let given = guard.reset.iter().find(|(name, _)| name.text == *state);
        values.push(match given {
            Some((_, formula)) => assembling.formula(&Formula::read(source, formula)?)?,
            None if before.states.contains(state) => assembling.read(&state.as_str().into())?,
            None => {
                let what = format!(
                    "the reset of `{}` leaves `{state}` undefined", guard.name.text
                );
                let needed = format!(
                    "`{}` has this state, `{}` before it has not; give it, as in `reset: [(\"{state}\", \"0\")]`",
                    after.name, before.name
                );
                return Err(source.fault_of(&guard.name, Fault::Missing { what, needed }));
            }
        });
    }
    Ok(assembling.tape(&values))
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
        self.event(guard, mode).map_or(T::one(), |event| event.function.value(t, x, p))
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
        match self.period {
            Some(_) => Forcing::Periodic { phase: TAU },
            None => Forcing::None,
        }
    }

    fn period<T: Scalar>(&self, p: &[T]) -> T {
        self.period.as_ref().map_or(T::one(), |period| period.value(T::zero(), &[], p))
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
