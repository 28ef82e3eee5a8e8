//! Names of unknowns, parameters and monitors; unknown names, and the known name that was probably
//! meant.

/// A group of unknowns of one nature and one unit: a scalar, or all values of a field.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// The name of the unknown.
    pub name: String,
    /// How many components it has.
    pub length: usize,
}

impl From<&str> for Group {
    fn from(name: &str) -> Self {
        Group { name: name.into(), length: 1 }
    }
}

impl From<(&str, usize)> for Group {
    fn from((name, length): (&str, usize)) -> Self {
        Group { name: name.into(), length }
    }
}

/// The names of a zero problem's unknowns, parameters and monitors.
///
/// ```
/// use tangency::core::problem::Names;
/// let names = Names::new(["x", "y"], ["p"]);
/// assert_eq!((names.dimension(), names.parameter("p")), (2, Some(0)));
/// let field = Names::new([("u", 99)], ["lambda"]).with_monitors(["max"]);
/// assert_eq!(field.dimension(), 99);
/// ```
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Names {
    /// Groups of unknowns, in the order of `z`.
    pub unknowns: Vec<Group>,
    /// Parameters, in the order of `p`.
    pub parameters: Vec<String>,
    /// Monitors: named scalars of the solution.
    pub monitors: Vec<String>,
}

impl Names {
    /// Names of unknowns (`"x"`, or `("u", 99)` for a field of 99 values) and of parameters.
    pub fn new<G: Into<Group>, P: Into<String>>(
        unknowns: impl IntoIterator<Item = G>,
        parameters: impl IntoIterator<Item = P>,
    ) -> Self {
        Names {
            unknowns: unknowns.into_iter().map(Into::into).collect(),
            parameters: parameters.into_iter().map(Into::into).collect(),
            monitors: Vec::new(),
        }
    }

    /// Adds the names of monitors.
    pub fn with_monitors<S: Into<String>>(mut self, monitors: impl IntoIterator<Item = S>) -> Self {
        self.monitors.extend(monitors.into_iter().map(Into::into));
        self
    }

    /// The number of unknowns `n`.
    pub fn dimension(&self) -> usize {
        self.unknowns.iter().map(|group| group.length).sum()
    }

    /// The length of `x = (z, p)`.
    pub fn length(&self) -> usize {
        self.dimension() + self.parameters.len()
    }

    /// The position of a parameter among the parameters.
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter == name)
    }

    /// The position in `z` of the first unknown of a group.
    pub fn unknown(&self, name: &str) -> Option<usize> {
        let group = self.unknowns.iter().position(|group| group.name == name)?;
        Some(self.unknowns[..group].iter().map(|group| group.length).sum())
    }

    /// The position of a monitor among the monitors.
    pub fn monitor(&self, name: &str) -> Option<usize> {
        self.monitors.iter().position(|monitor| monitor == name)
    }
}

/// A name that does not exist, with those that do.
///
/// ```
/// use tangency::core::problem::UnknownName;
/// let error = UnknownName::new("column", "laod", ["load", "max"]);
/// assert_eq!(
///     error.to_string(),
///     "unknown column `laod`; did you mean `load`? Known: load, max"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} `{}`{}Known: {}", shown(name), self.question(), self.known())]
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
            Some(name) => format!("; did you mean `{}`? ", shown(name)),
            None => ". ".into(),
        }
    }

    fn known(&self) -> String {
        if self.available.is_empty() { "none".into() } else { listed(&self.available) }
    }
}

/// How many letters of a name a message shows.
const SHOWN: usize = 60;
/// How many letters of a list of names a message shows.
const LISTED: usize = 240;

/// Whether a letter is not seen, or turns others round: control characters, and those that choose a
/// direction.
pub(crate) fn is_hidden(letter: char) -> bool {
    let is_mark = matches!(letter, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
    is_mark || letter.is_control()
}

/// A name or a value as messages show it: letters that are not seen are escaped, and it is cut
/// where it is long.
pub(crate) fn shown(text: &str) -> String {
    let plain = |letter: char| match is_hidden(letter) {
        true => letter.escape_default().to_string(),
        false => letter.to_string(),
    };
    let cut = if text.chars().nth(SHOWN).is_some() { "…" } else { "" };
    text.chars().take(SHOWN).map(plain).collect::<String>() + cut
}

/// Names as messages list them: as many as fit, and how many there are.
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

/// Names without repetitions, in the order in which they come first.
pub(crate) fn distinct<'a>(names: impl IntoIterator<Item = &'a String>) -> Vec<&'a str> {
    let mut distinct: Vec<&str> = Vec::new();
    for name in names {
        if !distinct.contains(&name.as_str()) {
            distinct.push(name);
        }
    }
    distinct
}

/// The position of a name among those that exist.
///
/// # Errors
/// [`UnknownName`] if it is not among them.
pub fn position<S: AsRef<str>>(
    what: &str,
    name: &str,
    known: impl IntoIterator<Item = S> + Clone,
) -> Result<usize, UnknownName> {
    let found = known.clone().into_iter().position(|known| known.as_ref() == name);
    let names = || known.into_iter().map(|known| known.as_ref().to_string());
    found.ok_or_else(|| UnknownName::new(what, name, names()))
}

/// The candidate nearest to a mistyped name: the one with the fewest insertions, deletions,
/// replacements and swaps of neighbours (in either case), if they are at most a third of the name's
/// letters. One is always forgiven.
///
/// ```
/// use tangency::core::problem::suggest;
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
