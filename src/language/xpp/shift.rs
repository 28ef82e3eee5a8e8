//! What remains to be replaced in a formula: the index of a sum, and names by how far they are from
//! others.

use super::super::source::ModelError;
use super::names::Names;
use super::origin::Slice;
use super::tree::{Known, Tree};

/// Whether the index of a sum occurs outside of all sums within it.
pub(super) fn index_outside(tree: &Tree, found: &mut bool) {
    let mut open = vec![tree];
    while let Some(tree) = open.pop() {
        *found |= *tree == Tree::Name(Known::Index);
        if !matches!(tree, Tree::Sum(..)) {
            open.extend(tree.children());
        }
    }
}

/// Refuses shifts by what is not a number.
pub(super) fn unresolved(names: &Names, text: Slice, tree: &Tree) -> Result<(), ModelError> {
    let mut found = None;
    tree.visit(&mut |part| {
        if let Tree::Shift(_, _, place) = part {
            found = Some(place.clone());
        }
    });
    found.map_or(Ok(()), |place| {
        let reason = "by how many names must be a number here, or the index of a sum";
        Err(text.part(place).unsupported(names.source, "`shift` by what can be varied", reason))
    })
}
