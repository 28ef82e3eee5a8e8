//! Periodic solutions as closed curves.

use super::discretisation::DiscretisedProblem;
use super::solutions::Solutions;
use super::start::discretisation_of;
use super::work::Work;
use crate::core::bvp::erased::Number;
use crate::core::bvp::mesh::Mesh;
use crate::core::failure::Failure;
use crate::core::linalg::largest;
use crate::core::numerics::node_weights;
use crate::core::problem::FieldIn;
use crate::core::system::Solution;

/// Heuristic: the number of phases that are tried before the best phase is refined.
const PHASES: usize = 64;

/// Heuristic: two oscillations count as having different shapes if the absolute value of their
/// correlation is smaller than this bound.
const ALIKE: f64 = 0.9;

/// Discretisation: a state counts as constant if its oscillation, relative to the largest value of
/// any state, is smaller than this bound.
const STILL: f64 = 1e-9;

impl Solutions {
    /// Computes the amplitude of a cycle about its mean, relative to the amplitude of the last
    /// accepted cycle.
    pub fn amplitude(&self, x: &[f64]) -> Option<f64> {
        let layout = &self.equations.layout;
        if !(layout.phase && layout.closes()) || self.phase.reference.len() != x.len() {
            return None;
        }
        let s = &layout.segments[0];
        if s.nodes == 2 {
            return Some(self.amplitude_of_motion(x));
        }
        let (weights, reference) = (time_weights(&self.equations), &self.phase.reference);
        let of_state = |state: usize| {
            let values = s.values + state * s.nodes..s.values + (state + 1) * s.nodes;
            let (x, r) = (
                about_mean(&x[values.clone()], &weights),
                about_mean(&reference[values], &weights),
            );
            let size = largest(&r);
            let value = reference[s.values + state * s.nodes].abs();
            let product = |a: &[f64], b: &[f64]| -> f64 {
                a.iter().zip(b).zip(&weights).map(|((a, b), w)| a * b * w).sum()
            };
            (size, value, [product(&x, &r), product(&r, &r), product(&x, &x)])
        };
        let states: Vec<(f64, f64, [f64; 3])> = (0..s.states).map(of_state).collect();
        let largest = states.iter().fold(0.0, |most: f64, state| most.max(state.0).max(state.1));
        let mut sums = [0.0; 3];
        for (size, _, products) in states.into_iter().filter(|state| state.0 > STILL * largest) {
            sums.iter_mut().zip(products).for_each(|(sum, part)| *sum += part / (size * size));
        }
        Some(signed(sums))
    }

    /// Computes the amplitude of a cycle that is discretised by single shooting; the amplitude is
    /// computed from the vector field at the cycle's start, because both nodes have the same state.
    /// The phase condition keeps the start of the cycle on a line through the equilibrium.
    fn amplitude_of_motion(&self, x: &[f64]) -> f64 {
        let [own, reference] = [x, &self.phase.reference].map(|x| first_motion(&self.equations, x));
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum();
        signed([product(&own, &reference), product(&reference, &reference), product(&own, &own)])
    }

    /// Returns the period of a cycle; `None` if a forcing prescribes the period.
    pub fn free_period(&self, x: &[f64]) -> Option<f64> {
        let layout = &self.equations.layout;
        if !layout.phase && layout.cycle != Some(false) {
            return None;
        }
        let q: Vec<f64> = (0..layout.numbers()).map(|k| x[layout.number(k)]).collect();
        let mut numbers = Vec::new();
        layout.spread(&q, &mut numbers);
        Some(self.equations.duration(&numbers, |_| true))
    }

    /// Returns copies of a saved solution on the current meshes, one for each segment or phase at
    /// which the solution can begin on a branch.
    pub fn images(&self, solution: &Solution, near: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
        let (equations, layout) = (&self.equations, &self.equations.layout);
        let (method, meshes) = discretisation_of(equations, solution)?;
        if method.to_string() != equations.method.to_string() {
            return Ok(Vec::new());
        }
        let mut saved = Saved::new(equations, meshes, solution)?;
        if layout.phase && layout.closes() {
            let shift = saved.best_phase(self)?;
            return Ok(vec![saved.shifted(equations, shift)?]);
        }
        let segments = layout.segments.len();
        let (near, mut images) = (&near[layout.values()..layout.dimension], Vec::new());
        for turn in 0..segments {
            if let Some(extras) = saved.rotated(turn, near) {
                images.push(saved.on(equations, &extras, (turn, 0.0))?);
            }
        }
        if images.is_empty() {
            let periods =
                if segments == 1 { equations.meshes[0].end().round() as usize } else { 1 };
            return (0..periods).map(|k| saved.shifted(equations, k as f64)).collect();
        }
        Ok(images)
    }
}

