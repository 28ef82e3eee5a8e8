//! Newton's method on the defining system of an event.

use super::corrector::{Corrector, MATRIX_ERROR};
use super::event::{Event, MakeCondition};
use super::extended::Extended;
use super::located::Located;
use super::meaning::Meaning;
use super::newton::{Newton, NewtonError, Tolerances};
use crate::core::bifurcation::At;
use crate::core::failure::Failure;
use crate::core::linalg::{self, along};

/// Solves the defining system of an event, starting from a guess on the curve, and computes the
/// position of the solution along `row`, measured from the point `base`. On return, only the
/// defining systems of the curve itself are held.
pub(super) fn solve(
    corrector: &mut Corrector,
    event: &Event,
    guess: Vec<f64>,
    (row, base): (&[f64], &[f64]),
) -> Result<Located, NewtonError> {
    let curve = corrector.equations.exchange(Vec::new());
    let (n, end) = (corrector.equations.dimension(), corrector.equations.length());
    let (count, own) = (curve.len(), curve.iter().map(|condition| condition.unknowns()).sum());
    let (outcome, mut conditions) = if let Some(instead) = &event.instead {
        let mut bare = guess;
        bare.drain(n..n + own);
        let makes = [instead].into_iter().chain(&event.condition);
        (solve_with(corrector, makes, event, &bare), curve)
    } else {
        corrector.equations.exchange(curve);
        let outcome = solve_with(corrector, event.condition.iter(), event, &guess);
        (outcome, corrector.equations.exchange(Vec::new()))
    };
    // The event's defining systems are removed, and the curve's auxiliary unknowns are back in
    // their positions.
    conditions.truncate(count);
    corrector.equations.exchange(conditions);
    let Solved { unknowns, meaning, error } = outcome?;
    let kept = if event.instead.is_none() { own } else { 0 };
    let mut point = unknowns[..n + kept].to_vec();
    point.resize(n + own, 0.0);
    if let (true, Some((unknown, level))) = (kept < own, event.test.auxiliary()) {
        point[n + unknown] = level;
    }
    point.extend(&unknowns[unknowns.len() - (end - n)..]);
    let along = along(row, &point, base);
    let mut located = Located::new((event.kind, &event.name), along, point, error);
    meaning.give_to(&mut located.special);
    Ok(located)
}

/// A solution of the defining system of an event.
struct Solved {
    unknowns: Vec<f64>,
    meaning: Meaning,
    /// The estimated error of the continued parameter.
    error: f64,
}

/// Heuristic: the smallest damping factor of Newton's method in a bracket. An iteration that needs
/// stronger damping converges slowly if at all, and a bisection costs less.
const LEAST_DAMPING_IN_BRACKET: f64 = 0.125;

/// Solves the equations of the curve with additional defining systems held.
fn solve_with<'m>(
    corrector: &mut Corrector,
    makes: impl Iterator<Item = &'m MakeCondition>,
    event: &Event,
    guess: &[f64],
) -> Result<Solved, NewtonError> {
    let Corrector { equations, norm, event_tolerances, refines, sensitivities, .. } = corrector;
    let weights = &norm.weights;
    let n = equations.dimension();
    let mut unknowns = guess.to_vec();
    for make in makes {
        unknowns = equations.hold(make(), &unknowns)?;
    }
    let released = equations.released.len();
    let (measured, parameters) = (guess.len() - released, weights.len() - released);
    let mut all = weights[..measured.max(n)].to_vec();
    all.resize(equations.parameters_at(), 0.0);
    all.extend(&weights[parameters..]);
    let tolerances = Tolerances { least_damping: LEAST_DAMPING_IN_BRACKET, ..*event_tolerances };
    let mut left = converge(equations, &mut unknowns, &all, tolerances)?;
    if restart_reflected(equations, &mut unknowns)? {
        left = converge(equations, &mut unknowns, &all, tolerances)?;
    }
    let parameter = equations.parameters_at();
    let error = left[parameter];
    let scale = all[parameter].sqrt().recip();
    let mut meaning = Meaning::of(equations, event, &unknowns, scale);
    if let Some(condition) = event.condition.as_ref().map(|make| make()) {
        // The event's named auxiliary unknowns come first among its numbers.
        let own = &left[parameter - condition.unknowns()..][..condition.names().len()];
        meaning.numbers.iter_mut().zip(own).for_each(|(number, left)| number.error += left);
    }
    // If the discretisation is refined, the finest discretisation gives the derivatives.
    let discretised = equations.system().discretised();
    let is_refined = *refines && discretised.is_some_and(|it| it.is_refinable());
    if *sensitivities && !is_refined {
        meaning.differentiate(equations, event, &unknowns);
    }
    Ok(Solved { unknowns, meaning, error })
}

