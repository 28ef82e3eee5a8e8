//! Chooses distinct names for documents.

use super::document::Document;

/// The largest number of settings in the name of a document.
const MOST_SETTINGS: usize = 3;

/// Returns a name for each of several documents. The name consists of the values of the settings in
/// which the documents differ, such as `c = 0.8`, or is the given name if these settings do not
/// distinguish the documents. A setting is ignored if it is a parameter that varies along a branch.
pub(super) fn distinguished(documents: &[(&str, &Document)]) -> Vec<String> {
    let given = || documents.iter().map(|(name, _)| (*name).to_owned()).collect::<Vec<_>>();
    let keys = differing(documents);
    if keys.is_empty() || keys.len() > MOST_SETTINGS {
        return given();
    }
    let words = |document: &Document| {
        let of = |key: &&str| format!("{key} = {}", setting(document, key).unwrap_or_default());
        keys.iter().map(of).collect::<Vec<_>>().join(", ")
    };
    let names: Vec<String> = documents.iter().map(|(_, document)| words(document)).collect();
    let repeated = |(k, name): (usize, &String)| names[..k].contains(name);
    if names.iter().enumerate().any(repeated) { given() } else { names }
}

/// Returns the names of the settings in which documents differ, except for parameters that vary
/// along a branch.
pub(super) fn differing<'a>(documents: &[(&str, &'a Document)]) -> Vec<&'a str> {
    let Some((_, first)) = documents.first() else { return Vec::new() };
    let varies = |key: &str| {
        let mut branches = documents.iter().flat_map(|(_, document)| &document.branches);
        branches.any(|branch| branch.released.iter().any(|name| name == key))
    };
    let differs = |key: &str| {
        let values: Vec<_> = documents.iter().map(|(_, document)| setting(document, key)).collect();
        values.iter().all(Option::is_some) && values.iter().any(|value| *value != values[0])
    };
    let keys = first.settings.iter().map(|(key, _)| key.as_str());
    keys.filter(|key| !varies(key) && differs(key)).collect()
}

/// Returns the value of a document's setting.
pub(super) fn setting<'a>(document: &'a Document, key: &str) -> Option<&'a str> {
    document.settings.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
}
