//! Checks names and texts that are read from files, and formats names and texts for messages.

use crate::core::spelling::is_hidden;

/// The error of an invalid value in a document.
#[derive(Clone, Debug, PartialEq, Eq, miette::Diagnostic, thiserror::Error)]
#[error("{place} is {found}, but {rule}")]
pub struct Invalid {
    /// The place of the value in the document: the branch, the point or label, and the column.
    pub place: String,
    /// The value.
    pub found: String,
    /// The required form.
    pub rule: String,
}

/// The maximum number of characters of a quoted text.
const QUOTED: usize = 60;

/// Formats a text for a message: in quotes, with control characters escaped, and shortened if the
/// text is long.
pub(crate) fn quoted(text: &str) -> String {
    let cut = if text.chars().nth(QUOTED).is_some() { "…" } else { "" };
    format!("{:?}{cut}", text.chars().take(QUOTED).collect::<String>())
}

/// The maximum number of characters in a line of a message.
#[cfg(feature = "cli")]
const LINE: usize = 700;
/// The number of characters that are kept at the end of a line that is shortened in the middle.
#[cfg(feature = "cli")]
const END: usize = 300;
/// The maximum number of lines in a message.
#[cfg(feature = "cli")]
const LINES: usize = 20;
/// The maximum length, in characters, of a word that is never divided.
#[cfg(feature = "cli")]
const WORD: usize = 40;
/// The largest number of digits with which a message writes a number in full.
#[cfg(feature = "cli")]
const DIGITS: usize = 25;

/// Formats a message for a terminal: control characters except line breaks are escaped, long
/// numbers are written with powers of ten, and long lines are shortened in the middle.
#[cfg(feature = "cli")]
pub(crate) fn printable(message: &str) -> String {
    let lines = message.split('\n').take(LINES).map(|line| shortened(&with_powers(&escaped(line))));
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(feature = "cli")]
fn escaped(line: &str) -> String {
    let show = |letter: char| match is_hidden(letter) {
        false => letter.to_string(),
        true => letter.escape_default().to_string(),
    };
    line.chars().map(show).collect()
}

/// Rewrites numbers that have many digits in a line of a message in scientific notation, such as
/// `1e300`.
#[cfg(feature = "cli")]
fn with_powers(line: &str) -> String {
    let is_digit = |letter: char| letter.is_ascii_digit() || letter == '.';
    let (mut whole, mut rest) = (String::new(), line);
    while let Some(begin) = rest.find(is_digit) {
        let (before, digits) = rest.split_at(begin);
        let (digits, after) =
            digits.split_at(digits.find(|c| !is_digit(c)).unwrap_or(digits.len()));
        let number = Some(digits).filter(|digits| digits.len() > DIGITS);
        let number = number.and_then(|digits| digits.parse::<f64>().ok());
        whole += before;
        whole += &number.map_or_else(|| digits.to_string(), |number| format!("{number:e}"));
        rest = after;
    }
    whole + rest
}

#[cfg(feature = "cli")]
fn shortened(line: &str) -> String {
    let letters: Vec<char> = line.chars().collect();
    if letters.len() <= LINE {
        return line.into();
    }
    let text = |part: &[char]| part.iter().collect::<String>();
    // Words are not cut, unless they are long.
    let blank = |mut letters: std::slice::Iter<char>| letters.position(|letter| *letter == ' ');
    let [mut first, mut last] = [LINE - END, letters.len() - END];
    let before: Vec<char> = letters[first - WORD..first].iter().rev().copied().collect();
    first -= blank(before.iter()).map_or(0, |at| at + 1);
    last += blank(letters[last..last + WORD].iter()).map_or(0, |at| at + 1);
    format!("{} … {}", text(&letters[..first]), text(&letters[last..]))
}

/// Returns an error for a name or title that contains characters that would move the cursor of a
/// terminal, or make a picture file invalid.
pub(crate) fn text(place: &str, text: &str) -> Result<(), Invalid> {
    require(!text.contains(is_hidden), place, text, "must not contain control characters")
}

/// Returns an error for a name that contains the name of a folder, because the name of a result
/// must be a single component of a path.
pub(crate) fn component(place: &str, name: &str) -> Result<(), Invalid> {
    text(place, name)?;
    let rule = "the name must be a plain file name, without a folder";
    require(is_plain(name), place, name, rule)
}

/// Returns an error for the name of an archive entry that would place the unpacked file outside the
/// destination folder.
pub(crate) fn entry(place: &str, name: &str) -> Result<(), Invalid> {
    text(place, name)?;
    let rule = "the name of an entry of an archive must consist of plain names separated by `/`";
    require(name.split('/').all(is_plain), place, name, rule)
}

fn is_plain(name: &str) -> bool {
    !matches!(name, "" | "." | "..") && !name.contains(['/', '\\'])
}

fn require(holds: bool, place: &str, found: &str, rule: &str) -> Result<(), Invalid> {
    match holds {
        true => Ok(()),
        false => Err(Invalid { place: place.into(), found: quoted(found), rule: rule.into() }),
    }
}
