//! Indirect dependencies between formulas, and substitution of formulas for names.

use super::super::syntax::{Node, Step};
use super::tree::{Known, Tree};
use std::collections::{BTreeMap, BTreeSet};

/// The maximum number of nodes of a formula after substitution.
const LARGEST: usize = 20_000;

/// The formulas that define constants, fixed quantities and functions.
#[derive(Default)]
pub(super) struct Formulas {
    pub constants: Vec<Option<Tree>>,
    pub fixed: Vec<Tree>,
    pub functions: Vec<Tree>,
}

impl Formulas {
    fn behind(&self, known: Known) -> Option<&Tree> {
        match known {
            Known::Constant(k) => self.constants.get(k)?.as_ref(),
            Known::Fixed(k) => self.fixed.get(k),
            Known::Function(k) => self.functions.get(k),
            _ => None,
        }
    }

    /// Returns all names on which a formula depends, directly or through the formulas of other
    /// names.
    pub fn all_names(&self, tree: &Tree) -> BTreeSet<Known> {
        self.reached(tree, |_| true)
    }

    /// Returns the names on which a formula depends, directly or through the formulas of functions.
    pub fn by_functions(&self, tree: &Tree) -> BTreeSet<Known> {
        self.reached(tree, |known| matches!(known, Known::Function(_)))
    }

    fn reached(&self, tree: &Tree, through: impl Fn(Known) -> bool) -> BTreeSet<Known> {
        let mut found = BTreeSet::new();
        let mut open: Vec<Known> = tree.names().into_iter().collect();
        while let Some(known) = open.pop() {
            if found.insert(known) && through(known) {
                open.extend(self.behind(known).into_iter().flat_map(Tree::names));
            }
        }
        found
    }

    /// Returns the index of a function that depends on itself, or `None` if no function depends on
    /// itself.
    pub fn circular(&self) -> Option<usize> {
        let circular =
            |k: &usize| self.by_functions(&self.functions[*k]).contains(&Known::Function(*k));
        (0..self.functions.len()).find(circular)
    }

    /// Sorts the constants that are given by formulas, such that each constant follows the
    /// constants on which it depends; if a constant depends on itself, returns its index as the
    /// error.
    pub fn order(&self) -> Result<Vec<usize>, usize> {
        let count = self.constants.len();
        let needs = |k: usize| -> Vec<usize> {
            let names = self.constants[k].as_ref().map(|tree| self.by_functions(tree));
            let constant = |known| match known {
                Known::Constant(other) if self.constants[other].is_some() => Some(other),
                _ => None,
            };
            names.into_iter().flatten().filter_map(constant).collect()
        };
        let (mut order, mut entered, mut done) =
            (Vec::new(), vec![false; count], vec![false; count]);
        for first in (0..count).filter(|k| self.constants[*k].is_some()) {
            let mut open = vec![(first, Vec::new(), false)];
            while let Some((k, mut rest, known)) = open.pop() {
                if done[k] {
                    continue;
                }
                if !known {
                    if std::mem::replace(&mut entered[k], true) {
                        return Err(k);
                    }
                    rest = needs(k);
                }
                match rest.pop() {
                    Some(other) => open.extend([(k, rest, true), (other, Vec::new(), false)]),
                    None => {
                        done[k] = true;
                        order.push(k);
                    }
                }
            }
        }
        Ok(order)
    }

    /// Substitutes new values for states in a formula; if `fixed` is true, the values are also
    /// substituted in the fixed quantities on which the formula depends.
    pub fn after(&self, tree: &Tree, states: &BTreeMap<usize, Tree>, fixed: bool) -> Option<Tree> {
        let mut left = LARGEST;
        self.replaced(tree, &Replacing { states, fixed }, None, &mut left)
    }

    fn replaced(
        &self,
        tree: &Tree,
        replacing: &Replacing,
        arguments: Option<&[Tree]>,
        left: &mut usize,
    ) -> Option<Tree> {
        let put = |tree: &Tree, left: &mut usize| {
            *left = left.checked_sub(tree.0.len())?;
            Some(tree.clone())
        };
        let replaced = tree.rebuilt(&mut |Node { step, .. }, operands| {
            *left = left.checked_sub(1).ok_or(())?;
            let tree = match step {
                Step::Name(Known::State(k)) if replacing.states.contains_key(k) => {
                    put(&replacing.states[k], left)
                }
                Step::Name(Known::Argument(k)) if arguments.is_some() => {
                    arguments.and_then(|all| put(all.get(*k)?, left))
                }
                Step::Name(Known::Fixed(k))
                    if replacing.fixed && self.changes(&self.fixed[*k], replacing) =>
                {
                    self.replaced(&self.fixed[*k], replacing, None, left)
                }
                Step::Call(Known::Function(k), _)
                    if self.changes(&self.functions[*k], replacing) =>
                {
                    self.replaced(&self.functions[*k], replacing, Some(&operands), left)
                }
                Step::Sum(index, body) => {
                    let body = self.replaced(&Tree(body.clone()), replacing, arguments, left);
                    body.map(|Tree(body)| Tree::of(Step::Sum(*index, body), operands))
                }
                step => Some(Tree::of(step.clone(), operands)),
            };
            tree.ok_or(())
        });
        replaced.ok()
    }

    fn changes(&self, tree: &Tree, replacing: &Replacing) -> bool {
        let through = |known| match known {
            Known::Fixed(_) => replacing.fixed,
            known => matches!(known, Known::Function(_)),
        };
        let names = self.reached(tree, through);
        names
            .iter()
            .any(|known| matches!(known, Known::State(k) if replacing.states.contains_key(k)))
    }
}

/// The formulas that are substituted for names in other formulas.
struct Replacing<'a> {
    states: &'a BTreeMap<usize, Tree>,
    fixed: bool,
}
