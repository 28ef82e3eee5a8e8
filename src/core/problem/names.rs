//! Names of unknowns, parameters and monitors, and the error for unknown names.

use crate::core::spelling::{listed, of_other_programs, shown, suggest};
use miette::Diagnostic;
use std::collections::HashSet;
use std::fmt;
use std::ops::Range;

/// A group of unknowns with the same meaning and unit: a scalar, an array, or all values of a field.
///
/// ```
/// use tangency::core::problem::Group;
/// let names = ["c", "u[1,0]", "u[1,1]", "u[2,0]", "u[2,1]"].map(String::from);
/// let groups = Group::of_states(&names);
/// assert_eq!((groups.len(), groups[1].name.as_str(), groups[1].length), (2, "u", 4));
/// assert_eq!(groups[1].indices, [[1, 2], [0, 1]]);
/// assert_eq!(groups[1].range("u[2,0]"), Some(2..3));
/// assert!(groups[1].elements().eq(names[1..].iter().cloned()));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// The name of the unknown.
    pub name: String,
    /// The number of components of the group.
    pub length: usize,
    /// The first and the last value of each index of an array; an empty list if the group is not an
    /// array. The last index varies fastest. If the group is defined on a mesh, each element of the
    /// array has one component per mesh node.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub indices: Vec<[i64; 2]>,
}

impl Group {
    /// Creates a group that is not an array.
    pub fn new(name: impl Into<String>, length: usize) -> Self {
        Group { name: name.into(), length, indices: Vec::new() }
    }

    /// Groups the names of states: an array whose elements `u[1]`, `u[2]`, … or `u[1,1]`, `u[1,2]`,
    /// … are consecutive becomes one group; any other state is a group of one component.
    pub fn of_states(states: &[String]) -> Vec<Group> {
        let mut groups = Vec::new();
        for run in states.chunk_by(|a, b| array_of(a).is_some() && array_of(a) == array_of(b)) {
            match Group::of_elements(run) {
                Some(group) => groups.push(group),
                None => groups.extend(run.iter().map(|state| Group::new(state, 1))),
            }
        }
        groups
    }

    /// Returns the array with exactly these elements in this order; `None` if the names do not form
    /// an array.
    fn of_elements(elements: &[String]) -> Option<Group> {
        let (first, last) = (indices_of(elements.first()?)?, indices_of(elements.last()?)?);
        let indices = first.iter().zip(&last).map(|(first, last)| [*first, *last]).collect();
        let (name, length) = (array_of(&elements[0])?.to_string(), elements.len());
        let group = Group { name, length, indices };
        let fits = first.len() == last.len() && group.count() == length;
        (fits && group.elements().eq(elements.iter().cloned())).then_some(group)
    }

    /// Returns the number of elements; 1 if the group is not an array.
    pub fn count(&self) -> usize {
        let range = |[first, last]: &[i64; 2]| match last < first {
            true => 0,
            false => {
                usize::try_from(first.abs_diff(*last)).map_or(usize::MAX, |n| n.saturating_add(1))
            }
        };
        self.indices.iter().map(range).fold(1, usize::saturating_mul)
    }

    /// Defines the group on a mesh, so that each element of the array has one value per mesh node.
    pub fn on_mesh(mut self, nodes: usize) -> Self {
        self.length = self.count() * nodes;
        self
    }