/// Returns the vector field at the start of the first segment.
fn first_motion(equations: &DiscretisedProblem, x: &[f64]) -> Vec<f64> {
    let (layout, s) = (&equations.layout, &equations.layout.segments[0]);
    let start: Vec<f64> = (0..s.states).map(|i| x[s.values + i * s.nodes]).collect();
    let q: Vec<f64> = (0..layout.numbers()).map(|k| x[layout.number(k)]).collect();
    let mut motion = vec![0.0; s.states];
    let field = f64::residual(&*equations.problem).on_segment(0, &q);
    field.slope(0.0, &start, &q, &mut motion);
    motion
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

/// A saved solution on its own meshes.
struct Saved {
    equations: DiscretisedProblem,
    /// The buffers into which the saved solution is loaded.
    work: Work<f64>,
    extras: Vec<f64>,
    parameters: Vec<f64>,
}

impl Saved {
    fn new(like: &DiscretisedProblem, meshes: Vec<Mesh>, from: &Solution) -> Result<Self, Failure> {
        let equations = like.on(meshes)?;
        let layout = &equations.layout;
        let (mut work, p) = (Work::new(layout), &from.parameters);
        let (states, extras) = (&from.state, from.state[layout.values()..].to_vec());
        work.load(layout, |i| states.get(i).copied().unwrap_or_else(|| p[i - states.len()]));
        Ok(Saved { equations, work, extras, parameters: p.clone() })
    }

    /// Returns the extra unknowns of the saved solution after the solution is rewritten to begin
    /// with a later segment; the start time is chosen so that the extra unknowns are nearest to
    /// `near`.
    fn rotated(&self, segments: usize, near: &[f64]) -> Option<Vec<f64>> {
        let q = [&self.parameters[..], &self.extras].concat();
        self.equations.problem.itineraries()?.rotated(segments, &q, near)
    }

    /// Returns the solution on other meshes, delayed by a phase shift.
    fn shifted(&mut self, onto: &DiscretisedProblem, shift: f64) -> Result<Vec<f64>, Failure> {
        let extras = self.extras.clone();
        self.on(onto, &extras, (0, shift))
    }

    /// Returns the phase shift with which the cycle satisfies the phase condition best.
    fn best_phase(&mut self, of: &Solutions) -> Result<f64, Failure> {
        let (layout, reference) = (&of.equations.layout, &of.phase.reference);
        let width = self.equations.meshes[0].end() / PHASES as f64;
        let (mut best, mut least) = (0.0, f64::INFINITY);
        for k in 0..PHASES {
            let z = self.shifted(&of.equations, k as f64 * width)?;
            let distance: f64 =
                z[..layout.values()].iter().zip(reference).map(|(z, r)| (z - r).powi(2)).sum();
            if distance < least {
                (best, least) = (k as f64 * width, distance);
            }
        }
        let (mut a, mut fa) = (best - width, self.phase_at(of, best - width)?);
        let mut b = best + width;
        for _ in 0..12 {
            let fb = self.phase_at(of, b)?;
            if fb == fa || fb == 0.0 {
                break;
            }
            let next = (b - fb * (b - a) / (fb - fa)).clamp(best - width, best + width);
            (a, fa) = (b, fb);
            let moved = (next - b).abs();
            b = next;
            if moved < 1e-13 * width {
                break;
            }
        }
        Ok(b)
    }

    /// Returns the left-hand side of the phase condition at a phase shift.
    fn phase_at(&mut self, of: &Solutions, shift: f64) -> Result<f64, Failure> {
        let (z, layout) = (self.shifted(&of.equations, shift)?, &of.equations.layout);
        let nodes: Vec<f64> = layout.order.iter().map(|&k| z[k]).collect();
        Ok(of.phase.value(layout, &nodes))
    }

    /// Returns the solution on other meshes with other extra unknowns; the solution begins with a
    /// later segment or is delayed by a phase shift.
    fn on(
        &mut self,
        onto: &DiscretisedProblem,
        extras: &[f64],
        (turn, shift): (usize, f64),
    ) -> Result<Vec<f64>, Failure> {
        let Saved { equations, work, .. } = self;
        let (count, end) = (equations.meshes.len(), equations.meshes[0].end());
        onto.at_nodes(extras, |segment, tau, out| {
            // The states jump between the end of a segment and its start.
            let tau = if shift == 0.0 { tau } else { wrapped(tau + shift, end) };
            equations.value(work, (segment + turn) % count, tau, out)
        })
    }
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

/// Reduces a time to one period, by subtracting whole periods.
fn wrapped(tau: f64, period: f64) -> f64 {
    let tau = tau.rem_euclid(period);
    if tau < period { tau } else { 0.0 }
}
