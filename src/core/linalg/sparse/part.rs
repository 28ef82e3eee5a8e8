//! Elimination of a part of the elimination tree.

use super::super::lu::Entry;
use super::front::Front;
use super::matrix::Matrix;
use super::node::Node;
use super::tree::Tree;
use super::triangles::Triangles;
use std::mem::take;
use std::ops::Range;

/// The Schur complement of a node's front, which is added to the front of the node's parent.
#[derive(Clone, Debug, Default)]
struct Rest<E> {
    /// The position of the node in the tree.
    node: usize,
    entries: Vec<E>,
    /// The indices of the rows and columns of the Schur complement.
    lists: [Vec<usize>; 2],
    /// The number of leading rows and columns that are fully summed but were not eliminated,
    /// because their pivots were too small.
    delayed: usize,
}

/// A matrix, and the tree by which it is eliminated.
pub(super) struct Job<'a, E> {
    pub tree: &'a Tree,
    pub matrix: &'a Matrix<'a, E>,
    /// The number of rows of the matrix without its border.
    pub size: usize,
    /// The factors by which rows and columns are scaled.
    pub scales: &'a [Vec<f64>; 2],
}

impl<E> Clone for Job<'_, E> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<E> Copy for Job<'_, E> {}

/// A part of the elimination tree: its factors, and memory for computing the factors.
#[derive(Default)]
pub(super) struct Part<E> {
    pub triangles: Triangles<E>,
    /// The position of each row and of each column in the current front.
    local: [Vec<usize>; 2],
    /// Runs of consecutive rows of a child's Schur complement, with their positions in the current
    /// front.
    runs: Vec<Range<usize>>,
    /// The Schur complements of the children of each node.
    rests: Vec<Vec<Rest<E>>>,
    pool: Vec<Rest<E>>,
    front: Vec<E>,
}

impl<E: Entry> Part<E> {
    /// Eliminates the nodes of this part, and all remaining columns if the part is the `last`.
    pub fn factor(&mut self, job: Job<E>, nodes: &[usize], last: bool) {
        nodes.iter().for_each(|&k| self.eliminate(job, k));
        if last {
            self.eliminate(job, job.tree.nodes.len());
        }
        self.triangles.close(&mut self.local);
    }

    /// Prepares a factorisation of a matrix with `size` rows, including its border.
    pub fn prepare(&mut self, size: usize, nodes: usize) {
        self.triangles.clear();
        self.local.iter_mut().for_each(|local| local.resize(size, 0));
        self.rests.resize_with(nodes + 1, Vec::new);
    }

    /// Takes the Schur complements that other parts have left for this part, in the order of the
    /// nodes of the tree.
    pub fn take_rests(&mut self, others: &mut [Part<E>]) {
        for (k, rests) in self.rests.iter_mut().enumerate() {
            others.iter_mut().for_each(|other| rests.append(&mut other.rests[k]));
            rests.sort_by_key(|rest| rest.node);
        }
    }

    /// Gives memory for Schur complements back to the other parts.
    pub fn give_memory(&mut self, others: &mut [Part<E>]) {
        let spare = self.pool.len() / (others.len() + 1);
        for other in others {
            other.pool.extend(self.pool.drain(self.pool.len() - spare..));
        }
    }

    /// Assembles the frontal matrix (the front) of a node of the elimination tree, eliminates
    /// columns with acceptable pivots, and passes the remaining columns to the front of the parent
    /// node. If the tree has no such node, eliminates all remaining columns: the columns of the
    /// border, and columns that were delayed because they had no acceptable pivot.
    fn eliminate(&mut self, job: Job<E>, k: usize) {
        let Job { tree, matrix, size: n, .. } = job;
        let (node, m) = (tree.nodes.get(k), matrix.border.width);
        let children = take(&mut self.rests[k]);
        let (own, pattern) = node.map_or((&[][..], &[][..]), |node| (&node.own, &node.pattern));
        let lists = &mut self.triangles.lists;
        let from = lists[0].len();
        for (side, list) in lists.iter_mut().enumerate() {
            list.extend(own);
            children.iter().for_each(|child| list.extend(&child.lists[side][..child.delayed]));
            list.extend(pattern);
            list.extend(n..n + m);
        }
        let size = lists[0].len() - from;
        let summed = if node.is_some() { size - m - pattern.len() } else { size };
        self.assemble(job, from, summed - own.len(), node);
        if !children.is_empty() {
            for (local, list) in self.local.iter_mut().zip(&self.triangles.lists) {
                list[from..].iter().enumerate().for_each(|(at, &v)| local[v] = at);
            }
        }
        for child in children {
            self.add(size, &child);
            self.pool.push(child);
        }
        let [rows, columns] = &mut self.triangles.lists;
        let (rows, columns) = (&mut rows[from..], &mut columns[from..]);
        let entries = &mut self.front[..size * size];
        let diagonal = matrix.diagonal;
        let pivots = Front { entries, rows, columns, summed, width: m, diagonal }.eliminate();
        self.triangles.keep(&self.front, from, pivots);
        if let Some(node) = node {
            self.leave(from, [pivots, summed], [k, node.parent]);
        }
    }

