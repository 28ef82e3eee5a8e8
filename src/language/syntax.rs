//! Syntax of formulas: parses a text into nodes in postfix order, in the dialect of models or of
//! XPPAUT.
//!
//! From the weakest to the strongest, the operators are `|`, `&`, comparisons, `+ -`, `* /`, the
//! signs `- + !`, and `^` (or `**`), which associates to the right and whose exponent may have a
//! sign. As in XPPAUT, `if(c, a, b)` may be written `if(c)then(a)else(b)`, and `sum(i, 1, n, …)`
//! may be written `sum(1, n)of(…i'…)`.
//!
//! In XPPAUT files, all operators associate to the left, comparisons bind as strongly as powers,
//! `|` binds as strongly as sums and `&` as products, and letter case is ignored.

use super::operation::Operation;
use super::source::{Fault, ModelError, Phrase, Source};
use std::ops::Range;
use winnow::ascii::{digit1, multispace0};
use winnow::combinator::{alt, cut_err, eof, fail, not, opt, peek, preceded, repeat};
use winnow::error::{ContextError, StrContext, StrContextValue};
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location, Stateful};
use winnow::token::{one_of, take_while};

/// The dialect in which a formula is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialect {
    /// The dialect of formulas in this library's models.
    Own,
    /// The dialect of formulas in XPPAUT files.
    Xpp,
}

/// A binary operator, with its binding strength in models and in XPPAUT files; the strength is 0 if
/// the dialect does not have the operator.
pub(super) struct Infix {
    pub sign: &'static str,
    pub operation: Operation,
    pub own: u8,
    pub xpp: u8,
}

/// The binary operators. In the list of operators, an operator precedes every operator that is a
/// prefix of it; if an operation has several spellings, the preferred spelling comes last.
pub(super) const INFIX: [Infix; 16] = [
    Infix { sign: "||", operation: Operation::Or, own: 1, xpp: 0 },
    Infix { sign: "|", operation: Operation::Or, own: 1, xpp: 4 },
    Infix { sign: "&&", operation: Operation::And, own: 2, xpp: 0 },
    Infix { sign: "&", operation: Operation::And, own: 2, xpp: 6 },
    Infix { sign: "<=", operation: Operation::AtMost, own: COMPARISON, xpp: 7 },
    Infix { sign: ">=", operation: Operation::AtLeast, own: COMPARISON, xpp: 7 },
    Infix { sign: "==", operation: Operation::Equal, own: COMPARISON, xpp: 7 },
    Infix { sign: "!=", operation: Operation::Unequal, own: COMPARISON, xpp: 7 },
    Infix { sign: "<", operation: Operation::Less, own: COMPARISON, xpp: 7 },
    Infix { sign: ">", operation: Operation::More, own: COMPARISON, xpp: 7 },
    Infix { sign: "+", operation: Operation::Add, own: 4, xpp: 4 },
    Infix { sign: "-", operation: Operation::Subtract, own: 4, xpp: 4 },
    Infix { sign: "**", operation: Operation::Power, own: POWER, xpp: 7 },
    Infix { sign: "^", operation: Operation::Power, own: POWER, xpp: 7 },
    Infix { sign: "*", operation: Operation::Multiply, own: 5, xpp: 6 },
    Infix { sign: "/", operation: Operation::Divide, own: 5, xpp: 6 },
];

/// The binding strength of comparison operators, which cannot be chained.
pub(super) const COMPARISON: u8 = 3;
/// The binding strength of the signs `-`, `+` and `!`.
pub(super) const SIGN: u8 = 6;
/// The binding strength of powers, which associate to the right.
pub(super) const POWER: u8 = 7;

impl Infix {
    /// Returns the binding strength of the operator, and the minimum binding strength of its right
    /// operand.
    fn strengths(&self, dialect: Dialect) -> (u8, u8) {
        match dialect {
            Dialect::Own if self.own == POWER => (POWER, SIGN),
            Dialect::Own => (self.own, self.own + 1),
            Dialect::Xpp => (self.xpp, self.xpp + 1),
        }
    }
}

impl Dialect {
    /// Returns the maximum nesting depth of brackets, signs and powers. The limit for XPPAUT is
    /// lower, because converted formulas contain more brackets.
    fn depth(self) -> usize {
        if self == Dialect::Own { 150 } else { 100 }
    }

