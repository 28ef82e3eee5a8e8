//! Texts of equations, and errors that quote the place in the text.

use crate::core::problem::UnknownName;
use crate::misread::{Place, part_of, reason, remedy};
use miette::Diagnostic;
use ron::error::SpannedError;
use serde::de::{Deserialize, Deserializer, Visitor};
use serde::{Serialize, Serializer};
use std::cell::Cell;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A text from which equations are parsed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// The name of the source in error messages: a file name, or an empty string for a scene, which
    /// messages name separately.
    pub name: String,
    /// The text.
    pub text: Arc<str>,
}

thread_local! {
    /// The memory address and the length of the text that is being parsed. If serde borrows a
    /// substring of the text, the position of the substring is computed from its address.
    static LENT: Cell<(usize, usize)> = const { Cell::new((0, 0)) };
}

impl Source {
    /// Creates a source from a name and a text; a byte-order mark at the start of the text is
    /// removed.
    pub fn new(name: impl Into<String>, text: impl Into<Arc<str>>) -> Self {
        let text: Arc<str> = text.into();
        let text = match without_mark(&text) {
            plain if plain.len() < text.len() => plain.into(),
            _ => text,
        };
        Source { name: name.into(), text }
    }

    /// Parses a part of the text; the phrases (substrings) that the parser borrows from the text
    /// know their positions in it.
    pub(super) fn lend<T>(&self, part: Range<usize>, read: impl FnOnce(&str) -> T) -> T {
        LENT.set((self.text.as_ptr() as usize, self.text.len()));
        let value = read(&self.text[part]);
        LENT.set((0, 0));
        value
    }

    /// Returns a part of the text as a phrase.
    pub fn phrase(&self, span: Range<usize>) -> Phrase {
        let text = self.text.get(span.clone()).unwrap_or_default();
        Phrase { text: text.into(), span: Some(span) }
    }

    /// Returns the position of a phrase (a name or a formula) in this text; if the phrase was
    /// rewritten, returns the position of the original phrase; `None` if the phrase is not from
    /// this text.
    fn span_of(&self, phrase: &Phrase) -> Option<Range<usize>> {
        phrase.span.clone().filter(|span| self.text.get(span.clone()).is_some())
    }

    /// Returns the file and the line of a phrase (a name or a formula), as `equations.ron:7` or
    /// `line 7`; `None` if the phrase is not from this text.
    pub(super) fn line_of(&self, phrase: &Phrase) -> Option<String> {
        let line = self.line(self.span_of(phrase)?.start);
        Some(match self.name.is_empty() {
            true => format!("line {line}"),
            false => format!("{}:{line}", self.name),
        })
    }

    /// Returns an error that quotes a part of a phrase (a name or a formula).
    pub fn fault(&self, phrase: &Phrase, part: Range<usize>, fault: Fault) -> ModelError {
        // Blanks after a part do not belong to it.
        let part = part.start..part.start + phrase.text[part].trim_end().len();
        let place = match self.span_of(phrase) {
            Some(span) if self.text[span.clone()] == phrase.text => {
                self.place(span.start + part.start..span.start + part.end)
            }
            // For a rewritten phrase the whole original is shown.
            Some(span) => self.place(span),
            None => Place::within(&phrase.text, part),
        };
        ModelError::new(&self.name, place, fault)
    }

    /// Returns an error that quotes a whole phrase.
    pub fn fault_of(&self, phrase: &Phrase, fault: Fault) -> ModelError {
        self.fault(phrase, 0..phrase.text.len(), fault)
    }

    /// Returns the error for a name that is declared twice.
    pub(super) fn twice(
        &self,
        phrase: &Phrase,
        name: impl Into<String>,
        first: &'static str,
    ) -> ModelError {
        self.fault_of(phrase, Fault::Twice { name: name.into(), first })
    }

    /// Returns an error that quotes a part of the text.
    pub fn fault_at(&self, part: Range<usize>, fault: Fault) -> ModelError {
        ModelError::new(&self.name, self.place(part), fault)
    }

    /// Returns the number of the line at a byte offset, counted from 1.
    fn line(&self, offset: usize) -> usize {
        1 + self.text[..offset].matches('\n').count()
    }

    fn place(&self, part: Range<usize>) -> Place {
        Place { line: Some(self.line(part.start)), ..Place::within(&self.text, part) }
    }
}

