//! Solutions on one mesh carried over to another.

use super::equations::{Discretised, Work};
use super::layout::span;
use crate::core::bvp::Mesh;
use crate::core::failure::Failure;
use crate::core::interpolation::lagrange;

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

    /// The values at all nodes, given for each segment and time in units of its duration, and
    /// others behind them.
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

    /// Takes vectors that begin with values at the nodes, ordered as `z`, to the nodes of other
    /// meshes with as many intervals. What follows the values stays.
    pub fn remesh(&self, meshes: &[Mesh], vectors: &mut [Vec<f64>]) {
        let (m, places, before) = (self.layout.degree, self.method.places(), vectors.to_vec());
        // The first of `m + 1` old nodes for each new one, and their weights.
        let (mut firsts, mut weights) = (Vec::new(), Vec::new());
        for (segment, s) in self.layout.segments.iter().enumerate() {
            firsts.clear();
            weights.clear();
            for node in 0..s.nodes {
                let j = (node / m).min(s.intervals - 1);
                let tau = span(meshes, segment, j).at(places[node - j * m]);
                let (interval, place) = self.meshes[segment].locate(tau);
                firsts.push(interval * m);
                weights.extend((0..=m).map(|a| lagrange(places, a, place)));
            }
            let values = s.values..s.values + s.states * s.nodes;
            for (vector, before) in vectors.iter_mut().zip(&before) {
                let of_states = vector[values.clone()].chunks_exact_mut(s.nodes);
                for (new, old) in of_states.zip(before[values.clone()].chunks_exact(s.nodes)) {
                    let nodes = firsts.iter().zip(weights.chunks_exact(m + 1));
                    for (new, (&first, weights)) in new.iter_mut().zip(nodes) {
                        *new = old[first..].iter().zip(weights).map(|(x, w)| x * w).sum();
                    }
                }
            }
        }
    }
}