    /// Iterates over the names of the array's elements; if the group is not an array, the only item
    /// is the name of the group.
    pub fn elements(&self) -> impl Iterator<Item = String> + use<'_> {
        (0..self.count()).map(|k| self.element(k))
    }

    /// Returns the name of an element, given its position in the array.
    fn element(&self, k: usize) -> String {
        if self.indices.is_empty() {
            return self.name.clone();
        }
        let values: Vec<String> = self.indices_at(k).iter().map(i64::to_string).collect();
        format!("{}[{}]", self.name, values.join(","))
    }

    /// Returns the indices of an element, given its position in the array.
    pub(crate) fn indices_at(&self, mut k: usize) -> Vec<i64> {
        let mut values = vec![0; self.indices.len()];
        for (value, [first, last]) in values.iter_mut().zip(&self.indices).rev() {
            let range = (last - first + 1) as usize;
            *value = first + (k % range) as i64;
            k /= range;
        }
        values
    }

    /// Returns the range of components of the whole group, given its name, or of one element of the
    /// array, given the element's name; `None` for any other name.
    pub fn range(&self, name: &str) -> Option<Range<usize>> {
        if self.name == name {
            return Some(0..self.length);
        }
        if self.indices.is_empty() || array_of(name)? != self.name {
            return None;
        }
        let values = indices_of(name).filter(|values| values.len() == self.indices.len())?;
        let mut element = 0;
        for (value, [first, last]) in values.iter().zip(&self.indices) {
            let within = (first..=last).contains(&value).then(|| (value - first) as usize)?;
            element = element * (last - first + 1) as usize + within;
        }
        let each = self.length / self.count();
        Some(element * each..(element + 1) * each)
    }
}

/// Returns the name of an element's array, for example `u` for `u[1,2]`.
fn array_of(element: &str) -> Option<&str> {
    Some(element.strip_suffix(']')?.split_once('[')?.0)
}

/// Returns the indices of an element of an array, given the element's name.
fn indices_of(element: &str) -> Option<Vec<i64>> {
    let (_, indices) = element.strip_suffix(']')?.split_once('[')?;
    indices.split(',').map(|index| index.trim().parse().ok()).collect()
}

impl From<&str> for Group {
    fn from(name: &str) -> Self {
        Group::new(name, 1)
    }
}

/// The array with the elements `u[1]`, …, `u[n]`; a scalar if the array has one element.
impl From<(&str, usize)> for Group {
    fn from((name, length): (&str, usize)) -> Self {
        let indices = if length == 1 { Vec::new() } else { vec![[1, length as i64]] };
        Group { indices, ..Group::new(name, length) }
    }
}

/// The names of the unknowns, parameters and monitors of a zero problem, and the default values of
/// its parameters.
///
/// ```
/// use tangency::core::problem::Names;
/// let names = Names::new(["x", "y"], ["p"]);
/// assert_eq!((names.dimension(), names.parameter("p")), (2, Some(0)));
/// let field = Names::new([("u", 99)], ["lambda"]).with_monitors(["max"]);
/// assert_eq!(field.dimension(), 99);
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Names {
    /// The groups of unknowns, in the order of `z`.
    pub unknowns: Vec<Group>,
    /// The names of the parameters, in the order of `p`.
    pub parameters: Vec<String>,
    /// The names of the monitors, which are scalar functions of the solution.
    pub monitors: Vec<String>,
    /// The default values of all parameters, in order; an empty list if the problem has no default
    /// values.
    #[serde(default)]
    pub defaults: Vec<f64>,
}

impl Names {
    /// Creates the names of unknowns (`"x"`, or `("u", 99)` for an array with the elements `u[1]`, …,
    /// `u[99]`) and of parameters.
    pub fn new<G: Into<Group>, P: Into<String>>(
        unknowns: impl IntoIterator<Item = G>,
        parameters: impl IntoIterator<Item = P>,
    ) -> Self {
        Names {
            unknowns: unknowns.into_iter().map(Into::into).collect(),
            parameters: parameters.into_iter().map(Into::into).collect(),
            monitors: Vec::new(),
            defaults: Vec::new(),
        }
    }

    /// Sets the default values of all parameters.
    pub(crate) fn with_defaults(mut self, defaults: Vec<f64>) -> Self {
        self.defaults = defaults;
        self
    }

    /// Adds the names of monitors.
    pub fn with_monitors<S: Into<String>>(mut self, monitors: impl IntoIterator<Item = S>) -> Self {
        self.monitors.extend(monitors.into_iter().map(Into::into));
        self
    }

    /// Returns the number `n` of unknowns.
    pub fn dimension(&self) -> usize {
        self.unknowns.iter().map(|group| group.length).sum()
    }

    /// Returns the length of the vector `x = (z, p)` of unknowns and parameters.
    pub fn length(&self) -> usize {
        self.dimension() + self.parameters.len()
    }

