//! Formulas: from text to nodes in postfix order.
//!
//! From the weakest: `|`, `&`, comparisons, `+ -`, `* /`, the signs `- + !`, and `^` (or `**`),
//! which goes from right to left and may be followed by a sign. `if(c, a, b)` may be written
//! `if(c)then(a)else(b)`, and `sum(i, 1, n, …)` as `sum(1, n)of(…i'…)`, as in XPPAUT.

use super::operation::Operation;
use super::source::{Fault, ModelError, Phrase, Source};
use std::ops::Range;
use winnow::ascii::{digit1, multispace0};
use winnow::combinator::{alt, cut_err, eof, fail, not, opt, peek, preceded, repeat};
use winnow::error::{ContextError, StrContext, StrContextValue};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stateful};
use winnow::token::{one_of, take_while};

/// How deep brackets, signs and powers may be nested.
const DEPTH: usize = 150;

/// A text with how deep the parser is in it.
type Input<'a> = Stateful<LocatingSlice<&'a str>, usize>;

/// A step of a formula in postfix order, with its place in the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    pub step: Step,
    pub place: Range<usize>,
}

/// The operation of a node on the values before it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    /// Adds a number.
    Number(f64),
    /// Adds the value of a name.
    Name(String),
    /// Replaces an index by the element of an array.
    Element(String),
    /// Replaces an index and an end, 0 or 1, by the element of an array there.
    ElementAt(String),
    /// Replaces its operands by a result.
    Apply(Operation),
    /// Replaces arguments by a function's value.
    Call(String, usize),
    /// Replaces two ends of a range by the sum of a formula in an index.
    Sum(String, Vec<Node>),
}

/// A formula that has been read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Formula {
    pub phrase: Phrase,
    pub nodes: Vec<Node>,
}

impl Formula {
    /// Reads a formula.
    pub fn read(source: &Source, phrase: &Phrase) -> Result<Formula, ModelError> {
        let whole = preceded(blank, |input: &mut Input| expression(input, 0));
        let nodes =
            all(source, phrase, whole, "an operator, as in `2*x`, or the end of the formula")?;
        Ok(Formula { phrase: phrase.clone(), nodes })
    }
}

/// A name in a statement: a scalar, one element, or all elements of an array.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Declared {
    pub name: String,
    pub index: Option<Index>,
}

/// The index of what a statement names.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Index {
    /// One element.
    One(Formula),
    /// All between two ends, for each value of an index.
    Range(String, Formula, Formula),
}

impl Declared {
    /// Reads `u`, `u[3]` or `u[i=1..n]`.
    pub fn read(source: &Source, phrase: &Phrase) -> Result<Declared, ModelError> {
        let formula = |nodes| Formula { phrase: phrase.clone(), nodes };
        let inner = |input: &mut Input| {
            let index = opt((name, symbol("=")).map(|(name, _)| name)).parse_next(input)?;
            let first = expression(input, 0)?;
            match index {
                None => Ok(Index::One(formula(first))),
                Some(index) => {
                    expected(symbol(".."), "`..`").parse_next(input)?;
                    Ok(Index::Range(index, formula(first), formula(expression(input, 0)?)))
                }
            }
        };
        let whole = |input: &mut Input| {
            blank(input)?;
            let name = expected(name, "a name").parse_next(input)?;
            let open = opt(symbol("[")).parse_next(input)?.is_some();
            let index = if open { Some(inner(input)?) } else { None };
            if open {
                expected(symbol("]"), "`]`").parse_next(input)?;
            }
            Ok(Declared { name, index })
        };
        all(source, phrase, whole, "`[`, or the end of the name")
    }
}

/// Reads a phrase to its end.
fn all<'a, T>(
    source: &Source,
    phrase: &'a Phrase,
    parser: impl Parser<Input<'a>, T, winnow::error::ErrMode<ContextError>>,
    at_end: &'static str,
) -> Result<T, ModelError> {
    let input = Stateful { input: LocatingSlice::new(phrase.text.as_str()), state: 0 };
    let end = expected(eof, at_end);
    (parser, end).map(|(value, _)| value).parse(input).map_err(|error| {
        let at = error.offset();
        let length = phrase.text[at..].chars().next().map_or(0, char::len_utf8);
        let names = error.inner().context().filter_map(|context| match context {
            StrContext::Expected(StrContextValue::Description(words)) => Some(*words),
            _ => None,
        });
        match names.last().unwrap_or("a formula") {
            TOO_DEEP => source.fault(
                phrase,
                at..at + length,
                Fault::TooLarge { what: TOO_DEEP, limit: DEPTH },
            ),
            words => {
                source.fault(phrase, at..at + length, Fault::Syntax { expected: words.into() })
            }
        }
    })
}

const TOO_DEEP: &str = "brackets, signs and powers in each other";

