//! The deviation of a computed curve from invariance.

use super::curve::{Curve, Side, cubic};
use super::growth::Node;
use super::planar::{Vector, cross, minus, norm, plus};

/// Computes the largest distance between the images of the nodes and the curve through the nodes,
/// which consists of cubic pieces with the derivatives at the nodes, and a line from the saddle to
/// the first node. Returns `None` if no image lies between the saddle and the end of the curve.
pub(super) fn deviation(curve: &Curve, nodes: &[Node]) -> Option<f64> {
    let saddle = curve.local.at(0.0).0;
    let way = match curve.side {
        Side::Unstable => curve.rate,
        Side::Stable => -curve.rate,
    };
    let last = nodes.last()?.t;
    let images = nodes.iter().filter(|node| node.t + way <= last);
    let distances = images.map(|node| {
        let at = curve.image(node.at);
        distance(at, interpolated(saddle, nodes, node.t + way))
    });
    distances.reduce(f64::max)
}

/// Returns the point at `t` of the curve through the nodes, and the tangent at this point.
fn interpolated(saddle: Vector, nodes: &[Node], t: f64) -> (Vector, Vector) {
    let after = nodes.partition_point(|node| node.t < t);
    match (after.checked_sub(1).map(|before| &nodes[before]), nodes.get(after)) {
        (Some(a), Some(b)) => cubic([a.t, b.t], [a.at, b.at], [a.slope, b.slope], t),
        (None, Some(first)) => {
            let chord = minus(first.at, saddle);
            (plus(saddle, (t - first.t).exp(), chord), chord)
        }
        (Some(last), None) => (last.at, last.slope),
        (None, None) => (saddle, [0.0; 2]),
    }
}

/// Returns the distance of a point from a line.
fn distance(at: Vector, (point, tangent): (Vector, Vector)) -> f64 {
    let apart = minus(at, point);
    let size = norm(tangent);
    if size > 0.0 { cross(apart, tangent).abs() / size } else { norm(apart) }
}
