//! Elements of arrays: what a name with ranges of indices stands for.

use crate::core::problem::Group;
use std::sync::Arc;

/// The most elements of an array, and the most states of equations whose matrices may be sparse.
pub(super) const ELEMENTS: usize = 200_000;

/// The values of indices that have names.
pub(super) type Indices = Vec<(Arc<str>, f64)>;

/// A scalar, or an element of an array with the values of its indices.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub name: String,
    pub at: Indices,
}

/// A scalar, or elements of an array: for each index a range, with a name where it is not one
/// value. The last index changes first.
#[derive(Clone, Debug)]
pub(super) struct Elements {
    array: Group,
    indices: Vec<Option<Arc<str>>>,
}

impl Elements {
    /// A scalar if there are no ranges.
    pub fn new(name: String, ranges: Vec<(Option<Arc<str>>, [i64; 2])>) -> Self {
        let (indices, ranges) = ranges.into_iter().unzip();
        let array = Group { name, length: 0, indices: ranges };
        Elements { array, indices }
    }

    /// All elements of the array that has this name among some states, where it is no state itself.
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

    /// How many they are.
    pub fn count(&self) -> usize {
        self.array.count()
    }

    /// Their names.
    pub fn names(&self) -> impl Iterator<Item = String> + use<'_> {
        self.array.elements()
    }

    /// The elements.
    pub fn iter(&self) -> impl Iterator<Item = Element> + use<'_> {
        self.names().zip(self.values()).map(|(name, at)| Element { name, at })
    }

    /// The values of the indices that have names, for each element.
    pub fn values(&self) -> impl Iterator<Item = Indices> + use<'_> {
        (0..self.count()).map(|k| {
            let values = self.indices.iter().zip(self.array.indices_at(k));
            values.filter_map(|(name, value)| Some((name.clone()?, value as f64))).collect()
        })
    }
}
