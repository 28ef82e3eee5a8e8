//! The elimination tree of a sparse matrix: groups of columns that are eliminated together, with the
//! order of the groups.

use super::Pattern;
use super::dissection::Graph;
use super::node::Node;
use super::partition::{LEAST_WORK, Partition, partition, work};
use faer::Side;
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, SymbolicSupernodalParams};
use std::ops::Range;

/// Heuristic: the largest bandwidth of a matrix that is eliminated as a band matrix.
const BAND: usize = 12;

/// Heuristic: the number of columns of a band matrix that are eliminated together.
const BLOCK: usize = 12;

/// Heuristic: the rules for merging nodes of the elimination tree, as pairs (columns, fraction): if
/// the merged node has at most this number of columns, less than this fraction of its entries may
/// be zero.
const RELAX: &[(usize, f64)] = &[(8, 0.9), (24, 0.5), (64, 0.1), (usize::MAX, 0.02)];

/// Heuristic: the largest time of an elimination on one processor after a dissection, as a multiple of
/// the time for the minimum degree order.
const MOST_WORK: f64 = 1.2;

/// The elimination tree, in which nodes come before their parents.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    pub nodes: Vec<Node>,
    /// The nodes in parts that can be eliminated side by side; the last part comes after all others.
    pub parts: Vec<Vec<usize>>,
}

impl Tree {
    /// Computes the elimination tree of a sparsity pattern, which is made symmetric first. The
    /// columns of a band matrix keep their order, or are eliminated from both ends; for other
    /// patterns, the order is the approximate minimum degree order (P. R. Amestoy, T. A. Davis and I.
    /// S. Duff, SIAM J. Matrix Anal. Appl. 17 (1996) 886), and a node consists of several columns. A
    /// large matrix is [dissected](Graph::dissected_order) first if the dissection reduces the sequential work.
    pub fn of(pattern: &Pattern) -> Tree {
        let n = pattern.size();
        let band = (0..n)
            .flat_map(|j| pattern.column(j).iter().map(move |&i| i.abs_diff(j)))
            .fold(0, usize::max);
        let mut nodes = if band <= BAND { banded(n, band) } else { ordered(pattern) };
        place_entries(pattern, &mut nodes);
        Tree { parts: partition(&nodes).parts, nodes }
    }
}

/// Returns the nodes of the elimination tree of a band matrix. The columns of a large matrix are
/// eliminated from both ends towards the middle, so that two threads can eliminate them.
fn banded(n: usize, band: usize) -> Vec<Node> {
    let count = n.div_ceil(BLOCK);
    let node = |k: usize, parent: usize, coupled: fn([usize; 4]) -> Range<usize>| {
        let (start, end) = (k * BLOCK, n.min((k + 1) * BLOCK));
        let pattern = coupled([start, end, band, n]).collect();
        Node { own: (start..end).collect(), pattern, parent, entries: Vec::new() }
    };
    let forward = |[_, end, band, n]: [usize; 4]| end..n.min(end + band);
    let backward = |[start, _, band, _]: [usize; 4]| start - band..start;
    let from_left: Vec<Node> = (0..count).map(|k| node(k, k + 1, forward)).collect();
    if band > BLOCK || from_left.iter().map(work).sum::<f64>() < LEAST_WORK {
        return from_left;
    }
    // The middle block comes last; the blocks after the middle come in reverse order.
    let (middle, root) = (count / 2, count - 1);
    let place = |k: usize| if k < middle { k } else { middle + root - k };
    let left = (0..middle).map(|k| node(k, if k + 1 < middle { k + 1 } else { root }, forward));
    let right = (middle + 1..count).rev().map(|k| node(k, place(k) + 1, backward));
    left.chain(right).chain([node(middle, count, |_| 0..0)]).collect()
}