    fn is_letter(self, letter: char) -> bool {
        letter == '_'
            || match self {
                Dialect::Own => letter.is_alphabetic(),
                Dialect::Xpp => letter.is_ascii_alphabetic(),
            }
    }

    /// Returns whether a character may occur in a name, except as the first character.
    fn is_digit(self, letter: char) -> bool {
        match self {
            Dialect::Own => letter.is_numeric(),
            Dialect::Xpp => letter.is_ascii_digit() || letter == '.',
        }
    }

    /// Returns whether a name is a given keyword of the language.
    fn is(self, name: &str, word: &str) -> bool {
        name == word || self == Dialect::Xpp && name.eq_ignore_ascii_case(word)
    }
}

/// The text to parse, with its dialect and the current nesting depth.
type Input<'a> = Stateful<LocatingSlice<&'a str>, (Dialect, usize)>;

/// A step of a formula in postfix order, with its position in the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node<N = String> {
    pub step: Step<N>,
    pub place: Range<usize>,
}

/// One step of a formula in postfix order, which operates on a stack of values; names are texts or
/// resolved.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step<N = String> {
    /// Adds a number.
    Number(String),
    /// Pushes the value that a name denotes.
    Name(N),
    /// Removes the given number of indices from the stack, and pushes the value of the array
    /// element with these indices.
    Element(N, usize),
    /// Removes the given number of indices and an end of the interval (0 or 1) from the stack, and
    /// pushes the value of the array element at this end.
    ElementAt(N, usize),
    /// Replaces the operands of an operation by its result.
    Apply(Operation),
    /// Removes the given number of arguments from the stack, and pushes the value of a function of
    /// these arguments.
    Call(N, usize),
    /// Removes the two ends of a range from the stack, and pushes the sum of a formula over an
    /// index in this range.
    Sum(N, Vec<Node<N>>),
}

impl<N> Step<N> {
    /// Returns the number of values on the stack that the step replaces by its result.
    pub fn operands(&self) -> usize {
        match self {
            Step::Number(_) | Step::Name(_) => 0,
            Step::Element(_, indices) => *indices,
            Step::ElementAt(_, indices) => indices + 1,
            Step::Sum(..) => 2,
            Step::Apply(operation) => operation.arity(),
            Step::Call(_, count) => *count,
        }
    }
}

/// Returns the value of a numeric literal.
pub(super) fn value_of(digits: &str) -> f64 {
    let plain = |digits: &str| digits.parse().ok();
    plain(digits).or_else(|| plain(&digits.replace('d', "e"))).unwrap_or(f64::NAN)
}

/// A parsed formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Formula {
    pub phrase: Phrase,
    pub nodes: Vec<Node>,
}

/// The help for an equation in place of a formula.
const SEPARATED: &str = "`==` compares two values; equations with left-hand sides, such as `0 = g(x, y)` or \
                         `2*x' + y' = f(x, y)`, belong to the unknowns of a `Residual` with \
                         `dynamics: flow`";

impl Formula {
    /// Parses a formula.
    pub fn read(source: &Source, phrase: &Phrase) -> Result<Formula, ModelError> {
        let nodes = nodes(&phrase.text, Dialect::Own);
        let nodes = nodes.map_err(|(part, fault)| {
            let error = source.fault(phrase, part.clone(), fault);
            match &phrase.text[part] {
                "=" => error.with_help(SEPARATED),
                _ => error,
            }
        })?;
        Ok(Formula { phrase: phrase.clone(), nodes })
    }
}

/// Parses a formula that is written in a given dialect.
///
/// # Errors
/// Returns, as the error, the range of the invalid part of the text, and a description of the
/// syntax error.
pub(super) fn nodes(text: &str, dialect: Dialect) -> Result<Vec<Node>, (Range<usize>, Fault)> {
    let whole = preceded(blank, |input: &mut Input| expression(input, 0));
    all(text, dialect, whole, "an operator, as in `2*x`, or the end of the formula")
}

/// A name declared in a statement: a scalar, or elements of an array.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Declared {
    pub name: String,
    /// The indices of the array elements; empty for a scalar.
    pub indices: Vec<Index>,
}