    /// Returns the index of a parameter in the list of parameters; `None` if it does not exist.
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter == name)
    }

    /// Returns the position in `z` of the first unknown of a group, or of an array element.
    pub fn unknown(&self, name: &str) -> Option<usize> {
        self.range(name).map(|range| range.start)
    }

    /// Returns the range in `z` of the unknowns of a group, or of an array element.
    pub fn range(&self, name: &str) -> Option<Range<usize>> {
        let mut start = 0;
        self.unknowns.iter().find_map(|group| {
            let range = group.range(name).map(|own| start + own.start..start + own.end);
            start += group.length;
            range
        })
    }

    /// Iterates over the names of all scalars and of the elements of all arrays.
    pub fn elements(&self) -> impl Iterator<Item = String> + use<'_> {
        self.unknowns.iter().flat_map(Group::elements)
    }

    /// Returns the typical size of each group, given the sizes of the elements in the order of
    /// [`elements`]; the size of an array is the largest size of its elements. The result is empty if
    /// no sizes are given.
    ///
    /// [`elements`]: Self::elements
    pub fn sizes_of_groups(&self, sizes: &[f64]) -> Vec<f64> {
        let mut sizes = sizes.iter();
        let largest = |group: &Group| sizes.by_ref().take(group.count()).copied().reduce(f64::max);
        self.unknowns.iter().map_while(largest).collect()
    }

    /// Returns the index of a monitor in the list of monitors; `None` if it does not exist.
    pub fn monitor(&self, name: &str) -> Option<usize> {
        self.monitors.iter().position(|monitor| monitor == name)
    }
}

/// The error for a name that does not exist; the help text suggests the most similar existing name.
///
/// ```
/// use tangency::Diagnostic;
/// use tangency::core::problem::UnknownName;
/// let error = UnknownName::new("column", "laod", ["load", "max"]);
/// assert_eq!(error.to_string(), "unknown column `laod`");
/// let help = error.help().map(|help| help.to_string());
/// assert_eq!(help.as_deref(), Some("did you mean `load`? Known: load, max"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} `{}`", shown(name))]
pub struct UnknownName {
    /// The kind of object that the name should refer to, such as `column`, `scene` or `branch`.
    pub what: String,
    /// The name.
    pub name: String,
    /// The names of all existing objects of this kind.
    pub available: Vec<String>,
}

impl Diagnostic for UnknownName {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.remedy()))
    }
}

impl UnknownName {
    /// Creates the error for a name that is missing from the available names.
    pub fn new<S: Into<String>>(
        what: impl Into<String>,
        name: impl Into<String>,
        available: impl IntoIterator<Item = S>,
    ) -> Self {
        let available = available.into_iter().map(Into::into).collect();
        UnknownName { what: what.into(), name: name.into(), available }
    }

    /// Returns the help text: the name that was probably intended, and all existing names.
    pub fn remedy(&self) -> String {
        let UnknownName { name, available, .. } = self;
        let known = if available.is_empty() { "none".into() } else { listed(available) };
        let foreign = of_other_programs(name);
        if let Some(own) = foreign.filter(|own| available.iter().any(|name| name == own)) {
            return format!("`{name}` of other programs is called `{own}` here. Known: {known}");
        }
        match suggest(name, available.iter().map(String::as_str)) {
            Some(meant) => format!("did you mean `{}`? Known: {known}", shown(meant)),
            None => format!("known: {known}"),
        }
    }
}

/// Returns the names without repetitions, in the order of their first occurrence.
pub(crate) fn distinct<'a>(names: impl IntoIterator<Item = &'a String>) -> Vec<&'a str> {
    let mut known = HashSet::new();
    names.into_iter().map(String::as_str).filter(|name| known.insert(*name)).collect()
}

/// Returns the position of a name in a list of existing names.
///
/// # Errors
/// [`UnknownName`] if the name is missing from the list.
pub fn position<S: AsRef<str>>(
    what: &str,
    name: &str,
    known: impl IntoIterator<Item = S> + Clone,
) -> Result<usize, UnknownName> {
    let found = known.clone().into_iter().position(|known| known.as_ref() == name);
    let names = || known.into_iter().map(|known| known.as_ref().to_string());
    found.ok_or_else(|| UnknownName::new(what, name, names()))
}