    /// Clears a front (frontal matrix) whose row and column lists begin at `from`, and adds the
    /// matrix entries of a node and of the border. In the row and column lists of the front,
    /// delayed columns come after the node's own columns and before the node's pattern.
    fn assemble(&mut self, job: Job<E>, from: usize, delayed: usize, node: Option<&Node>) {
        let (matrix, [rows, columns]) = (job.matrix, &self.triangles.lists);
        let (rows, columns) = (&rows[from..], &columns[from..]);
        let (size, m) = (rows.len(), matrix.border.width);
        self.front.clear();
        self.front.resize(size * size, E::default());
        let [row_scales, column_scales] = job.scales;
        let mut put = |i: usize, j: usize, a: E| {
            self.front[j * size + i] +=
                a * E::from_real(row_scales[rows[i]] * column_scales[columns[j]]);
        };
        let (border, shift) = (&matrix.border, matrix.on_diagonal());
        let first = size - m;
        let Some(node) = node else {
            for i in 0..m {
                (0..m).for_each(|k| put(first + i, first + k, (border.corner)(i, k)));
            }
            return;
        };
        let own = node.own.len();
        let place = |at: u32| if (at as usize) < own { at as usize } else { at as usize + delayed };
        for &[k, i, j] in &node.entries {
            put(place(i), place(j), matrix.entry(k as usize));
        }
        for (at, &v) in node.own.iter().enumerate() {
            put(at, at, -shift);
            for k in 0..m {
                put(first + k, at, (border.row)(k, v));
                put(at, first + k, (border.column)(v, k));
            }
        }
    }

    /// Adds the Schur complement of a child node to the parent's front (frontal matrix), which has
    /// the given size; `local` contains the positions of rows and columns in this front.
    fn add(&mut self, size: usize, child: &Rest<E>) {
        let [rows, columns] = &child.lists;
        self.runs.clear();
        for &row in rows {
            let at = self.local[0][row];
            match self.runs.last_mut() {
                Some(run) if run.end == at => run.end += 1,
                _ => self.runs.push(at..at + 1),
            }
        }
        let entries = child.entries.chunks_exact(rows.len().max(1));
        for (&column, mut entries) in columns.iter().zip(entries) {
            let target = &mut self.front[self.local[1][column] * size..][..size];
            for run in &self.runs {
                let (own, rest) = entries.split_at(run.len());
                let target = &mut target[run.clone()];
                for i in 0..own.len() {
                    target[i] += own[i];
                }
                entries = rest;
            }
        }
    }

    /// Passes the rows and columns that were not eliminated in a front (frontal matrix) to the
    /// parent's front; the lists of the front begin at `from`.
    fn leave(&mut self, from: usize, [pivots, summed]: [usize; 2], [node, parent]: [usize; 2]) {
        let lists = &mut self.triangles.lists;
        let size = lists[0].len() - from;
        if pivots == size {
            return;
        }
        let mut rest = self.pool.pop().unwrap_or_default();
        (rest.node, rest.delayed) = (node, summed - pivots);
        for (to, list) in rest.lists.iter_mut().zip(lists) {
            to.clear();
            to.extend_from_slice(&list[from + pivots..]);
            if pivots == 0 {
                list.truncate(from);
            }
        }
        rest.entries.clear();
        for column in self.front[pivots * size..].chunks_exact(size) {
            rest.entries.extend_from_slice(&column[pivots..]);
        }
        self.rests[parent].push(rest);
    }
}
