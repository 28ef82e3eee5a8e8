//! Formulas in XPPAUT's language.

use super::super::source::{Fault, ModelError};
use super::function::{FUNCTIONS, REFUSED};
use super::names::Names;
use super::origin::Slice;
use super::shift::{index_outside, unresolved};
use super::token::{Token, tokens};
use super::tree::{Known, OPERATORS, Tree};
use std::ops::Range;

/// How deep brackets and signs may be nested.
const DEPTH: usize = 100;
/// The most operators of a formula.
const LONGEST: usize = 400;

/// Reads a formula; of a function with its arguments.
pub(super) fn read(names: &Names, text: Slice, arguments: &[String]) -> Result<Tree, ModelError> {
    let tokens = tokens(names, text)?;
    let mut reader =
        Reader { names, text, arguments, tokens: &tokens, next: 0, depth: 0, operators: 0 };
    let tree = reader.expression(0)?;
    if reader.next < reader.tokens.len() {
        return Err(reader.expected("an operator, or the end of the formula"));
    }
    let mut free = false;
    index_outside(&tree, &mut free);
    if free {
        return Err(text.unsupported(
            names.source,
            "`i'` outside of a sum",
            "it has no value there",
        ));
    }
    unresolved(names, text, &tree)?;
    Ok(tree)
}

/// A parser of formulas.
pub(super) struct Reader<'a, 's> {
    pub names: &'a Names<'s>,
    pub text: Slice<'a>,
    arguments: &'a [String],
    pub tokens: &'a [(Token, Range<usize>)],
    pub next: usize,
    depth: usize,
    operators: usize,
}

