//! What the names of a file stand for, and how they are written here.

use super::super::operation::function;
use super::super::source::{Fault, ModelError, Source};
use super::function::{REFUSED, built_in};
use super::origin::{Slice, Text};
use super::parts::{Parts, Sort};
use super::tree::Known;
use crate::core::problem::UnknownName;
use std::cell::Cell;
use std::collections::{HashMap, HashSet};

/// Names that are XPPAUT's own, beside those of functions.
const RESERVED: [&str; 16] = [
    "SHIFT", "IF", "THEN", "ELSE", "SUM", "OF", "NOT", "PI", "T", "I'", "START", "END", "MOUSE_X",
    "MOUSE_Y", "MOUSE_VX", "MOUSE_VY",
];

/// Whether a name is XPPAUT's own.
fn is_reserved(upper: &str) -> bool {
    let refused = REFUSED.iter().any(|(known, ..)| *known == upper);
    refused || RESERVED.contains(&upper) || built_in(upper).is_some()
}

/// The names of a file.
pub(super) struct Names<'s> {
    pub source: &'s Source,
    known: HashMap<String, Known>,
    /// How the names of states, constants, fixed quantities and functions are written.
    states: Vec<String>,
    constants: Vec<String>,
    fixed: Vec<String>,
    functions: Vec<String>,
    /// How many arguments functions take.
    pub arguments: Vec<usize>,
    /// The values of constants that are numbers.
    pub values: Vec<Option<f64>>,
    /// The state that counts iterates, if there is one.
    pub clock: Option<String>,
    /// Names that are written in another way here.
    pub renamed: Vec<(String, String)>,
    /// How names are written here.
    taken: HashSet<String>,
    /// Whether a divisor of `mod` may be negative, and what the function is called that knows it.
    pub needs_modulo: Cell<bool>,
    modulo: String,
    /// How many parts sums may yet be written out as.
    pub budget: Cell<usize>,
}

impl<'s> Names<'s> {
    /// The names that a file declares.
    pub fn of(source: &'s Source, parts: &Parts) -> Result<Self, ModelError> {
        let mut names = Names {
            source,
            known: HashMap::new(),
            states: Vec::new(),
            constants: Vec::new(),
            fixed: Vec::new(),
            functions: Vec::new(),
            arguments: Vec::new(),
            values: Vec::new(),
            clock: None,
            renamed: Vec::new(),
            taken: HashSet::new(),
            needs_modulo: Cell::new(false),
            modulo: String::new(),
            budget: Cell::new(1_000_000),
        };
        for (k, named) in parts.states.iter().enumerate() {
            let written = names.declare(named.name.all(), Known::State(k))?;
            names.states.push(written);
        }
        for (k, (sort, named)) in parts.constants.iter().enumerate() {
            let written = names.declare(named.name.all(), Known::Constant(k))?;
            names.constants.push(written);
            let value = super::option::number(named.formula.all().text);
            names.values.push(value.filter(|_| *sort == Sort::Number));
        }
        for (k, named) in parts.fixed.iter().enumerate() {
            let written = names.declare(named.name.all(), Known::Fixed(k))?;
            names.fixed.push(written);
        }
        for (k, function) in parts.functions.iter().enumerate() {
            let written = names.declare(function.named.name.all(), Known::Function(k))?;
            names.functions.push(written);
            names.arguments.push(function.arguments.len());
        }
        names.modulo = names.free("modulo", true);
        Ok(names)
    }

    fn declare(&mut self, name: Slice, known: Known) -> Result<String, ModelError> {
        let name = name.trim();
        let upper = name.text.to_ascii_uppercase();
        check(self.source, name)?;
        let first = match self.known.get(&upper) {
            _ if is_reserved(&upper) => Some("a name of XPPAUT's"),
            Some(Known::State(_)) => Some("a state"),
            Some(Known::Constant(_)) => Some("a parameter or a constant"),
            Some(Known::Function(_)) => Some("a function"),
            Some(_) => Some("a quantity"),
            None => None,
        };
        if let Some(first) = first {
            return Err(name.fault(self.source, Fault::Twice { name: name.text.into(), first }));
        }
        let written = self.free(name.text, matches!(known, Known::Function(_)));
        if written != name.text {
            self.renamed.push((name.text.into(), written.clone()));
        }
        self.known.insert(upper, known);
        Ok(written)
    }

