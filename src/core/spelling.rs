//! Suggests names to replace an unknown name: the most similar known name, or, for the name of a
//! setting in AUTO, XPPAUT or MatCont, this program's name of the setting. Long names in messages are
//! shortened.
//!
//! Names are compared by the number of edits, where a swap of neighbouring letters is one edit (F.
//! J. Damerau, *Commun. ACM* 7:171, 1964).
//!
//! ```
//! use tangency::core::spelling::suggest;
//! assert_eq!(suggest("laod", ["load", "gap"]), Some("load"));
//! assert_eq!(suggest("voltage", ["load", "gap"]), None);
//! ```

/// Returns the candidate most similar to a mistyped name: the one with the fewest insertions,
/// deletions, replacements and swaps of neighbouring letters (ignoring case), if their number is at
/// most a third of the name's length. A name that differs by one edit is always accepted. If no
/// candidate is so similar, the candidate is returned whose words begin the name, or whose first
/// words are the name: `transient` for `transient_periods`.
///
/// ```
/// use tangency::core::spelling::suggest;
/// assert_eq!(suggest("frequency_ration", ["frequency", "frequency_ratio"]), Some("frequency_ratio"));
/// assert_eq!(suggest("voltage", ["load", "max"]), None);
/// assert_eq!(suggest("Λ", ["λ"]), Some("λ"));
/// assert_eq!(suggest("transient_periods", ["period", "transient"]), Some("transient"));
/// ```
pub fn suggest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = (name.chars().count() / 3).max(1);
    let name = name.to_lowercase();
    let candidates: Vec<&str> = candidates.into_iter().collect();
    let similar = candidates
        .iter()
        .copied()
        .map(|candidate| (strsim::osa_distance(&name, &candidate.to_lowercase()), candidate))
        // A candidate without any common letter is not suggested.
        .filter(|(distance, _)| *distance <= allowed && *distance < name.chars().count())
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate);
    let of_words = |candidate: &&&str| shares_words(&name, &candidate.to_lowercase());
    similar.or_else(|| candidates.iter().find(of_words).copied())
}

/// The minimum number of characters of the words that two names have in common.
const WORDS: usize = 4;

/// Returns whether one of two names consists of the first words of the other name.
fn shares_words(a: &str, b: &str) -> bool {
    let (short, long) = if a.len() < b.len() { (a, b) } else { (b, a) };
    let rest = long.strip_prefix(short).filter(|_| short.chars().count() >= WORDS);
    rest.is_some_and(|rest| rest.starts_with('_'))
}

/// The maximum number of characters of a name in a message.
const SHOWN: usize = 60;
/// The maximum number of characters of a list of names in a message.
const LISTED: usize = 240;

/// Returns whether a character is invisible or changes the direction of neighbouring characters:
/// control characters and directional formatting.
pub(crate) fn is_hidden(letter: char) -> bool {
    let is_mark = matches!(letter, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
    is_mark || letter.is_control()
}

/// Formats a name or a value for messages: invisible characters are escaped, and long texts are
/// shortened.
pub(crate) fn shown(text: &str) -> String {
    let plain = |letter: char| match is_hidden(letter) {
        true => letter.escape_default().to_string(),
        false => letter.to_string(),
    };
    let cut = if text.chars().nth(SHOWN).is_some() { "…" } else { "" };
    text.chars().take(SHOWN).map(plain).collect::<String>() + cut
}

/// Formats a list of names for messages: the first names up to the maximum length, and the number
/// of omitted names.
pub(crate) fn listed<S: AsRef<str>>(names: &[S]) -> String {
    let mut list = String::new();
    for name in names {
        if list.chars().count() > LISTED {
            return format!("{list}, … ({} in all)", names.len());
        }
        let comma = if list.is_empty() { "" } else { ", " };
        list += &format!("{comma}{}", shown(name.as_ref()));
    }
    list
}

/// The names of settings in AUTO, XPPAUT and MatCont, in lower case, with the names of the same
/// settings in this program.
const OF_OTHER_PROGRAMS: [(&str, &str); 21] = [
    ("ntst", "intervals"),
    ("ncol", "degree"),
    ("ds", "initial_step"),
    ("dsmin", "min_step"),
    ("dsmax", "max_step"),
    ("initstepsize", "initial_step"),
    ("minstepsize", "min_step"),
    ("maxstepsize", "max_step"),
    ("nmx", "max_points"),
    ("nmax", "max_points"),
    ("maxnumpoints", "max_points"),
    ("npr", "save_every"),
    ("epsl", "tolerance"),
    ("epsu", "tolerance"),
    ("funtolerance", "tolerance"),
    ("vartolerance", "tolerance"),
    ("epss", "event_tolerance"),
    ("testtolerance", "event_tolerance"),
    ("itnw", "max_iterations"),
    ("itmx", "max_iterations"),
    ("singularities", "detect"),
];

/// Returns this program's name of a setting, given its name in AUTO, XPPAUT or MatCont.
pub(crate) fn of_other_programs(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    OF_OTHER_PROGRAMS.iter().find(|(other, _)| *other == name).map(|(_, own)| *own)
}
