//! What is wrong with a text that is not written as RON is, in words for those who wrote it.

use crate::spelling::{shown, suggest};
use ron::Error as RonError;

/// What is wrong, and what may stand there instead.
pub(crate) fn reason(code: &RonError) -> String {
    use RonError::*;
    match code {
        Eof => "the text ends before all brackets are closed".into(),
        ExpectedString => "expected a text in quotes, as `\"name\"`".into(),
        ExpectedStringEnd => "the quotes that begin here are not closed".into(),
        ExpectedBoolean => "expected `true` or `false`".into(),
        ExpectedArray => "expected a list, `[…]`".into(),
        ExpectedArrayEnd => "expected a comma, or the end of the list, `]`".into(),
        ExpectedComma => "expected a comma, or the closing bracket".into(),
        ExpectedMapColon => "expected a colon and a value behind the name of a field".into(),
        ExpectedStructLike | ExpectedUnit => "expected `(…)`".into(),
        ExpectedNamedStructLike(name) if !name.is_empty() => format!("expected `{name}(…)`"),
        ExpectedNamedStructLike(_) => "expected `(…)`".into(),
        ExpectedStructLikeEnd | ExpectedOptionEnd => {
            "expected a comma, or the closing bracket, `)`".into()
        }
        ExpectedInteger | InvalidIntegerDigit { .. } => "expected a whole number".into(),
        ExpectedFloat | FloatUnderscore => "expected a number".into(),
        IntegerOutOfBounds => "the number is too large, or negative where it must not be".into(),
        ExpectedIdentifier | InvalidIdentifier(_) | SuggestRawIdentifier(_) => {
            "expected a name without quotes".into()
        }
        TrailingCharacters => {
            "the text should end before this: a bracket before it is closed too early, or this is too much".into()
        }
        UnclosedBlockComment => "the comment is not closed: `*/` is missing".into(),
        NoSuchStructField { expected, found, outer } => unknown("field", found, expected, outer),
        NoSuchEnumVariant { expected, found, outer } => unknown("name", found, expected, outer),
        MissingStructField { field, outer } => format!("the field `{field}`{} is missing", of(outer)),
        DuplicateStructField { field, outer } => {
            format!("the field `{field}`{} is given twice", of(outer))
        }
        ExpectedDifferentLength { expected, found } => {
            format!("expected {expected}, and there are {found}")
        }
        InvalidValueForType { expected, found } => format!("expected {expected}, not {found}"),
        InvalidEscape(_) => "no escape that is known: a backslash is written twice, `\\\\`".into(),
        ExceededRecursionLimit => "brackets are nested too deeply".into(),
        other => other.to_string(),
    }
}

/// Of what a field is.
fn of(outer: &Option<String>) -> String {
    outer.as_ref().map_or(String::new(), |outer| format!(" of `{outer}`"))
}

fn unknown(what: &str, found: &str, expected: &[&str], outer: &Option<String>) -> String {
    let meant = suggest(found, expected.iter().copied());
    let meant = meant.map_or(String::new(), |meant| format!("; did you mean `{meant}`?"));
    let found = shown(found);
    match expected {
        [] => format!("there is no {what} `{found}`{}: none is expected", of(outer)),
        _ => format!(
            "there is no {what} `{found}`{}{meant} Known: {}",
            of(outer),
            expected.join(", ")
        )
        .replace("` Known", "`. Known"),
    }
}
