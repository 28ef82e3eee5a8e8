//! Names of unknowns, parameters and monitors, and unknown names.

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
///     "unknown column `laod`. Known: load, max"
/// );
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} `{name}`. Known: {}", available.join(", "))]
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
