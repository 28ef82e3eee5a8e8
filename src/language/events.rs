//! Guards given as text: the condition of their events, the next mode, and the reset of the states.

use super::assembling::{Assembling, elements};
use super::assembly::Value;
use super::basis::{constant, tape_of};
use super::duration::Duration;
use super::elements::{Element, Indices};
use super::product::{following, named};
use super::scope::Scope;
use super::source::{Fault, ModelError, Phrase, Source};
use super::statement::{self, Next};
use super::syntax::{Declared, Formula};
use super::tape::Tape;
use super::times::Times;
use crate::core::hybrid::Guard;
use crate::core::problem::{distinct, position};
use crate::core::scalar::Scalar;
use std::collections::HashMap;

/// The condition under which an event of a guard occurs.
#[derive(Clone, Debug)]
pub(super) enum When {
    /// The event occurs at the zeros of a function.
    Vanishes(Tape),
    /// The event occurs at given times.
    At(Times),
}

impl When {
    /// Returns the value of the guard's function; for events at given times, returns the time left
    /// until the next event.
    pub fn value<T: Scalar>(&self, t: T, x: &[T], p: &[T]) -> T {
        match self {
            When::Vanishes(function) => function.value(t, x, p),
            When::At(times) => times.left(t, p),
        }
    }

    /// Returns the guard's function, or `None` if the events occur at given times.
    pub fn function(&self) -> Option<&Tape> {
        if let When::Vanishes(function) = self { Some(function) } else { None }
    }
}

/// The event of a guard in one of the modes in which the guard is active.
#[derive(Clone, Debug)]
pub(super) struct Event {
    pub when: When,
    pub next: Choice,
    pub accumulates_to: Option<Choice>,
    /// The formulas of the states after the event, for each possible next mode.
    pub resets: Vec<(usize, Tape)>,
}

/// The possible modes after an event, and the functions that select one of them: the mode of the
/// first function with a positive value is selected.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    modes: Vec<usize>,
    functions: Vec<Tape>,
}

impl Choice {
    /// Returns the possible modes after the event, in the order in which their functions are
    /// tested.
    pub fn modes(&self) -> &[usize] {
        &self.modes
    }

    /// Returns the function that selects the mode at a given index.
    pub fn function(&self, position: usize) -> &Tape {
        &self.functions[position]
    }

    /// Returns the mode after an event at `(t, x, p)`; the last mode is returned if no function is
    /// positive.
    pub fn at(&self, t: f64, x: &[f64], p: &[f64]) -> usize {
        let positive = self.functions.iter().position(|function| function.value(t, x, p) > 0.0);
        self.modes[positive.unwrap_or(self.modes.len() - 1)]
    }
}

/// A mode of a statement of equations, while the statement is assembled.
pub(super) struct ModeScope {
    pub name: String,
    pub states: Vec<String>,
    pub scope: Scope,
    /// The number of definitions that belong to this mode only; these definitions precede all
    /// others.
    pub own: usize,
}

/// Returns the names of the modes.
fn names(scopes: &[ModeScope]) -> Vec<&str> {
    scopes.iter().map(|mode| &mode.name[..]).collect()
}

/// Returns an error if a definition or a function is invalid in all modes.
pub(super) fn check_named(scopes: &[ModeScope]) -> Result<(), ModelError> {
    let mut of_modes: Vec<Vec<Option<ModelError>>> = Vec::new();
    for mode in scopes {
        let mut errors = Assembling::new(&mode.scope).errors_of_named();
        let common = errors.split_off(mode.own);
        errors.into_iter().flatten().next().map_or(Ok(()), Err)?;
        of_modes.push(common);
    }
    for k in 0..of_modes[0].len() {
        let errors: Option<Vec<&ModelError>> = of_modes.iter().map(|all| all[k].as_ref()).collect();
        // The error that occurs last in the text is the most helpful one.
        let last = errors.into_iter().flatten().max_by_key(|e| (e.place.line, e.place.column));
        if let Some(error) = last {
            return Err(error.clone());
        }
    }
    Ok(())
}

