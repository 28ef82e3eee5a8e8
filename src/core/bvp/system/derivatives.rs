//! Directional derivatives of the equations, and gradients of directional derivatives.

use super::discretisation::DiscretisedProblem;
use super::joints::add_gradient_of_joints;
use super::layout::UnknownLayout;
use super::local::{Arguments, Dependence, Passes, Weighted};
use super::phase::Phase;
use super::residual::{derivative, residual};
use super::work::Work;
use crate::core::bvp::erased::Number;
use crate::core::bvp::interval::weighted as summed;
use crate::core::failure::{Failure, unknown_order};
use crate::core::problem::{FieldIn, ROOM};
use crate::core::scalar::{CHUNK, Chunk, Directional, Jet, seeded};
use crate::core::system::{Deviation, Expansion, mixed, moving, third};
use num_dual::{Dual, Dual2, Dual64};

/// Scratch space for derivatives of the equations, kept to avoid repeated allocations.
pub(super) struct Derivatives {
    first: Work<Dual64>,
    /// Buffers for second derivatives, created at their first use because they are large; the
    /// fields `third` and `jets` are also created at their first use.
    second: Option<Work<Dual<Chunk>>>,
    third: Option<Work<Dual2<Chunk>>>,
    jets: Option<Work<Jet<ROOM>>>,
    nested: Passes<Dual<Chunk>>,
    nested_twice: Passes<Dual2<Chunk>>,
}

impl Derivatives {
    pub fn new(layout: &UnknownLayout) -> Self {
        Derivatives {
            first: Work::new(layout),
            second: None,
            third: None,
            jets: None,
            nested: Passes::new(layout),
            nested_twice: Passes::new(layout),
        }
    }

    /// Computes the directional derivative of the equations at `x` along one, two or three
    /// directions.
    pub fn along(
        &mut self,
        of: (&DiscretisedProblem, &Phase),
        x: &[f64],
        directions: &[&[f64]],
        out: &mut [f64],
    ) -> Result<(), Failure> {
        match *directions {
            [d] => derivative(of, &mut self.first, |i| Dual64::new(x[i], d[i]), |r| r.eps, out),
            [d, e] => {
                let work = self.second.get_or_insert_with(|| Work::new(&of.0.layout));
                derivative(of, work, |i| moving(x[i], d[i], e[i]), mixed, out)
            }
            [d, e, f] => {
                let work = self.third.get_or_insert_with(|| Work::new(&of.0.layout));
                third([d, e, f], out, |v, w, out| {
                    derivative(of, work, |i| moving(x[i], v[i], w[i]), mixed, out)
                })
            }
            _ => Err(unknown_order(directions.len())),
        }
    }

    /// Computes the Taylor coefficients of all left-hand sides, one for each monomial of a space.
    pub fn expand(
        &mut self,
        (equations, phase): (&DiscretisedProblem, &Phase),
        expansion: &Expansion,
    ) -> Result<Vec<Vec<f64>>, Failure> {
        let work = self.jets.get_or_insert_with(|| Work::new(&equations.layout));
        work.load(&equations.layout, |i| expansion.argument(i));
        residual(equations, phase, work)?;
        expansion.images(&work.r)
    }

    /// Returns the size of a deviation `d` from a solution; the states are integrated over all
    /// segments by the method's own quadrature. In a cycle with events, a deviation shifts the
    /// nodes in time by `δt` together with the events, and the states at a fixed time deviate by
    /// `δx − f δt`.
    pub fn deviation(
        &mut self,
        equations: &DiscretisedProblem,
        x: &[f64],
        d: &[f64],
    ) -> Result<Deviation, Failure> {
        let work = &mut self.first;
        work.load(&equations.layout, |i| Dual64::new(x[i], d[i]));
        let Work { nodes, numbers, local, .. } = work;
        let layout = &equations.layout;
        let duration = equations.duration(numbers, |_| true);
        let (period, lengthening) = (duration.re, duration.eps);
        let mut deviation = Deviation { period, lengthening, ..Deviation::default() };
        for at in layout.intervals() {
            let interval = equations.interval(at, nodes, numbers);
            let begin = layout.cycle.map(|_| interval.q[layout.parameters].eps);
            let (field, f) = (interval.field(), &mut local.x[..layout.segments[at.0].states]);
            equations.method.quadrature(interval, &mut local.method, &mut |weight, time, x| {
                f.fill(Dual64::from(0.0));
                if begin.is_some() {
                    field.slope(time, x, interval.q, f);
                }
                let later = begin.map_or(0.0, |begin| begin + time.eps);
                for (x, f) in x.iter().zip(&*f) {
                    let (deviates, f) = (x.eps - f.re * later, f.re);
                    deviation.square += weight.re * deviates * deviates;
                    deviation.along += weight.re * deviates * f;
                    deviation.motion += weight.re * f * f;
                }
            })?;
        }
        if layout.cycle != Some(false) {
            (deviation.along, deviation.motion) = (0.0, 0.0);
        }
        Ok(deviation)
    }

