//! Parses lists of names with values, and rejects unsupported commands of XPPAUT.

use super::super::source::{ModelError, Source};
use super::function;
use super::option::number;
use super::origin::{Named, Slice, Text};

/// The required form of an initial value or a parameter, for messages.
pub(super) const NUMBER: &str = "a number";
/// Returns the error for a formula in place of a number, with the number if the formula has a
/// value.
pub(super) fn no_formula(source: &Source, formula: Slice) -> ModelError {
    let remedy = match super::super::number(formula.text) {
        Ok(value) => format!(
            "write `{}`; a constant with a `!`, such as `!b=2*a`, can be a formula but cannot be \
             varied",
            rounded(value)
        ),
        Err(_) => {
            "write a number, or, for a quantity that is never varied, a constant with a `!`, \
                   such as `!b=2*a`"
                .into()
        }
    };
    formula.expected(source, NUMBER).with_help(format!(
        "XPPAUT does not accept formulas for initial values and parameters: {remedy}"
    ))
}

/// Returns a number with six significant digits, as in the files of XPPAUT.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

const CHEMICAL: &str = "pHtools commands state chemical equilibria, not equations";
const VOLTERRA: &str = "models cannot contain integral equations";

/// XPPAUT commands that have no counterpart in this library: the first letters of the command, a
/// description, the reason for the rejection, and the remedy.
pub(super) const REFUSED: [(&str, &str, &str, Option<&str>); 18] = [
    ("MKSOL", "a pHtools command (`mksol`)", CHEMICAL, None),
    ("ADDTOSOL", "a pHtools command", CHEMICAL, None),
    ("TRACKSOL", "a pHtools command", CHEMICAL, None),
    ("PHSOL", "a pHtools command", CHEMICAL, None),
    ("STRENGTH", "a pHtools command", CHEMICAL, None),
    ("BUFFCAP", "a pHtools command", CHEMICAL, None),
    ("SPECIES", "a pHtools command", CHEMICAL, None),
    ("MA", "a Markov process (`markov`)", "models are deterministic", None),
    ("W", "noise (`wiener`)", "models are deterministic", None),
    ("V", "an integral equation (`volterra`)", VOLTERRA, None),
    (
        "SO",
        "an algebraic variable (`solve`)",
        "only differential equations and maps can be converted to models",
        None,
    ),
    (
        "SP",
        "a network (`special`)",
        "models cannot contain networks",
        Some("write the network as a sum, as in `sum(0,9)of(w*shift(u0,i'))`"),
    ),
    (
        "EX",
        "a library of compiled functions (`export`)",
        "the file would not contain the equations",
        None,
    ),
    (
        "TA",
        "a table (`table`)",
        "models cannot contain tables",
        Some("write the tabulated function as a formula"),
    ),
    (
        "GR",
        "a group (`group`)",
        "models cannot contain groups",
        Some("write the equations of every member of the group separately"),
    ),
    (
        "B",
        "a boundary condition (`bdry`)",
        "boundary-value problems in .ode files cannot be converted",
        Some("state the boundary-value problem as a `Boundary` problem in RON"),
    ),
    (
        "OP",
        "a file of options (`options`)",
        "options in other files are not read",
        Some("write the options in the .ode file, as in `@ total=50`"),
    ),
    (
        "OD",
        "the old form of files",
        "lines of the old form begin with numbers",
        Some("convert the file with `xppaut -convert`"),
    ),
];

/// Rejects calls of functions that have no counterpart in this library, before any other error in
/// the line is reported.
pub(super) fn refuse_calls(source: &Source, line: Slice) -> Result<(), ModelError> {
    let plain = |word: &str| {
        let start = line.text.get(..word.len());
        let behind = line.text[word.len().min(line.text.len())..].trim_start();
        start.is_some_and(|start| start.eq_ignore_ascii_case(word)) && !behind.starts_with('=')
    };
    let first = line.text.split([' ', '\t']).next().unwrap_or_default().to_ascii_uppercase();
    let word = first.bytes().all(|byte| byte.is_ascii_alphanumeric());
    let whole = word && first.len() < line.text.len() && plain(&first);
    let refused = REFUSED.iter().any(|(start, ..)| first.starts_with(start));
    if whole && (refused || ["SET", "ONLY"].contains(&first.as_str())) {
        return Ok(());
    }
    let letter = |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.');
    let (bytes, mut at) = (line.text.as_bytes(), 0);
    while at < bytes.len() {
        let length = bytes[at..].iter().take_while(|byte| letter(byte)).count();
        if length == 0 {
            at += 1;
            continue;
        }
        let word = line.text[at..at + length].to_ascii_uppercase();
        let refused = function::REFUSED.iter().find(|(known, ..)| *known == word);
        let behind = line.text[at + length..].trim_start();
        if let Some((_, construct, reason)) =
            refused.filter(|_| behind.starts_with(['(', '{', '[']))
        {
            return Err(line.part(at..at + length).unsupported(source, *construct, *reason));
        }
        at += length;
    }
    Ok(())
}

/// Parses a list of names with values, such as `a=1,b=2 c=3`.
pub(super) fn values_of(source: &Source, list: Slice) -> Result<Vec<Named>, ModelError> {
    let (mut values, mut rest) = (Vec::new(), list.trim());
    let ends = |c: char| c == ',' || c == '=' || c.is_whitespace();
    while !rest.text.is_empty() {
        let end = rest.text.find(ends).unwrap_or(rest.text.len());
        let (name, behind) = (rest.part(0..end), rest.from(end).trim());
        if name.text.is_empty() && !behind.text.starts_with('=') {
            rest = behind.from(1).trim();
            continue;
        }
        let Some(stripped) = behind.text.strip_prefix('=') else {
            // XPPAUT takes a missing value as 0.
            values.push(Named { name: name.to_text(), formula: behind.part(0..0).to_text() });
            rest = behind;
            continue;
        };
        let value = behind.from(behind.text.len() - stripped.len()).trim();
        let end = value.text.find(|c: char| c == ',' || c.is_whitespace());
        let end = end.unwrap_or(value.text.len());
        let number_text = value.part(0..end);
        if number(number_text.text).is_none() {
            return Err(no_formula(source, number_text));
        }
        values.push(Named { name: name.to_text(), formula: number_text.to_text() });
        rest = value.from(end).trim();
    }
    Ok(values)
}

/// Returns the names of the arguments between the brackets of a function.
pub(super) fn arguments_of(within: Slice) -> Vec<Text> {
    let (mut arguments, mut rest) = (Vec::new(), Some(within));
    while let Some(list) = rest {
        let (first, others) = match list.split(&[',']) {
            Some((first, _, others)) => (first, Some(others)),
            None => (list, None),
        };
        arguments.push(first.trim().to_text());
        rest = others;
    }
    arguments
}
