//! Conversion of XPPAUT's `global` lines, which are conditions with resets, to guards.
//!
//! After a condition is met, the motion may cross the surface of the condition; the motion may also
//! start beyond this surface. In both cases, an additional mode lasts until the motion returns. If
//! the resets of the condition prevent a crossing of its surface, as at impacts, the condition
//! needs only one mode.

use super::super::basis::Kind;
use super::super::operation::Operation;
use super::super::source::{ModelError, Source};
use super::super::statement::{Formulas as Pairs, Guard, HybridEquations, Mode, Next};
use super::super::{Phrase, hybrid};
use super::crossing::Crossings;
use super::depend::Formulas;
use super::formula;
use super::global::Global;
use super::names::Names;
use super::parts::Parts;
use super::tree::{Known, Tree};
use super::trial::{TRIALS, Trial};
use crate::core::hybrid::HybridSystem;
use std::collections::{BTreeMap, BTreeSet};

/// The maximum number of conditions that have a mode of their own.
const PASSED: usize = 3;

/// The absolute value below which the function of a `global` condition counts as zero.
const ROUNDING: f64 = 1e-9;

/// A resolved condition.
pub(super) struct Event {
    /// The function that is positive before the event.
    guard: Tree,
    /// The states on which the function of the guard depends.
    depends: BTreeSet<usize>,
    /// The states that the event resets, with formulas in terms of the states before the event.
    resets: BTreeMap<usize, Tree>,
    /// The whole `global` line as a phrase (a text with its position), for error messages.
    place: Phrase,
}

impl Event {
    /// Resolves the names in a condition and its resets; as in XPPAUT, each reset affects the
    /// formulas of the resets after it.
    pub fn read(
        names: &Names,
        formulas: &Formulas,
        global: &Global,
        ignored: &mut Vec<String>,
    ) -> Result<Event, ModelError> {
        let source = names.source;
        let condition = formula::read(names, global.condition.all(), &[])?;
        let place = global.condition.all().phrase(source, global.condition.all().text.into());
        let guard = if global.falls { condition } else { condition.negated() };
        let states = formulas.all_names(&guard).into_iter();
        let depends = states.filter_map(|known| match known {
            Known::State(k) => Some(k),
            _ => None,
        });
        let mut resets = BTreeMap::new();
        for reset in &global.resets {
            let name = reset.name.all();
            match (names.find(name.text), name.text.to_ascii_lowercase().as_str()) {
                (Some(Known::State(k)), _) => {
                    let value = formula::read(names, reset.formula.all(), &[])?;
                    let value = formulas.after(&value, &resets, false);
                    resets.insert(k, value.ok_or_else(|| too_large(source, &place))?);
                }
                (None, "out_put") => {
                    ignored.push(format!("line {}: `out_put` in resets", name.line(source)));
                }
                (None, "arret") => {
                    let reason = "motion that continues after an event";
                    return Err(name.unsupported(source, "the end of a motion (`arret`)", reason));
                }
                (Some(_), _) => {
                    let construct = "a reset of a quantity other than a state";
                    return Err(name
                        .unsupported(source, construct, "only states can be set")
                        .with_help("make the name a state, as in `b'=0` with `init b=1`"));
                }
                _ => {
                    return Err(names
                        .state(&reset.name)
                        .err()
                        .unwrap_or_else(|| name.expected(source, "a state")));
                }
            }
        }
        Ok(Event { guard, depends: depends.collect(), resets, place })
    }
}

/// Describes the result of random trials that decide whether the motion crosses the surface of a
/// condition.
fn tried_out(source: &Source, place: &Phrase, goes_on: bool) -> String {
    let line = source.line_of(place).unwrap_or_default();
    let result = match goes_on {
        true => {
            "from at least one of the tested states, the motion crosses the surface where the \
             condition changes, so each side of the surface needs its own mode"
        }
        false => {
            "from all tested states, the motion stays on one side of the surface where the \
             condition changes, so the model needs no separate mode for the other side"
        }
    };
    format!(
        "{line}: the formulas do not show whether, after an event of `global`, the motion crosses \
         the surface where the condition `{}` changes; a test from {TRIALS} states has the \
         following result: {result}. Check this result, or import the model and define its modes",
        place.text
    )
}

fn too_large(source: &Source, place: &Phrase) -> ModelError {
    use super::super::source::Fault;
    let what = "parts of resets inserted into other formulas";
    source.fault_of(place, Fault::TooLarge { what, limit: 20_000 })
}