    /// Considers a weighted sum of all left-hand sides, and adds the gradient of its first or second
    /// derivative along a direction to `out` (of the same length as `x`).
    pub fn add_gradient(
        &mut self,
        equations: &DiscretisedProblem,
        weighted: &Weighted,
        twice: bool,
        out: &mut [f64],
    ) -> Result<(), Failure> {
        match twice {
            false => add_gradient(equations, weighted, &mut self.nested, out),
            true => add_gradient(equations, weighted, &mut self.nested_twice, out),
        }
    }
}

/// Considers a weighted sum of all left-hand sides, and adds the gradient of a directional
/// derivative of the sum to `out` (of the same length as `x`).
fn add_gradient<T: Directional + Number>(
    equations: &DiscretisedProblem,
    weighted: &Weighted,
    passes: &mut Passes<T>,
    out: &mut [f64],
) -> Result<(), Failure> {
    let layout = &equations.layout;
    for s in 0..layout.segments.len() {
        passes.take_numbers(layout, Some(s), weighted.at);
        passes.slopes.clear();
        passes.slopes.resize(weighted.numbers.local.len(), 0.0);
        for j in 0..layout.segments[s].intervals {
            add_gradient_inside(equations, (s, j), weighted, passes, out)?;
        }
        for (&number, &slope) in weighted.numbers.local.iter().zip(&passes.slopes) {
            layout.scatter(s, number, slope, out);
        }
    }
    if layout.cycle.is_some() {
        return add_gradient_of_joints(equations, weighted, passes, out);
    }
    let &Weighted { at, w, numbers } = weighted;
    let dependence = Dependence { unknowns: &layout.ends, segment: None, numbers: &numbers.all };
    passes.add_gradient(layout, dependence, at, out, |passes| {
        let b = &mut passes.r[..layout.boundary];
        equations.boundary(&passes.unknowns, &passes.q, b);
        Ok(*summed(b, &w[layout.conditions()..]).derivative())
    })
}

/// Adds the contribution of an interval to a gradient: the interval's equations are linear, except
/// for functions of a few arguments, and each argument is a linear combination of the values at the
/// interval's nodes.
fn add_gradient_inside<T: Directional + Number>(
    equations: &DiscretisedProblem,
    (s, j): (usize, usize),
    &Weighted { at: Arguments { x, v }, w, numbers }: &Weighted,
    passes: &mut Passes<T>,
    out: &mut [f64],
) -> Result<(), Failure> {
    let (layout, n, numbers) =
        (&equations.layout, equations.layout.segments[s].states, &numbers.local);
    let (order, rows) = (&layout.order[layout.interval(s, j)], layout.equations(s, j));
    let closing = &w[layout.conditions() + layout.boundary..][..layout.integrals];
    let combined = |coefficients: &[f64], of: &[f64], i: usize| -> f64 {
        let nodes = order[i..].iter().step_by(n);
        coefficients.iter().zip(nodes).map(|(c, &z)| c * of[z]).sum()
    };
    passes.unknowns.clear();
    passes.unknowns.resize(2 * n, T::zero());
    for start in (0..n + numbers.len()).step_by(CHUNK) {
        passes.seed(numbers, n, start);
        let Passes { unknowns, q, r, local, slopes, .. } = &mut *passes;
        let each = equations.method.arguments().chunks_exact(layout.degree + 1).enumerate();
        for (c, coefficients) in each {
            for (i, argument) in unknowns[..n].iter_mut().enumerate() {
                let value = seeded(combined(coefficients, x, i), i, start);
                *argument = T::along(value, combined(coefficients, v, i));
            }
            let interval = equations.alone((s, j), unknowns, q);
            let weights = [&w[rows.start + c * n..][..n], closing];
            let sum = equations.method.nonlinear(interval, c, weights, &mut local.method, r)?;
            for (k, slope) in (start..n + numbers.len()).zip(sum.derivative().eps) {
                match k.checked_sub(n) {
                    Some(number) => slopes[number] += slope,
                    None => order[k..]
                        .iter()
                        .step_by(n)
                        .zip(coefficients)
                        .for_each(|(&z, coefficient)| out[z] += coefficient * slope),
                }
            }
        }
    }
    Ok(())
}