/// An index of array elements.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Index {
    /// A single value.
    One(Formula),
    /// All integers between two ends, with the name that the index has in formulas.
    Range(String, Formula, Formula),
}

impl Declared {
    /// Parses a name without an index.
    pub fn plain(source: &Source, phrase: &Phrase) -> Result<String, ModelError> {
        let Declared { name, indices } = Declared::read(source, phrase)?;
        let fault = Fault::Syntax { expected: "a name without an index".into() };
        if indices.is_empty() { Ok(name) } else { Err(source.fault_of(phrase, fault)) }
    }

    /// Parses a declared name, such as `u`, `u[3]`, `u[i=1..n]` or `u[0, j=1..n]`.
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
            let mut indices = Vec::new();
            if opt(symbol("[")).parse_next(input)?.is_some() {
                indices.push(inner(input)?);
                while opt(symbol(",")).parse_next(input)?.is_some() {
                    indices.push(inner(input)?);
                }
                expected(symbol("]"), "`]`").parse_next(input)?;
            }
            Ok(Declared { name, indices })
        };
        all(&phrase.text, Dialect::Own, whole, "`[`, or the end of the name")
            .map_err(|(part, fault)| source.fault(phrase, part, fault))
    }
}

/// Parses a text up to its end.
fn all<'a, T>(
    text: &'a str,
    dialect: Dialect,
    parser: impl Parser<Input<'a>, T, winnow::error::ErrMode<ContextError>>,
    at_end: &'static str,
) -> Result<T, (Range<usize>, Fault)> {
    let input = Stateful { input: LocatingSlice::new(text), state: (dialect, 0) };
    let end = expected(eof, at_end);
    (parser, end).map(|(value, _)| value).parse(input).map_err(|error| {
        let at = error.offset();
        let length = text[at..].chars().next().map_or(0, char::len_utf8);
        let names = error.inner().context().filter_map(|context| match context {
            StrContext::Expected(StrContextValue::Description(words)) => Some(*words),
            _ => None,
        });
        let fault = match names.last().unwrap_or("a formula") {
            TOO_DEEP => Fault::TooLarge { what: TOO_DEEP, limit: dialect.depth() },
            words => Fault::Syntax { expected: words.into() },
        };
        (at..at + length, fault)
    })
}

const TOO_DEEP: &str = "nested brackets, signs and powers";

fn blank(input: &mut Input) -> ModalResult<()> {
    multispace0.void().parse_next(input)
}

/// Adds a description of the required syntax to a parser's error.
fn expected<'a, T>(
    parser: impl Parser<Input<'a>, T, winnow::error::ErrMode<ContextError>>,
    words: &'static str,
) -> impl Parser<Input<'a>, T, winnow::error::ErrMode<ContextError>> {
    cut_err(parser).context(StrContext::Expected(StrContextValue::Description(words)))
}

/// Parses a symbol and the blanks that follow it.
fn symbol<'a>(
    text: &'static str,
) -> impl Parser<Input<'a>, (), winnow::error::ErrMode<ContextError>> {
    (text, multispace0).void()
}

/// Parses a name, which consists of letters, digits and underscores and does not start with a
/// digit. The index `i'` of a sum in XPPAUT's notation has a prime.
fn name(input: &mut Input) -> ModalResult<String> {
    let (dialect, _) = input.state;
    let inner = move |c: char| dialect.is_letter(c) || dialect.is_digit(c);
    let name = (one_of(move |c: char| dialect.is_letter(c)), take_while(0.., inner));
    let mut name = name.take().parse_next(input)?.to_string();
    if dialect.is(&name, "i") && opt('\'').parse_next(input)?.is_some() {
        name = "i'".into();
    }
    blank(input)?;
    Ok(name)
}

/// Parses a keyword of the language.
fn word<'a>(
    word: &'static str,
) -> impl Parser<Input<'a>, (), winnow::error::ErrMode<ContextError>> {
    move |input: &mut Input<'a>| {
        let (dialect, _) = input.state;
        name.verify(|name: &str| dialect.is(name, word)).void().parse_next(input)
    }
}

