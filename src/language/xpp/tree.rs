//! Formulas of an XPPAUT file with resolved names, and their conversion to the language of models.

use super::super::operation::Operation;
use super::super::syntax::{COMPARISON, INFIX, Infix, Node, POWER, SIGN, Step, value_of};
use std::collections::BTreeSet;

/// The meaning of a name in an XPPAUT file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Known {
    State(usize),
    Constant(usize),
    Fixed(usize),
    Function(usize),
    /// A function that exists both in XPPAUT and in the language of models.
    BuiltIn(&'static str),
    /// The function `mod` with a divisor that may be negative.
    Modulo,
    /// The argument with this index, of the function in whose formula the name occurs.
    Argument(usize),
    Time,
    Pi,
    /// The summation index of the sum that contains the name.
    Index,
}

/// The binding strength of formulas that never need brackets around them, such as names.
const WHOLE: u8 = 9;

/// A formula in postfix order, with resolved names.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tree(pub Vec<Node<Known>>);

impl Tree {
    /// Builds a formula from its last step and the operands of this step.
    pub fn of(step: Step<Known>, operands: impl IntoIterator<Item = Tree>) -> Tree {
        let mut operands = operands.into_iter();
        let mut nodes = operands.next().unwrap_or_default().0;
        operands.for_each(|Tree(other)| nodes.extend(other));
        nodes.push(Node { step, place: 0..0 });
        Tree(nodes)
    }

    /// Returns a number as a formula.
    pub fn number(value: f64) -> Tree {
        let number = Tree::of(Step::Number(format!("{}", value.abs())), []);
        if value < 0.0 { Tree::apply(Operation::Negate, [number]) } else { number }
    }

    pub fn name(known: Known) -> Tree {
        Tree::of(Step::Name(known), [])
    }

    pub fn apply(operation: Operation, operands: impl IntoIterator<Item = Tree>) -> Tree {
        Tree::of(Step::Apply(operation), operands)
    }

    /// Returns the negative of the formula; a difference is negated by exchanging its operands.
    pub fn negated(mut self) -> Tree {
        match self.0.last().map(|node| &node.step) {
            Some(Step::Apply(Operation::Negate)) => {
                self.0.pop();
                self
            }
            Some(Step::Apply(Operation::Subtract)) => {
                self.0.pop();
                // The second operand begins where no more values are needed.
                let (mut begin, mut needed) = (self.0.len(), 1);
                while needed > 0 {
                    begin -= 1;
                    needed = needed - 1 + self.0[begin].step.operands();
                }
                let second = Tree(self.0.split_off(begin));
                Tree::apply(Operation::Subtract, [second, self])
            }
            _ => Tree::apply(Operation::Negate, [self]),
        }
    }

    /// Rebuilds a formula, operands first: the callback receives a node and its rebuilt operands.
    pub fn rebuilt<E>(
        &self,
        f: &mut impl FnMut(&Node<Known>, Vec<Tree>) -> Result<Tree, E>,
    ) -> Result<Tree, E> {
        let mut made: Vec<Tree> = Vec::new();
        for node in &self.0 {
            let operands = made.split_off(made.len() - node.step.operands());
            made.push(f(node, operands)?);
        }
        Ok(made.pop().unwrap_or_default())
    }

    /// Returns the names that occur in the formula, including the names of functions.
    pub fn names(&self) -> BTreeSet<Known> {
        let (mut names, mut open) = (BTreeSet::new(), vec![&self.0]);
        while let Some(nodes) = open.pop() {
            for Node { step, .. } in nodes {
                match step {
                    Step::Name(known) | Step::Call(known, _) => drop(names.insert(*known)),
                    Step::Sum(_, body) => open.push(body),
                    _ => {}
                }
            }
        }
        names
    }

    /// Returns the value of the formula if it contains only numbers and constants with known
    /// values.
    pub fn value(&self, constant: &dyn Fn(usize) -> Option<f64>) -> Option<f64> {
        let mut values: Vec<f64> = Vec::new();
        for Node { step, .. } in &self.0 {
            let operands = values.split_off(values.len() - step.operands());
            values.push(match (step, &operands[..]) {
                (Step::Number(digits), _) => value_of(digits),
                (Step::Name(Known::Constant(k)), _) => constant(*k)?,
                (Step::Name(Known::Pi), _) => std::f64::consts::PI,
                (Step::Apply(Operation::Negate), [a]) => -a,
                (Step::Apply(Operation::Add), [a, b]) => a + b,
                (Step::Apply(Operation::Subtract), [a, b]) => a - b,
                (Step::Apply(Operation::Multiply), [a, b]) => a * b,
                (Step::Apply(Operation::Divide), [a, b]) => a / b,
                _ => return None,
            });
        }
        values.pop()
    }

    /// Returns the formula as text, in which names have the given spellings.
    pub fn written(&self, names: &dyn Fn(Known) -> String) -> String {
        written(&self.0, names)
    }
}

/// Converts nodes to text, and returns for each formula the binding strength of its weakest
/// operator.
fn written(nodes: &[Node<Known>], names: &dyn Fn(Known) -> String) -> String {
    let mut done: Vec<(String, u8)> = Vec::new();
    let within = |(text, strength): (String, u8), least: u8| {
        if strength < least { format!("({text})") } else { text }
    };
    for Node { step, .. } in nodes {
        let mut operands = done.split_off(done.len() - step.operands());
        let whole = |text: String| (text, WHOLE);
        let called = |name: String, operands: Vec<(String, u8)>| {
            let operands: Vec<String> = operands.into_iter().map(|(text, _)| text).collect();
            whole(format!("{name}({})", operands.join(", ")))
        };
        done.push(match step {
            Step::Number(digits) => whole(digits.clone()),
            Step::Name(known) | Step::Element(known, _) | Step::ElementAt(known, _) => {
                whole(names(*known))
            }
            Step::Call(known, _) => called(names(*known), operands),
            Step::Sum(_, body) => {
                let ends: Vec<String> = operands.into_iter().map(|(text, _)| text).collect();
                whole(format!("sum({})of({})", ends.join(","), written(body, names)))
            }
            Step::Apply(Operation::Negate) => {
                (format!("-{}", within(operands.remove(0), SIGN + 1)), SIGN)
            }
            Step::Apply(Operation::Select) => {
                let [a, b, c] = [0, 1, 2].map(|k| &operands[k].0);
                whole(format!("if({a})then({b})else({c})"))
            }
            Step::Apply(operation) => {
                match INFIX.iter().rfind(|infix| infix.operation == *operation) {
                    Some(Infix { sign, own, .. }) => {
                        // Powers associate to the right, and comparisons cannot be chained.
                        let least = match *own {
                            POWER => [WHOLE, WHOLE],
                            COMPARISON => [COMPARISON + 1; 2],
                            own => [own, own + 1],
                        };
                        let second = within(operands.remove(1), least[1]);
                        let first = within(operands.remove(0), least[0]);
                        (first + sign + &second, *own)
                    }
                    None => called(operation.name().into(), operands),
                }
            }
        });
    }
    done.pop().unwrap_or_default().0
}