impl<'a> Reader<'a, '_> {
    /// Where the next part stands: the end, if there is none.
    pub(super) fn place(&self) -> Slice<'a> {
        let end = self.text.text.len();
        self.text.part(self.tokens.get(self.next).map_or(end..end, |(_, place)| place.clone()))
    }

    pub(super) fn expected(&self, words: impl Into<String>) -> ModelError {
        self.place().expected(self.names.source, words)
    }

    fn sign(&mut self, signs: &[&str]) -> Option<&'static str> {
        match self.tokens.get(self.next) {
            Some((Token::Sign(sign), _)) if signs.contains(sign) => {
                self.next += 1;
                Some(sign)
            }
            _ => None,
        }
    }

    pub(super) fn require(&mut self, sign: &'static str) -> Result<(), ModelError> {
        match self.sign(&[sign]) {
            Some(_) => Ok(()),
            None => Err(self.expected(format!("`{sign}`"))),
        }
    }

    pub(super) fn word(&mut self, word: &str) -> bool {
        let found = matches!(self.tokens.get(self.next),
            Some((Token::Name(name), _)) if name.eq_ignore_ascii_case(word));
        self.next += usize::from(found);
        found
    }

    /// Operators that bind at least so strongly, from left to right.
    pub(super) fn expression(&mut self, least: u8) -> Result<Tree, ModelError> {
        self.depth += 1;
        let too_deep = Fault::TooLarge { what: "brackets and signs in each other", limit: DEPTH };
        if self.depth > DEPTH {
            return Err(self.place().fault(self.names.source, too_deep));
        }
        let mut left = self.signed()?;
        while let Some((Token::Sign(sign), _)) = self.tokens.get(self.next) {
            let operator = OPERATORS.into_iter().find(|operator| operator.sign == *sign);
            let Some(operator) = operator.filter(|operator| operator.there >= least) else { break };
            self.operators += 1;
            if self.operators > LONGEST {
                let fault = Fault::TooLarge { what: "operators of a formula", limit: LONGEST };
                return Err(self.place().fault(self.names.source, fault));
            }
            self.next += 1;
            let right = self.expression(operator.there + 1)?;
            left = Tree::Binary(operator, Box::new([left, right]));
        }
        self.depth -= 1;
        Ok(left)
    }

    /// An operand with its sign, which binds less than powers and comparisons.
    fn signed(&mut self) -> Result<Tree, ModelError> {
        if self.sign(&["-", "~"]).is_some() {
            return Ok(Tree::Negative(Box::new(self.expression(7)?)));
        }
        if self.word("not") {
            return Ok(Tree::Not(Box::new(self.expression(7)?)));
        }
        self.operand()
    }

    fn operand(&mut self) -> Result<Tree, ModelError> {
        let place = self.place();
        match self.tokens.get(self.next) {
            Some((Token::Number(text), _)) => {
                self.next += 1;
                Ok(Tree::Number(text.clone()))
            }
            Some((Token::Sign("("), _)) => {
                self.next += 1;
                let inner = self.expression(0)?;
                self.require(")")?;
                Ok(inner)
            }
            Some((Token::Name(name), _)) => {
                self.next += 1;
                self.named(name, place)
            }
            _ => Err(self.expected("a number, a name or `(`")),
        }
    }

    /// What begins with a name.
    fn named(&mut self, name: &str, place: Slice) -> Result<Tree, ModelError> {
        let source = self.names.source;
        let argument = self.arguments.iter().position(|known| known.eq_ignore_ascii_case(name));
        if let Some(k) = argument {
            return Ok(Tree::Name(Known::Argument(k)));
        }
        let upper = name.to_ascii_uppercase();
        if let Some((_, what, why)) = REFUSED.iter().find(|(known, ..)| *known == upper) {
            return Err(place.unsupported(source, *what, *why));
        }
        match upper.as_str() {
            "IF" => return self.condition(),
            "SUM" => return self.sum(place),
            "SHIFT" => return self.shift(),
            "I'" => return Ok(Tree::Name(Known::Index)),
            _ => {}
        }
        let function = FUNCTIONS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        if let Some(&(function, takes)) = function {
            let arguments = self.list(name, takes, place)?;
            return Ok(self.call(function, arguments));
        }
        match self.names.find(name) {
            Some(Known::Function(k)) => {
                Ok(Tree::Own(k, self.list(name, self.names.arguments[k], place)?))
            }
            Some(known) => Ok(Tree::Name(known)),
            None => Err(self.names.unknown_in_formula(place)),
        }
    }

    /// The arguments of a function.
    fn list(&mut self, name: &str, takes: usize, place: Slice) -> Result<Vec<Tree>, ModelError> {
        self.require("(")?;
        let mut arguments = vec![self.expression(0)?];
        while self.sign(&[","]).is_some() {
            arguments.push(self.expression(0)?);
        }
        self.require(")")?;
        if arguments.len() == takes {
            return Ok(arguments);
        }
        let words = if takes == 1 { "one argument".into() } else { format!("{takes} arguments") };
        let (function, given) = (name.to_string(), arguments.len());
        Err(place.fault(self.names.source, Fault::Arguments { function, takes: words, given }))
    }

    /// A function of XPPAUT's: `mod` of a divisor that may be negative is not ours.
    fn call(&self, function: &'static str, arguments: Vec<Tree>) -> Tree {
        let positive = |tree: &Tree| tree.value(&|k| self.names.values[k]).is_some_and(|m| m > 0.0);
        if function == "mod" && !positive(&arguments[1]) {
            self.names.needs_modulo.set(true);
            return Tree::Modulo(arguments);
        }
        Tree::Call(function, arguments)
    }

    fn condition(&mut self) -> Result<Tree, ModelError> {
        let mut parts = Vec::with_capacity(3);
        for word in ["", "then", "else"] {
            if !word.is_empty() && !self.word(word) {
                return Err(self.expected(format!("`{word}(`")));
            }
            self.require("(")?;
            parts.push(self.expression(0)?);
            self.require(")")?;
        }
        let wrong = |_| self.expected("`else(`");
        Ok(Tree::If(Box::new(<[Tree; 3]>::try_from(parts).map_err(wrong)?)))
    }
}
