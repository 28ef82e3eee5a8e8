//! Unknown names, and the known name that was probably meant.

/// A name that does not exist, with those that do.
///
/// ```
/// use tangency::core::names::UnknownName;
/// let error = UnknownName::new("column", "laod", ["load", "max"]);
/// assert_eq!(
///     error.to_string(),
///     "unknown column `laod`; did you mean `load`? Known: load, max"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} `{name}`{}Known: {}", self.question(), self.known())]
pub struct UnknownName {
    /// What the name stands for: `column`, `scene`, `branch`.
    pub what: String,
    /// The name.
    pub name: String,
    /// The names that exist.
    pub available: Vec<String>,
}

impl UnknownName {
    /// A name that is not among the available ones.
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
/// replacements and swaps of neighbours (in either case), if they are at most a third of the name's
/// letters. One is always forgiven.
///
/// ```
/// use tangency::core::names::suggest;
/// assert_eq!(suggest("frequency_ration", ["frequency", "frequency_ratio"]), Some("frequency_ratio"));
/// assert_eq!(suggest("voltage", ["load", "max"]), None);
/// assert_eq!(suggest("Λ", ["λ"]), Some("λ"));
/// ```
pub fn suggest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = (name.chars().count() / 3).max(1);
    let name = name.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| (strsim::osa_distance(&name, &candidate.to_lowercase()), candidate))
        // A name that shares no letter is no suggestion.
        .filter(|(distance, _)| *distance <= allowed && *distance < name.chars().count())
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}
