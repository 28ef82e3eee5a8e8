//! Names and texts that come from files: what they may hold, and how messages show them.

use super::error::Invalid;

/// How many letters of a text a message quotes.
const QUOTED: usize = 60;

/// A text in a message: in quotes, its control characters escaped, cut where it is long.
pub(crate) fn quoted(text: &str) -> String {
    let cut = if text.chars().nth(QUOTED).is_some() { "…" } else { "" };
    format!("{:?}{cut}", text.chars().take(QUOTED).collect::<String>())
}

/// A message as a terminal may show it: control characters are escaped, but for the ends of its lines.
#[cfg(feature = "cli")]
pub(crate) fn printable(message: &str) -> String {
    let kept = |letter: char| !letter.is_control() || letter == '\n' || letter == '\t';
    let show = |letter: char| match kept(letter) {
        true => letter.to_string(),
        false => letter.escape_default().to_string(),
    };
    message.chars().map(show).collect()
}

/// Refuses a name or a title that would move the cursor of a terminal, or make an ill-formed picture.
pub(crate) fn text(place: &str, text: &str) -> Result<(), Invalid> {
    require(!text.contains(char::is_control), place, text, "must hold no control characters")
}

/// Refuses a name that could choose a folder: a result's name is one plain component of a path.
pub(crate) fn component(place: &str, name: &str) -> Result<(), Invalid> {
    text(place, name)?;
    let rule = "must be one plain name of a file, without a folder";
    require(is_plain(name), place, name, rule)
}

/// Refuses a name that would leave the folder into which an archive with entries of this name is unpacked.
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
