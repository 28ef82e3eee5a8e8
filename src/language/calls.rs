//! Checks the names and calls in formulas without computing values, so that functions that are
//! never called are checked, too.

use super::operation::{self, Operation};
use super::scope::{Function, Scope};
use super::source::{Fault, ModelError, Phrase};
use super::syntax::{Node, Step};
use std::ops::Range;
use std::sync::Arc;

impl Scope {
    /// Returns the errors of all functions in the order of the functions' names; a valid function
    /// yields `None`.
    pub fn errors_of_functions(&self) -> Vec<Option<ModelError>> {
        let mut functions: Vec<(&String, &Function)> = self.functions.iter().collect();
        functions.sort_unstable_by_key(|(name, _)| *name);
        let error = |own: &Function| {
            let formula = &self.formulas[own.formula];
            let mut locals = own.arguments.clone();
            self.check_nodes(&formula.nodes, &formula.phrase, &mut locals).err()
        };
        functions.into_iter().map(|(_, own)| error(own)).collect()
    }

    /// Returns an error for unknown names and invalid calls in a formula; the given local names
    /// count as known.
    pub fn check_nodes(
        &self,
        nodes: &[Node],
        phrase: &Phrase,
        locals: &mut Vec<Arc<str>>,
    ) -> Result<(), ModelError> {
        for Node { step, place } in nodes {
            match step {
                Step::Name(name) => {
                    let known = locals.iter().any(|local| **local == **name) || self.is_known(name);
                    self.require(known, name, phrase, place)?;
                }
                Step::Element(name, _) | Step::ElementAt(name, _) => {
                    let known = self.names().any(|known| is_element(known, name));
                    self.require(known, name, phrase, place)?;
                }
                Step::Call(function, given) => {
                    self.called(function, *given, phrase, place)?;
                }
                Step::Sum(index, body) => {
                    locals.push(index.as_str().into());
                    let checked = self.check_nodes(body, phrase, locals);
                    locals.pop();
                    checked?;
                }
                Step::Number(_) | Step::Apply(_) => {}
            }
        }
        Ok(())
    }

    fn require(
        &self,
        known: bool,
        name: &str,
        phrase: &Phrase,
        place: &Range<usize>,
    ) -> Result<(), ModelError> {
        match known {
            true => Ok(()),
            false => Err(self.unknown("name", name, phrase, place.clone())),
        }
    }

    fn is_known(&self, name: &str) -> bool {
        self.meaning(name).is_some() || ["pi", "e"].contains(&name)
    }

    /// Resolves a call. Returns an error if the called name is not a function, or if the number of
    /// arguments is wrong. The call `x(0)` or `x(1)` of a state `x` is valid, and denotes the value
    /// of the state at an end of the interval.
    pub fn called(
        &self,
        function: &str,
        given: usize,
        phrase: &Phrase,
        place: &Range<usize>,
    ) -> Result<Called<'_>, ModelError> {
        let own = self.functions.get(function).map(Called::Own);
        let built_in = || Some(Called::BuiltIn(operation::function(function)?.operation));
        let state = || self.is_state(function);
        let called = own.or_else(built_in).or_else(|| state().then_some(Called::State));
        let Some(called) = called else {
            return Err(self.unknown("function", function, phrase, place.clone()));
        };
        let (count, several) = match &called {
            Called::Own(own) => (own.arguments.len(), false),
            Called::BuiltIn(operation) => {
                let several = matches!(operation, Operation::Minimum | Operation::Maximum);
                (operation.arity(), several)
            }
            Called::State => (1, false),
        };
        if given == count || several && given > count {
            return Ok(called);
        }
        let takes = match count {
            1 => "one argument".to_string(),
            _ => format!("{count} arguments"),
        };
        let fault = Fault::Arguments { function: function.into(), takes, given };
        Err(self.source.fault(phrase, place.clone(), fault))
    }
}

/// The meaning of a name that is called.
pub(super) enum Called<'s> {
    /// A function defined in the model.
    Own(&'s Function),
    /// A function that is built into the language.
    BuiltIn(Operation),
    /// A state, whose value at an end of the interval is meant.
    State,
}

/// Returns whether a name has the form of an element of a given array.
fn is_element(name: &str, array: &str) -> bool {
    name.strip_prefix(array).is_some_and(|rest| rest.starts_with('['))
}
