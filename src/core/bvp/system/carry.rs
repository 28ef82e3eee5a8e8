//! Transfer of solution vectors from one mesh to another.

use super::discretisation::DiscretisedProblem;
use super::layout::span;
use crate::core::bvp::mesh::Mesh;
use crate::core::numerics::lagrange;

/// Interpolates vectors from the meshes of `equations` onto other meshes, which can have other
/// numbers of intervals; components after the values at nodes are unchanged. The interpolation
/// weights are the same for all states and vectors.
pub(super) fn remesh(equations: &DiscretisedProblem, meshes: &[Mesh], vectors: &mut [Vec<f64>]) {
    let (m, places) = (equations.layout.degree, equations.method.places());
    let before = vectors.to_vec();
    vectors.iter_mut().for_each(Vec::clear);
    // For each new node, the first of `m + 1` old nodes, and their weights.
    let (mut firsts, mut weights) = (Vec::new(), Vec::new());
    for (segment, s) in equations.layout.segments.iter().enumerate() {
        firsts.clear();
        weights.clear();
        let intervals = meshes[segment].intervals();
        for node in 0..=intervals * m {
            let j = (node / m).min(intervals - 1);
            let tau = span(meshes, segment, j).at(places[node - j * m]);
            let (interval, place) = equations.meshes[segment].locate(tau);
            firsts.push(interval * m);
            weights.extend((0..=m).map(|a| lagrange(places, a, place)));
        }
        let values = s.values..s.values + s.states * s.nodes;
        for (vector, before) in vectors.iter_mut().zip(&before) {
            for old in before[values.clone()].chunks_exact(s.nodes) {
                let nodes = firsts.iter().zip(weights.chunks_exact(m + 1));
                vector.extend(nodes.map(|(&first, weights)| {
                    old[first..].iter().zip(weights).map(|(x, w)| x * w).sum::<f64>()
                }));
            }
        }
    }
    let rest = equations.layout.values();
    vectors.iter_mut().zip(&before).for_each(|(new, old)| new.extend_from_slice(&old[rest..]));
}