/// Parses a number, such as `2`, `2.`, `.5` or `1e-3`. The two dots of a range such as `1..3` do
/// not belong to the number.
fn number(input: &mut Input) -> ModalResult<String> {
    let (dialect, _) = input.state;
    let fraction = ('.', not('.'), opt(digit1)).void();
    let mantissa = alt(((digit1, opt(fraction)).void(), ('.', digit1).void()));
    let mark = move |c: char| "eE".contains(c) || dialect == Dialect::Own && "dD".contains(c);
    let exponent = (one_of(mark), opt(one_of(['+', '-'])), digit1).void();
    let number = (mantissa, opt(exponent)).take().map(str::to_ascii_lowercase);
    (number, multispace0).map(|(number, _)| number).parse_next(input)
}

/// Runs a parser with the nesting depth increased by one.
fn deeper<'a, T>(
    input: &mut Input<'a>,
    parser: impl FnOnce(&mut Input<'a>) -> ModalResult<T>,
) -> ModalResult<T> {
    let (dialect, depth) = input.state;
    if depth >= dialect.depth() {
        return expected(fail, TOO_DEEP).parse_next(input);
    }
    input.state = (dialect, depth + 1);
    let value = parser(input);
    input.state = (dialect, depth);
    value
}

/// Parses a binary operator and the blanks that follow it.
fn infix(input: &mut Input) -> ModalResult<&'static Infix> {
    let (dialect, _) = input.state;
    let known = |infix: &&Infix| infix.strengths(dialect).0 > 0 && input.starts_with(infix.sign);
    match INFIX.iter().find(known) {
        Some(infix) => symbol(infix.sign).value(infix).parse_next(input),
        None => fail.parse_next(input),
    }
}

/// Parses an operand, and the operators of at least a given binding strength with their operands.
fn expression(input: &mut Input, least: u8) -> ModalResult<Vec<Node>> {
    let (dialect, _) = input.state;
    deeper(input, |input| {
        let begin = input.current_token_start();
        let mut nodes = signed(input)?;
        let mut compared = false;
        loop {
            let binds = |infix: &&Infix| infix.strengths(dialect).0 >= least;
            let Some(infix) = opt(infix.verify(binds)).parse_next(input)? else {
                return Ok(nodes);
            };
            let (strength, following) = infix.strengths(dialect);
            if strength == COMPARISON && std::mem::replace(&mut compared, true) {
                return expected(fail, "`&` between two comparisons, as in `0 < x & x < 1`")
                    .parse_next(input);
            }
            nodes.extend(expression(input, following)?);
            let place = begin..input.previous_token_end();
            nodes.push(Node { step: Step::Apply(infix.operation), place });
        }
    })
}

/// Parses an operand and its sign. A sign binds more weakly than a power: `-x^2` is `-(x^2)`.
fn signed(input: &mut Input) -> ModalResult<Vec<Node>> {
    let begin = input.current_token_start();
    let operation = match input.state.0 {
        Dialect::Own => {
            let not_equal = ("!", peek(not("="))).void();
            let negation = (not_equal, multispace0).value(Some(Operation::Not));
            let minus = symbol("-").value(Some(Operation::Negate));
            opt(alt((minus, symbol("+").value(None), negation))).parse_next(input)?
        }
        Dialect::Xpp => {
            let minus = alt((symbol("-"), symbol("~"))).value(Some(Operation::Negate));
            opt(alt((minus, word("not").value(Some(Operation::Not))))).parse_next(input)?
        }
    };
    let Some(operation) = operation else { return operand(input) };
    let least = if input.state.0 == Dialect::Own { SIGN } else { POWER };
    let mut nodes = expression(input, least)?;
    let place = begin..input.previous_token_end();
    nodes.extend(operation.map(|operation| Node { step: Step::Apply(operation), place }));
    Ok(nodes)
}

