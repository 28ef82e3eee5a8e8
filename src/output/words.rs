//! Names and texts that come from files: what they may hold, and how messages show them.

use crate::spelling::is_hidden;

/// A value of a document that makes no sense.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place} is {found}, but {rule}")]
pub struct Invalid {
    /// Where it is: branch, point or label, column.
    pub place: String,
    /// The value.
    pub found: String,
    /// The required form.
    pub rule: String,
}

/// How many letters of a text a message quotes.
const QUOTED: usize = 60;

/// A text in a message: in quotes, its control characters escaped, cut where it is long.
pub(crate) fn quoted(text: &str) -> String {
    let cut = if text.chars().nth(QUOTED).is_some() { "…" } else { "" };
    format!("{:?}{cut}", text.chars().take(QUOTED).collect::<String>())
}

/// How many letters a line of a message has at most …
#[cfg(feature = "cli")]
const LINE: usize = 380;
/// … of which this many are its end, …
#[cfg(feature = "cli")]
const END: usize = 120;
/// … and how many lines there are.
#[cfg(feature = "cli")]
const LINES: usize = 20;
/// A number of more digits is written with its power of ten.
#[cfg(feature = "cli")]
const DIGITS: usize = 25;

/// A message as a terminal may show it: control characters are escaped, but for the ends of its
/// lines, long numbers have powers of ten, and long lines are cut in their middle.
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

/// A line in which numbers of many digits are written as `1e300`.
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
    format!("{} … {}", text(&letters[..LINE - END]), text(&letters[letters.len() - END..]))
}

/// Refuses a name or a title that would move the cursor of a terminal, or make an ill-formed
/// picture.
pub(crate) fn text(place: &str, text: &str) -> Result<(), Invalid> {
    require(!text.contains(is_hidden), place, text, "must hold no control characters")
}

/// Refuses a name that could choose a folder: a result's name is one plain component of a path.
pub(crate) fn component(place: &str, name: &str) -> Result<(), Invalid> {
    text(place, name)?;
    let rule = "must be one plain name of a file, without a folder";
    require(is_plain(name), place, name, rule)
}

/// Refuses a name that would leave the folder into which an archive with entries of this name is
/// unpacked.
pub(crate) fn entry(place: &str, name: &str) -> Result<(), Invalid> {
    text(place, name)?;
    let rule = "must be plain names with `/` between them: it is that of an entry in an archive";
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