/// Adds a guard, or extends an existing guard of the same name to further modes.
pub(super) fn add(
    source: &Source,
    stated: &statement::Guard,
    (scopes, period): (&[ModeScope], &Duration),
    guards: &mut Vec<Guard>,
    events: &mut Vec<Vec<Option<Event>>>,
) -> Result<(), ModelError> {
    let name = Declared::plain(source, &stated.name)?;
    let (guard, of_modes) = understood(source, name, stated, (scopes, period))?;
    let Some(known) = guards.iter().position(|known| known.name == guard.name) else {
        guards.push(guard);
        events.push(of_modes);
        return Ok(());
    };
    if guard.modes.iter().any(|mode| guards[known].modes.contains(mode)) {
        return Err(source.twice(&stated.name, guard.name, "a guard in one of these modes"));
    }
    guards[known].modes.extend(&guard.modes);
    let own = &mut guards[known];
    if own.per_period != guard.per_period {
        let (what, reason) = (
            format!("the times of `{}`", guard.name),
            "either all guards of the same name must have functions, or all must have the same \
             number of event times in a period"
                .into(),
        );
        return Err(source.fault_of(&stated.name, Fault::Misplaced { what, reason }));
    }
    own.accumulates_to = own.accumulates_to.or(guard.accumulates_to);
    own.changes_in = own.changes_in.into_iter().chain(guard.changes_in).reduce(f64::min);
    for (event, new) in events[known].iter_mut().zip(of_modes) {
        *event = event.take().or(new);
    }
    Ok(())
}

/// Assembles a guard, with its event in each of the modes in which the guard is active.
fn understood(
    source: &Source,
    name: String,
    guard: &statement::Guard,
    (scopes, period): (&[ModeScope], &Duration),
) -> Result<(Guard, Vec<Option<Event>>), ModelError> {
    let modes = match (&guard.modes[..], scopes.len()) {
        ([], 1) => vec![0],
        ([], _) => {
            let what = format!("the guard `{name}` does not name the modes that it ends");
            let needed = "name the modes that the guard ends, as in `modes: [\"flight\"]`".into();
            return Err(source.fault_of(&guard.name, Fault::Missing { what, needed }));
        }
        (stated, _) => {
            let mut modes = Vec::new();
            for name in stated {
                for mode in named(source, name, &names(scopes))? {
                    if modes.contains(&mode) {
                        let first = "a mode of this guard";
                        let fault = Fault::Twice { name: scopes[mode].name.clone(), first };
                        return Err(source.fault_of(name, fault));
                    }
                    modes.push(mode);
                }
            }
            modes
        }
    };
    let mut events: Vec<Option<Event>> = vec![None; scopes.len()];
    let (mut accumulates, mut per_period) = (None, 0);
    for &mode in &modes {
        let scope = &scopes[mode].scope;
        let next = choice(source, &guard.next, scopes, mode)?
            .unwrap_or(Choice { modes: vec![mode], functions: Vec::new() });
        let accumulates_to = choice(source, &guard.accumulates_to, scopes, mode)?;
        accumulates = accumulates_to.as_ref().map(|choice| choice.modes[0]).or(accumulates);
        let when = when(source, guard, scope)?;
        if let When::At(times) = &when {
            per_period = times.in_period(source, period, scope.parameters())?;
        }
        let mut resets: Vec<(usize, Tape)> = Vec::new();
        for &after in
            next.modes.iter().chain(accumulates_to.iter().flat_map(|choice| &choice.modes))
        {
            if !resets.iter().any(|(known, _)| *known == after) {
                resets.push((after, reset(source, guard, scopes, (mode, after))?));
            }
        }
        events[mode] = Some(Event { when, next, accumulates_to, resets });
    }
    let changes_in = guard.changes_in.as_ref().map(|time| duration(source, time)).transpose()?;
    let guard = Guard::new(name, modes).at(per_period);
    Ok((Guard { accumulates_to: accumulates, changes_in, ..guard }, events))
}