/// Returns the nodes of the elimination tree of a matrix that is not a band matrix.
fn ordered(pattern: &Pattern) -> Vec<Node> {
    let n = pattern.size();
    let (starts, rows) = upper(pattern);
    let symbolic = SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows);
    let nodes = nodes(symbolic, SymmetricOrdering::Amd);
    let Partition { total, critical, .. } = partition(&nodes);
    if total < LEAST_WORK {
        return nodes;
    }
    let Some(order) = Graph::of(&starts, &rows).dissected_order() else { return nodes };
    let mut inverse = vec![0; n];
    order.iter().enumerate().for_each(|(at, &v)| inverse[v] = at);
    let order = PermRef::new_checked(&order, &inverse, n);
    let dissected = self::nodes(symbolic, SymmetricOrdering::Custom(order));
    let found = partition(&dissected);
    let is_better = found.critical < critical && found.total < MOST_WORK * total;
    if is_better { dissected } else { nodes }
}

/// Returns the nodes of the elimination tree for columns in a given order; the upper triangle of the
/// pattern is given.
fn nodes(symbolic: SymbolicSparseColMatRef<usize>, order: SymmetricOrdering<usize>) -> Vec<Node> {
    let n = symbolic.ncols();
    let params = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        supernodal_params: SymbolicSupernodalParams { relax: Some(RELAX) },
        ..CholeskySymbolicParams::default()
    };
    let found = factorize_symbolic_cholesky(symbolic, Side::Upper, order, params);
    let Ok(found) = found else { return banded(n, n) };
    let (SymbolicCholeskyRaw::Supernodal(tree), Some(order)) = (found.raw(), found.perm()) else {
        return banded(n, n);
    };
    let order = order.arrays().0;
    let (begins, ends) = (tree.supernode_begin(), tree.supernode_end());
    let mut node_of = vec![0; n];
    for (s, (&begin, &end)) in begins.iter().zip(ends).enumerate() {
        node_of[begin..end].fill(s);
    }
    let node = |s: usize| {
        let rows = tree.supernode(s).pattern();
        Node {
            own: order[begins[s]..ends[s]].to_vec(),
            pattern: rows.iter().map(|&row| order[row]).collect(),
            parent: rows.first().map_or(begins.len(), |&row| node_of[row]),
            entries: Vec::new(),
        }
    };
    (0..begins.len()).map(node).collect()
}

/// Returns the upper triangle, including the diagonal, of the symmetrised pattern: the start of
/// each column, and the rows of all entries.
fn upper(pattern: &Pattern) -> (Vec<usize>, Vec<usize>) {
    let n = pattern.size();
    let mut columns: Vec<Vec<usize>> = (0..n).map(|j| vec![j]).collect();
    for j in 0..n {
        for &i in pattern.column(j) {
            columns[i.max(j)].push(i.min(j));
        }
    }
    let mut starts = vec![0];
    let mut rows = Vec::new();
    for mut column in columns {
        column.sort_unstable();
        column.dedup();
        rows.extend(column);
        starts.push(rows.len());
    }
    (starts, rows)
}

/// Assigns each entry of the matrix to the node that eliminates the first of its two unknowns.
fn place_entries(pattern: &Pattern, nodes: &mut [Node]) {
    let n = pattern.size();
    let mut node_of = vec![0; n];
    for (s, node) in nodes.iter().enumerate() {
        node.own.iter().for_each(|&v| node_of[v] = s);
    }
    let mut of_node: Vec<Vec<[usize; 3]>> = vec![Vec::new(); nodes.len()];
    for j in 0..n {
        for (k, &i) in (pattern.start(j)..).zip(pattern.column(j)) {
            of_node[node_of[i].min(node_of[j])].push([k, i, j]);
        }
    }
    let mut local = vec![0; n];
    for (node, entries) in nodes.iter_mut().zip(of_node) {
        node.own.iter().chain(&node.pattern).enumerate().for_each(|(at, &v)| local[v] = at);
        let placed = |[k, i, j]: [usize; 3]| [k, local[i], local[j]].map(|it| it as u32);
        node.entries = entries.into_iter().map(placed).collect();
    }
}
