//! Texts that state equations, and what is wrong with them: where, and how it looks there.

use crate::core::problem::UnknownName;
use crate::spelling::sentence;
use serde::de::{Deserialize, Deserializer, Visitor};
use serde::{Serialize, Serializer};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A text from which equations are read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The name in errors: a file's name; empty for a scene, which is named elsewhere.
    pub name: String,
    /// The text.
    pub text: Arc<str>,
    /// The text without what is not to be read: the same places have the same offsets.
    masked: Arc<str>,
}

impl Source {
    /// A text with a name, without a byte-order mark.
    pub fn new(name: impl Into<String>, text: impl Into<Arc<str>>) -> Self {
        let text: Arc<str> = text.into();
        let text = match without_mark(&text) {
            plain if plain.len() < text.len() => plain.into(),
            _ => text,
        };
        Source { name: name.into(), masked: text.clone(), text }
    }

    /// The text without the parts that are not to be read.
    pub fn without(&self, parts: &[Range<usize>]) -> Self {
        Source { masked: blanked(&self.text, parts).into(), ..self.clone() }
    }

    /// The text that is to be read.
    pub fn readable(&self) -> &str {
        &self.masked
    }

    /// A part of the text, which is known to be one by where it is in memory.
    pub fn phrase(&self, part: &str) -> Phrase {
        Phrase { address: Some(part.as_ptr() as usize), ..part.into() }
    }

    /// Where a phrase begins, in bytes; `None` if it was not taken from this text as it is.
    fn offset(&self, phrase: &Phrase) -> Option<usize> {
        let within = |text: &str| {
            let at = phrase.address?.checked_sub(text.as_ptr() as usize)?;
            match phrase.stands_for {
                Some(length) => text.get(at..at + length).map(|_| at),
                None => (text.get(at..at + phrase.text.len())? == phrase.text).then_some(at),
            }
        };
        within(&self.masked).or(within(&self.text))
    }

    /// The file and the line of a phrase, `equations.ron:7`, or `line 7`; `None` if it was not
    /// taken from this text.
    pub(super) fn line_of(&self, phrase: &Phrase) -> Option<String> {
        let line = self.line(self.offset(phrase)?);
        Some(match self.name.is_empty() {
            true => format!("line {line}"),
            false => format!("{}:{line}", self.name),
        })
    }

    /// An error at a part of a phrase.
    pub fn fault(&self, phrase: &Phrase, part: Range<usize>, fault: Fault) -> ModelError {
        // Blanks behind a part do not belong to it.
        let part = part.start..part.start + phrase.text[part].trim_end().len();
        let known = phrase.stands_for.map_or_else(|| part.clone(), |length| 0..length);
        let place = self.offset(phrase).map(|at| self.place(at + known.start..at + known.end));
        let place = place.unwrap_or_else(|| Place::within(&phrase.text, part));
        ModelError { file: self.name.clone(), place: Box::new(place), fault }
    }

    /// An error of a whole phrase.
    pub fn fault_of(&self, phrase: &Phrase, fault: Fault) -> ModelError {
        self.fault(phrase, 0..phrase.text.len(), fault)
    }

    /// Where a part of the text begins, which is known to be one by where it is in memory.
    pub(super) fn at(&self, part: &str) -> usize {
        let begins = |text: &str| (part.as_ptr() as usize).checked_sub(text.as_ptr() as usize);
        let within = |at: &usize| at + part.len() <= self.text.len();
        let texts = [&self.masked, &self.text];
        texts.into_iter().filter_map(|text| begins(text)).find(within).unwrap_or(0)
    }

    /// An error at a part of the text.
    pub fn fault_at(&self, part: Range<usize>, fault: Fault) -> ModelError {
        ModelError { file: self.name.clone(), place: Box::new(self.place(part)), fault }
    }

    /// The line of an offset, from 1.
    fn line(&self, offset: usize) -> usize {
        1 + self.text[..offset].matches('\n').count()
    }

    fn place(&self, part: Range<usize>) -> Place {
        let mut place = Place::within(&self.text, part.clone());
        place.line = Some(self.line(part.start));
        place
    }
}

