//! Vectors on one mesh carried over to another.

use super::discretisation::DiscretisedProblem;
use super::layout::span;
use crate::core::bvp::mesh::Mesh;
use crate::core::numerics::lagrange;

/// Takes vectors that begin with values at the nodes, ordered as `z`, to the nodes of other
/// meshes with as many intervals. What follows the values stays.
pub(super) fn remesh(equations: &DiscretisedProblem, meshes: &[Mesh], vectors: &mut [Vec<f64>]) {
    let (m, places, before) =
        (equations.layout.degree, equations.method.places(), vectors.to_vec());
    // The first of `m + 1` old nodes for each new one, and their weights.
    let (mut firsts, mut weights) = (Vec::new(), Vec::new());
    for (segment, s) in equations.layout.segments.iter().enumerate() {
        firsts.clear();
        weights.clear();
        for node in 0..s.nodes {
            let j = (node / m).min(s.intervals - 1);
            let tau = span(meshes, segment, j).at(places[node - j * m]);
            let (interval, place) = equations.meshes[segment].locate(tau);
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