fn blank(input: &mut Input) -> ModalResult<()> {
    multispace0.void().parse_next(input)
}

/// The syntax that must stand here.
fn expected<'a, T>(
    parser: impl Parser<Input<'a>, T, winnow::error::ErrMode<ContextError>>,
    words: &'static str,
) -> impl Parser<Input<'a>, T, winnow::error::ErrMode<ContextError>> {
    cut_err(parser).context(StrContext::Expected(StrContextValue::Description(words)))
}

/// A symbol, and the blanks behind it.
fn symbol<'a>(
    text: &'static str,
) -> impl Parser<Input<'a>, (), winnow::error::ErrMode<ContextError>> {
    (text, multispace0).void()
}

/// A name: letters, digits and underscores, not first a digit. Only the index of XPPAUT's sums,
/// `i'`, has a prime.
fn name(input: &mut Input) -> ModalResult<String> {
    let letter = |c: char| c.is_alphabetic() || c == '_';
    let name = (one_of(letter), take_while(0.., move |c: char| letter(c) || c.is_numeric()));
    let mut name = name.take().parse_next(input)?.to_string();
    if name == "i" && opt('\'').parse_next(input)?.is_some() {
        name.push('\'');
    }
    blank(input)?;
    Ok(name)
}

/// A number: `2`, `2.`, `.5`, `1e-3`. The dots of a range do not belong to it.
fn number(input: &mut Input) -> ModalResult<f64> {
    let fraction = ('.', not('.'), opt(digit1)).void();
    let mantissa = alt(((digit1, opt(fraction)).void(), ('.', digit1).void()));
    let exponent = (one_of(['e', 'E', 'd', 'D']), opt(one_of(['+', '-'])), digit1).void();
    let number = (mantissa, opt(exponent)).take();
    let value = number.verify_map(|text: &str| text.replace(['d', 'D'], "e").parse().ok());
    (value, multispace0).map(|(value, _)| value).parse_next(input)
}

/// Goes one level deeper.
fn deeper<'a, T>(
    input: &mut Input<'a>,
    parser: impl FnOnce(&mut Input<'a>) -> ModalResult<T>,
) -> ModalResult<T> {
    if input.state >= DEPTH {
        return expected(fail, TOO_DEEP).parse_next(input);
    }
    input.state += 1;
    let value = parser(input);
    input.state -= 1;
    value
}

/// Operators between two operands: how strongly they bind, and the least strength of what follows.
fn infix(input: &mut Input) -> ModalResult<(Operation, u8, u8)> {
    use Operation::*;
    let operator = alt((
        alt((symbol("||"), symbol("|"))).value((Or, 1, 2)),
        alt((symbol("&&"), symbol("&"))).value((And, 2, 3)),
        symbol("<=").value((AtMost, 3, 4)),
        symbol(">=").value((AtLeast, 3, 4)),
        symbol("==").value((Equal, 3, 4)),
        symbol("!=").value((Unequal, 3, 4)),
        symbol("<").value((Less, 3, 4)),
        symbol(">").value((More, 3, 4)),
        symbol("+").value((Add, 4, 5)),
    ));
    let stronger = alt((
        symbol("-").value((Subtract, 4, 5)),
        alt((symbol("**"), symbol("^"))).value((Power, 7, 6)),
        symbol("*").value((Multiply, 5, 6)),
        symbol("/").value((Divide, 5, 6)),
    ));
    alt((operator, stronger)).parse_next(input)
}

/// How strongly comparisons bind.
const COMPARISON: u8 = 3;

/// Operators that bind at least so strongly, and their operands.
fn expression(input: &mut Input, least: u8) -> ModalResult<Vec<Node>> {
    deeper(input, |input| {
        let begin = input.current_token_start();
        let mut nodes = signed(input)?;
        let mut compared = false;
        loop {
            let next =
                opt(infix.verify(|(_, strength, _)| *strength >= least)).parse_next(input)?;
            let Some((operation, strength, following)) = next else { return Ok(nodes) };
            if strength == COMPARISON && std::mem::replace(&mut compared, true) {
                return expected(fail, "`&` between two comparisons, as in `0 < x & x < 1`")
                    .parse_next(input);
            }
            nodes.extend(expression(input, following)?);
            let place = begin..input.previous_token_end();
            nodes.push(Node { step: Step::Apply(operation), place });
        }
    })
}

/// An operand with its sign. A sign binds less than a power: `-x^2` is `-(x^2)`.
fn signed(input: &mut Input) -> ModalResult<Vec<Node>> {
    let begin = input.current_token_start();
    let not_equal = ("!", peek(not("="))).void();
    let negation = (not_equal, multispace0).value(Some(Operation::Not));
    let sign = alt((symbol("-").value(Some(Operation::Negate)), symbol("+").value(None), negation));
    let Some(operation) = opt(sign).parse_next(input)? else { return operand(input) };
    let mut nodes = expression(input, 6)?;
    let place = begin..input.previous_token_end();
    nodes.extend(operation.map(|operation| Node { step: Step::Apply(operation), place }));
    Ok(nodes)
}

