//! Elements of arrays: the elements denoted by a name with ranges of indices.

use crate::core::problem::Group;
use std::sync::Arc;

/// The maximum number of elements of an array, and of states of equations with sparse matrices.
pub(super) const ELEMENTS: usize = 200_000;

/// The values of named indices.
pub(super) type Indices = Vec<(Arc<str>, f64)>;

/// A scalar, or an element of an array with the values of its indices.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub name: String,
    pub at: Indices,
}

/// A scalar, or elements of an array: each index has a range, with a name unless it is a single
/// value. The last index varies fastest.
#[derive(Clone, Debug)]
pub(super) struct Elements {
    array: Group,
    indices: Vec<Option<Arc<str>>>,
}

impl Elements {
    /// Creates the elements; without ranges, a scalar.
    pub fn new(name: String, ranges: Vec<(Option<Arc<str>>, [i64; 2])>) -> Self {
        let (indices, ranges) = ranges.into_iter().unzip();
        let array = Group { name, length: 0, indices: ranges };
        Elements { array, indices }
    }

    /// Returns all elements of the named array among some states, if the name is not itself a
    /// state.
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

    /// Returns the number of elements.
    pub fn count(&self) -> usize {
        self.array.count()
    }

    /// Returns the names of the elements.
    pub fn names(&self) -> impl Iterator<Item = String> + use<'_> {
        self.array.elements()
    }

    /// Iterates over the elements.
    pub fn iter(&self) -> impl Iterator<Item = Element> + use<'_> {
        self.names().zip(self.values()).map(|(name, at)| Element { name, at })
    }

    /// Iterates over the elements, and returns the values of their named indices.
    pub fn values(&self) -> impl Iterator<Item = Indices> + use<'_> {
        (0..self.count()).map(|k| {
            let values = self.indices.iter().zip(self.array.indices_at(k));
            values.filter_map(|(name, value)| Some((name.clone()?, value as f64))).collect()
        })
    }
}
