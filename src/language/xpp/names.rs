//! The names in an XPPAUT file: their meaning, and their spelling in the converted equations.

use super::super::operation::function;
use super::super::source::{Fault, ModelError, Source};
use super::function::{REFUSED, built_in};
use super::origin::{Slice, Text};
use super::parts::{Parts, Sort};
use super::tree::Known;
use crate::core::problem::UnknownName;
use std::cell::Cell;
use std::collections::{HashMap, HashSet};

/// The names that XPPAUT reserves, in addition to the names of functions.
const RESERVED: [&str; 16] = [
    "SHIFT", "IF", "THEN", "ELSE", "SUM", "OF", "NOT", "PI", "T", "I'", "START", "END", "MOUSE_X",
    "MOUSE_Y", "MOUSE_VX", "MOUSE_VY",
];

/// Returns whether a name is reserved by XPPAUT.
fn is_reserved(upper: &str) -> bool {
    let refused = REFUSED.iter().any(|(known, ..)| *known == upper);
    refused || RESERVED.contains(&upper) || built_in(upper).is_some()
}

/// The names in an XPPAUT file.
pub(super) struct Names<'s> {
    pub source: &'s Source,
    known: HashMap<String, Known>,
    /// The spelling of each state in the converted equations.
    states: Vec<String>,
    constants: Vec<String>,
    fixed: Vec<String>,
    functions: Vec<String>,
    /// The number of arguments of each function.
    pub arguments: Vec<usize>,
    /// The value of each constant that is a number; `None` for other constants.
    pub values: Vec<Option<f64>>,
    /// The name of the state that counts iterates, for an XPPAUT file of a map that uses `t`.
    pub clock: Option<String>,
    /// The names whose spelling differs between the XPPAUT file and the converted equations, with
    /// the new spelling.
    pub renamed: Vec<(String, String)>,
    /// All spellings that are already in use.
    taken: HashSet<String>,
    /// Whether a formula contains `mod` with a divisor that may be negative, so that the converted
    /// equations need a separate function for `mod`.
    pub needs_modulo: Cell<bool>,
    modulo: String,
    /// The remaining number of formula parts that the expansion of sums may still create.
    pub budget: Cell<usize>,
}

impl<'s> Names<'s> {
    /// Collects the names that an XPPAUT file declares.
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
            _ if is_reserved(&upper) => Some("a name reserved by XPPAUT"),
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

    /// Returns an unused, valid spelling of a name; the spelling of a function also differs from
    /// all functions of the language.
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

    /// Returns whether a spelling is already in use.
    pub fn is_taken(&self, name: &str) -> bool {
        self.taken.contains(name) || name == "t"
    }

    /// Returns the meaning of a name in an XPPAUT file; letter case is ignored.
    pub fn find(&self, name: &str) -> Option<Known> {
        match name.to_ascii_uppercase().as_str() {
            "T" => Some(Known::Time),
            "PI" => Some(Known::Pi),
            upper => self.known.get(upper).copied(),
        }
    }

    /// Returns the index of the state with a given name.
    pub fn state(&self, name: &Text) -> Result<usize, ModelError> {
        match self.find(name.all().text) {
            Some(Known::State(k)) => Ok(k),
            _ => Err(self.unknown("state", name.all(), self.states.iter().take(20))),
        }
    }

    /// Returns the error for an unknown name.
    pub fn unknown<'n>(
        &self,
        what: &str,
        name: Slice,
        known: impl Iterator<Item = &'n String>,
    ) -> ModelError {
        let known: Vec<&str> = known.map(String::as_str).collect();
        name.fault(self.source, Fault::Unknown(UnknownName::new(what, name.text, known)))
    }

    /// Returns the error for an unknown name in a formula.
    pub fn unknown_in_formula(&self, name: Slice) -> ModelError {
        // The first elements of long arrays are enough in the list of known names.
        let quantities = [&self.states, &self.constants, &self.fixed];
        let known = quantities.into_iter().flat_map(|names| names.iter().take(12));
        self.unknown("name", name, known.chain(&self.functions))
    }

    /// Returns the spelling of a name in the converted equations.
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

    /// Returns the name that is a given number of places after another name in XPPAUT's tables.
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

/// Returns an error if a name is invalid.
pub(super) fn check(source: &Source, name: Slice) -> Result<(), ModelError> {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let inner = |c: char| letter(c) || c.is_ascii_digit() || c == '.';
    match name.text.starts_with(letter) && name.text.chars().all(inner) {
        true => Ok(()),
        false => Err(name.expected(source, "a name: a letter, then letters, digits, `_` and `.`")),
    }
}
