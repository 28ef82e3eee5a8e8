//! Parses formulas in XPPAUT's language, and resolves the names in them.

use super::super::operation::Operation;
use super::super::source::{Fault, ModelError};
use super::super::syntax::{Dialect, Node, Step, nodes};
use super::function::{REFUSED, built_in};
use super::names::Names;
use super::origin::Slice;
use super::tree::{Known, Tree};
use std::ops::Range;

/// Parses a formula; the formula of a function may contain the function's arguments.
pub(super) fn read(names: &Names, text: Slice, arguments: &[String]) -> Result<Tree, ModelError> {
    let nodes = nodes(text.text, Dialect::Xpp);
    let nodes = nodes.map_err(|(part, fault)| text.part(part).fault(names.source, fault))?;
    Reader { names, text, arguments }.tree(&nodes, Index::Outside)
}

/// The value of the summation index, for a formula inside a sum.
#[derive(Clone, Copy, PartialEq)]
enum Index {
    Outside,
    /// The formula is inside a sum, but the index of the sum does not have a value yet.
    Free,
    At(i64),
}

/// The context in which the names of a formula are resolved.
struct Reader<'a, 's> {
    names: &'a Names<'s>,
    text: Slice<'a>,
    arguments: &'a [String],
}

impl<'a> Reader<'a, '_> {
    fn tree(&self, nodes: &[Node], index: Index) -> Result<Tree, ModelError> {
        let mut trees: Vec<Tree> = Vec::new();
        for Node { step, place } in nodes {
            let operands = trees.split_off(trees.len() - step.operands());
            trees.push(match step {
                Step::Number(digits) => Tree::of(Step::Number(digits.clone()), []),
                Step::Name(name) => self.name(name, place, index)?,
                Step::Call(name, _) => self.call(name, operands, place)?,
                Step::Sum(_, body) => self.sum(operands, body, place)?,
                Step::Apply(operation) => Tree::apply(*operation, operands),
                Step::Element(..) | Step::ElementAt(..) => {
                    return Err(self.part(place).expected(self.names.source, "no index"));
                }
            });
        }
        Ok(trees.pop().unwrap_or_default())
    }

    fn part(&self, place: &Range<usize>) -> Slice<'a> {
        self.text.part(place.clone())
    }

    /// Returns the value of a formula that contains only numbers, or `None` for any other formula.
    fn value(&self, tree: &Tree) -> Option<f64> {
        tree.value(&|k| self.names.values[k])
    }

    fn argument(&self, name: &str) -> Option<Known> {
        let argument = self.arguments.iter().position(|known| known.eq_ignore_ascii_case(name));
        argument.map(Known::Argument)
    }

    fn name(&self, name: &str, place: &Range<usize>, index: Index) -> Result<Tree, ModelError> {
        let source = self.names.source;
        if let Some(argument) = self.argument(name) {
            return Ok(Tree::name(argument));
        }
        match index {
            _ if name != "i'" => {}
            Index::Outside => {
                let reason = "`i'` is defined only inside a sum";
                return Err(self.text.unsupported(source, "`i'` outside of a sum", reason));
            }
            Index::Free => return Ok(Tree::name(Known::Index)),
            Index::At(k) => return Ok(Tree::number(k as f64)),
        }
        self.refuse(name, place)?;
        let known = self.names.find(name);
        let is_function = matches!(known, Some(Known::Function(_)))
            || built_in(name).is_some()
            || ["IF", "SUM", "SHIFT"].contains(&name.to_ascii_uppercase().as_str());
        if is_function {
            return Err(self.part(&(place.end..place.end)).expected(source, "`(`"));
        }
        known.map(Tree::name).ok_or_else(|| self.names.unknown_in_formula(self.part(place)))
    }

    /// Rejects a call of a function that has no counterpart in this library.
    fn refuse(&self, name: &str, place: &Range<usize>) -> Result<(), ModelError> {
        let refused = REFUSED.iter().find(|(known, ..)| known.eq_ignore_ascii_case(name));
        refused.map_or(Ok(()), |(_, what, why)| {
            Err(self.part(place).unsupported(self.names.source, *what, *why))
        })
    }

    fn call(
        &self,
        name: &str,
        arguments: Vec<Tree>,
        place: &Range<usize>,
    ) -> Result<Tree, ModelError> {
        let (source, behind) = (self.names.source, place.start + name.len());
        let place = place.start..behind;
        self.refuse(name, &place)?;
        let function = built_in(name);
        let (known, takes) = match (self.argument(name).or(self.names.find(name)), function) {
            _ if name.eq_ignore_ascii_case("shift") => return self.shift(arguments, &place),
            (None, Some(function)) => (Known::BuiltIn(function.name), function.operation.arity()),
            (Some(Known::Function(k)), _) => (Known::Function(k), self.names.arguments[k]),
            (Some(_), _) => {
                let place = behind..self.text.text.len();
                let words = "an operator, or the end of the formula";
                return Err(self.part(&place).expected(source, words));
            }
            (None, None) => return Err(self.names.unknown_in_formula(self.part(&place))),
        };
        let given = arguments.len();
        if given != takes {
            let takes =
                if takes == 1 { "one argument".into() } else { format!("{takes} arguments") };
            let fault = Fault::Arguments { function: name.into(), takes, given };
            return Err(self.part(&place).fault(source, fault));
        }
        // `mod` differs from XPPAUT's for divisors that may be negative.
        let is_modulo = function.is_some_and(|known| known.operation == Operation::Modulo);
        if is_modulo && !self.value(&arguments[1]).is_some_and(|m| m > 0.0) {
            self.names.needs_modulo.set(true);
            return Ok(Tree::of(Step::Call(Known::Modulo, given), arguments));
        }
        Ok(Tree::of(Step::Call(known, given), arguments))
    }

    /// Resolves `sum(1,n)of(…i'…)`.
    fn sum(
        &self,
        ends: Vec<Tree>,
        body: &[Node],
        place: &Range<usize>,
    ) -> Result<Tree, ModelError> {
        let source = self.names.source;
        let word = self.part(&(place.start..place.start + "sum".len()));
        let end = |tree: &Tree| {
            let value = self.value(tree).filter(|end| end.abs() < 1e9);
            value.map(|value| value.trunc() as i64).ok_or_else(|| {
                word.unsupported(
                    source,
                    "a sum with a variable limit",
                    "both limits of a sum must be numbers",
                )
                .with_help("declare the names in the limits of the sum with `number`")
            })
        };
        let [low, high] = [end(&ends[0])?, end(&ends[1])?];
        let has = |found: fn(&Step) -> bool| body.iter().any(|node| found(&node.step));
        let inner = has(|step| matches!(step, Step::Sum(..)));
        if inner && has(|step| matches!(step, Step::Name(name) if name == "i'")) {
            let reason = "XPPAUT has only one index, `i'`, for the two sums";
            return Err(word
                .unsupported(source, "a sum within a sum over the same index", reason)
                .with_help("write out all terms of one of the two sums"));
        }
        let shifts =
            |step: &Step| matches!(step, Step::Call(name, _) if name.eq_ignore_ascii_case("shift"));
        if !has(shifts) {
            let body = self.tree(body, Index::Free)?.0;
            let ends = [low, high].map(|end| Tree::number(end as f64));
            return Ok(Tree::of(Step::Sum(Known::Index, body), ends));
        }
        // Names depend on the index, so the terms are written out.
        let count = usize::try_from(high - low + 1).unwrap_or(0);
        let size = body.len().saturating_mul(count);
        let Some(left) = self.names.budget.get().checked_sub(size) else {
            let what = "terms of sums written out";
            return Err(word.fault(source, Fault::TooLarge { what, limit: 1_000_000 }));
        };
        self.names.budget.set(left);
        let terms = (low..=high).map(|k| self.tree(body, Index::At(k)));
        let add = |sum, term| Ok(Tree::apply(Operation::Add, [sum, term?]));
        let mut terms = terms;
        match terms.next() {
            Some(first) => terms.try_fold(first?, add),
            None => Ok(Tree::number(0.0)),
        }
    }

    /// Resolves a call such as `shift(x,2)`, which denotes the second name after `x` in XPPAUT's
    /// tables.
    fn shift(&self, arguments: Vec<Tree>, place: &Range<usize>) -> Result<Tree, ModelError> {
        let (source, word) = (self.names.source, self.part(place));
        let [of, by] = &arguments[..] else {
            let (function, given) = ("shift".into(), arguments.len());
            let fault = Fault::Arguments { function, takes: "2 arguments".into(), given };
            return Err(word.fault(source, fault));
        };
        let known = match &of.0[..] {
            [Node { step: Step::Name(known), .. }] => Some(*known),
            _ => None,
        };
        let Some(known @ (Known::State(_) | Known::Fixed(_) | Known::Constant(_))) = known else {
            return Err(word.expected(source, "a state, a parameter or a quantity in `shift`"));
        };
        let Some(by) = self.value(by) else {
            let reason = "the second argument of `shift` must be a number or the index of a sum";
            return Err(word.unsupported(source, "`shift` by a variable quantity", reason));
        };
        let found =
            if by.abs() < 1e9 { self.names.shifted(known, by.trunc() as i64) } else { None };
        found.map(Tree::name).ok_or_else(|| {
            let reason = format!("no name is defined {by} places after the name in `shift`");
            word.unsupported(source, "`shift` beyond all names", reason)
        })
    }
}