fn operand(input: &mut Input) -> ModalResult<Vec<Node>> {
    let (dialect, begin) = (input.state.0, input.current_token_start());
    let node = |step, input: &Input| Node { step, place: begin..input.previous_token_end() };
    if let Some(digits) = opt(number).parse_next(input)? {
        return Ok(vec![node(Step::Number(digits), input)]);
    }
    if opt(symbol("(")).parse_next(input)?.is_some() {
        let nodes = expression(input, 0)?;
        expected(symbol(")"), "an operator or `)`").parse_next(input)?;
        return Ok(nodes);
    }
    let mut name = expected(name, "a number, a name or `(`").parse_next(input)?;
    prime(&mut name, input)?;
    if dialect == Dialect::Own && opt(symbol("[")).parse_next(input)?.is_some() {
        let (mut nodes, indices) = list(input)?;
        expected(symbol("]"), "an operator or `]`").parse_next(input)?;
        prime(&mut name, input)?;
        if opt(symbol("(")).parse_next(input)?.is_none() {
            nodes.push(node(Step::Element(name, indices), input));
            return Ok(nodes);
        }
        nodes.extend(expression(input, 0)?);
        expected(symbol(")"), "an operator or `)`").parse_next(input)?;
        nodes.push(node(Step::ElementAt(name, indices), input));
        return Ok(nodes);
    }
    if opt(symbol("(")).parse_next(input)?.is_none() {
        return Ok(vec![node(Step::Name(name), input)]);
    }
    match name.as_str() {
        name if dialect.is(name, "sum") => sum(input, begin),
        name if dialect.is(name, "if") => condition(input, begin),
        _ => {
            let (mut nodes, arguments) = list(input)?;
            expected(symbol(")"), "an operator, `,` or `)`").parse_next(input)?;
            nodes.push(node(Step::Call(name, arguments), input));
            Ok(nodes)
        }
    }
}

/// Parses the prime of a rate, such as `x'` or `u[i]'`, and adds it to the name.
fn prime(name: &mut String, input: &mut Input) -> ModalResult<()> {
    let is_own = input.state.0 == Dialect::Own && !name.ends_with('\'');
    if is_own && opt(symbol("'")).parse_next(input)?.is_some() {
        name.push('\'');
    }
    Ok(())
}

/// Parses a list of formulas separated by commas, and returns their number.
fn list(input: &mut Input) -> ModalResult<(Vec<Node>, usize)> {
    let mut nodes = expression(input, 0)?;
    let mut more = repeat(0.., preceded(symbol(","), |input: &mut Input| expression(input, 0)));
    let more: Vec<Vec<Node>> = more.parse_next(input)?;
    let count = 1 + more.len();
    nodes.extend(more.into_iter().flatten());
    Ok((nodes, count))
}

/// Parses the rest of `if(c, a, b)` or `if(c)then(a)else(b)` after the first bracket.
fn condition(input: &mut Input, begin: usize) -> ModalResult<Vec<Node>> {
    let mut nodes = expression(input, 0)?;
    let is_list =
        input.state.0 == Dialect::Own && opt(peek(symbol(","))).parse_next(input)?.is_some();
    for (name, needed) in [("then", "`then(`"), ("else", "`else(`")] {
        if is_list {
            expected(symbol(","), "an operator, `,` or `)`").parse_next(input)?;
        } else {
            expected(symbol(")"), "an operator, `,` or `)`").parse_next(input)?;
            expected((word(name), symbol("(")).void(), needed).parse_next(input)?;
        }
        nodes.extend(expression(input, 0)?);
    }
    expected(symbol(")"), "an operator or `)`").parse_next(input)?;
    let place = begin..input.previous_token_end();
    nodes.push(Node { step: Step::Apply(Operation::Select), place });
    Ok(nodes)
}

/// Parses the rest of `sum(i, 1, n, …)` or `sum(1, n)of(…i'…)` after the first bracket.
fn sum(input: &mut Input, begin: usize) -> ModalResult<Vec<Node>> {
    let at = input.current_token_start();
    let first = opt((name, symbol(",")).map(|(name, _)| name)).parse_next(input)?;
    let behind_first = input.previous_token_end();
    let mut nodes = expression(input, 0)?;
    let of = |input: &mut Input| (symbol(")"), word("of"), symbol("(")).void().parse_next(input);
    let index = match first {
        // In `sum(a, …)of(…)` the name is the first end.
        Some(name)
            if input.state.0 == Dialect::Xpp || opt(peek(of)).parse_next(input)?.is_some() =>
        {
            expected(of, "an operator or `)of(`").parse_next(input)?;
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
