//! The distance along a branch from a zero solution at which nonlinear terms become significant.

use super::corrector::Corrector;
use crate::core::bifurcation::At;
use crate::core::failure::Failure;
use crate::core::linalg::norm;
use std::ops::Range;

/// Heuristic: two bounds for the nonlinear fraction of the terms, averaged over the equations:
/// nonlinear terms are insignificant below the first bound, and significant above the second bound.
/// The average may contain a few equations that consist of rounding errors only.
const LINEAR: f64 = 0.05;
const NONLINEAR: f64 = 0.3;

/// Rounding: the derivative of an equation along the tangent vanishes by symmetry if the derivative is at most
/// this fraction of the largest derivative. Changes of the equation that are larger than this fraction of the
/// largest linear change are then nonlinear, at any length, and say nothing about the size of solutions.
const VANISHES: f64 = 1e-14;

/// Rounding: from a zero start, the search for the length at which nonlinear terms become
/// significant begins at this length, which is so small that unknowns can have any unit.
const SMALLEST: f64 = 1e-30;
/// Rounding: the search for the length at which nonlinear terms become significant stops at this
/// length.
const LARGEST: f64 = 1e30;

/// Heuristic: the factor by which the computed length at which nonlinear terms become significant
/// may differ from the exact length.
const CLOSE: f64 = 1.1;

/// Heuristic: the change of the parameter after which nonlinear terms are computed again, in units of the
/// parameter's range.
const ELSEWHERE: f64 = 0.25;

/// Heuristic: nonlinear terms at the start are rounding errors if they become significant at a length larger
/// by this factor than the length at another value of the parameter.
const FARTHER: f64 = 1e3;

/// Computes the length along a tangent at which nonlinear terms are comparable with linear terms,
/// or at which a group of unknowns has changed by its own size; `None` if neither length exists. At
/// a Hopf point, and at a branch point of zero solutions, no other quantity determines the size of
/// the emanating solutions. If the nonlinear terms vanish at the start, as for van der Pol's oscillator
/// without damping, the length is computed at another value of the parameter.
pub(super) fn linear_range(
    corrector: &mut Corrector,
    unknowns: &[f64],
    tangent: &[f64],
) -> Option<f64> {
    let groups = groups_along(corrector, tangent);
    let own = |group: &Range<usize>| norm(&unknowns[group.clone()]) / norm(&tangent[group.clone()]);
    let own = groups.iter().map(own).filter(|own| *own > 0.0).fold(f64::INFINITY, f64::min);
    let mut terms = Terms::at(corrector, unknowns, tangent, groups.clone()).ok()?;
    // The tangent at the start is a null vector.
    terms.slope.fill(0.0);
    if own.is_finite() {
        // The equations are linear over unknowns that are rounding errors.
        return match terms.nonlinearity(own) {
            Some(part) if part < LINEAR => terms.range(10.0 * own, Some(own)),
            _ => Some(own),
        };
    }
    let here = terms.range(SMALLEST, None);
    let parameter = corrector.equations.parameters_at();
    let mut beside = unknowns.to_vec();
    beside[parameter] += ELSEWHERE / corrector.norm.scaled(parameter, 1.0);
    let elsewhere = Terms::at(corrector, &beside, tangent, groups).ok();
    let elsewhere = elsewhere.and_then(|mut terms| terms.range(SMALLEST, None));
    corrector.equations.load(unknowns);
    match (here, elsewhere) {
        (Some(here), Some(elsewhere)) if here > FARTHER * elsewhere => Some(elsewhere),
        (here, elsewhere) => here.or(elsewhere),
    }
}

/// Returns the groups of unknowns that change along a tangent, except scalars such as a period.
fn groups_along(corrector: &Corrector, tangent: &[f64]) -> Vec<Range<usize>> {
    let mut end = 0;
    let all = corrector.equations.names().unknowns.iter().map(|group| {
        end += group.length;
        end - group.length..end
    });
    all.filter(|group| group.len() > 1 && tangent[group.clone()].iter().any(|t| *t != 0.0))
        .collect()
}

/// The terms of the equations along a tangent.
struct Terms<'c, 'a> {
    corrector: &'c mut Corrector<'a>,
    unknowns: &'c [f64],
    tangent: &'c [f64],
    groups: Vec<Range<usize>>,
    /// The left sides of the equations at the start.
    start: Vec<f64>,
    /// The derivatives of the left sides along the tangent, which are subtracted from their changes.
    slope: Vec<f64>,
    /// For each equation, the sum of the derivatives along the parts of the tangent in the groups of
    /// unknowns, without signs.
    sizes: Vec<f64>,
}

