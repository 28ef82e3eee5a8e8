//! Syntax errors in texts, with their place in the text and, for RON, the reason.

use crate::core::problem::UnknownName;
use crate::core::spelling::shown;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use ron::Error as RonError;
use ron::error::{Position, SpannedError};
use std::fmt;
use std::ops::Range;

/// A marked part of a line of text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The number of the line that contains the marked part, counted from 1; `None` for a text that
    /// is not in a file.
    pub line: Option<usize>,
    /// The number of the first marked column, counted from 1.
    pub column: usize,
    /// The number of marked columns.
    pub width: usize,
    /// The text of the whole line that contains the marked part.
    pub text: String,
}

impl Place {
    /// Returns the place of a part of a text; the place ends with the line in which the part
    /// begins.
    pub(crate) fn within(text: &str, part: Range<usize>) -> Self {
        let begin = text[..part.start].rfind('\n').map_or(0, |end| end + 1);
        let end = text[part.start..].find('\n').map_or(text.len(), |end| part.start + end);
        let width = text[part.start..part.end.clamp(part.start, end)].chars().count().max(1);
        let column = text[begin..part.start].chars().count() + 1;
        Place { line: None, column, width, text: text[begin..end].trim_end().to_string() }
    }
}

/// The maximum number of characters of a quoted line; of a longer line, only the surroundings of
/// the error are quoted.
const WIDTH: usize = 100;

/// Formats the line, followed by a line with marks below the marked part; the result is empty for
/// an empty line.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Place { line, column, width, text } = self;
        if text.trim().is_empty() {
            return Ok(());
        }
        let byte = |letter: usize| text.char_indices().nth(letter).map_or(text.len(), |(at, _)| at);
        let part = byte(column - 1)..byte(column - 1 + width);
        let snippet = Snippet::source(&**text).line_start(line.unwrap_or(1));
        let marked = snippet.annotation(AnnotationKind::Primary.span(part));
        let lines = Group::with_level(Level::ERROR).element(marked);
        write!(f, "\n{}", Renderer::plain().term_width(WIDTH).render(&[lines]))
    }
}

/// Returns the part of a text at which a RON error occurred; if syntax is missing, returns the last
/// token before the error.
pub(crate) fn part_of(text: &str, error: &SpannedError) -> Range<usize> {
    let [begin, end] = [error.span.start, error.span.end].map(|place| offset(text, place));
    let begin = begin + (text[begin..].len() - text[begin..].trim_start_matches(' ').len());
    let begin = begin.min(text.trim_end().len());
    begin..end.max(begin)
}

/// Returns the byte offset of a position in a text, limited to the length of the text.
fn offset(text: &str, Position { line, col }: Position) -> usize {
    let begin = match line {
        0 | 1 => 0,
        _ => text.match_indices('\n').nth(line - 2).map_or(text.len(), |(end, _)| end + 1),
    };
    let letters = text[begin..].char_indices().map(|(at, _)| begin + at);
    letters.chain([text.len()]).nth(col.saturating_sub(1)).unwrap_or(text.len())
}

/// Describes a RON error and the syntax that would be valid instead.
pub(crate) fn reason(code: &RonError) -> String {
    use RonError::*;
    match code {
        Eof => "the text ends before all brackets are closed".into(),
        ExpectedString => "expected a text in quotes, such as `\"name\"`".into(),
        ExpectedStringEnd => {
            "the text in quotes that begins at this place has no closing quote".into()
        }
        ExpectedBoolean => "expected `true` or `false`".into(),
        ExpectedArray => "expected a list, `[…]`".into(),
        ExpectedArrayEnd => "expected a comma, or the end of the list, `]`".into(),
        ExpectedComma => "expected a comma, or the closing bracket".into(),
        ExpectedMapColon => "expected a colon and a value after the name of a field".into(),
        ExpectedStructLike | ExpectedUnit => "expected `(…)`".into(),
        ExpectedNamedStructLike(name) if !name.is_empty() => format!("expected `{name}(…)`"),
        ExpectedNamedStructLike(_) => "expected `(…)`".into(),
        ExpectedStructLikeEnd | ExpectedOptionEnd => {
            "expected a comma, or the closing bracket, `)`".into()
        }
        ExpectedInteger | InvalidIntegerDigit { .. } => "expected a whole number".into(),
        ExpectedFloat | FloatUnderscore => "expected a number".into(),
        IntegerOutOfBounds => {
            "the number is too large, or is negative but must not be negative".into()
        }
        ExpectedIdentifier | InvalidIdentifier(_) | SuggestRawIdentifier(_) => {
            "expected a name without quotes".into()
        }
        TrailingCharacters => {
            "the text continues after its expected end: an earlier bracket is closed too early, or \
             the text from this place must be removed"
                .into()
        }
        UnclosedBlockComment => "the comment is not closed: `*/` is missing".into(),
        NoSuchStructField { found, outer, .. } => unknown("field", found, outer),
        NoSuchEnumVariant { found, outer, .. } => unknown("name", found, outer),
        MissingStructField { field, outer } => {
            format!("the field `{field}`{} is missing", of(outer))
        }
        DuplicateStructField { field, outer } => {
            format!("the field `{field}`{} is given twice", of(outer))
        }
        ExpectedDifferentLength { expected, found } => {
            format!("expected {expected}, found {found}")
        }
        InvalidValueForType { expected, found } => format!("expected {expected}, not {found}"),
        InvalidEscape(_) => {
            "unknown escape sequence: a backslash must be written twice, `\\\\`".into()
        }
        ExceededRecursionLimit => "brackets are nested too deeply".into(),
        other => other.to_string(),
    }
}

/// Returns a phrase that names the structure to which an unknown field would belong.
fn of(outer: &Option<String>) -> String {
    outer.as_ref().map_or(String::new(), |outer| format!(" of `{outer}`"))
}

/// Returns the remedy for a RON error; for an unknown name, the remedy lists the valid names.
pub(crate) fn remedy(code: &RonError) -> Option<String> {
    match code {
        RonError::NoSuchStructField { expected, found, .. }
        | RonError::NoSuchEnumVariant { expected, found, .. }
            if !expected.is_empty() =>
        {
            Some(UnknownName::new("name", found.as_str(), expected.iter().copied()).remedy())
        }
        _ => None,
    }
}

/// Returns the message for an unknown name, which states the kind of object (for example a field)
/// that the name should denote.
pub(crate) fn unknown(what: &str, found: &str, outer: &Option<String>) -> String {
    format!("unknown {what} `{}`{}", shown(found), of(outer))
}