/// A text without the byte-order mark that some editors write first.
pub(crate) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// A text with blanks in place of some parts, line ends excepted.
pub(crate) fn blanked(text: &str, parts: &[Range<usize>]) -> String {
    let blank = |at: usize| parts.iter().any(|part| part.contains(&at));
    let letters = text.char_indices().map(|(at, letter)| match letter {
        '\n' => "\n".to_string(),
        // As many blanks as bytes, so that nothing moves.
        letter if blank(at) => " ".repeat(letter.len_utf8()),
        letter => letter.to_string(),
    });
    letters.collect()
}

/// A part of a source: a name, or a formula. Two are equal if their texts are.
#[derive(Clone, Debug, Default)]
pub struct Phrase {
    /// Its text.
    pub text: String,
    /// Where it begins in memory, if it was borrowed from a source: tells its place there.
    address: Option<usize>,
    /// How long the part of the source is that it was rewritten from, if it was.
    stands_for: Option<usize>,
}

impl Phrase {
    /// What it is rewritten as: errors in that show all of it.
    ///
    /// ```
    /// use tangency::language::{Fault, Source};
    /// let source = Source::new("", "x + X");
    /// let phrase = source.phrase(&source.text[4..]).rewritten("(x)".into());
    /// let error = source.fault(&phrase, 1..2, Fault::Form { reason: "wrong".into() });
    /// assert_eq!((error.place.column, error.place.width), (5, 1));
    /// ```
    pub fn rewritten(&self, text: String) -> Phrase {
        let length = self.stands_for.unwrap_or(self.text.len());
        Phrase { text, address: self.address, stands_for: Some(length) }
    }
}

impl PartialEq for Phrase {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl Eq for Phrase {}

impl<'de> Deserialize<'de> for Phrase {
    /// Text, or a number.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Phrase;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a formula or a name in quotes, or a number")
            }

            fn visit_borrowed_str<E>(self, text: &'de str) -> Result<Phrase, E> {
                Ok(Phrase { address: Some(text.as_ptr() as usize), ..text.into() })
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
    /// A whole number as a number, all else as text.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.text.parse::<i32>() {
            Ok(number) if number.to_string() == self.text => serializer.serialize_i32(number),
            _ => serializer.serialize_str(&self.text),
        }
    }
}

impl From<String> for Phrase {
    fn from(text: String) -> Self {
        Phrase { text, address: None, stands_for: None }
    }
}

impl From<&str> for Phrase {
    fn from(text: &str) -> Self {
        text.to_string().into()
    }
}

/// A part of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The line, from 1; `None` where the text stands in no file.
    pub line: Option<usize>,
    /// The first column, from 1.
    pub column: usize,
    /// How many columns.
    pub width: usize,
    /// The text of the line.
    pub text: String,
}

impl Place {
    /// A part of a text, with the line it begins in.
    fn within(text: &str, part: Range<usize>) -> Self {
        let begin = text[..part.start].rfind('\n').map_or(0, |end| end + 1);
        let end = text[part.start..].find('\n').map_or(text.len(), |end| part.start + end);
        let width = text[part.start..part.end.clamp(part.start, end)].chars().count().max(1);
        let column = text[begin..part.start].chars().count() + 1;
        Place { line: None, column, width, text: text[begin..end].trim_end().to_string() }
    }
}

/// The longest part of a line that an error shows.
const SHOWN: usize = 100;

/// The line with marks below the place; nothing of an empty line.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.text.trim().is_empty() {
            return Ok(());
        }
        let number = self.line.map_or(String::new(), |line| line.to_string());
        // Long lines are shown from shortly before the place.
        let skipped = if self.column > SHOWN / 2 { self.column - SHOWN / 4 } else { 0 };
        let plain = |letter: char| if letter.is_control() { ' ' } else { letter };
        let shown: String = self.text.chars().skip(skipped).take(SHOWN).map(plain).collect();
        let width = self.width.min((SHOWN + 1 + skipped).saturating_sub(self.column)).max(1);
        let (margin, before) = (" ".repeat(number.len()), " ".repeat(self.column - 1 - skipped));
        write!(f, " {number} | {shown}\n {margin} | {before}{}", "^".repeat(width))
    }
}