/// The contents of a file that contains events.
pub(super) struct Hybrid<'a, 's> {
    pub names: &'a Names<'s>,
    pub formulas: &'a Formulas,
    pub parts: &'a Parts,
    pub events: Vec<Event>,
    /// The states with their rates.
    pub rates: Pairs,
    /// All other fields, as a statement without modes and guards.
    pub rest: HybridEquations,
}

/// A mode, given by a flag for each condition: whether the motion is beyond the surface of the
/// condition.
type Passed = Vec<bool>;

impl Hybrid<'_, '_> {
    /// Returns the statement with the required number of modes, and descriptions of the conditions
    /// for which random trials decided whether the motion crosses the surface.
    pub fn statement(self) -> Result<(HybridEquations, Vec<String>), ModelError> {
        let plain = self.with_modes(&[], &Vec::new())?;
        let source = self.names.source;
        let model = hybrid::understood(source, &plain, &[])?;
        let crossings = Crossings::of(source, &plain)?;
        let start = self.parts.found.options.start;
        let (mut passable, mut begin, mut tried) = (Vec::new(), Vec::new(), Vec::new());
        for (k, event) in self.events.iter().enumerate() {
            let trial = Trial { system: &model, guard: k, start, x: self.start(&model) };
            let beyond = trial.begins_beyond();
            let decided = if event.depends.is_empty() { Some(true) } else { crossings.goes_on(k) };
            let goes_on = decided.unwrap_or_else(|| trial.goes_on(&event.depends));
            if decided.is_none() && !beyond {
                tried.push(tried_out(source, &event.place, goes_on));
            }
            if beyond || goes_on {
                passable.push(k);
                begin.push(beyond);
            }
        }
        if passable.len() > PASSED {
            let place = &self.events[passable[PASSED]].place;
            let construct =
                "a fourth condition of `global` that remains true after its event".to_string();
            let reason =
                "the number of modes doubles for each condition of `global` that remains true after \
                 its event, and at most three such conditions are supported"
                    .to_string();
            let fault = super::super::Fault::Unsupported { construct, reason };
            return Err(source.fault_of(place, fault));
        }
        match passable.is_empty() {
            true => Ok((plain, tried)),
            false => Ok((self.with_modes(&passable, &begin)?, tried)),
        }
    }

    /// Returns the initial values of the states.
    fn start(&self, model: &super::super::Hybrid) -> Vec<f64> {
        let initial = model.basis().initial_at(0.0, &model.basis().defaults);
        let value = |name: &String| {
            initial.iter().find(|(known, _)| known == name).map_or(0.0, |(_, x)| *x)
        };
        model.modes().swap_remove(0).states.iter().map(value).collect()
    }

    /// Returns the statement with additional modes for motion beyond the surfaces of the given
    /// conditions; the motion starts in the first mode.
    fn with_modes(
        &self,
        passable: &[usize],
        begin: &Passed,
    ) -> Result<HybridEquations, ModelError> {
        let count = 1usize << passable.len();
        let passed = |mode: usize| -> Passed {
            (0..passable.len()).map(|bit| begin[bit] ^ (mode >> bit & 1 == 1)).collect()
        };
        let modes: Vec<Passed> = (0..count).map(passed).collect();
        let named = |mode: &Passed| -> Phrase {
            let words: Vec<&str> =
                mode.iter().map(|passed| if *passed { "beyond" } else { "before" }).collect();
            if words.is_empty() { "motion".into() } else { words.join("_").into() }
        };
        let mut statement = self.rest.clone();
        statement.modes = modes
            .iter()
            .map(|mode| Mode { name: named(mode), states: self.rates.clone(), ..Mode::default() })
            .collect();
        for k in 0..self.events.len() {
            for mode in &modes {
                let bit = passable.iter().position(|other| *other == k);
                let several = self.events.len() > 1;
                let number = if several { format!("{}", k + 1) } else { String::new() };
                let guard = match bit.filter(|bit| mode[*bit]) {
                    Some(bit) => self.back(k, bit, mode, &named),
                    None => self.guard(k, mode, passable, &named)?,
                };
                let word = if bit.is_some_and(|bit| mode[bit]) { "back" } else { "event" };
                let name = format!("{word}{number}").into();
                statement.guards.push(Guard { name, modes: vec![named(mode)], ..guard });
            }
        }
        Ok(statement)
    }

