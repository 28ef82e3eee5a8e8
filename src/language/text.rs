//! What stands around a statement: attributes, comments and blanks.

use super::source::without_mark;

/// The kind of the statement that is all of a text, and what stands behind it.
pub(crate) fn statement_in(text: &str) -> (&str, &str) {
    let text = skip_attributes(without_mark(text));
    text.split_at(text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len()))
}

/// A text from behind its first attributes, `#![…]`, blanks and comments.
fn skip_attributes(text: &str) -> &str {
    let mut text = skip_comments(text);
    while text.starts_with('#') {
        text = skip_comments(text.split_once(']').map_or("", |(_, rest)| rest));
    }
    text
}

/// A text from behind its first blanks and comments.
pub(crate) fn skip_comments(mut text: &str) -> &str {
    loop {
        text = text.trim_start();
        text = match text.as_bytes() {
            [b'/', b'/', ..] => text.split_once('\n').map_or("", |(_, rest)| rest),
            [b'/', b'*', ..] => behind_block(&text[2..]),
            _ => return text,
        };
    }
}

/// A text from behind a comment that has been opened. Comments may stand in comments.
fn behind_block(mut text: &str) -> &str {
    let mut depth = 1;
    while depth > 0 {
        let [open, close] = ["/*", "*/"].map(|mark| text.find(mark).unwrap_or(text.len()));
        depth = if open < close { depth + 1 } else { depth - 1 };
        text = text.get(open.min(close) + 2..).unwrap_or("");
    }
    text
}
