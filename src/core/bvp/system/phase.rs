//! The phase condition of autonomous periodic orbits.

use super::discretisation::DiscretisedProblem;
use super::layout::UnknownLayout;
use super::oscillation::Oscillation;
use super::work::Work;
use crate::core::bvp::erased::Number;
use crate::core::bvp::interval::placed;
use crate::core::bvp::method::Method;
use crate::core::failure::{Failure, not_finite};
use crate::core::linalg::largest;
use crate::core::numerics::node_weights;
use crate::core::problem::FieldIn;
use crate::core::scalar::Scalar;

/// The phase condition `Σ_k w_k ⟨ẋ_k, x_k − x̂_k⟩ = 0`, with a reference solution `x̂` and the
/// quadrature weights `w` of the nodes. For shooting, whose nodes are few, each state of the inner
/// product is divided by its size in the oscillation of the reference solution: a product that one
/// state dominates would have no solution where the cycles shrink. The phase condition is inactive
/// until a reference solution is set.
#[derive(Clone, Debug, Default)]
pub(super) struct Phase {
    /// The reference solution, as `x = (z, p)`; empty before it is set.
    pub reference: Vec<f64>,
    /// The oscillation of the reference solution; `None` before the solution is set, and for motions
    /// that cannot be integrated.
    pub oscillation: Option<Oscillation>,
    /// The time derivative `dx/dτ` of the reference solution at the first node.
    pub motion: Vec<f64>,
    /// The gradient of the phase condition, with the entries `w_k ẋ_k`, node by node.
    pub row: Vec<f64>,
}

impl Phase {
    /// Computes the left-hand side of the phase condition.
    pub fn value<T: Scalar>(&self, layout: &UnknownLayout, nodes: &[T]) -> T {
        let mut sum = T::zero();
        for ((row, x), &z) in self.row.iter().zip(nodes).zip(&layout.order) {
            sum += (*x - self.reference[z]) * *row;
        }
        sum
    }

    /// Makes `x = (z, p)` the reference solution.
    pub fn refer_to(
        &mut self,
        equations: &DiscretisedProblem,
        x: &[f64],
        work: &mut Work<f64>,
    ) -> Result<(), Failure> {
        if !equations.layout.phase {
            return Ok(());
        }
        work.load(&equations.layout, |i| x[i]);
        let motion = motion(equations, work)?;
        self.refer_to_motion(equations, x, &motion);
        Ok(())
    }

    /// Makes `x = (z, p)` the reference solution, with a given time derivative (in the order of
    /// `z`), which can differ from the time derivative of this solution.
    pub fn refer_to_motion(&mut self, equations: &DiscretisedProblem, x: &[f64], motion: &[f64]) {
        let layout = &equations.layout;
        let weights = node_weights(equations.method.places());
        let mut row = vec![0.0; layout.values()];
        for (s, j) in layout.intervals() {
            let (span, n) = (equations.span(s, j), layout.segments[s].states);
            let (h, nodes) = (span.end - span.start, layout.interval(s, j));
            let rows = row[nodes.clone()].chunks_exact_mut(n);
            for ((row, order), weight) in
                rows.zip(layout.order[nodes].chunks_exact(n)).zip(&weights)
            {
                row.iter_mut().zip(order).for_each(|(r, &z)| *r += h * weight * motion[z]);
            }
        }
        self.motion =
            layout.order[..layout.segments[0].states].iter().map(|&z| motion[z]).collect();
        self.oscillation = Oscillation::of(equations, x);
        if matches!(equations.method, Method::Shooting(_)) {
            self.scale(&mut row);
        }
        // The sign of the condition is arbitrary, but is kept: the sign of the determinant detects
        // branch points.
        let along: f64 = row.iter().zip(&self.row).map(|(new, old)| new * old).sum();
        if along < 0.0 {
            row.iter_mut().for_each(|r| *r = -*r);
        }
        self.row = row;
        x.clone_into(&mut self.reference);
    }

    /// Divides the entries of each state by the square of the state's size; the largest entry keeps its
    /// size. An equilibrium has no sizes.
    fn scale(&self, row: &mut [f64]) {
        let Some(sizes) = self.oscillation.as_ref().and_then(Oscillation::sizes) else { return };
        let before = largest(row);
        for states in row.chunks_exact_mut(sizes.len()) {
            for (entry, size) in states.iter_mut().zip(&sizes) {
                *entry /= size * size;
            }
        }
        let scaled = largest(row);
        if scaled > 0.0 {
            row.iter_mut().for_each(|entry| *entry *= before / scaled);
        }
    }
}

/// Computes the time derivative `dx/dτ` at all nodes, in the order of `z`, for the solution loaded
/// in `work`.
fn motion(equations: &DiscretisedProblem, work: &mut Work<f64>) -> Result<Vec<f64>, Failure> {
    let (layout, places) = (&equations.layout, equations.method.places());
    let mut motion = vec![0.0; layout.values()];
    for (s, j) in layout.intervals() {
        let (span, n) = (equations.span(s, j), layout.segments[s].states);
        let q = &work.numbers[layout.local(s)];
        let duration = equations.duration_of(s, q);
        let field = f64::residual(&*equations.problem).on_segment(s, q);
        let f = &mut work.local.x[..n];
        let nodes = layout.interval(s, j);
        let values = work.nodes[nodes.clone()].chunks_exact(n);
        for ((place, x), order) in
            places.iter().zip(values).zip(layout.order[nodes].chunks_exact(n))
        {
            let t = duration * span.at(*place);
            field.domain(x, q).map_err(|cause| placed(cause, s, t))?;
            field.slope(t, x, q, f);
            if let Some(i) = not_finite(f) {
                return Err(placed(equations.not_finite(s, i, f[i]), s, t));
            }
            order.iter().zip(f.iter()).for_each(|(&z, f)| motion[z] = duration * f);
        }
    }
    Ok(motion)
}
