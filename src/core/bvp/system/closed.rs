//! Periodic solutions as closed curves.

use super::discretisation::DiscretisedProblem;
use super::oscillation::Oscillation;
use super::solutions::Solutions;
use super::start::discretisation_of;
use super::work::Work;
use crate::core::bvp::mesh::Mesh;
use crate::core::failure::Failure;
use crate::core::system::Solution;

/// Heuristic: the number of phases that are tried before the best phase is refined.
const PHASES: usize = 64;

impl Solutions {
    /// Computes the amplitude of a cycle about its mean, relative to the amplitude of the last
    /// accepted cycle; `None` for solutions other than autonomous cycles, and for cycles that cannot
    /// be integrated.
    pub fn amplitude(&self, x: &[f64]) -> Option<f64> {
        let layout = &self.equations.layout;
        if !(layout.phase && layout.closes()) || self.phase.reference.len() != x.len() {
            return None;
        }
        let own = Oscillation::of(&self.equations, x)?;
        Some(own.amplitude(self.phase.oscillation.as_ref()?))
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

/// Reduces a time to one period, by subtracting whole periods.
fn wrapped(tau: f64, period: f64) -> f64 {
    let tau = tau.rem_euclid(period);
    if tau < period { tau } else { 0.0 }
}
