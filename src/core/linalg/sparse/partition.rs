//! Division of an elimination tree into parts that threads eliminate side by side.

use super::node::Node;

/// Heuristic: the [time](work) from which on an elimination is divided. Below this time, starting
/// threads takes a noticeable part of the time.
pub(super) const LEAST_WORK: f64 = 6e7;

/// Heuristic: the number of parts that are eliminated side by side. The number does not depend on the
/// processor, so that results are the same on all processors; more parts leave more work for the
/// last part.
const PARTS: usize = 8;

/// Heuristic: an elimination is divided only if the division reduces the sequential work to this
/// fraction of the total work.
const WORTHWHILE: f64 = 0.75;

/// Heuristic: the time in which an entry of a front is assembled and stored, in units of the time of a
/// multiplication.
const MOVING: f64 = 50.0;

/// Heuristic: the largest number of nodes that are moved to the last part.
const MOST_SPLITS: usize = 256;

/// The nodes of an elimination tree in parts that threads eliminate side by side.
pub(super) struct Partition {
    /// Lists of nodes that do not depend on each other, and, as the last list, the remaining nodes,
    /// which depend on all others. Each list is in increasing order.
    pub parts: Vec<Vec<usize>>,
    /// The time that all nodes take, in units of the time of a multiplication.
    pub total: f64,
    /// The time that the largest part and the last part take.
    pub critical: f64,
}

/// Returns the time that the elimination of a node takes, in units of the time of a multiplication.
pub(super) fn work(node: &Node) -> f64 {
    let size = (node.own.len() + node.pattern.len()) as f64;
    node.products() + MOVING * size * size
}

/// Divides an elimination tree into parts. A small tree, or a tree without branches, has one part.
pub(super) fn partition(nodes: &[Node]) -> Partition {
    let work: Vec<f64> = nodes.iter().map(work).collect();
    let total: f64 = work.iter().sum();
    let whole = || {
        let parts = vec![(0..nodes.len()).collect()];
        Partition { parts, total, critical: total }
    };
    if total < LEAST_WORK {
        return whole();
    }
    let (mut of_subtree, mut children) = (work.clone(), vec![Vec::new(); nodes.len() + 1]);
    for (k, node) in nodes.iter().enumerate() {
        children[node.parent].push(k);
        if node.parent < nodes.len() {
            of_subtree[node.parent] += of_subtree[k];
        }
    }
    let mut roots = children[nodes.len()].clone();
    let (mut rest, mut best) = (0.0, (WORTHWHILE * total, None));
    for _ in 0..MOST_SPLITS {
        roots.sort_by(|&a, &b| of_subtree[b].total_cmp(&of_subtree[a]));
        let (shares, largest) = shares(&roots, &of_subtree);
        if rest + largest < best.0 {
            best = (rest + largest, Some(shares));
        }
        let Some((&first, others)) = roots.split_first() else { break };
        rest += work[first];
        roots = [&children[first][..], others].concat();
    }
    let (critical, Some(shares)) = best else { return whole() };
    let mut part_of = vec![PARTS; nodes.len()];
    for (part, share) in shares.iter().enumerate() {
        share.iter().for_each(|&root| part_of[root] = part);
    }
    // Parents come after their children.
    for (k, node) in nodes.iter().enumerate().rev() {
        if let Some(&of_parent) = part_of.get(node.parent).filter(|part| **part < PARTS) {
            part_of[k] = of_parent;
        }
    }
    let mut parts = vec![Vec::new(); PARTS + 1];
    part_of.iter().enumerate().for_each(|(k, &part)| parts[part].push(k));
    let last = parts.pop();
    parts.retain(|part| !part.is_empty());
    parts.extend(last);
    Partition { parts, total, critical }
}

/// Distributes subtrees, the largest first, over the parts, and returns the work of the largest
/// part.
fn shares(roots: &[usize], of_subtree: &[f64]) -> (Vec<Vec<usize>>, f64) {
    let mut shares = vec![(0.0_f64, Vec::new()); PARTS];
    for &root in roots {
        if let Some((work, share)) = shares.iter_mut().min_by(|a, b| a.0.total_cmp(&b.0)) {
            *work += of_subtree[root];
            share.push(root);
        }
    }
    let largest = shares.iter().map(|(work, _)| *work).fold(0.0, f64::max);
    (shares.into_iter().map(|(_, share)| share).collect(), largest)
}