    /// A name as it may be written here, which nothing has yet, nor a function of the language if
    /// it is a function's.
    pub fn free(&mut self, name: &str, is_function: bool) -> String {
        let mut written: String = name.replace('.', "_");
        let ours = |written: &str| {
            let known = is_function && function(written).is_some();
            known || ["t", "if", "sum", "then", "else", "of"].contains(&written)
        };
        while ours(&written) || self.taken.contains(&written) {
            written.push('_');
        }
        self.taken.insert(written.clone());
        written
    }

    /// Whether something else is written so.
    pub fn is_taken(&self, name: &str) -> bool {
        self.taken.contains(name) || name == "t"
    }

    /// The meaning of a name, letters of both cases being the same.
    pub fn find(&self, name: &str) -> Option<Known> {
        match name.to_ascii_uppercase().as_str() {
            "T" => Some(Known::Time),
            "PI" => Some(Known::Pi),
            upper => self.known.get(upper).copied(),
        }
    }

    /// The state of this name.
    pub fn state(&self, name: &Text) -> Result<usize, ModelError> {
        match self.find(name.all().text) {
            Some(Known::State(k)) => Ok(k),
            _ => Err(self.unknown("state", name.all(), self.states.iter().take(20))),
        }
    }

    /// An error of a name that nothing has.
    pub fn unknown<'n>(
        &self,
        what: &str,
        name: Slice,
        known: impl Iterator<Item = &'n String>,
    ) -> ModelError {
        let known: Vec<&str> = known.map(String::as_str).collect();
        name.fault(self.source, Fault::Unknown(UnknownName::new(what, name.text, known)))
    }

    /// An error of a name in a formula that nothing has.
    pub fn unknown_in_formula(&self, name: Slice) -> ModelError {
        // Of long arrays the first elements show what there is.
        let quantities = [&self.states, &self.constants, &self.fixed];
        let known = quantities.into_iter().flat_map(|names| names.iter().take(12));
        self.unknown("name", name, known.chain(&self.functions))
    }

    /// How a name is written here.
    pub fn written(&self, known: Known) -> String {
        match known {
            Known::State(k) => self.states[k].clone(),
            Known::Constant(k) => self.constants[k].clone(),
            Known::Fixed(k) => self.fixed[k].clone(),
            Known::Function(k) => self.functions[k].clone(),
            Known::Argument(k) => format!("a{k}"),
            Known::BuiltIn(name) => name.into(),
            Known::Modulo => self.modulo.clone(),
            Known::Time => self.clock.clone().unwrap_or("t".into()),
            Known::Pi => "pi".into(),
            Known::Index => "i'".into(),
        }
    }

    /// The name that stands so many names behind another one in XPPAUT's tables.
    pub fn shifted(&self, known: Known, by: i64) -> Option<Known> {
        let states = self.states.len() as i64;
        let variable = |k: i64| match k {
            0.. if k < states => Some(Known::State(k as usize)),
            0.. if k - states < self.fixed.len() as i64 => {
                Some(Known::Fixed((k - states) as usize))
            }
            -1 => Some(Known::Time),
            _ => None,
        };
        match known {
            Known::State(k) => variable(k as i64 + by),
            Known::Fixed(k) => variable(states + k as i64 + by),
            Known::Constant(k) => {
                let k = usize::try_from(k as i64 + by).ok()?;
                (k < self.constants.len()).then_some(Known::Constant(k))
            }
            _ => None,
        }
    }
}

/// Refuses what is no name.
pub(super) fn check(source: &Source, name: Slice) -> Result<(), ModelError> {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let inner = |c: char| letter(c) || c.is_ascii_digit() || c == '.';
    match name.text.starts_with(letter) && name.text.chars().all(inner) {
        true => Ok(()),
        false => Err(name.expected(source, "a name: a letter, then letters, digits, `_` and `.`")),
    }
}
