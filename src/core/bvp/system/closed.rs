//! Periodic solutions as closed curves.

use super::BoundarySystem;
use super::discretisation::Discretisation;
use super::layout::Layout;
use crate::core::bvp::{Legs, Mesh};
use crate::core::condition::Failure;
use crate::core::interpolation::node_weights;
use crate::core::solution::{Cycles, Solution};
use crate::core::vector::largest;

/// How many phases are tried before the best one is refined.
const PHASES: usize = 64;

/// A solution repeats itself if its halves differ by less than this, relative to its size.
const REPEATS: f64 = 1e-6;

/// Oscillations with a smaller correlation have different shapes.
const ALIKE: f64 = 0.9;

/// States that oscillate less than this, compared with the largest value of any, are at rest.
const STILL: f64 = 1e-9;

impl Cycles for BoundarySystem {
    fn repeats(&mut self, x: &[f64]) -> bool {
        let segments = self.equations.layout.segments.len();
        let single = segments == 1;
        let halves = segments.is_multiple_of(2) && self.rotated(x, segments / 2, x).is_some();
        if !(single || halves) {
            return false;
        }
        let end = self.meshes()[0].end();
        let (mut size, mut miss) = (0.0_f64, 0.0_f64);
        let most = self.equations.layout.states;
        let mut halves = [vec![0.0; most], vec![0.0; most]];
        self.plain.load(&self.equations.layout, |i| x[i]);
        for k in 0..PHASES {
            let tau = k as f64 / PHASES as f64;
            let (first, second) = match single {
                true => ((0, 0.5 * tau * end), (0, 0.5 * (1.0 + tau) * end)),
                false => {
                    let segment = k * (segments / 2) / PHASES;
                    ((segment, tau), (segment + segments / 2, tau))
                }
            };
            for ((segment, tau), out) in [first, second].into_iter().zip(&mut halves) {
                let states = self.equations.layout.segments[segment].states;
                let out = &mut out[..states];
                if self.equations.value(&mut self.plain, segment, tau, out).is_err() {
                    return false;
                }
            }
            for (a, b) in halves[0].iter().zip(&halves[1]) {
                size = size.max(a.abs());
                miss = miss.max((a - b).abs());
            }
        }
        miss <= REPEATS * size
    }

    fn amplitude(&mut self, x: &[f64]) -> Option<f64> {
        let layout = &self.equations.layout;
        if !(layout.phase && layout.closes()) || self.phase.reference.len() != x.len() {
            return None;
        }
        let (weights, reference) = (time_weights(&self.equations), &self.phase.reference);
        let s = &layout.segments[0];
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
        let [product, whole, own] = sums;
        if whole == 0.0 {
            return Some(0.0);
        }
        // Beyond an equilibrium the oscillation is the same upside down; what is alike neither way
        // is another one.
        let alike = product.abs() > ALIKE * (own * whole).sqrt();
        Some(if alike { product / whole } else { (own / whole).sqrt() })
    }

    fn free_period(&mut self, x: &[f64]) -> Option<f64> {
        let layout = &self.equations.layout;
        if !layout.phase && layout.legs != Some(Legs { forced: false }) {
            return None;
        }
        let q: Vec<f64> = (0..layout.numbers()).map(|k| x[layout.number(k)]).collect();
        let mut numbers = Vec::new();
        layout.spread(&q, &mut numbers);
        Some(self.equations.duration(&numbers, |_| true))
    }
}

impl BoundarySystem {
    /// A saved solution on the present mesh, in each of the phases in which it may be met.
    pub(super) fn images_of(
        &mut self,
        solution: &Solution,
        near: &[f64],
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let (method, meshes) = self.discretisation_of(solution)?;
        if method.to_string() != self.equations.method.to_string() {
            return Ok(Vec::new());
        }
        let mut from = self.on(meshes)?;
        let x = [&solution.state[..], &solution.parameters[..]].concat();
        if self.equations.layout.phase && self.equations.layout.closes() {
            let shift = self.best_phase(&mut from, &x)?;
            return Ok(vec![self.shifted(&mut from, &x, shift)?]);
        }
        let segments = self.equations.layout.segments.len();
        let mut images = Vec::new();
        for turn in 0..segments {
            if let Some(extras) = self.rotated(&x, turn, near) {
                images.push(self.taken_over(&mut from, &x, &extras, (turn, 0.0))?);
            }
        }
        if images.is_empty() {
            let periods = if segments == 1 { self.meshes()[0].end().round() as usize } else { 1 };
            return (0..periods).map(|k| self.shifted(&mut from, &x, k as f64)).collect();
        }
        Ok(images)
    }

