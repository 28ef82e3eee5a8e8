//! Sums, and names that depend on their index.

use super::super::source::{Fault, ModelError};
use super::formula::Reader;
use super::names::Names;
use super::origin::Slice;
use super::shift::index_outside;
use super::token::Token;
use super::tree::{Known, Tree};

impl Reader<'_, '_> {
    /// `sum(1,n)of(…i'…)`.
    pub(super) fn sum(&mut self, place: Slice) -> Result<Tree, ModelError> {
        let source = self.names.source;
        self.require("(")?;
        let mut ends = [0i64; 2];
        for (k, sign) in [",", ")"].into_iter().enumerate() {
            let tree = self.expression(0)?;
            let value = tree.value(&|k| self.names.values[k]).filter(|end| end.abs() < 1e9);
            let Some(value) = value else {
                let reason = "it must be a number here; declare the names in it with `number`";
                return Err(place.unsupported(
                    source,
                    "an end of a sum that can be varied",
                    reason,
                ));
            };
            ends[k] = value.trunc() as i64;
            self.require(sign)?;
        }
        if !self.word("of") {
            return Err(self.expected("`of(`"));
        }
        self.require("(")?;
        let body = self.expression(0)?;
        self.require(")")?;
        let (mut inner, mut outer, mut shifts) = (false, false, false);
        body.visit(&mut |tree| {
            inner |= matches!(tree, Tree::Sum(..));
            shifts |= matches!(tree, Tree::Shift(..));
        });
        index_outside(&body, &mut outer);
        if inner && outer {
            let reason = "XPPAUT has one index for both; write one of them out";
            return Err(place.unsupported(
                source,
                "a sum within a sum over the same index",
                reason,
            ));
        }
        match shifts {
            true => self.written_out(&body, ends, place),
            false => Ok(Tree::Sum(ends[0], ends[1], Box::new(body))),
        }
    }

    /// The terms of a sum in which names depend on the index.
    fn written_out(
        &self,
        body: &Tree,
        [low, high]: [i64; 2],
        place: Slice,
    ) -> Result<Tree, ModelError> {
        let count = usize::try_from(high - low + 1).unwrap_or(0);
        let size = body.size().saturating_mul(count);
        let Some(left) = self.names.budget.get().checked_sub(size) else {
            let fault =
                Fault::TooLarge { what: "terms of sums that are written out", limit: 1_000_000 };
            return Err(place.fault(self.names.source, fault));
        };
        self.names.budget.set(left);
        let terms = (low..=high).map(|index| resolved(self.names, self.text, body, Some(index)));
        Ok(Tree::Terms(terms.collect::<Result<_, _>>()?))
    }

    /// `shift(x,2)`: the name that is so many names behind another one.
    pub(super) fn shift(&mut self) -> Result<Tree, ModelError> {
        let word = self.tokens[self.next - 1].1.clone();
        self.require("(")?;
        let at = self.place();
        let known = match self.tokens.get(self.next) {
            Some((Token::Name(name), _)) => self.names.find(name),
            _ => None,
        };
        let quantity =
            matches!(known, Some(Known::State(_) | Known::Fixed(_) | Known::Constant(_)));
        let (Some(known), true) = (known, quantity) else {
            return Err(at.expected(self.names.source, "a state, a parameter or a quantity"));
        };
        self.next += 1;
        self.require(",")?;
        let by = self.expression(0)?;
        self.require(")")?;
        resolved(self.names, self.text, &Tree::Shift(known, Box::new(by), word), None)
    }
}

/// A formula with the names that shifts lead to, at an index of the sum around it.
fn resolved(
    names: &Names,
    text: Slice,
    tree: &Tree,
    index: Option<i64>,
) -> Result<Tree, ModelError> {
    match (tree, index) {
        (Tree::Name(Known::Index), Some(index)) => Ok(Tree::number(index as f64)),
        // Its index is its own.
        (Tree::Sum(..), _) => Ok(tree.clone()),
        (Tree::Shift(known, by, place), _) => {
            let by = resolved(names, text, by, index)?;
            let Some(value) = by.value(&|k| names.values[k]) else {
                return Ok(Tree::Shift(*known, Box::new(by), place.clone()));
            };
            let found =
                if value.abs() < 1e9 { names.shifted(*known, value.trunc() as i64) } else { None };
            found.map(Tree::Name).ok_or_else(|| {
                let reason = format!("{value} names behind this one there is none");
                text.part(place.clone()).unsupported(
                    names.source,
                    "`shift` beyond all names",
                    reason,
                )
            })
        }
        _ => tree.map(&mut |part| resolved(names, text, part, index)),
    }
}