fn operand(input: &mut Input) -> ModalResult<Vec<Node>> {
    let begin = input.current_token_start();
    let node = |step, input: &Input| Node { step, place: begin..input.previous_token_end() };
    if let Some(value) = opt(number).parse_next(input)? {
        return Ok(vec![node(Step::Number(value), input)]);
    }
    if opt(symbol("(")).parse_next(input)?.is_some() {
        let nodes = expression(input, 0)?;
        expected(symbol(")"), "an operator or `)`").parse_next(input)?;
        return Ok(nodes);
    }
    let name = expected(name, "a number, a name or `(`").parse_next(input)?;
    if opt(symbol("[")).parse_next(input)?.is_some() {
        let mut nodes = expression(input, 0)?;
        expected(symbol("]"), "an operator or `]`").parse_next(input)?;
        if opt(symbol("(")).parse_next(input)?.is_none() {
            nodes.push(node(Step::Element(name), input));
            return Ok(nodes);
        }
        nodes.extend(expression(input, 0)?);
        expected(symbol(")"), "an operator or `)`").parse_next(input)?;
        nodes.push(node(Step::ElementAt(name), input));
        return Ok(nodes);
    }
    if opt(symbol("(")).parse_next(input)?.is_none() {
        return Ok(vec![node(Step::Name(name), input)]);
    }
    match name.as_str() {
        "sum" => sum(input, begin),
        "if" => condition(input, begin),
        _ => {
            let mut nodes = expression(input, 0)?;
            let mut more =
                repeat(0.., preceded(symbol(","), |input: &mut Input| expression(input, 0)));
            let more: Vec<Vec<Node>> = more.parse_next(input)?;
            expected(symbol(")"), "an operator, `,` or `)`").parse_next(input)?;
            let arguments = 1 + more.len();
            nodes.extend(more.into_iter().flatten());
            nodes.push(node(Step::Call(name, arguments), input));
            Ok(nodes)
        }
    }
}

/// `if(c, a, b)` or `if(c)then(a)else(b)`, from behind the first bracket.
fn condition(input: &mut Input, begin: usize) -> ModalResult<Vec<Node>> {
    let mut nodes = expression(input, 0)?;
    let words = opt(symbol(")")).parse_next(input)?.is_some();
    let between = |first: bool| match (words, first) {
        (true, true) => (["then", "("], "`then(`"),
        (true, false) => (["else", "("], "`else(`"),
        _ => ([",", ""], "an operator, `,` or `)`"),
    };
    for first in [true, false] {
        let ([word, bracket], needed) = between(first);
        expected((symbol(word), symbol(bracket)).void(), needed).parse_next(input)?;
        nodes.extend(expression(input, 0)?);
        if words && first {
            expected(symbol(")"), "an operator or `)`").parse_next(input)?;
        }
    }
    expected(symbol(")"), "an operator or `)`").parse_next(input)?;
    let place = begin..input.previous_token_end();
    nodes.push(Node { step: Step::Apply(Operation::Select), place });
    Ok(nodes)
}

/// `sum(i, 1, n, …)` or `sum(1, n)of(…i'…)`, from behind the first bracket.
fn sum(input: &mut Input, begin: usize) -> ModalResult<Vec<Node>> {
    let at = input.current_token_start();
    let first = opt((name, symbol(",")).map(|(name, _)| name)).parse_next(input)?;
    let behind_first = input.previous_token_end();
    let mut nodes = expression(input, 0)?;
    let of = |input: &mut Input| (symbol(")"), symbol("of"), symbol("(")).void().parse_next(input);
    let index = match first {
        // `sum(a, …)of(…)`: the name was the first end.
        Some(name) if opt(of).parse_next(input)?.is_some() => {
            nodes.insert(0, Node { step: Step::Name(name), place: at..behind_first });
            None
        }
        Some(name) => Some(name),
        None => {
            expected(symbol(","), "an operator or `,`").parse_next(input)?;
            nodes.extend(expression(input, 0)?);
            expected(of, "`)of(`, as in `sum(1, n)of(…i'…)`; or `sum(i, 1, n, …)`")
                .parse_next(input)?;
            None
        }
    };
    if index.is_some() {
        expected(symbol(","), "an operator or `,`").parse_next(input)?;
        nodes.extend(expression(input, 0)?);
        expected(symbol(","), "an operator or `,`").parse_next(input)?;
    }
    let body = expression(input, 0)?;
    expected(symbol(")"), "an operator or `)`").parse_next(input)?;
    let place = begin..input.previous_token_end();
    nodes.push(Node { step: Step::Sum(index.unwrap_or("i'".into()), body), place });
    Ok(nodes)
}
