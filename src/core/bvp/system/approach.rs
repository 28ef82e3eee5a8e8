//! The distance of a cycle from an equilibrium.

use super::rest::jacobian;
use super::solutions::Solutions;
use super::work::Work;
use crate::core::bvp::erased::Number;
use crate::core::numerics::extremum;
use crate::core::problem::FieldIn;
use crate::core::system::Approach;
use faer::MatRef;
use nalgebra::{DMatrix, DVector};

/// Rounding: a matrix counts as singular in directions whose singular values are below this
/// fraction of the largest singular value.
const SINGULAR: f64 = 1e-13;

/// Rounding: a state whose range is at most this fraction of its size counts as constant up to
/// rounding errors; an example is the coordinate normal to an invariant surface in which the orbit
/// lies. The extent of a constant state is this fraction of its size.
const ROUNDING: f64 = 1e-10;

/// Heuristic: a real eigenvalue counts as zero if it is smaller than this fraction of the largest
/// eigenvalue.
const WEAK: f64 = 1e-2;

impl Solutions {
    /// Estimates the distance of a cycle with a free period from the nearest equilibrium, by one
    /// Newton correction from each node; returns this distance, the extents (ranges) of the states,
    /// and whether the equilibrium is a saddle, according to the Jacobian at the nearest node.
    pub fn approach(&mut self, x: &[f64]) -> Option<Approach> {
        self.free_period(x)?;
        self.load(x);
        let extents = self.extents();
        let Solutions { equations, plain, .. } = self;
        let Work { nodes, numbers, .. } = &*plain;
        let (mut distance, mut nearest) = (f64::INFINITY, None);
        for (segment, s) in equations.layout.segments.iter().enumerate() {
            let q = &numbers[equations.layout.local(segment)];
            let field = f64::residual(&*equations.problem).on_segment(segment, q);
            let mut slope = vec![0.0; s.states];
            for x in nodes[s.values..s.values + s.nodes * s.states].chunks_exact(s.states) {
                field.slope(0.0, x, q, &mut slope);
                let Ok(entries) = jacobian(&*equations.problem, segment, x, q) else { continue };
                let matrix = DMatrix::from_column_slice(s.states, s.states, &entries);
                // Motion on a surface gives no information about deviations across it: the matrix is
                // singular there, and the shortest correction is used.
                let singular = matrix.svd(true, true);
                let least = SINGULAR * singular.singular_values.max();
                let Ok(way) = singular.solve(&DVector::from_column_slice(&slope), least) else {
                    continue;
                };
                let parts = way.iter().zip(&extents[s.ends..]).map(|(d, extent)| d.abs() / extent);
                let here = parts.fold(0.0, f64::max);
                if here < distance {
                    (distance, nearest) = (here, Some(entries));
                }
            }
        }
        let is_saddle = nearest.is_some_and(|entries| is_saddle(&entries));
        distance.is_finite().then_some(Approach { distance, extents, is_saddle })
    }

    /// Returns the range of each state of each segment, from parabolas through the nodes.
    fn extents(&self) -> Vec<f64> {
        let Solutions { equations, plain, .. } = self;
        let (layout, places) = (&equations.layout, equations.method.places());
        let mut extents = Vec::new();
        for (segment, s) in layout.segments.iter().enumerate() {
            let times = (0..s.intervals).flat_map(|j| {
                let span = equations.span(segment, j);
                places[..layout.degree].iter().map(move |place| span.at(*place))
            });
            let times: Vec<f64> = times.chain([1.0]).collect();
            let nodes = &plain.nodes[s.values..s.values + s.nodes * s.states];
            extents.extend((0..s.states).map(|i| {
                let values = nodes[i..].iter().step_by(s.states);
                let samples: Vec<(f64, f64)> = times.iter().copied().zip(values.copied()).collect();
                extent(&samples)
            }));
        }
        extents
    }
}

/// Whether eigenvalues with real parts of both signs occur among the eigenvalues of a matrix, which is
/// stored column by column. A real eigenvalue near zero, as at a saddle-node, has both signs.
fn is_saddle(entries: &[f64]) -> bool {
    let n = entries.len().isqrt();
    let matrix = MatRef::from_column_major_slice(entries, n, n);
    let Ok(eigenvalues) = matrix.eigenvalues() else { return false };
    let largest = eigenvalues.iter().fold(0.0, |most: f64, l| most.max(l.norm()));
    let mut signs = [false; 2];
    for l in eigenvalues {
        let is_zero = l.im == 0.0 && l.re.abs() < WEAK * largest;
        signs[0] |= l.re > 0.0 || is_zero;
        signs[1] |= l.re < 0.0 || is_zero;
    }
    signs == [true; 2]
}

/// Returns the range of a function that is given by samples.
fn extent(samples: &[(f64, f64)]) -> f64 {
    let turns = samples.windows(3).filter_map(|three| {
        let [before, value, after] = [0, 1, 2].map(|k| three[k].1);
        let turns = (value - before) * (after - value) < 0.0;
        turns.then(|| extremum(three)).flatten().map(|it| it.1)
    });
    let values = samples.iter().map(|it| it.1).chain(turns);
    let [low, high] =
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    (high - low).max(ROUNDING * high.abs().max(low.abs()))
}
