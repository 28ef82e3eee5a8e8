//! The parts of formulas.

use super::super::source::ModelError;
use super::names::Names;
use super::origin::Slice;
use std::ops::Range;

/// A part of a formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(String),
    Name(String),
    Sign(&'static str),
}

/// Splits a formula.
pub(super) fn tokens(names: &Names, text: Slice) -> Result<Vec<(Token, Range<usize>)>, ModelError> {
    const SIGNS: [&str; 19] = [
        "**", "==", ">=", "<=", "!=", "+", "-", "*", "/", "^", "&", "|", ">", "<", "(", ")", ",",
        "~", "%",
    ];
    let (mut tokens, mut at) = (Vec::new(), 0);
    let bytes = text.text.as_bytes();
    while let Some(&byte) = bytes.get(at) {
        let start = at;
        if byte.is_ascii_whitespace() {
            at += 1;
            continue;
        }
        if byte.is_ascii_digit() || byte == b'.' {
            at = number_end(bytes, at);
            let digits = text.text[start..at].to_ascii_lowercase();
            if digits.parse::<f64>().is_err() {
                return Err(text.part(start..at).expected(names.source, "a number"));
            }
            tokens.push((Token::Number(digits), start..at));
        } else if byte.is_ascii_alphabetic() || byte == b'_' {
            at = run(bytes, at, |b| b.is_ascii_alphanumeric() || b == b'_' || b == b'.');
            // The index of sums.
            let index =
                text.text[start..at].eq_ignore_ascii_case("i") && bytes.get(at) == Some(&b'\'');
            at += usize::from(index);
            tokens.push((Token::Name(text.text[start..at].into()), start..at));
        } else if let Some(sign) = SIGNS.iter().find(|sign| text.text[at..].starts_with(*sign)) {
            at += sign.len();
            let sign = if *sign == "**" { "^" } else { *sign };
            tokens.push((Token::Sign(sign), start..at));
        } else {
            let width = text.text[at..].chars().next().map_or(1, char::len_utf8);
            let place = text.part(at..at + width);
            return Err(match byte {
                b'{' | b'[' => place.expected(names.source, "an operator or `(`"),
                _ => place.expected(names.source, "a number, a name or an operator"),
            });
        }
    }
    Ok(tokens)
}

/// Where a number ends: `2`, `2.`, `.5`, `1e-3`.
fn number_end(bytes: &[u8], start: usize) -> usize {
    let digit = |byte: u8| byte.is_ascii_digit();
    let mut at = run(bytes, start, digit);
    if bytes.get(at) == Some(&b'.') {
        at = run(bytes, at + 1, digit);
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let signed = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
        at = run(bytes, at + 1 + signed, digit);
    }
    at
}

/// The end of bytes of a kind.
fn run(bytes: &[u8], from: usize, inside: impl Fn(u8) -> bool) -> usize {
    from + bytes[from..].iter().take_while(|byte| inside(**byte)).count()
}