    /// The extras of a solution that begins with a later segment instead, near those of another one
    /// in time.
    fn rotated(&self, x: &[f64], segments: usize, near: &[f64]) -> Option<Vec<f64>> {
        let Layout { dimension, .. } = *self.equations.layout;
        let extras = self.equations.layout.values()..dimension;
        let q = [&x[dimension..], &x[extras.clone()]].concat();
        self.problem().itineraries()?.rotated(segments, &q, &near[extras])
    }

    /// A solution on other meshes as one on these, later by a shift.
    fn shifted(
        &self,
        from: &mut BoundarySystem,
        x: &[f64],
        shift: f64,
    ) -> Result<Vec<f64>, Failure> {
        let Layout { dimension, .. } = *from.equations.layout;
        let extras = x[from.equations.layout.values()..dimension].to_vec();
        self.taken_over(from, x, &extras, (0, shift))
    }

    /// A solution on other meshes as one on these, with these extras, that begins with a later
    /// segment or by a shift later.
    fn taken_over(
        &self,
        from: &mut BoundarySystem,
        x: &[f64],
        extras: &[f64],
        (turn, shift): (usize, f64),
    ) -> Result<Vec<f64>, Failure> {
        let (count, end) = (from.meshes().len(), from.meshes()[0].end());
        from.plain.load(&from.equations.layout, |i| x[i]);
        self.equations.sampled(extras, |segment, tau, out| {
            // The states at the end of a leg are not those at its beginning.
            let tau = if shift == 0.0 { tau } else { wrapped(tau + shift, end) };
            from.equations.value(&mut from.plain, (segment + turn) % count, tau, out)
        })
    }

    /// By how much later than it does a cycle is to begin to meet the phase condition.
    fn best_phase(&self, from: &mut BoundarySystem, x: &[f64]) -> Result<f64, Failure> {
        let layout = &self.equations.layout;
        let reference = &self.phase.reference;
        let width = from.meshes()[0].end() / PHASES as f64;
        let (mut best, mut least) = (0.0, f64::INFINITY);
        for k in 0..PHASES {
            let z = self.shifted(from, x, k as f64 * width)?;
            let distance: f64 =
                z[..layout.values()].iter().zip(reference).map(|(z, r)| (z - r).powi(2)).sum();
            if distance < least {
                (best, least) = (k as f64 * width, distance);
            }
        }
        let (mut a, mut fa) = (best - width, self.phase_at(from, x, best - width)?);
        let mut b = best + width;
        for _ in 0..12 {
            let fb = self.phase_at(from, x, b)?;
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

    /// The left side of the phase condition at a shift.
    fn phase_at(&self, from: &mut BoundarySystem, x: &[f64], shift: f64) -> Result<f64, Failure> {
        let z = self.shifted(from, x, shift)?;
        let nodes: Vec<f64> = self.equations.layout.order.iter().map(|&k| z[k]).collect();
        Ok(self.phase.value(&self.equations.layout, &nodes))
    }
}

/// The weights of the values at the nodes of the first segment in an integral over its time.
fn time_weights(equations: &Discretisation) -> Vec<f64> {
    let (m, weights) = (equations.layout.degree, node_weights(equations.method.places()));
    let mesh: &Mesh = &equations.meshes[0];
    let mut sums = vec![0.0; mesh.intervals() * m + 1];
    for (j, ends) in mesh.points().windows(2).enumerate() {
        let nodes = sums[j * m..=(j + 1) * m].iter_mut();
        nodes.zip(&weights).for_each(|(sum, weight)| *sum += (ends[1] - ends[0]) * weight);
    }
    sums
}

/// Values less their mean.
fn about_mean(values: &[f64], weights: &[f64]) -> Vec<f64> {
    let whole: f64 = weights.iter().sum();
    let mean = values.iter().zip(weights).map(|(x, w)| x * w).sum::<f64>() / whole;
    values.iter().map(|x| x - mean).collect()
}

/// A time within a period.
fn wrapped(tau: f64, period: f64) -> f64 {
    let tau = tau.rem_euclid(period);
    if tau < period { tau } else { 0.0 }
}
