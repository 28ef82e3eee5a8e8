//! The meaning of names in formulas.

use super::elements::{Element, Elements};
use super::operation::{FUNCTIONS, function};
use super::source::{Fault, ModelError, Phrase, Source};
use super::syntax::{Declared, Formula};
use crate::core::problem::UnknownName;
use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::sync::Arc;

/// The kind of quantity that a name in a formula denotes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    State(usize),
    Parameter(usize),
    Definition(usize),
    Time,
}

impl Meaning {
    fn is_state(self) -> bool {
        matches!(self, Meaning::State(_))
    }

    pub fn words(self) -> &'static str {
        match self {
            Meaning::State(_) => "a state",
            Meaning::Parameter(_) => "a parameter",
            Meaning::Definition(_) => "a definition",
            Meaning::Time => "time",
        }
    }
}

/// A name defined by a formula; for an element of an array, also the values of its indices.
#[derive(Clone, Debug)]
pub(super) struct Definition {
    pub element: Element,
    pub formula: usize,
}

#[derive(Clone, Debug)]
pub(super) struct Function {
    pub arguments: Vec<Arc<str>>,
    pub formula: usize,
}

/// The meanings that all names in the formulas of a model have in one of its modes.
#[derive(Clone, Debug)]
pub(super) struct Scope {
    pub source: Source,
    meanings: HashMap<String, Meaning>,
    /// All names in the scope, in the order of their declaration.
    order: Vec<String>,
    /// The number of states in the scope.
    pub dimension: usize,
    pub definitions: Vec<Definition>,
    pub functions: HashMap<String, Function>,
    pub formulas: Vec<Formula>,
    /// The names that occur in at least one formula.
    pub used: RefCell<BTreeSet<String>>,
}

impl Scope {
    pub fn new(source: Source) -> Self {
        Scope {
            source,
            meanings: HashMap::new(),
            order: Vec::new(),
            dimension: 0,
            definitions: Vec::new(),
            functions: HashMap::new(),
            formulas: Vec::new(),
            used: RefCell::default(),
        }
    }

    /// Declares a name and the quantity that it denotes.
    pub fn declare(
        &mut self,
        phrase: &Phrase,
        name: &str,
        meaning: Meaning,
    ) -> Result<(), ModelError> {
        if meaning != Meaning::Time {
            self.refuse_reserved(phrase, name)?;
        }
        self.refuse_taken(phrase, name)?;
        self.dimension += usize::from(meaning.is_state());
        self.meanings.insert(name.into(), meaning);
        self.order.push(name.into());
        Ok(())
    }

    /// Returns whether a name denotes a state.
    pub fn is_state(&self, name: &str) -> bool {
        self.meaning(name).is_some_and(Meaning::is_state)
    }

    /// Returns the meaning of a name, or `None` if the name is unknown.
    pub fn meaning(&self, name: &str) -> Option<Meaning> {
        self.meanings.get(name).copied()
    }

