//! The modes of a hybrid system given as text: a list of modes, or all combinations of the
//! alternative modes of several parts, for example of contact and friction.

use super::source::{Fault, ModelError, Phrase, Source};
use super::statement::{HybridEquations, Mode};
use super::syntax::Declared;
use crate::core::problem::position;

/// The character that separates the names of the parts' modes in the name of a combined mode.
const AND: char = '.';
/// The maximum number of combined modes.
const MOST: usize = 256;

/// Returns the modes of a statement; each mode includes the states that are common to all modes.
///
/// # Errors
/// [`ModelError`] if there are no modes or too many modes, or if two modes of the parts have the
/// same name.
pub(super) fn modes_of(
    source: &Source,
    statement: &HybridEquations,
) -> Result<Vec<Mode>, ModelError> {
    let HybridEquations { modes, product, states, .. } = statement;
    let common = Mode { states: states.clone(), ..Mode::default() };
    match (&modes[..], &product[..]) {
        ([], []) => {
            let (what, needed) =
                ("the equations have no mode".into(), "state at least one mode".into());
            Err(source.fault_of(&Phrase::default(), Fault::Missing { what, needed }))
        }
        ([first, ..], [_, ..]) => {
            let (what, reason) = (
                "`modes` together with `product`".into(),
                "`product` alone defines the modes, as the combinations of its alternatives".into(),
            );
            Err(source.fault_of(&first.name, Fault::Misplaced { what, reason }))
        }
        (modes, []) => {
            let named = |mode: &Mode| {
                let name = mode.name.rewritten(Declared::plain(source, &mode.name)?);
                Ok(Mode { name, ..joined(&common, mode) })
            };
            modes.iter().map(named).collect()
        }
        ([], parts) => combinations(source, common, parts),
    }
}

/// Returns all combined modes; a combined mode consists of one mode of each part of the system.
fn combinations(
    source: &Source,
    common: Mode,
    parts: &[Vec<Mode>],
) -> Result<Vec<Mode>, ModelError> {
    let mut known = Vec::new();
    for alternative in parts.iter().flatten() {
        let name = Declared::plain(source, &alternative.name)?;
        if known.contains(&name) {
            let fault = Fault::Twice { name, first: "an alternative" };
            return Err(source.fault_of(&alternative.name, fault));
        }
        known.push(name);
    }
    let count = parts.iter().try_fold(1_usize, |count, part| count.checked_mul(part.len()));
    if count.is_none_or(|count| count == 0 || count > MOST) {
        let what = "the combinations in `product`".into();
        let reason = format!(
            "the number of combinations must be between 1 and {MOST}, and each part of the product \
             needs at least one alternative mode"
        );
        return Err(source.fault_of(&Phrase::default(), Fault::Misplaced { what, reason }));
    }
    let with = |modes: Vec<Mode>, part: &Vec<Mode>| -> Vec<Mode> {
        let each = |mode: Mode| part.iter().map(move |own| joined(&mode, own));
        modes.into_iter().flat_map(each).collect()
    };
    Ok(parts.iter().fold(vec![common], with))
}

/// Joins the names, the states and the definitions of two modes into one mode.
fn joined(first: &Mode, second: &Mode) -> Mode {
    let name = match first.name.text.is_empty() {
        true => second.name.clone(),
        false => first.name.rewritten(format!("{}{AND}{}", first.name.text, second.name.text)),
    };
    let states = [&first.states[..], &second.states].concat();
    let definitions = [&first.definitions[..], &second.definitions].concat();
    Mode { name, states, definitions }
}

/// Splits the name of a combined mode into the names of the modes of the parts.
fn alternatives(name: &str) -> impl Iterator<Item = &str> {
    name.split(AND)
}

/// Returns the combined modes that a name denotes: the name lists modes of one or more parts, and a
/// combined mode is returned if it contains all listed modes.
///
/// # Errors
/// [`ModelError`] if the name is unknown.
pub(super) fn named(
    source: &Source,
    name: &Phrase,
    modes: &[&str],
) -> Result<Vec<usize>, ModelError> {
    let has = |mode: &str, own: &str| alternatives(mode).any(|known| known == own);
    let all = |mode: &usize| alternatives(&name.text).all(|own| has(modes[*mode], own));
    let found: Vec<usize> = (0..modes.len()).filter(all).collect();
    match found.is_empty() {
        true => Err(unknown(source, name, modes)),
        false => Ok(found),
    }
}

/// Returns the combined mode that follows `mode`: each part of the system that has a mode in `name`
/// changes to this mode, and the other parts remain in their modes.
///
/// # Errors
/// [`ModelError`] if the name is unknown.
pub(super) fn following(
    source: &Source,
    name: &Phrase,
    modes: &[&str],
    mode: usize,
) -> Result<usize, ModelError> {
    let mut parts: Vec<&str> = alternatives(modes[mode]).collect();
    for own in alternatives(&name.text) {
        let place = modes.iter().find_map(|mode| alternatives(mode).position(|it| it == own));
        match place.and_then(|place| parts.get_mut(place)) {
            Some(part) => *part = own,
            None => return Err(unknown(source, name, modes)),
        }
    }
    let next = parts.join(&AND.to_string());
    modes.iter().position(|known| *known == next).ok_or_else(|| unknown(source, name, modes))
}

/// Returns the error for an unknown name of a mode.
fn unknown(source: &Source, name: &Phrase, modes: &[&str]) -> ModelError {
    let mut known: Vec<&str> = Vec::new();
    for own in modes.iter().flat_map(|mode| alternatives(mode)) {
        if !known.contains(&own) {
            known.push(own);
        }
    }
    match position("mode", &name.text, known) {
        Err(unknown) => source.fault_of(name, Fault::Unknown(unknown)),
        // Each alternative is known, but no mode has all of them.
        Ok(_) => {
            let (what, reason) = (format!("`{}`", name.text), "no mode has this name".into());
            source.fault_of(name, Fault::Misplaced { what, reason })
        }
    }
}