    /// Returns the guard whose event occurs when the motion returns across the surface of a
    /// condition.
    fn back(
        &self,
        k: usize,
        bit: usize,
        mode: &Passed,
        named: &dyn Fn(&Passed) -> Phrase,
    ) -> Guard {
        let mut after = mode.clone();
        after[bit] = false;
        let function = self.written(&self.events[k].guard.clone().negated(), &self.events[k]);
        Guard {
            function: Some(function),
            next: Next(vec![(named(&after), None)]),
            ..Guard::default()
        }
    }

    /// Returns the guard whose event occurs when a condition is met, in a given mode.
    fn guard(
        &self,
        k: usize,
        mode: &Passed,
        passable: &[usize],
        named: &dyn Fn(&Passed) -> Phrase,
    ) -> Result<Guard, ModelError> {
        let event = &self.events[k];
        let source = self.names.source;
        let resets = self.resets(k, mode, passable)?;
        // The conditions whose side may change at the event.
        let touched = |other: usize| {
            other == k || self.events[other].depends.iter().any(|state| resets.contains_key(state))
        };
        let mut open: Vec<usize> =
            (0..passable.len()).filter(|bit| touched(passable[*bit])).collect();
        // If no state of the condition is reset, motion continues beyond it.
        let own = passable.iter().position(|other| *other == k);
        let goes_on = own.filter(|_| !event.depends.iter().any(|state| resets.contains_key(state)));
        open.retain(|bit| Some(*bit) != goes_on);
        let mut next = Vec::new();
        for choice in 0..1usize << open.len() {
            let (mut after, mut holds) = (mode.clone(), None);
            if let Some(bit) = goes_on {
                after[bit] = true;
            }
            for (position, bit) in open.iter().enumerate() {
                let guard = &self.events[passable[*bit]].guard;
                let guard = self.formulas.after(guard, &resets, true);
                let guard = guard.ok_or_else(|| too_large(source, &event.place))?;
                after[*bit] = choice >> position & 1 == 1;
                let met = if after[*bit] { Operation::AtMost } else { Operation::More };
                // The reset may set its own condition to zero up to rounding.
                let zero = if Some(*bit) == own { ROUNDING } else { 0.0 };
                let holds_here = Tree::apply(met, [guard, Tree::number(zero)]);
                holds = Some(match holds {
                    None => holds_here,
                    Some(before) => Tree::apply(Operation::And, [before, holds_here]),
                });
            }
            let last = choice + 1 == 1 << open.len();
            let function = holds.filter(|_| !last).map(|tree| self.written(&tree, event));
            next.push((named(&after), function));
        }
        let reset = resets.iter().map(|(state, value)| {
            (self.names.written(Known::State(*state)).into(), self.written(value, event))
        });
        let (function, reset) = (self.written(&event.guard, event), reset.collect());
        let next = if passable.is_empty() { Next::default() } else { Next(next) };
        Ok(Guard { function: Some(function), next, reset, ..Guard::default() })
    }

    /// Returns the states that an event resets, each with its formula; the resets of other
    /// conditions that are met immediately after the event are included.
    fn resets(
        &self,
        k: usize,
        mode: &Passed,
        passable: &[usize],
    ) -> Result<BTreeMap<usize, Tree>, ModelError> {
        let mut resets = self.events[k].resets.clone();
        let count = self.events.len();
        for other in (1..count).map(|step| (k + step) % count) {
            let beyond =
                passable.iter().position(|known| *known == other).is_some_and(|bit| mode[bit]);
            let event = &self.events[other];
            if beyond || !event.depends.iter().any(|state| resets.contains_key(state)) {
                continue;
            }
            let after = |tree: &Tree| {
                let tree = self.formulas.after(tree, &resets, true);
                tree.ok_or_else(|| too_large(self.names.source, &event.place))
            };
            let guard = after(&event.guard)?;
            if guard.value(&|k| self.names.values[k]).is_some_and(|value| value > 0.0) {
                continue;
            }
            let met = Tree::apply(Operation::AtMost, [guard, Tree::number(0.0)]);
            let mut both = resets.clone();
            for (state, value) in &event.resets {
                let before = resets.get(state).cloned();
                let before = before.unwrap_or(Tree::name(Known::State(*state)));
                both.insert(
                    *state,
                    Tree::apply(Operation::Select, [met.clone(), after(value)?, before]),
                );
            }
            resets = both;
        }
        Ok(resets)
    }

    fn written(&self, tree: &Tree, event: &Event) -> Phrase {
        // Errors in the formula show the condition.
        event.place.rewritten(tree.written(&|known| self.names.written(known)))
    }
}
