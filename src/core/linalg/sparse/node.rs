//! A node of an elimination tree.

/// A node of the elimination tree: columns that are eliminated together.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// The unknowns whose columns are eliminated at this node; the same indices, in the same order,
    /// are the equations whose rows are fully summed at this node.
    pub own: Vec<usize>,
    /// The unknowns that are eliminated later and are coupled to the columns of this node.
    pub pattern: Vec<usize>,
    /// The parent of the node; for a root, the number of nodes.
    pub parent: usize,
    /// The entries of the matrix that belong to this node, each given by its position in the
    /// matrix, its row and its column; rows and columns are numbered by their positions in the list
    /// `own` followed by the list `pattern`.
    pub entries: Vec<[u32; 3]>,
}

impl Node {
    /// Returns the number of multiplications at this node.
    pub fn products(&self) -> f64 {
        let (own, size) = (self.own.len(), self.own.len() + self.pattern.len());
        (own * size * size) as f64
    }
}
