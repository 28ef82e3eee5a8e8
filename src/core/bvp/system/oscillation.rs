//! The oscillation of a cycle about its mean.

use super::discretisation::DiscretisedProblem;
use super::profiles::history;
use super::work::Work;
use crate::core::bvp::mesh::Mesh;
use crate::core::bvp::method::Method;
use crate::core::linalg::largest;
use crate::core::numerics::node_weights;

/// Heuristic: two oscillations count as having different shapes if the absolute value of their
/// correlation is smaller than this bound.
const ALIKE: f64 = 0.9;

/// Discretisation: a state counts as constant if its oscillation, relative to the largest value of
/// any state, is smaller than this bound; all states are in units of their scales.
const STILL: f64 = 1e-9;

/// Heuristic: the smallest size of a state's oscillation, relative to the largest, that counts: at a period
/// doubling, the state that oscillates in the doubled orbits can be constant.
const LEAST: f64 = 1e-3;

/// The oscillation of a cycle.
#[derive(Clone, Debug)]
pub(super) struct Oscillation {
    /// The values of each state over one period, in units of the state's scale.
    states: Vec<Vec<f64>>,
    /// The scales of the states.
    units: Vec<f64>,
    /// The weights of the values in a quadrature over time.
    weights: Vec<f64>,
}

impl Oscillation {
    /// Returns the values at the nodes of the mesh for collocation, and the values along the integrated
    /// motion for shooting, whose nodes are few; `None` if the motion cannot be integrated.
    pub fn of(equations: &DiscretisedProblem, x: &[f64]) -> Option<Self> {
        let (layout, s) = (&equations.layout, &equations.layout.segments[0]);
        let q: Vec<f64> = (0..layout.numbers()).map(|k| x[layout.number(k)]).collect();
        let mut units = equations.problem.scales(0, &q);
        units.resize(s.states, 1.0);
        if matches!(equations.method, Method::Collocation(_)) {
            let values = |i: usize| x[s.values + i * s.nodes..][..s.nodes].iter();
            let states = (0..s.states).map(|i| values(i).map(|x| x / units[i]).collect()).collect();
            return Some(Oscillation { states, units, weights: time_weights(equations) });
        }
        let mut work = Work::new(&equations.layout);
        work.load(&equations.layout, |i| x[i]);
        let mut history = history(equations, 0, 0.0, &mut work).ok()?;
        // The last value repeats the first.
        history.pop();
        let values = |i: usize| history.iter().map(|values| values[i + 1] / units[i]).collect();
        let states = (0..s.states).map(values).collect();
        Some(Oscillation { states, units, weights: vec![1.0; history.len()] })
    }

    /// Returns the size of each state's oscillation (half the difference between its largest and its
    /// smallest value), but at least [`LEAST`] of the largest size in units of the scales; `None` for an
    /// equilibrium.
    pub fn sizes(&self) -> Option<Vec<f64>> {
        let size = |values: &Vec<f64>| {
            let [low, high] =
                [f64::min, f64::max].map(|of| values.iter().copied().reduce(of).unwrap_or(0.0));
            0.5 * (high - low)
        };
        let values = self.states.iter().map(|values| largest(values)).fold(0.0, f64::max);
        let sizes: Vec<f64> = self.states.iter().map(size).collect();
        let most = largest(&sizes);
        let in_units =
            sizes.iter().zip(&self.units).map(|(size, unit)| size.max(LEAST * most) * unit);
        (most > STILL * values).then(|| in_units.collect())
    }

    /// Returns the signed amplitude relative to a reference oscillation. All states have equal weights:
    /// each state is divided by its largest deviation from its mean in the reference oscillation.
    pub fn amplitude(&self, reference: &Oscillation) -> f64 {
        let weights = &self.weights;
        let product = |a: &[f64], b: &[f64]| -> f64 {
            a.iter().zip(b).zip(weights).map(|((a, b), w)| a * b * w).sum()
        };
        let of_state = |(x, reference): (&Vec<f64>, &Vec<f64>)| {
            let [x, r] = [x, reference].map(|values| about_mean(values, weights));
            let products = [product(&x, &r), product(&r, &r), product(&x, &x)];
            (largest(&r), reference[0].abs(), products)
        };
        let states: Vec<(f64, f64, [f64; 3])> =
            self.states.iter().zip(&reference.states).map(of_state).collect();
        let most = states.iter().fold(0.0, |most: f64, state| most.max(state.0).max(state.1));
        let mut sums = [0.0; 3];
        for (size, _, products) in states.into_iter().filter(|state| state.0 > STILL * most) {
            sums.iter_mut().zip(products).for_each(|(sum, part)| *sum += part / (size * size));
        }
        signed(sums)
    }
}

/// Returns the signed amplitude of an oscillation relative to a reference oscillation, from the
/// inner product of the two oscillations, the squared norm of the reference, and the squared norm
/// of the oscillation. When a branch of cycles passes an equilibrium, the oscillation changes sign,
/// and so does its correlation with the reference oscillation. The absolute value of the amplitude
/// comes from the oscillation's own norm, because the inner product can also vanish if the phases
/// of the two oscillations differ.
fn signed([product, whole, own]: [f64; 3]) -> f64 {
    if whole == 0.0 {
        return 0.0;
    }
    let amplitude = (own / whole).sqrt();
    let opposite = product < -ALIKE * (own * whole).sqrt();
    if opposite { -amplitude } else { amplitude }
}

/// Returns the weights of the values at the nodes of the first segment in a quadrature over its
/// time.
fn time_weights(equations: &DiscretisedProblem) -> Vec<f64> {
    let (m, weights) = (equations.layout.degree, node_weights(equations.method.places()));
    let mesh: &Mesh = &equations.meshes[0];
    let mut sums = vec![0.0; mesh.intervals() * m + 1];
    for (j, ends) in mesh.points().windows(2).enumerate() {
        let nodes = sums[j * m..=(j + 1) * m].iter_mut();
        nodes.zip(&weights).for_each(|(sum, weight)| *sum += (ends[1] - ends[0]) * weight);
    }
    sums
}

/// Subtracts the weighted mean of all values from each value.
fn about_mean(values: &[f64], weights: &[f64]) -> Vec<f64> {
    let whole: f64 = weights.iter().sum();
    let mean = values.iter().zip(weights).map(|(x, w)| x * w).sum::<f64>() / whole;
    values.iter().map(|x| x - mean).collect()
}
