//! Texts that are derived from a source, with the source position of each part.

use super::super::source::{Fault, ModelError, Phrase, Source};
use std::ops::Range;

/// A text in which each byte, and the end of the text, has a known position in the source from
/// which the text is derived.
#[derive(Clone, Debug, Default)]
pub(super) struct Text {
    text: String,
    at: Vec<u32>,
    end: u32,
}

impl Text {
    /// Creates an empty text at a given position of the source.
    pub fn empty(at: usize) -> Self {
        Text { end: at as u32, ..Text::default() }
    }

    /// Appends a part of the source that begins at a given position.
    pub fn push(&mut self, part: &str, at: usize) {
        self.text.push_str(part);
        self.at.extend((at..at + part.len()).map(|at| at as u32));
        self.end = (at + part.len()) as u32;
    }

    /// Appends a part of another text that is derived from the same source.
    pub fn extend(&mut self, part: Slice) {
        self.text.push_str(part.text);
        self.at.extend_from_slice(part.at);
        self.end = part.end;
    }

    /// Appends a text that replaces a part of another text derived from the same source.
    pub fn replace(&mut self, part: Slice, by: &str) {
        let span = part.span();
        self.text.push_str(by);
        let (first, last) = (span.start as u32, span.end.saturating_sub(1) as u32);
        self.at.extend((0..by.len()).map(|k| if k + 1 == by.len() { last } else { first }));
        self.end = part.end;
    }

    /// Returns the whole text as a slice.
    pub fn all(&self) -> Slice<'_> {
        Slice { text: &self.text, at: &self.at, end: self.end }
    }

    /// Returns the length of the text in bytes.
    pub fn len(&self) -> usize {
        self.text.len()
    }
}

/// A part of a text derived from a source.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slice<'a> {
    pub text: &'a str,
    at: &'a [u32],
    end: u32,
}

impl<'a> Slice<'a> {
    /// Returns a part of the slice, given by a range of bytes.
    pub fn part(self, range: Range<usize>) -> Slice<'a> {
        let end = self.at.get(range.end).copied().unwrap_or(self.end);
        Slice { text: &self.text[range.clone()], at: &self.at[range], end }
    }

    /// Returns the part of the slice that begins at a given byte.
    pub fn from(self, start: usize) -> Slice<'a> {
        self.part(start..self.text.len())
    }

    /// Returns the slice without blanks at its ends.
    pub fn trim(self) -> Slice<'a> {
        let start = self.text.len() - self.text.trim_start().len();
        self.part(start..start + self.text.trim().len())
    }

    /// Splits the slice of a text at the first occurrence of one of the given letters.
    pub fn split(self, letters: &[char]) -> Option<(Slice<'a>, char, Slice<'a>)> {
        let at = self.text.find(letters)?;
        let letter = self.text[at..].chars().next()?;
        Some((self.part(0..at), letter, self.from(at + letter.len_utf8())))
    }

    /// Copies the slice into a text of its own, with the positions of its letters in the original text.
    pub fn to_text(self) -> Text {
        Text { text: self.text.into(), at: self.at.into(), end: self.end }
    }

    /// Returns the position of the slice in the source.
    pub fn span(self) -> Range<usize> {
        let start = self.at.first().copied().unwrap_or(self.end) as usize;
        start..self.at.last().map_or(start, |last| *last as usize + 1)
    }

    /// Returns the line number of the slice in the source, counted from 1.
    pub fn line(self, source: &Source) -> usize {
        let before = source.text.get(..self.span().start).unwrap_or_default();
        1 + before.matches('\n').count()
    }

    /// Returns an error that quotes the slice.
    pub fn fault(self, source: &Source, fault: Fault) -> ModelError {
        source.fault_of(&source.phrase(self.span()), fault)
    }

    /// Returns the error for an unsupported construct in the slice.
    pub fn unsupported(
        self,
        source: &Source,
        construct: impl Into<String>,
        reason: impl Into<String>,
    ) -> ModelError {
        let fault = Fault::Unsupported { construct: construct.into(), reason: reason.into() };
        self.fault(source, fault)
    }

    /// Returns the error for unexpected syntax in the slice.
    pub fn expected(self, source: &Source, expected: impl Into<String>) -> ModelError {
        self.fault(source, Fault::Syntax { expected: expected.into() })
    }

    /// Returns a phrase (a text with its position) that consists of a given text at the position of
    /// the slice; if the text differs from the source only in blanks, the source's own text is
    /// used.
    pub fn phrase(self, source: &Source, text: String) -> Phrase {
        let own = source.phrase(self.span());
        let plain = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
        match plain(&own.text) == plain(&text) && !own.text.contains('\n') {
            true => own,
            false => own.rewritten(text),
        }
    }
}

/// A name with a formula.
pub(super) struct Named {
    pub name: Text,
    pub formula: Text,
}