/// Returns the condition that triggers a guard's event in a mode.
fn when(source: &Source, guard: &statement::Guard, scope: &Scope) -> Result<When, ModelError> {
    let name = &guard.name.text;
    match (&guard.function, &guard.at) {
        (Some(function), None) => Ok(When::Vanishes(tape_of(scope, function)?)),
        (None, Some(at)) => {
            let unused = [!guard.accumulates_to.0.is_empty(), guard.changes_in.is_some()];
            if unused.contains(&true) {
                let what = format!("`accumulates_to` or `changes_in` of `{name}`");
                let reason = "the events of this guard occur at prescribed times".into();
                return Err(source
                    .fault_of(&guard.name, Fault::Misplaced { what, reason })
                    .with_help("omit both fields"));
            }
            Ok(When::At(Times::read(scope, at)?))
        }
        (None, None) => {
            let what = format!("the guard `{name}` has neither a `function` nor event times `at`");
            let needed =
                "give the guard a `function`, which is positive while the mode lasts, or event \
                 times `at`, as in `at: \"n*period\"`"
                    .into();
            Err(source.fault_of(&guard.name, Fault::Missing { what, needed }))
        }
        (Some(_), Some(at)) => {
            let what = format!("`at` of `{name}`");
            let reason = "a guard with a `function` cannot have event times `at`".into();
            Err(source.fault_of(at, Fault::Misplaced { what, reason }).with_help(
                "state either `function`, whose zeros are the events, or `at`, the times of the \
                 events",
            ))
        }
    }
}

/// Evaluates the setting `changes_in`, the time scale on which the function of a guard changes; the
/// time must be positive.
fn duration(source: &Source, phrase: &Phrase) -> Result<f64, ModelError> {
    let time = constant(&Scope::new(source.clone()), phrase)?;
    if time > 0.0 {
        return Ok(time);
    }
    let (what, reason) = (
        "the time `changes_in`".into(),
        "the time scale on which a guard changes must be above 0".into(),
    );
    Err(source.fault_of(phrase, Fault::Misplaced { what, reason }))
}

/// Returns the possible next modes, or `None` if the statement names no next mode.
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
    let (mut modes, mut functions) = (Vec::new(), Vec::new());
    for (k, (name, function)) in next.0.iter().enumerate() {
        if function.is_none() && k + 1 < next.0.len() {
            let what = format!("`{}` without a function", name.text);
            let reason =
                "the modes after a mode without a function are never reached, so only the last \
                 mode may lack a function"
                    .into();
            return Err(source.fault_of(name, Fault::Misplaced { what, reason }));
        }
        modes.push(following(source, name, &names(scopes), mode)?);
        let value = match function {
            Some(function) => assembling.read(function)?,
            None => Value::number(1.0),
        };
        functions.push(assembling.tape(&[value]));
    }
    Ok(Some(Choice { modes, functions }))
}

/// For each state that is reset, by its name: the formula of its value after the event, and the
/// values of the state's array indices.
type Resets = HashMap<String, (Formula, Indices)>;

/// Returns the reset formulas of a guard in a mode, by the names of the reset states; a name with a
/// range of indices resets all elements in the range.
fn resets(
    source: &Source,
    guard: &statement::Guard,
    scopes: &[ModeScope],
    before: &Scope,
) -> Result<Resets, ModelError> {
    // A reset may concern a state that only some of the possible next modes have.
    let known = distinct(scopes.iter().flat_map(|mode| &mode.states));
    let mut resets = Resets::new();
    for (name, formula) in &guard.reset {
        let formula = Formula::read(source, formula)?;
        for Element { name: state, at } in elements(before, name)?.iter() {
            position("state", &state, known.iter().copied())
                .map_err(|unknown| source.fault_of(name, Fault::Unknown(unknown)))?;
            if resets.insert(state.clone(), (formula.clone(), at)).is_some() {
                return Err(source.twice(name, state, "reset"));
            }
        }
    }
    Ok(resets)
}

/// Returns the tape (the list of operations) that computes, from the states before an event, the
/// states of the next mode immediately after the event.
fn reset(
    source: &Source,
    guard: &statement::Guard,
    scopes: &[ModeScope],
    (before, after): (usize, usize),
) -> Result<Tape, ModelError> {
    let (before, after) = (&scopes[before], &scopes[after]);
    let mut assembling = Assembling::new(&before.scope);
    let resets = resets(source, guard, scopes, &before.scope)?;
    let mut values = Vec::new();
    for state in &after.states {
        values.push(match resets.get(state) {
            Some((formula, at)) => assembling.indexed(formula, at)?,
            None if before.states.contains(state) => assembling.read(&state.as_str().into())?,
            None => {
                let what =
                    format!(
                        "the reset of `{}` leaves `{state}` undefined, a state of mode `{}` but not of `{}` \
                         before the event",
                        guard.name.text, after.name, before.name
                    );
                let needed =
                    format!("give the value, as in `reset: [(\"{state}\", \"0\")]`");
                return Err(source.fault_of(&guard.name, Fault::Missing { what, needed }));
            }
        });
    }
    Ok(assembling.tape(&values))
}
