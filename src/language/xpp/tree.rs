//! Formulas as trees, and how they are written in the language of models.

use std::collections::BTreeSet;
use std::ops::Range;

/// The meaning of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Known {
    State(usize),
    Constant(usize),
    Fixed(usize),
    Function(usize),
    /// `mod` of a divisor that may be negative.
    Modulo,
    /// An argument of the function in which it stands.
    Argument(usize),
    Time,
    Pi,
    /// The index of the sum in which it stands.
    Index,
}

/// An operation of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Operator {
    /// How it is written.
    pub sign: &'static str,
    /// How strongly it binds in XPPAUT.
    pub there: u8,
    /// How strongly it binds here.
    pub here: u8,
}

/// The operations of two operands. In XPPAUT comparisons bind as strongly as powers, and all go
/// from left to right.
pub(super) const OPERATORS: [Operator; 13] = [
    Operator { sign: "|", there: 4, here: 1 },
    Operator { sign: "&", there: 6, here: 2 },
    Operator { sign: "==", there: 7, here: 3 },
    Operator { sign: "!=", there: 7, here: 3 },
    Operator { sign: ">=", there: 7, here: 3 },
    Operator { sign: "<=", there: 7, here: 3 },
    Operator { sign: ">", there: 7, here: 3 },
    Operator { sign: "<", there: 7, here: 3 },
    Operator { sign: "+", there: 4, here: 4 },
    Operator { sign: "-", there: 4, here: 4 },
    Operator { sign: "*", there: 6, here: 5 },
    Operator { sign: "/", there: 6, here: 5 },
    Operator { sign: "^", there: 7, here: 7 },
];

/// How strongly a comparison binds here.
const COMPARISON: u8 = 3;
/// How strongly a sign binds here.
const SIGN: u8 = 6;
/// The formulas that need no brackets anywhere.
const WHOLE: u8 = 9;

/// A formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Tree {
    Number(String),
    Name(Known),
    Negative(Box<Tree>),
    Not(Box<Tree>),
    Binary(Operator, Box<[Tree; 2]>),
    /// A function of XPPAUT's.
    Call(&'static str, Vec<Tree>),
    /// `mod` of a divisor that may be negative.
    Modulo(Vec<Tree>),
    /// A function of the file's own.
    Own(usize, Vec<Tree>),
    If(Box<[Tree; 3]>),
    /// A sum from an index to an index.
    Sum(i64, i64, Box<Tree>),
    /// A sum that has been written out.
    Terms(Vec<Tree>),
    /// The name that is so many names behind a name, with its place in the formula.
    Shift(Known, Box<Tree>, Range<usize>),
}

impl Tree {
    /// A number.
    pub fn number(value: f64) -> Tree {
        let number = Tree::Number(format!("{}", value.abs()));
        if value < 0.0 { Tree::Negative(Box::new(number)) } else { number }
    }

    /// An operation of two operands.
    pub fn binary(sign: &str, a: Tree, b: Tree) -> Tree {
        let found = OPERATORS.into_iter().find(|operator| operator.sign == sign);
        Tree::Binary(found.unwrap_or(OPERATORS[8]), Box::new([a, b]))
    }

    /// It with the opposite sign: of a difference the opposite difference.
    pub fn negated(self) -> Tree {
        match self {
            Tree::Binary(operator, sides) if operator.sign == "-" => {
                let [a, b] = *sides;
                Tree::Binary(operator, Box::new([b, a]))
            }
            Tree::Negative(inner) => *inner,
            other => Tree::Negative(Box::new(other)),
        }
    }

    /// The formulas that it consists of.
    pub fn children(&self) -> &[Tree] {
        match self {
            Tree::Number(_) | Tree::Name(_) => &[],
            Tree::Negative(a) | Tree::Not(a) | Tree::Sum(_, _, a) | Tree::Shift(_, a, _) => {
                std::slice::from_ref(a)
            }
            Tree::Binary(_, both) => &both[..],
            Tree::If(three) => &three[..],
            Tree::Call(_, all) | Tree::Own(_, all) | Tree::Terms(all) | Tree::Modulo(all) => all,
        }
    }

    /// The same of other formulas.
    pub fn map<E>(&self, f: &mut impl FnMut(&Tree) -> Result<Tree, E>) -> Result<Tree, E> {
        let mut boxed = |tree: &Tree| f(tree).map(Box::new);
        Ok(match self {
            Tree::Number(_) | Tree::Name(_) => self.clone(),
            Tree::Negative(a) => Tree::Negative(boxed(a)?),
            Tree::Not(a) => Tree::Not(boxed(a)?),
            Tree::Sum(low, high, a) => Tree::Sum(*low, *high, boxed(a)?),
            Tree::Shift(known, a, place) => Tree::Shift(*known, boxed(a)?, place.clone()),
            Tree::Binary(operator, both) => {
                Tree::Binary(*operator, Box::new([f(&both[0])?, f(&both[1])?]))
            }
            Tree::If(three) => Tree::If(Box::new([f(&three[0])?, f(&three[1])?, f(&three[2])?])),
            Tree::Call(name, all) => Tree::Call(name, all.iter().map(f).collect::<Result<_, E>>()?),
            Tree::Modulo(all) => Tree::Modulo(all.iter().map(f).collect::<Result<_, E>>()?),
            Tree::Own(k, all) => Tree::Own(*k, all.iter().map(f).collect::<Result<_, E>>()?),
            Tree::Terms(all) => Tree::Terms(all.iter().map(f).collect::<Result<_, E>>()?),
        })
    }

