//! Parses what surrounds a statement in a text (attributes, comments and the name of its kind), and
//! splits the bracketed part into unparsed fields.

use super::source::{ModelError, Source, misread, without_mark};
use ron::extensions::Extensions;
use ron::value::RawValue;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use std::ops::Range;

/// Splits a text that consists of one statement: returns the name of the kind of the statement, and
/// the rest of the text.
pub(crate) fn statement_in(text: &str) -> (&str, &str) {
    let text = skip_attributes(without_mark(text));
    text.split_at(text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len()))
}

/// Skips attributes, `#![…]`, blanks and comments at the start of a text.
fn skip_attributes(text: &str) -> &str {
    let mut text = skip_comments(text);
    while text.starts_with('#') {
        text = skip_comments(text.split_once(']').map_or("", |(_, rest)| rest));
    }
    text
}

/// Skips blanks and comments at the start of a text.
fn skip_comments(mut text: &str) -> &str {
    loop {
        text = text.trim_start();
        text = match text.as_bytes() {
            [b'/', b'/', ..] => text.split_once('\n').map_or("", |(_, rest)| rest),
            [b'/', b'*', ..] => behind_block(&text[2..]),
            _ => return text,
        };
    }
}

/// Skips the rest of a block comment after its opening mark. Block comments may be nested.
fn behind_block(mut text: &str) -> &str {
    let mut depth = 1;
    while depth > 0 {
        let [open, close] = ["/*", "*/"].map(|mark| text.find(mark).unwrap_or(text.len()));
        depth = if open < close { depth + 1 } else { depth - 1 };
        text = text.get(open.min(close) + 2..).unwrap_or("");
    }
    text
}

/// Returns the RON options with which scenes and statements are parsed.
pub(crate) fn options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
}

/// A field of a bracketed statement, with its name and its position in the source.
pub(crate) struct Field {
    pub name: String,
    pub value: Range<usize>,
    /// The range of the field in the source, from its name to the comma after its value.
    pub part: Range<usize>,
}

/// Returns the fields of a bracketed part of a source; comments are ignored.
pub(crate) fn fields_of(source: &Source, brackets: Range<usize>) -> Result<Vec<Field>, ModelError> {
    let text = &source.text[brackets.clone()];
    let read = options().from_str(text);
    let Parts(all) = read.map_err(|error| misread(source, brackets.start, error))?;
    let mut end = behind_comments(text, 0) + 1;
    let mut fields = Vec::new();
    let moved = |part: Range<usize>| brackets.start + part.start..brackets.start + part.end;
    for (name, value) in all {
        let start = behind_comments(text, end);
        let value = value.trim().get_ron();
        let at = value.as_ptr() as usize - text.as_ptr() as usize;
        end = at + value.len();
        let value = moved(at..end);
        let comma = behind_comments(text, end);
        if text[comma..].starts_with(',') {
            end = comma + 1;
        }
        fields.push(Field { name, value, part: moved(start..end) });
    }
    Ok(fields)
}

/// Returns the position after the blanks and comments that begin at a given position.
fn behind_comments(text: &str, at: usize) -> usize {
    text.len() - skip_comments(&text[at..]).len()
}

/// The names of fields, each with its unparsed value.
#[derive(Default)]
pub(crate) struct Parts<'a>(pub Vec<(String, &'a RawValue)>);

impl<'de> Deserialize<'de> for Parts<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Parts<'de>;

            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("names with values in brackets, as in `(states: [(\"x\", \"-x\")])`")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut parts = Vec::new();
                while let Some(part) = map.next_entry()? {
                    parts.push(part);
                }
                Ok(Parts(parts))
            }

            fn visit_unit<E>(self) -> Result<Self::Value, E> {
                Ok(Parts(Vec::new()))
            }
        }
        deserializer.deserialize_any(Reader)
    }
}
