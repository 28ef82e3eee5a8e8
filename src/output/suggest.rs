//! Names that were not found, and the one that was probably meant.

/// A name that does not exist, with those that do.
///
/// ```
/// use tangency::output::UnknownName;
/// let error = UnknownName::new("column", "laod", ["load", "max"]);
/// assert_eq!(
///     error.to_string(),
///     "there is no column `laod`; did you mean `load`? Known: load, max"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no {what} `{name}`{}Known: {}", self.question(), self.known())]
pub struct UnknownName {
    /// What the name should stand for: `column`, `scene`, `branch`.
    pub what: String,
    /// The name.
    pub name: String,
    /// The names that exist.
    pub available: Vec<String>,
}

impl UnknownName {
    /// A name that is not among those available.
    pub fn new<S: Into<String>>(
        what: impl Into<String>,
        name: impl Into<String>,
        available: impl IntoIterator<Item = S>,
    ) -> Self {
        let available = available.into_iter().map(Into::into).collect();
        UnknownName { what: what.into(), name: name.into(), available }
    }

    fn question(&self) -> String {
        match suggest(&self.name, self.available.iter().map(String::as_str)) {
            Some(name) => format!("; did you mean `{name}`? "),
            None => ". ".into(),
        }
    }

    fn known(&self) -> String {
        if self.available.is_empty() { "none".into() } else { self.available.join(", ") }
    }
}

/// The candidate nearest to a mistyped name: the one with the fewest insertions, deletions,
/// replacements and swaps of neighbours, if they are at most a third of the name's letters
/// (and at least one is always forgiven).
///
/// ```
/// use tangency::output::suggest;
/// assert_eq!(suggest("frequency_ration", ["frequency", "frequency_ratio"]), Some("frequency_ratio"));
/// assert_eq!(suggest("voltage", ["load", "max"]), None);
/// ```
pub fn suggest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = (name.chars().count() / 3).max(1);
    candidates
        .into_iter()
        .map(|candidate| (distance(name, candidate), candidate))
        .filter(|(distance, _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// The edit distance, where case counts for nothing and a swap of neighbours for one.
fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.to_lowercase().chars().collect();
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut before_last = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 0..a.len() {
        let mut row = vec![i + 1; b.len() + 1];
        for j in 0..b.len() {
            let replaced = last[j] + usize::from(a[i] != b[j]);
            row[j + 1] = replaced.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] {
                row[j + 1] = row[j + 1].min(before_last[j - 1] + 1);
            }
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}
