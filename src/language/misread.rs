//! Texts that are not written as RON is: where, what stands there, and what may.

use super::source::{Fault, ModelError, Source};
use crate::misread::reason;
use ron::error::{Position, SpannedError};

/// The error in a part of a source that begins there.
pub(crate) fn misread(source: &Source, at: usize, error: SpannedError) -> ModelError {
    let text = &*source.text;
    let [begin, end] =
        [error.span.start, error.span.end].map(|place| at + offset(&text[at..], place));
    // What is missing is seen behind the last thing that is there.
    let begin = begin + (text[begin..].len() - text[begin..].trim_start_matches(' ').len());
    let begin = begin.min(text.trim_end().len());
    source.fault_at(begin..end.max(begin), Fault::Form { reason: reason(&error.code) })
}

/// The bytes before a place, at most all.
fn offset(text: &str, Position { line, col }: Position) -> usize {
    let begin = match line {
        0 | 1 => 0,
        _ => text.match_indices('\n').nth(line - 2).map_or(text.len(), |(end, _)| end + 1),
    };
    let letters = text[begin..].char_indices().map(|(at, _)| begin + at);
    letters.chain([text.len()]).nth(col.saturating_sub(1)).unwrap_or(text.len())
}