/// Converts an error that the RON parser reports for a part of a source to a model error; the part
/// starts at the offset `begin`.
pub(crate) fn misread(source: &Source, begin: usize, error: SpannedError) -> ModelError {
    let part = part_of(&source.text[begin..], &error);
    let fault = Fault::Form { reason: reason(&error.code) };
    let misread = source.fault_at(begin + part.start..begin + part.end, fault);
    match remedy(&error.code) {
        Some(remedy) => misread.with_help(remedy),
        None => misread,
    }
}

/// Returns a text without the byte-order mark that some editors write at the beginning of a file.
pub(crate) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// A part of a source: a name, or a formula. Two phrases are equal if their texts are equal, even
/// at different positions.
#[derive(Clone, Debug, Default)]
pub struct Phrase {
    /// Its text.
    pub text: String,
    /// The position of the phrase in its source; if the phrase was rewritten, the position of the
    /// original phrase; `None` if the phrase is not from a source.
    span: Option<Range<usize>>,
}

impl Phrase {
    /// Replaces the text of a phrase (a name or a formula), but keeps its position. Errors that
    /// occur in the new text quote the whole original phrase.
    ///
    /// ```
    /// use tangency::language::{Fault, Source};
    /// let source = Source::new("", "x + X");
    /// let phrase = source.phrase(4..5).rewritten("(x)".into());
    /// let error = source.fault(&phrase, 1..2, Fault::Form { reason: "wrong".into() });
    /// assert_eq!((error.place.column, error.place.width), (5, 1));
    /// ```
    pub fn rewritten(&self, text: String) -> Phrase {
        Phrase { text, span: self.span.clone() }
    }

    /// Returns a part of the phrase; the part of a rewritten phrase has the position of the whole
    /// original.
    pub(super) fn part(&self, source: &Source, part: Range<usize>) -> Phrase {
        let text = self.text[part.clone()].to_string();
        let span = match &self.span {
            Some(whole) if source.text.get(whole.clone()) == Some(&self.text) => {
                Some(whole.start + part.start..whole.start + part.end)
            }
            whole => whole.clone(),
        };
        Phrase { text, span }
    }

    /// Returns whether two phrases have the same text at the same position.
    pub(super) fn is(&self, other: &Phrase) -> bool {
        self.span == other.span && self.text == other.text
    }
}

impl PartialEq for Phrase {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl Eq for Phrase {}

impl<'de> Deserialize<'de> for Phrase {
    /// Deserializes a phrase from a text or a number.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Phrase;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a formula or a name in quotes, or a number")
            }

            fn visit_borrowed_str<E>(self, text: &'de str) -> Result<Phrase, E> {
                let (begin, length) = LENT.get();
                let at = (text.as_ptr() as usize).checked_sub(begin);
                let span = at.map(|at| at..at + text.len()).filter(|span| span.end <= length);
                Ok(Phrase { text: text.into(), span })
            }

            fn visit_str<E>(self, text: &str) -> Result<Phrase, E> {
                Ok(text.into())
            }

            fn visit_i64<E>(self, number: i64) -> Result<Phrase, E> {
                Ok(number.to_string().into())
            }

            fn visit_u64<E>(self, number: u64) -> Result<Phrase, E> {
                Ok(number.to_string().into())
            }

            fn visit_f64<E>(self, number: f64) -> Result<Phrase, E> {
                Ok(number.to_string().into())
            }
        }
        deserializer.deserialize_any(Reader)
    }
}

impl Serialize for Phrase {
    /// Serializes a phrase that is an integer as a number, and every other phrase as text.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.text.parse::<i32>() {
            Ok(number) if number.to_string() == self.text => serializer.serialize_i32(number),
            _ => serializer.serialize_str(&self.text),
        }
    }
}

impl From<String> for Phrase {
    fn from(text: String) -> Self {
        Phrase { text, span: None }
    }
}

impl From<&str> for Phrase {
    fn from(text: &str) -> Self {
        text.to_string().into()
    }
}

/// An error in equations given as text, with the place of the error in the text.
///
/// ```
/// use tangency::language::{Fault, Model, Source};
/// let text = "Equations(\n    states: [(\"x\", \"lamda - x^2\")],\n    parameters: [(\"lambda\", 1)],\n)";
/// let error = Model::read(&Source::new("fold.ron", text), &[]).unwrap_err();
/// assert!(matches!(error.fault, Fault::Unknown(_)));
/// assert_eq!((error.place.line, error.place.column), (Some(2), 21));
/// assert_eq!(error.to_string(), "\
/// fold.ron, line 2, column 21: unknown name `lamda`
///   |
/// 2 |     states: [(\"x\", \"lamda - x^2\")],
///   |                     ^^^^^");
/// let help = "did you mean `lambda`? Known: lambda, x, t, pi, e";
/// assert_eq!(error.help.as_deref(), Some(help));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[error("{}{fault}{place}", self.prefix())]
pub struct ModelError {
    /// The name of the source, usually a file name; empty if the source does not have a name.
    pub file: String,
    /// The place of the error in the text.
    pub place: Box<Place>,
    /// The kind of the error.
    pub fault: Fault,
    /// The suggested remedy, unless the kind of error implies the remedy.
    #[help]
    pub help: Option<Box<str>>,
}

