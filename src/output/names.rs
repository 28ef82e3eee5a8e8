//! Chooses distinct names for documents.

use super::document::{Document, Plot};
use super::number::significant;
use super::sweeps::Sweeps;
use super::units::with_prefix;
use std::cmp::Ordering;

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
        let value = |key: &str| setting(document, key).unwrap_or_default();
        let of = |key: &&str| format!("{key} = {}", readable(&document.plot, key, value(key)));
        keys.iter().map(of).collect::<Vec<_>>().join(", ")
    };
    let names: Vec<String> = documents.iter().map(|(_, document)| words(document)).collect();
    let repeated = |(k, name): (usize, &String)| names[..k].contains(name);
    if names.iter().enumerate().any(repeated) { given() } else { names }
}

/// The number of digits of values in names, and the absolute value below which a number is written
/// with a power of ten.
const DIGITS: usize = 12;
const SMALL: f64 = 1e-3;

/// Writes the value of a setting with the unit of the setting's column, such as `1.5 µm`. If no unit
/// is known, very small and very large values are written with a power of ten.
fn readable(plot: &Plot, key: &str, value: &str) -> String {
    match value.parse::<f64>() {
        Ok(number) => with_prefix(number, plot.label(key)).unwrap_or_else(|| plain(number)),
        Err(_) => value.into(),
    }
}

fn plain(number: f64) -> String {
    let text = significant(number, DIGITS);
    match text.parse::<f64>() {
        Ok(rounded) if rounded != 0.0 && rounded.abs() < SMALL => format!("{rounded:e}"),
        _ => text,
    }
}

/// Gives the sweeps of several scenes different names if some names are equal: the name of a sweep
/// is preceded by the values of the settings in which the scenes differ, or by the given name of its
/// scene if the settings do not distinguish the scenes. A setting is ignored if a sweep varies it.
#[cfg(feature = "cli")]
pub(crate) fn tell_apart(sweeps: &mut [Sweeps], scenes: &[(String, Vec<(String, String)>)]) {
    let tables = || sweeps.iter().flat_map(|it| &it.sweeps);
    let mut names: Vec<&str> = tables().map(|table| table.name.as_str()).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    if names.len() == count {
        return;
    }
    let swept = |key: &str| tables().any(|table| table.axes.iter().any(|axis| axis == key));
    let documents: Vec<(&str, Document)> = sweeps
        .iter()
        .zip(scenes)
        .map(|(sweeps, (name, settings))| {
            let mut document = Document::new(&sweeps.title, Vec::new());
            document.plot = sweeps.plot.clone();
            document.settings = settings.iter().filter(|(key, _)| !swept(key)).cloned().collect();
            (name.as_str(), document)
        })
        .collect();
    let documents: Vec<(&str, &Document)> =
        documents.iter().map(|(name, it)| (*name, it)).collect();
    let alone = names.len() == 1;
    for (sweeps, name) in sweeps.iter_mut().zip(distinguished(&documents)) {
        for table in &mut sweeps.sweeps {
            table.name = if alone { name.clone() } else { format!("{name}, {}", table.name) };
        }
    }
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

/// Sorts documents by the values of the given settings; numbers precede words, and equal values
/// keep their order.
pub(super) fn sort<T>(documents: &mut [T], of: impl Fn(&T) -> &Document, keys: &[String]) {
    let order = |a: &str, b: &str| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => a.total_cmp(&b),
        (Ok(_), Err(_)) => Ordering::Less,
        (Err(_), Ok(_)) => Ordering::Greater,
        (Err(_), Err(_)) => a.cmp(b),
    };
    let value = |it: &T, key: &str| setting(of(it), key).unwrap_or_default().to_owned();
    documents.sort_by(|a, b| {
        let mut orders = keys.iter().map(|key| order(&value(a, key), &value(b, key)));
        orders.find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    });
}

/// Sorts documents that differ in a single setting by the number that is the value of this setting;
/// other documents keep their order.
#[cfg(feature = "cli")]
pub(crate) fn sort_by_number<T>(files: &mut [(T, Document)]) {
    let documents: Vec<(&str, &Document)> = files.iter().map(|(_, it)| ("", it)).collect();
    let [key] = differing(&documents)[..] else { return };
    let is_number = |(_, it): &(&str, &Document)| {
        setting(it, key).is_some_and(|value| value.parse::<f64>().is_ok())
    };
    if documents.iter().all(is_number) {
        let keys = [key.to_owned()];
        sort(files, |(_, document)| document, &keys);
    }
}

/// Returns the value of a document's setting.
pub(super) fn setting<'a>(document: &'a Document, key: &str) -> Option<&'a str> {
    document.settings.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
}
