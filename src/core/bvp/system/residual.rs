//! Left-hand sides of the discretised equations, and their directional derivatives.

use super::discretisation::DiscretisedProblem;
use super::phase::Phase;
use super::work::{Work, gather_ends};
use crate::core::bvp::erased::Number;
use crate::core::failure::{Failure, not_finite};

/// Computes all left-hand sides for the solution loaded in `work`, and writes them into the field
/// `r` of `work`.
pub(super) fn residual<T: Number>(
    equations: &DiscretisedProblem,
    phase: &Phase,
    work: &mut Work<T>,
) -> Result<(), Failure> {
    residual_inside(equations, work)?;
    residual_beside(equations, phase, work)
}

/// Computes the left-hand sides of the equations of all intervals.
pub(super) fn residual_inside<T: Number>(
    equations: &DiscretisedProblem,
    work: &mut Work<T>,
) -> Result<(), Failure> {
    let Work { nodes, numbers, r, local, .. } = work;
    for (s, j) in equations.layout.intervals() {
        let interval = equations.interval((s, j), nodes, numbers);
        let r = &mut r[equations.layout.equations(s, j)];
        equations.method.residual(interval, &mut local.method, r)?;
    }
    Ok(())
}

/// Computes the left-hand sides of boundary, integral and phase conditions.
pub(super) fn residual_beside<T: Number>(
    equations: &DiscretisedProblem,
    phase: &Phase,
    work: &mut Work<T>,
) -> Result<(), Failure> {
    let layout = &equations.layout;
    let conditions = &mut work.r[layout.conditions()..];
    let (boundary, closing) = conditions.split_at_mut(layout.boundary);
    gather_ends(layout, &work.nodes, &mut work.ends);
    equations.boundary(&work.ends, &work.q, boundary);
    closing.fill(T::zero());
    for (s, j) in layout.intervals() {
        let interval = equations.interval((s, j), &work.nodes, &work.numbers);
        equations.integrals(interval, &mut work.local, &mut closing[..layout.integrals])?;
    }
    if layout.phase {
        closing[layout.integrals] = phase.value(layout, &work.nodes);
    }
    Ok(())
}

/// Computes a directional derivative of all left-hand sides: evaluates them at dual numbers, and
/// takes one part of each result.
pub(super) fn derivative<T: Number>(
    (equations, phase): (&DiscretisedProblem, &Phase),
    work: &mut Work<T>,
    argument: impl Fn(usize) -> T,
    part: fn(&T) -> f64,
    out: &mut [f64],
) -> Result<(), Failure> {
    work.load(&equations.layout, argument);
    residual(equations, phase, work)?;
    out.iter_mut().zip(&work.r).for_each(|(out, r)| *out = part(r));
    let Some(row) = not_finite(out) else { return Ok(()) };
    let q: Vec<f64> = work.q.iter().map(|q| q.real()).collect();
    Err(equations.refusal(row, out[row], &q))
}