impl<'c, 'a> Terms<'c, 'a> {
    fn at(
        corrector: &'c mut Corrector<'a>,
        unknowns: &'c [f64],
        tangent: &'c [f64],
        groups: Vec<Range<usize>>,
    ) -> Result<Self, Failure> {
        let start = vec![0.0; unknowns.len()];
        let (slope, sizes) = (Vec::new(), Vec::new());
        let mut terms = Terms { corrector, unknowns, tangent, groups, start, slope, sizes };
        terms.start = terms.change(0.0, &(0..0))?;
        terms.differentiate()?;
        Ok(terms)
    }

    /// Computes, for each equation, the derivative along the tangent, and the sum of its parts without signs.
    fn differentiate(&mut self) -> Result<(), Failure> {
        let equations = &mut self.corrector.equations;
        equations.load(self.unknowns);
        let mut sizes = vec![0.0_f64; equations.dimension()];
        let mut slope = sizes.clone();
        self.slope.clone_from(&sizes);
        for group in &self.groups {
            let mut along = vec![0.0; self.tangent.len()];
            along[group.clone()].copy_from_slice(&self.tangent[group.clone()]);
            let direction = equations.direction_of(&along);
            let At { system, x, .. } = equations.at();
            system.derivative(x, &[&direction], &mut slope)?;
            sizes.iter_mut().zip(&slope).for_each(|(size, slope)| *size += slope.abs());
            self.slope.iter_mut().zip(&slope).for_each(|(sum, slope)| *sum += slope);
        }
        self.sizes = sizes;
        Ok(())
    }

    /// Returns the change of the residual if one group of unknowns is displaced along its part of
    /// the tangent by a given length.
    fn change(&mut self, length: f64, group: &Range<usize>) -> Result<Vec<f64>, Failure> {
        let mut moved = self.unknowns.to_vec();
        let part = moved[group.clone()].iter_mut().zip(&self.tangent[group.clone()]);
        part.for_each(|(x, t)| *x += length * t);
        let mut change = vec![0.0; moved.len()];
        let rows = change.len() - 1;
        self.corrector.equations.residual(&moved, None, &mut change[..rows])?;
        change.iter_mut().zip(&self.start).for_each(|(r, start)| *r -= start);
        Ok(change)
    }

    /// Returns the nonlinear fraction of the changes of the left sides over a length along the
    /// tangent; `None` if the left sides do not change, or if they cannot be evaluated. Along a null
    /// vector, the linear changes due to all groups of unknowns cancel in their sum, so the remaining
    /// sum is nonlinear; elsewhere, the derivative along the tangent is subtracted. A change of scalars,
    /// such as durations, is omitted, and counts as nonlinear.
    fn nonlinearity(&mut self, length: f64) -> Option<f64> {
        let all = self.groups.first()?.start..self.groups.last()?.end;
        let whole = self.change(length, &all).ok()?;
        let mut terms = vec![0.0; whole.len()];
        for group in self.groups.clone() {
            let change = self.change(length, &group).ok()?;
            terms.iter_mut().zip(change).for_each(|(sum, r)| *sum += r.abs());
        }
        let changes = whole.iter().zip(&self.slope).map(|(left, slope)| left - length * slope);
        let bound = VANISHES * self.sizes.iter().copied().fold(0.0, f64::max);
        let counts =
            |terms: f64, size: f64| terms > 0.0 && (size > bound || terms <= length * bound);
        let rows = changes.zip(&terms).zip(&self.sizes);
        let rows = rows.filter(|((_, terms), size)| counts(**terms, **size));
        let shares: Vec<f64> = rows.map(|((left, terms), _)| left.abs() / terms).collect();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        Some(mean).filter(|mean| mean.is_finite())
    }

    /// Returns the length at which nonlinear terms become significant, searched upwards from
    /// `from`. `linear` is a length at which nonlinear terms are insignificant, if such a length is
    /// known.
    fn range(&mut self, from: f64, mut linear: Option<f64>) -> Option<f64> {
        let mut length = from;
        while length < LARGEST {
            let part = self.nonlinearity(length);
            match linear {
                _ if part.is_some_and(|part| part < LINEAR) => linear = Some(length),
                Some(low) if part.is_none_or(|part| part >= NONLINEAR) => {
                    return Some(self.between(low, length));
                }
                _ => {}
            }
            length *= 10.0;
        }
        None
    }

    /// Computes the length at which nonlinear terms become significant by bisection between `low`
    /// and `high`.
    fn between(&mut self, mut low: f64, mut high: f64) -> f64 {
        while high > CLOSE * low {
            let middle = (low * high).sqrt();
            match self.nonlinearity(middle) {
                Some(part) if part < NONLINEAR => low = middle,
                _ => high = middle,
            }
        }
        low
    }
}