/// Starts those defining systems again whose auxiliary unknowns describe the
/// [reflection](crate::core::bifurcation::DefiningSystem::is_reflected) of a solution. Returns whether
/// any defining system was started again.
fn restart_reflected(equations: &mut Extended, unknowns: &mut [f64]) -> Result<bool, Failure> {
    equations.load(unknowns);
    let (mut place, mut any) = (equations.dimension(), false);
    let Extended { system, conditions, x, released, auxiliary, null, .. } = equations;
    let mut at = At { system: &mut **system, x, released, held: auxiliary, null };
    for condition in conditions {
        let y = &mut unknowns[place..place + condition.unknowns()];
        place += y.len();
        if condition.is_reflected(y) {
            condition.start(at.again(), y)?;
            any = true;
        }
    }
    Ok(any)
}

/// Heuristic: the number of samples from which rounding errors are estimated; a single sample may
/// be small by chance.
const SAMPLES: usize = 2;

/// Sets to zero those components of a solution's `z` that consist only of rounding errors, which
/// are estimated with the last factored matrix. `weights` are the inverse squares of the scales.
/// If solutions have a mesh, or if the residual cannot be evaluated, the components are unchanged.
fn clear_rounding(equations: &mut Extended, unknowns: &mut [f64], weights: &[f64]) {
    if equations.system().representation().is_on_mesh() {
        return;
    }
    let (mut cleared, n) = (unknowns.to_vec(), equations.dimension());
    let mut factors = std::mem::take(&mut equations.factors);
    let residual = |v: &[f64], out: &mut [f64]| equations.residual(v, None, out);
    let sizes: Vec<f64> = weights[..n].iter().map(|weight| weight.sqrt().recip()).collect();
    let solve = |right: &mut [f64]| factors.solve(right);
    let outcome = linalg::clear_rounding(&mut cleared, &sizes, residual, solve);
    equations.factors = factors;
    if outcome.is_ok() {
        unknowns[..n].copy_from_slice(&cleared[..n]);
    }
    equations.load(unknowns);
}

/// Rounding: a component smaller than this threshold, in units of its scale, may consist only of
/// rounding errors.
const SMALL: f64 = 1e-9;

/// Solves a defining system, and estimates the errors of the unknowns. The estimated errors are
/// multiples of a second additional Newton correction.
pub(super) fn converge(
    equations: &mut Extended,
    unknowns: &mut [f64],
    weights: &[f64],
    tolerances: Tolerances,
) -> Result<Vec<f64>, NewtonError> {
    // A separate Newton iteration, because the curvature estimated earlier belongs to other
    // equations.
    let mut newton = Newton::default();
    let mut left = finish(&mut newton, equations, unknowns, weights, tolerances)?;
    let parameter = equations.parameters_at();
    let rounding = 4.0 * f64::EPSILON * unknowns[parameter].abs();
    if left[parameter] > rounding {
        // The second correction is not applied, so that the assembled data belong to the point.
        equations.assemble(unknowns)?;
        let second = newton.residual_correction(equations, unknowns, false)?;
        left = second.iter().map(|d| d.abs()).collect();
        // The remaining error of a converged point is amplified rounding: one correction may be
        // small by chance.
        if left[parameter] > 100.0 * rounding {
            for noise in newton.rounding(equations, None, unknowns, SAMPLES)? {
                left.iter_mut().zip(noise).for_each(|(left, noise)| *left = left.max(noise.abs()));
            }
        }
    }
    let rounding = |x: &f64| 4.0 * f64::EPSILON * x.abs();
    Ok(left.iter().zip(&*unknowns).map(|(left, x)| 4.0 * left + rounding(x)).collect())
}

/// Solves a defining system without an estimate of the error.
pub(super) fn solve_accurately(
    equations: &mut Extended,
    unknowns: &mut [f64],
    weights: &[f64],
    tolerances: Tolerances,
) -> Result<(), NewtonError> {
    finish(&mut Newton::default(), equations, unknowns, weights, tolerances)?;
    Ok(equations.assemble(unknowns)?)
}

/// Solves a defining system and applies an additional correction, which completes Newton's
/// iteration. Returns the sizes of the additional correction's components.
fn finish(
    newton: &mut Newton,
    equations: &mut Extended,
    unknowns: &mut [f64],
    weights: &[f64],
    tolerances: Tolerances,
) -> Result<Vec<f64>, NewtonError> {
    let report = newton.solve(equations, unknowns, None, weights, tolerances)?;
    let parameter = equations.parameters_at();
    let refactor = report.matrix_error > MATRIX_ERROR;
    let correction = newton.residual_correction(equations, unknowns, refactor)?;
    let change = correction.iter().map(|d| d.abs()).collect();
    unknowns.iter_mut().zip(correction).for_each(|(x, d)| *x -= d);
    let is_small = |(x, w): (&f64, &f64)| *x != 0.0 && x.abs() * w.sqrt() <= SMALL;
    if unknowns[..parameter].iter().zip(weights).any(is_small) {
        clear_rounding(equations, unknowns, weights);
    }
    Ok(change)
}
