//! Solutions on one mesh carried over to another.

use super::equations::{Discretised, Work};
use super::layout::{Layout, span};
use crate::core::bvp::Mesh;
use crate::core::failure::Failure;
use crate::core::interpolation::lagrange;

/// The weights by which values at new nodes are made of those at old ones.
#[derive(Default)]
pub(super) struct Transfer {
    /// For each new node of all segments the first of `m + 1` old ones.
    first: Vec<usize>,
    /// Their weights.
    weights: Vec<f64>,
    before: Vec<f64>,
}

impl Transfer {
    /// Takes the values with which a vector begins, ordered as `z`, to the new nodes; what follows them
    /// stays.
    pub fn apply(&mut self, layout: &Layout, vector: &mut [f64]) {
        let mut node = 0;
        for s in &layout.segments {
            let nodes = node..node + s.nodes;
            let weights = self.weights.chunks_exact(layout.degree + 1).skip(node);
            for state in 0..s.states {
                let start = s.values + state * s.nodes;
                let values = &mut vector[start..start + s.nodes];
                values.clone_into(&mut self.before);
                let old = self.first[nodes.clone()].iter().zip(weights.clone());
                for (value, (&first, weights)) in values.iter_mut().zip(old) {
                    *value = self.before[first..].iter().zip(weights).map(|(x, w)| x * w).sum();
                }
            }
            node = nodes.end;
        }
    }
}

impl Discretised {
    /// The states of a segment at a time in units of its duration, at the arguments of `work`.
    pub fn value(
        &self,
        work: &mut Work<f64>,
        segment: usize,
        tau: f64,
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let (interval, place) = self.meshes[segment].locate(tau);
        let interval = self.interval((segment, interval), &work.nodes, &work.numbers);
        self.method.value(interval, place, &mut work.local.method, out)
    }

    /// The values at all nodes, given for each segment and time in units of its duration, and others behind them.
    pub fn sampled<E>(
        &self,
        others: &[f64],
        mut states: impl FnMut(usize, f64, &mut [f64]) -> Result<(), E>,
    ) -> Result<Vec<f64>, E> {
        let mut z = vec![0.0; self.layout.values()];
        for (s, j) in self.layout.intervals() {
            let (span, mut x) = (self.span(s, j), vec![0.0; self.layout.segments[s].states]);
            let nodes = self.layout.order[self.layout.interval(s, j)].chunks_exact(x.len());
            for (place, node) in self.method.places().iter().zip(nodes) {
                states(s, span.at(*place), &mut x)?;
                node.iter().zip(&x).for_each(|(&k, x)| z[k] = *x);
            }
        }
        z.extend_from_slice(others);
        Ok(z)
    }

    /// `x = (z, p)` on the nodes of another discretisation.
    pub fn carried(&self, onto: &Discretised, x: &[f64]) -> Result<Vec<f64>, Failure> {
        let mut work: Work<f64> = Work::new(&self.layout);
        work.load(&self.layout, |i| x[i]);
        let others = &x[self.layout.values()..];
        onto.sampled(others, |segment, tau, out| self.value(&mut work, segment, tau, out))
    }

    /// From the polynomials through the nodes of these meshes to the nodes of others with as many intervals.
    pub fn transfer(&self, meshes: &[Mesh]) -> Transfer {
        let (m, places) = (self.layout.degree, self.method.places());
        let mut transfer = Transfer::default();
        for (segment, s) in self.layout.segments.iter().enumerate() {
            for node in 0..s.nodes {
                let j = (node / m).min(s.intervals - 1);
                let tau = span(meshes, segment, j).at(places[node - j * m]);
                let (interval, place) = self.meshes[segment].locate(tau);
                transfer.first.push(interval * m);
                transfer.weights.extend((0..=m).map(|a| lagrange(places, a, place)));
            }
        }
        transfer
    }
}