impl ModelError {
    fn new(file: &str, place: Place, fault: Fault) -> Self {
        let help = fault.help().map(|help| help.to_string().into());
        ModelError { file: file.into(), place: Box::new(place), fault, help }
    }

    /// Adds the remedy for an unknown name to the error.
    pub(crate) fn with_help_of(self, unknown: &UnknownName) -> Self {
        self.with_help(unknown.remedy())
    }

    /// Adds a remedy.
    pub(crate) fn with_help(mut self, remedy: impl Into<String>) -> Self {
        self.help = Some(remedy.into().into());
        self
    }

    fn prefix(&self) -> String {
        let at = self.place.line.map(|line| format!("line {line}, column {}", self.place.column));
        let parts = [Some(self.file.clone()).filter(|name| !name.is_empty()), at];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { String::new() } else { parts.join(", ") + ": " }
    }
}

/// The kinds of errors in equations given as text.
#[derive(Clone, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A statement whose form is invalid.
    #[error("{reason}")]
    Form {
        /// The reason.
        reason: String,
    },
    /// An error in the syntax of a formula or a name.
    #[error("expected {expected}")]
    Syntax {
        /// A description of the syntax that is expected at the place of the error.
        expected: String,
    },
    /// An unknown name.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Unknown(UnknownName),
    /// An error for a name that is declared twice.
    #[error("`{name}` is given a second time, although `{name}` is already {first}")]
    Twice {
        /// The duplicate name.
        name: String,
        /// The kind of the item that was first declared with this name.
        first: &'static str,
    },
    /// An error for a function that is called with the wrong number of arguments.
    #[error("`{function}` takes {takes}, not {given}")]
    Arguments {
        /// The function.
        function: String,
        /// The required number of arguments, as text.
        takes: String,
        /// The number of arguments in the call.
        given: usize,
    },
    /// An error for an index, or an end of a range, that is not a constant integer.
    #[error("{what} must be an integer that does not depend on states, parameters or time{found}")]
    NotAnInteger {
        /// The role of the number that must be an integer, for messages, such as `the index`.
        what: &'static str,
        /// The value of the number, as text; empty if the number is not constant.
        found: String,
    },
    /// An error for a definition or a function that depends on itself.
    #[error("`{name}` is defined in terms of itself: {through}")]
    Circular {
        /// The name of the definition or function.
        name: String,
        /// The chain of names through which the definition or function depends on itself.
        through: String,
    },
    /// A statement in which a required part is missing.
    #[error("{what}")]
    #[diagnostic(help("{needed}"))]
    Missing {
        /// A description of the incomplete statement.
        what: String,
        /// The required part, and how to write it.
        needed: String,
    },
    /// A part of a statement that is not allowed at its place.
    #[error("{what}: {reason}")]
    Misplaced {
        /// The misplaced part.
        what: String,
        /// The reason.
        reason: String,
    },
    /// A quantity, such as a number of states, that exceeds a limit.
    #[error("the model has too many {what}: the limit is {limit}")]
    TooLarge {
        /// The name of the quantity that is too large.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
    /// A formula whose value is not a finite number.
    #[error("{what} at the start: {values}")]
    Undefined {
        /// The operation or the formula whose value is not finite.
        what: String,
        /// The arguments or names from which the non-finite value was computed, with their values.
        values: String,
    },
    /// A period of a forcing or a length of an interval that is not positive.
    #[error("{what} `{formula}` is {value}, but must be a finite number above 0")]
    NotPositive {
        /// The name of the quantity: `the period` or `the length`.
        what: &'static str,
        /// The formula.
        formula: String,
        /// The value of the period or length, with the parameters on which it depends.
        value: String,
    },
    /// A construct of another program's language that has no counterpart in this language.
    #[error("{construct} is not supported: {reason}")]
    Unsupported {
        /// The name of the unsupported construct in the other program's language.
        construct: String,
        /// The reason.
        reason: String,
    },
}