    /// Returns all names in the scope, in the order of their declaration.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.order.iter().map(String::as_str)
    }

    /// Returns an error if a name already has a meaning.
    fn refuse_taken(&self, phrase: &Phrase, name: &str) -> Result<(), ModelError> {
        let function = self.functions.contains_key(name).then_some("a function");
        let first = function.or(self.meaning(name).map(Meaning::words));
        first.map_or(Ok(()), |first| Err(self.source.twice(phrase, name, first)))
    }

    /// Returns an error if a name is reserved by the language.
    fn refuse_reserved(&self, phrase: &Phrase, name: &str) -> Result<(), ModelError> {
        if !["t", "if", "sum", "then", "else", "of"].contains(&name) {
            return Ok(());
        }
        let reason = "this name is a reserved word of the model language".to_string();
        let fault = Fault::Misplaced { what: format!("`{name}`"), reason };
        Err(self.source.fault_of(phrase, fault).with_help("choose another name"))
    }

    /// Returns an error if the formulas depend on time; used for kinds of equations without time.
    pub fn refuse_time(&self, reason: &str) -> Result<(), ModelError> {
        match self.uses("t") {
            true => {
                let fault = Fault::Misplaced { what: "time, `t`".into(), reason: reason.into() };
                Err(self.source.fault_of(&"t".into(), fault))
            }
            false => Ok(()),
        }
    }

    /// Returns the number of parameters in the scope.
    pub fn parameters(&self) -> usize {
        self.meanings.values().filter(|it| matches!(it, Meaning::Parameter(_))).count()
    }

    /// Returns the names of the states, in the order of their declaration.
    pub fn states(&self) -> impl Iterator<Item = &String> {
        self.order.iter().filter(|name| self.is_state(name))
    }

    /// Returns whether a name occurs in a formula.
    pub fn uses(&self, name: &str) -> bool {
        self.used.borrow().contains(name)
    }

    /// Adds a definition of one or more elements of an array. Elements that are already states
    /// remain states: `u[i=0..n+1]` defines only the two elements beyond the ends of the states
    /// `u[1]` to `u[n]`.
    pub fn define(
        &mut self,
        name: &Phrase,
        elements: &Elements,
        formula: &Phrase,
    ) -> Result<(), ModelError> {
        self.formulas.push(Formula::read(&self.source, formula)?);
        let formula = self.formulas.len() - 1;
        let only_states = elements.names().all(|element| self.is_state(&element));
        for element in elements.iter() {
            if only_states || !self.is_state(&element.name) {
                self.declare(name, &element.name, Meaning::Definition(self.definitions.len()))?;
                self.definitions.push(Definition { element, formula });
            }
        }
        Ok(())
    }

    /// Adds a function.
    pub fn function(
        &mut self,
        name: &Phrase,
        arguments: &[Phrase],
        formula: &Phrase,
    ) -> Result<(), ModelError> {
        let plain = |phrase: &Phrase| Declared::plain(&self.source, phrase);
        let called = plain(name)?;
        let stated = arguments;
        let arguments = arguments.iter().map(plain).collect::<Result<Vec<_>, _>>()?;
        self.refuse_reserved(name, &called)?;
        if arguments.is_empty() {
            let needed = "give the function an argument, or write a definition instead of the \
                          function"
                .into();
            let fault = Fault::Missing {
                what: format!("the function `{called}` is defined without an argument"),
                needed,
            };
            return Err(self.source.fault_of(name, fault));
        }
        for (k, argument) in arguments.iter().enumerate() {
            if arguments[..k].contains(argument) {
                return Err(self.source.twice(&stated[k], argument, "an argument"));
            }
        }
        if function(&called).is_some() {
            return Err(self.source.fault_of(
                name,
                Fault::Twice { name: called, first: "a function of the language" },
            ));
        }
        self.refuse_taken(name, &called)?;
        self.formulas.push(Formula::read(&self.source, formula)?);
        let formula = self.formulas.len() - 1;
        let arguments = arguments.into_iter().map(Arc::from).collect();
        self.functions.insert(called, Function { arguments, formula });
        Ok(())
    }

    /// Returns the error for an unknown name in a formula.
    pub fn unknown(
        &self,
        what: &str,
        name: &str,
        phrase: &Phrase,
        part: Range<usize>,
    ) -> ModelError {
        // The first elements of an array are enough in the list of known names.
        let mut arrays: HashMap<&str, usize> = HashMap::new();
        let mut known: Vec<&str> = Vec::new();
        for declared in &self.order {
            let array = declared.split('[').next().unwrap_or(declared);
            let count = arrays.entry(array).or_default();
            *count += usize::from(declared.ends_with(']'));
            if *count <= 2 {
                known.push(declared);
            }
        }
        known.extend(["pi", "e"]);
        if what == "function" {
            known = self.functions.keys().map(String::as_str).collect();
            known.sort_unstable();
            known.extend(FUNCTIONS.iter().map(|function| function.name));
            known.extend(["if", "sum"]);
        }
        self.source.fault(phrase, part, Fault::Unknown(UnknownName::new(what, name, known)))
    }
}
