//! The meanings of settings, taken from the tables of the reference manual.

use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The text of the reference manual of scenes and settings.
const REFERENCE: &str = include_str!("../../docs/reference/scenes.md");

/// The meanings of all settings, by the name of the setting.
static MEANINGS: LazyLock<BTreeMap<&'static str, String>> = LazyLock::new(meanings);

/// Returns the meaning of a setting; the text is empty if the reference manual does not list the
/// setting.
pub(super) fn meaning(name: &str) -> &'static str {
    MEANINGS.get(name).map_or("", String::as_str)
}

/// Parses the table rows `| `name` | default | meaning |` below the heading of the settings.
fn meanings() -> BTreeMap<&'static str, String> {
    let settings = REFERENCE.split_once("\n## Settings\n").map_or("", |(_, rest)| rest);
    let settings = settings.split("\n## ").next().unwrap_or_default();
    let row = |line: &'static str| {
        let mut cells = line.strip_prefix("| `")?.split(" | ");
        let name = cells.next()?.strip_suffix('`')?;
        let meaning = cells.nth(1)?.trim_end().trim_end_matches('|').trim_end();
        Some((name, plain(meaning)))
    };
    settings.lines().filter_map(row).collect()
}

/// Removes Markdown marks from a text: the quotes around code, and the brackets and targets of
/// links.
fn plain(text: &str) -> String {
    let (mut plain, mut rest) = (String::new(), text);
    while let Some((before, after)) = rest.split_once("](") {
        let (begin, end) = (before.rfind('[').unwrap_or_default(), after.find(')'));
        plain.push_str(&before[..begin]);
        plain.push_str(before[begin..].trim_start_matches('['));
        rest = end.map_or("", |end| &after[end + 1..]);
    }
    (plain + rest).replace('`', "")
}
