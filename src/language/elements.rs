//! Arrays: the elements that a name with ranges of indices denotes.

use crate::core::problem::Group;
use std::sync::Arc;

/// The maximum number of elements of an array, and the maximum number of states of equations with
/// sparse matrices.
pub(super) const ELEMENTS: usize = 200_000;

/// The names of the indices of an array element, each with its value.
pub(super) type Indices = Vec<(Arc<str>, f64)>;

/// A scalar, or an element of an array; an element contains the values of its named indices.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub name: String,
    pub at: Indices,
}

/// A scalar, or the elements of an array. Each index has a range, which has a name unless it
/// consists of a single value. In the order of the elements, the last index varies fastest.
#[derive(Clone, Debug)]
pub(super) struct Elements {
    array: Group,
    indices: Vec<Option<Arc<str>>>,
}

impl Elements {
    /// Creates the elements of an array, or a scalar if no ranges are given.
    pub fn new(name: String, ranges: Vec<(Option<Arc<str>>, [i64; 2])>) -> Self {
        let (indices, ranges) = ranges.into_iter().unzip();
        let array = Group { name, length: 0, indices: ranges };
        Elements { array, indices }
    }

    /// Returns all elements of the named array that occur among the given states, or `None` if the
    /// name is not the name of an array.
    pub fn of_array<'s>(&self, states: impl IntoIterator<Item = &'s String>) -> Option<Elements> {
        if !self.indices.is_empty() {
            return None;
        }
        let array = format!("{}[", self.array.name);
        let own = |state: &&String| state.starts_with(&array);
        let own: Vec<String> = states.into_iter().filter(own).cloned().collect();
        let [group]: [Group; 1] = Group::of_states(&own).try_into().ok()?;
        Some(Elements { indices: vec![None; group.indices.len()], array: group })
    }

    /// Returns the number of elements of the array.
    pub fn count(&self) -> usize {
        self.array.count()
    }

    /// Returns the names of the elements.
    pub fn names(&self) -> impl Iterator<Item = String> + use<'_> {
        self.array.elements()
    }

    /// Iterates over the elements of the array.
    pub fn iter(&self) -> impl Iterator<Item = Element> + use<'_> {
        self.names().zip(self.values()).map(|(name, at)| Element { name, at })
    }

    /// Iterates over the elements of the array, and returns the values of the named indices of each
    /// element.
    pub fn values(&self) -> impl Iterator<Item = Indices> + use<'_> {
        (0..self.count()).map(|k| {
            let values = self.indices.iter().zip(self.array.indices_at(k));
            values.filter_map(|(name, value)| Some((name.clone()?, value as f64))).collect()
        })
    }
}