    /// Shows it and all its parts.
    pub fn visit(&self, show: &mut dyn FnMut(&Tree)) {
        let mut open = vec![self];
        while let Some(tree) = open.pop() {
            show(tree);
            open.extend(tree.children());
        }
    }

    /// How many parts it has.
    pub fn size(&self) -> usize {
        let mut size = 0;
        self.visit(&mut |_| size += 1);
        size
    }

    /// The names that occur in it, functions included.
    pub fn names(&self) -> BTreeSet<Known> {
        let mut names = BTreeSet::new();
        self.visit(&mut |tree| {
            match tree {
                Tree::Name(known) => names.insert(*known),
                Tree::Own(k, _) => names.insert(Known::Function(*k)),
                _ => false,
            };
        });
        names
    }

    /// Its value, if it has one without knowing more than some constants.
    pub fn value(&self, constant: &dyn Fn(usize) -> Option<f64>) -> Option<f64> {
        match self {
            Tree::Number(text) => text.parse().ok(),
            Tree::Name(Known::Constant(k)) => constant(*k),
            Tree::Name(Known::Pi) => Some(std::f64::consts::PI),
            Tree::Negative(a) => Some(-a.value(constant)?),
            Tree::Binary(operator, both) => {
                let [a, b] = [both[0].value(constant)?, both[1].value(constant)?];
                match operator.sign {
                    "+" => Some(a + b),
                    "-" => Some(a - b),
                    "*" => Some(a * b),
                    "/" => Some(a / b),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// It as text, where names are written so.
    pub fn written(&self, names: &dyn Fn(Known) -> String) -> String {
        self.bound(names).0
    }

    /// It as text, and how strongly its weakest part binds.
    fn bound(&self, names: &dyn Fn(Known) -> String) -> (String, u8) {
        let within = |tree: &Tree, least: u8| {
            let (text, strength) = tree.bound(names);
            if strength < least { format!("({text})") } else { text }
        };
        let list = |all: &[Tree]| {
            let texts: Vec<String> = all.iter().map(|tree| within(tree, 0)).collect();
            texts.join(", ")
        };
        match self {
            Tree::Number(text) => (text.clone(), WHOLE),
            Tree::Name(known) => (names(*known), WHOLE),
            Tree::Negative(a) => (format!("-{}", within(a, SIGN + 1)), SIGN),
            Tree::Not(a) => (format!("not({})", within(a, 0)), WHOLE),
            Tree::Call(name, all) => (format!("{name}({})", list(all)), WHOLE),
            Tree::Modulo(all) => (format!("{}({})", names(Known::Modulo), list(all)), WHOLE),
            Tree::Own(k, all) => (format!("{}({})", names(Known::Function(*k)), list(all)), WHOLE),
            Tree::If(three) => {
                let [a, b, c] = [0, 1, 2].map(|k| within(&three[k], 0));
                (format!("if({a})then({b})else({c})"), WHOLE)
            }
            Tree::Sum(low, high, a) => (format!("sum({low},{high})of({})", within(a, 0)), WHOLE),
            Tree::Terms(all) if all.is_empty() => ("0".into(), WHOLE),
            Tree::Terms(all) if all.len() == 1 => all[0].bound(names),
            Tree::Terms(all) => {
                let texts: Vec<String> = all.iter().map(|term| within(term, 5)).collect();
                (texts.join("+"), 4)
            }
            // It has been replaced by what it stands for.
            Tree::Shift(known, ..) => (names(*known), WHOLE),
            Tree::Binary(..) => self.chain(&within),
        }
    }

    /// Operations one after the other, without recursion from one to the next.
    fn chain(&self, within: &dyn Fn(&Tree, u8) -> String) -> (String, u8) {
        let (mut tree, mut rights, mut strength) = (self, Vec::new(), None);
        while let Tree::Binary(Operator { sign, here, .. }, both) = tree {
            // Powers go from right to left here, and comparisons stand alone.
            let power = *sign == "^";
            let alone = power || *here == COMPARISON;
            if strength.is_some_and(|outer| *here < outer) || (alone && !rights.is_empty()) {
                break;
            }
            rights.push((*sign, within(&both[1], if power { WHOLE } else { here + 1 })));
            strength = Some(*here);
            tree = &both[0];
            if alone {
                break;
            }
        }
        let strength_of_first = strength.unwrap_or(WHOLE);
        let least = match rights.last() {
            Some(("^", _)) => WHOLE,
            _ if strength_of_first == COMPARISON => COMPARISON + 1,
            _ => strength_of_first,
        };
        let mut text = within(tree, least);
        for (sign, right) in rights.iter().rev() {
            text.push_str(sign);
            text.push_str(right);
        }
        let Tree::Binary(Operator { here, .. }, _) = self else { return (text, WHOLE) };
        (text, *here)
    }
}