/// An error in equations that are given as text, with its place.
///
/// ```
/// use tangency::language::{Fault, Model, Source};
/// let text = "Equations(\n    states: [(\"x\", \"lamda - x^2\")],\n    parameters: [(\"lambda\", 1)],\n)";
/// let error = Model::read(&Source::new("fold.ron", text), &[]).unwrap_err();
/// assert!(matches!(error.fault, Fault::Unknown(_)));
/// assert_eq!((error.place.line, error.place.column), (Some(2), 21));
/// assert_eq!(error.to_string(), "\
/// fold.ron, line 2, column 21: unknown name `lamda`; did you mean `lambda`? Known: lambda, x, t, pi, e
///  2 |     states: [(\"x\", \"lamda - x^2\")],
///    |                     ^^^^^");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{fault}{}", self.prefix(), self.shown())]
pub struct ModelError {
    /// The name of the source; empty if it has none.
    pub file: String,
    /// Where it is.
    pub place: Box<Place>,
    /// The kind of error.
    pub fault: Fault,
}

impl ModelError {
    /// The place on lines of its own, if it has text.
    fn shown(&self) -> String {
        let shown = self.place.to_string();
        if shown.is_empty() { shown } else { format!("\n{shown}") }
    }

    fn prefix(&self) -> String {
        let at = self.place.line.map(|line| format!("line {line}, column {}", self.place.column));
        let parts = [Some(self.file.clone()).filter(|name| !name.is_empty()), at];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { String::new() } else { parts.join(", ") + ": " }
    }
}

/// The errors of equations that are given as text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A statement is not of its form.
    #[error("{reason}")]
    Form {
        /// The reason.
        reason: String,
    },
    /// A formula or a name is not of the language.
    #[error("expected {expected}")]
    Syntax {
        /// The alternatives that may stand there.
        expected: String,
    },
    /// A name that nothing has.
    #[error("{}", sentence(.0))]
    Unknown(UnknownName),
    /// A name that two things have.
    #[error("`{name}` is {first} already; each name may be given once")]
    Twice {
        /// The name.
        name: String,
        /// The kind of its first owner.
        first: &'static str,
    },
    /// A function called with another number of arguments.
    #[error("`{function}` takes {takes}, not {given}")]
    Arguments {
        /// The function.
        function: String,
        /// How many arguments it takes, in words.
        takes: String,
        /// How many there are.
        given: usize,
    },
    /// An index, or the end of a range, that is no constant integer.
    #[error("{what} must be an integer that does not depend on states, parameters or time{found}")]
    NotAnInteger {
        /// Where it stands.
        what: &'static str,
        /// Its value, in words, if it has one.
        found: String,
    },
    /// A definition or a function that leads to itself.
    #[error("`{name}` is defined by itself: {through}")]
    Circular {
        /// The name.
        name: String,
        /// The names through which it leads to itself.
        through: String,
    },
    /// Something that must be there is not.
    #[error("{what}: {needed}")]
    Missing {
        /// The statement that is incomplete.
        what: String,
        /// The missing part, and how to give it.
        needed: String,
    },
    /// Something that may not be there is.
    #[error("{what}: {reason}")]
    Misplaced {
        /// The part that is out of place.
        what: String,
        /// Why it cannot be, and what to do.
        reason: String,
    },
    /// More than the limits allow.
    #[error("{what}: more than {limit}")]
    TooLarge {
        /// The quantity that is too large.
        what: &'static str,
        /// How many are allowed.
        limit: usize,
    },
    /// A value that is not a finite number.
    #[error("{what} at the start: {values}")]
    Undefined {
        /// The operation or the formula without a finite value.
        what: String,
        /// The values that decide.
        values: String,
    },
    /// A period or a length that is not positive.
    #[error("{what} `{formula}` is {value}, but must be a finite number above 0")]
    NotPositive {
        /// `the period` or `the length`.
        what: &'static str,
        /// Its formula.
        formula: String,
        /// Its value, with the parameters that decide.
        value: String,
    },
    /// A construct of another program's language that has no counterpart.
    #[error("{construct} is not supported: {reason}")]
    Unsupported {
        /// The construct, by its name there.
        construct: String,
        /// Why, and what to do.
        reason: String,
    },
}
