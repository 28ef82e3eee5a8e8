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
                self.before.clear();
                self.before.extend_from_slice(values);
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
    /// The states at a place in an interval, at the arguments of `work`.
    pub fn value(
        &self,
        work: &mut Work<f64>,
        (segment, interval): (usize, usize),
        place: f64,
        out: &mut [f64],
    ) -> Result<(), Failure> {
        let nodes = &work.nodes[self.layout.interval(segment, interval)];
        let q = &work.numbers[self.layout.local(segment)];
        let interval = self.interval((segment, interval), nodes, q);
        self.method.value(interval, place, &mut work.local.method, out)
    }

    /// `x = (z, p)` on the nodes of another discretisation.
    pub fn carried(&self, onto: &Discretised, x: &[f64]) -> Result<Vec<f64>, Failure> {
        let mut out = vec![0.0; onto.layout.values()];
        out.extend_from_slice(&x[self.layout.values()..]);
        let mut work: Work<f64> = Work::new(&self.layout);
        work.load(&self.layout, |i| x[i]);
        for (s, j) in onto.layout.intervals() {
            let (span, n) = (onto.span(s, j), onto.layout.segments[s].states);
            let mut states = vec![0.0; n];
            let nodes = onto.layout.order[onto.layout.interval(s, j)].chunks_exact(n);
            for (place, node) in onto.method.places().iter().zip(nodes) {
                let tau = span.start + (span.end - span.start) * place;
                let (interval, place) = self.meshes[s].locate(tau);
                self.value(&mut work, (s, interval), place, &mut states)?;
                node.iter().zip(&states).for_each(|(&z, state)| out[z] = *state);
            }
        }
        Ok(out)
    }

    /// From the polynomials through the nodes of these meshes to the nodes of others with as many intervals.
    pub fn transfer(&self, meshes: &[Mesh]) -> Transfer {
        let (m, places) = (self.layout.degree, self.method.places());
        let mut transfer = Transfer::default();
        for (segment, s) in self.layout.segments.iter().enumerate() {
            for node in 0..s.nodes {
                let j = (node / m).min(s.intervals - 1);
                let span = span(meshes, segment, j);
                let tau = span.start + (span.end - span.start) * places[node - j * m];
                let (interval, place) = self.meshes[segment].locate(tau);
                transfer.first.push(interval * m);
                transfer.weights.extend((0..=m).map(|a| lagrange(places, a, place)));
            }
        }
        transfer
    }
}
