//! The phase response of a cycle: the gradient `Z` of the cycle's asymptotic phase, in units of
//! time.
//!
//! A perturbation `δ` at time `t` advances the later motion by `Z(t)·δ`. A cycle with the same
//! perturbation `δ` in every period returns earlier by the time `Z·δ`. Therefore `Z·δ` is minus the
//! derivative of the period `T` with respect to a jump of the states between two intervals of the
//! discretised equations `F(z) = 0`. With one solution `λ` of a transposed system, the phase response
//! is
//!
//! ```text
//!     F_zᵀ λ = ∇T,    Z = Bᵀ λ at the start of an interval,    Z = −Cᵀ λ at its end,
//! ```
//!
//! where `B` and `C` are the derivatives of the interval's equations with respect to the states at
//! the interval's ends. The computation is the same for all methods, with or without events: the
//! equations include the conditions between segments, which imply `Z⁻ = Sᵀ Z⁺` with the saltation
//! matrix `S`. The matrix of the transposed system is regular exactly if no other Floquet
//! multiplier is 1. The normalisation `Z·f = 1` is not imposed, but used to check the result. The
//! adjoint of Gauss collocation is also Gauss collocation (J. M. Sanz-Serna, *SIAM Review* 58
//! (2016)); therefore, at the ends of intervals, `Z` has the same order of accuracy as the states.
//!
//! Between the ends of an interval, the response is `Z(t) = Φᵀ Z`, where `Z` is the response at the
//! interval's end and `Φ` is the derivative of the flow from `t` to the interval's end.

use super::BoundarySystem;
use super::assembly::AssembledJacobian;
use super::discretisation::DiscretisedProblem;
use super::factors::factor;
use super::meshed::Meshed;
use super::profiles::{along_segments, draw, points_each};
use super::work::Work;
use crate::core::bvp::interval::{Block, Interval, MonitoredFunctions, Span};
use crate::core::bvp::method::Method;
use crate::core::bvp::shooting::Shooting;
use crate::core::failure::{Failure, one_line};
use crate::core::linalg::{Border, Factors, Form, dot, refill};
use crate::core::ode::Settings;
use crate::core::problem::{FieldIn, Profile};
use crate::core::scalar::{CHUNK, Chunk, seeded};

/// Discretisation: a nontrivial multiplier closer to 1 than this leaves fewer than six digits of
/// the response: the error of the solution, 1e-12 of its size, is divided by the distance between
/// this multiplier and the trivial one.
const SIMPLE: f64 = 1e-6;

/// Discretisation: the largest accepted sum of the terms `|Z_i f_i|` in `Z·f = 1`. Near a fold of
/// cycles the sum of the terms `|Z_i f_i|` grows, and reveals the fold even if rounding errors hide
/// a multiplier near 1, as in a canard explosion.
const LARGEST: f64 = 1e6;

/// Discretisation: the largest accepted error of `Z·f = 1`: drawn curves have at least three
/// digits.
const NORMALISED: f64 = 1e-3;

/// Discretisation: the largest relative difference, at the start of an interval, between the
/// response computed by flows and the response of the equations. If the difference is larger, no
/// curve is drawn inside the interval, because the mesh does not resolve the motion or errors grow
/// over the interval.
const SAME: f64 = 1e-4;

/// Computes the phase response of an autonomous cycle `x = (z, p)`, smooth or with events: the gradient
/// `Z` of the asymptotic phase in units of time, as one profile over time for each state, named
/// `phase_response_x`. A small perturbation `δ` at time `t` advances the later motion by `Z(t)·δ`.
///
/// ```
/// use tangency::core::bvp::{Shooting, phase_response};
/// use tangency::core::orbit::periodic_orbits;
/// use tangency::vector_field;
/// // r' = r(1 − r²), φ' = 1 + b(1 − r²): the phase of the cycle r = 1 is φ − b log r.
/// vector_field! {
///     struct Radial [x, y; b] {
///         let inwards = -(x * x + y * y) + 1.0;
///         d/dt x = x * inwards - y * (b * inwards + 1.0);
///         d/dt y = y * inwards + x * (b * inwards + 1.0);
///     }
/// }
/// let mut cycles = periodic_orbits(Radial, 1, Shooting::default())?;
/// let period = std::f64::consts::TAU;
/// let z = cycles.sampled(&[period], |_, tau, x| {
///     (x[1], x[0]) = (tau * period).sin_cos();
/// });
/// let response = phase_response(&mut cycles, &[&z[..], &[0.7]].concat())?;
/// assert_eq!(response[0].name, "phase_response_x");
/// for [t, z] in &response[0].points {
///     assert!((z - (-t.sin() - 0.7 * t.cos())).abs() < 1e-9);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Failure::Unsupported`] for solutions whose period is not an unknown, [`Failure::Undetermined`] if a
/// nontrivial Floquet multiplier is 1, as at a fold of cycles, and the errors of
/// [`BoundarySystem::multipliers`].
pub fn phase_response(of: &mut BoundarySystem, x: &[f64]) -> Result<Vec<Profile>, Failure> {
    response_of(&mut of.0, x)
}

/// Computes the phase response for a discretisation.
pub(super) fn response_of(cycles: &mut Meshed, x: &[f64]) -> Result<Vec<Profile>, Failure> {
    if cycles.solutions.free_period(x).is_none() {
        let reason = "only a cycle with an unknown period has a phase response: forced motions, \
                      cycles of maps and solutions of other boundary-value problems have no phase";
        return Err(Failure::Unsupported(reason.into()));
    }
    cycles.assemble(x)?;
    let (floquet, mut orbit) = cycles.multipliers();
    require_simple(&floquet.deciding(&mut orbit, 1)?)?;
    let (equations, assembled) = (orbit.equations, orbit.assembled);
    let mut factors = Factors::default();
    factor((equations, assembled), floquet, Form::Jacobian, Border::NONE, &mut factors)?;
    let mut adjoint = gradient_of_period(equations, x);
    factors.solve_transposed(&mut adjoint);
    orbit.plain.load(&equations.layout, |i| x[i]);
    let shooting = match &equations.method {
        Method::Shooting(own) => (**own).clone(),
        Method::Collocation(_) => Shooting::default(),
    };
    let flows = Flows::new(shooting, assembled);
    PhaseResponse { equations, assembled, adjoint, work: orbit.plain, flows }.profiles()
}

/// Returns an error for a cycle with a second Floquet multiplier 1.
fn require_simple(multipliers: &[(f64, f64)]) -> Result<(), Failure> {
    let distances = multipliers.iter().map(|mu| (mu.0 - 1.0).hypot(mu.1));
    match distances.min_by(f64::total_cmp) {
        Some(distance) if distance <= SIMPLE => Err(Failure::Undetermined(format!(
            "a second Floquet multiplier differs from 1 by only {distance:.1e}, as at a fold of \
             cycles: the cycle is not hyperbolic, and its phase response is unbounded or \
             undetermined"
        ))),
        _ => Ok(()),
    }
}

/// Returns the derivatives of the period with respect to the unknowns.
fn gradient_of_period(equations: &DiscretisedProblem, x: &[f64]) -> Vec<f64> {
    let layout = &equations.layout;
    let mut gradient = vec![0.0; layout.dimension];
    let (mut q, mut numbers) = (Vec::new(), Vec::new());
    let value = |k: usize| x[layout.number(k)];
    for first in (0..layout.extras).step_by(CHUNK) {
        let extra = |e: usize| seeded(value(layout.parameters + e), e, first);
        let parameters = (0..layout.parameters).map(|k| Chunk::of(value(k)));
        refill(&mut q, parameters.chain((0..layout.extras).map(extra)));
        layout.spread(&q, &mut numbers);
        let period = equations.duration(&numbers, |_| true);
        let own = gradient[layout.values() + first..].iter_mut();
        own.zip(period.eps).for_each(|(entry, slope)| *entry = slope);
    }
    gradient
}

/// The phase response at an assembled cycle.
struct PhaseResponse<'a> {
    equations: &'a DiscretisedProblem,
    assembled: &'a AssembledJacobian,
    /// The adjoint solution `λ`, in the order of the equations.
    adjoint: Vec<f64>,
    /// The cycle.
    work: &'a Work<f64>,
    flows: Flows,
}

impl PhaseResponse<'_> {
    fn profiles(mut self) -> Result<Vec<Profile>, Failure> {
        let mut profiles = Vec::new();
        along_segments(self.equations, |segment, names, begin| {
            let rows = self.along(segment, begin)?;
            for (i, name) in names.iter().enumerate() {
                let name = format!("{}{name}", Profile::PHASE_RESPONSE);
                let curve = rows.iter().map(|row| [row[0], row[i + 1]]);
                draw(&mut profiles, &name, "time", curve.collect());
            }
            Ok(rows.last().map(|last| last[0]))
        })?;
        Ok(profiles)
    }

    /// Computes time (counted from `begin`) and phase response along a segment, at the points of
    /// the segment's time history.
    fn along(&mut self, segment: usize, begin: f64) -> Result<Vec<Vec<f64>>, Failure> {
        let (equations, work) = (self.equations, self.work);
        let s = &equations.layout.segments[segment];
        let (each, n) = (points_each(equations, segment), s.states);
        let ends: Vec<[Vec<f64>; 2]> = (0..s.intervals).map(|j| self.at_ends(segment, j)).collect();
        let sizes = self.sizes(segment);
        let all = ends.iter().flatten();
        let most = SAME * all.map(|z| size(z.iter().copied(), &sizes)).fold(0.0, f64::max);
        let mut rows = Vec::with_capacity(s.intervals * each + 1);
        for (interval, [start, end]) in ends.iter().enumerate() {
            let at = equations.interval((segment, interval), &work.nodes, &work.numbers);
            let duration = at.duration();
            let time = |place: f64| begin + duration * at.span.at(place);
            check_normalised(&at, [start, end])?;
            rows.push([&[time(0.0)], &start[..]].concat());
            if let Some(inside) = self.flows.response(&at, each, end)? {
                let differences = inside[..n].iter().zip(start).map(|(a, b)| a - b);
                if size(differences, &sizes) <= most {
                    let inside = inside.chunks_exact(n).enumerate().skip(1);
                    let row =
                        |(k, z): (usize, &[f64])| [&[time(k as f64 / each as f64)], z].concat();
                    rows.extend(inside.map(row));
                }
            }
            if interval + 1 == s.intervals {
                rows.push([&[time(1.0)], &end[..]].concat());
            }
        }
        Ok(rows)
    }

    /// Returns the phase response at the start and at the end of an interval.
    fn at_ends(&self, segment: usize, interval: usize) -> [Vec<f64>; 2] {
        let layout = &self.equations.layout;
        let n = layout.segments[segment].states;
        let (rows, width) = (layout.degree * n, (layout.degree + 1) * n);
        let mut expanded = Vec::new();
        let block = match self.assembled.structure.sparse() {
            Some(sparse) => {
                sparse.block(interval, &mut expanded);
                &expanded
            }
            None => &self.assembled.blocks[segment][interval * rows * width..][..rows * width],
        };
        let mut ends = [vec![0.0; n], vec![0.0; n]];
        let adjoint = &self.adjoint[layout.equations(segment, interval)];
        for (lambda, row) in adjoint.iter().zip(block.chunks_exact(width)) {
            for i in 0..n {
                ends[0][i] += lambda * row[i];
                ends[1][i] -= lambda * row[width - n + i];
            }
        }
        ends
    }

    /// Returns the largest value of each state on a segment.
    fn sizes(&self, segment: usize) -> Vec<f64> {
        let s = &self.equations.layout.segments[segment];
        let nodes = &self.work.nodes[s.values..s.values + s.nodes * s.states];
        let size = |i: usize| nodes.iter().skip(i).step_by(s.states).fold(0.0, larger);
        (0..s.states).map(size).collect()
    }
}

fn larger(most: f64, x: &f64) -> f64 {
    most.max(x.abs())
}

/// Returns the largest component of a phase response, after each component is multiplied by the
/// size of its state.
fn size(z: impl Iterator<Item = f64>, sizes: &[f64]) -> f64 {
    z.zip(sizes).map(|(z, size)| (z * size).abs()).fold(0.0, f64::max)
}

/// Returns an error for a phase response that violates `Z·f = 1`.
fn check_normalised(at: &Interval<f64>, ends: [&Vec<f64>; 2]) -> Result<(), Failure> {
    let n = ends[0].len();
    let mut motion = vec![0.0; n];
    let states = [&at.nodes[..n], &at.nodes[at.nodes.len() - n..]];
    for ((z, x), place) in ends.into_iter().zip(states).zip([0.0, 1.0]) {
        at.field().slope(at.time(place), x, at.q, &mut motion);
        let (along, time) = (dot(z, &motion), at.time(place));
        let parts: f64 = z.iter().zip(&motion).map(|(z, f)| (z * f).abs()).sum();
        let normalised = parts <= LARGEST && (along - 1.0).abs() <= NORMALISED;
        if !normalised {
            return Err(Failure::Undetermined(format!(
                "the phase response `Z` is unbounded or undetermined, as at a fold of cycles: the \
                 product Z·f with the vector field `f` must be 1, but is {along:.6}, a sum of \
                 terms of size {parts:.1e}, at t = {time:.6e} from the start of segment {}",
                at.span.segment
            )));
        }
    }
    Ok(())
}

/// Flows over the parts of an interval, with the derivatives of these flows.
struct Flows {
    shooting: Shooting,
    /// The states at the start of a part of the interval, and scratch space for the states at its
    /// end.
    x: Vec<f64>,
    end: Vec<f64>,
    /// The derivatives of each part's end with respect to its start and its end, stored row by row.
    parts: Vec<f64>,
}

impl Flows {
    fn new(mut shooting: Shooting, assembled: &AssembledJacobian) -> Self {
        shooting.settings.cancel.clone_from(&assembled.cancel);
        Flows { shooting, x: Vec::new(), end: Vec::new(), parts: Vec::new() }
    }

    /// Computes the phase response at the starts of the parts of an interval, in turn, from the
    /// response at the interval's end; `None` if a flow fails.
    fn response(
        &mut self,
        at: &Interval<f64>,
        count: usize,
        end: &[f64],
    ) -> Result<Option<Vec<f64>>, Failure> {
        let n = end.len();
        let mut flowed = self.follow(at, count, n);
        if flowed.as_ref().is_err_and(is_stiff) && self.shooting.settings.scheme.is_explicit() {
            let cancel = self.shooting.settings.cancel.clone();
            let settings = Settings { cancel, ..Settings::implicit() };
            self.shooting =
                Shooting::with(settings).map_err(|cause| Failure::Unsupported(one_line(&cause)))?;
            flowed = self.follow(at, count, n);
        }
        match flowed {
            Err(cause @ Failure::Cancelled(_)) => return Err(cause),
            Err(_) => return Ok(None),
            Ok(()) => {}
        }
        let mut response = vec![0.0; count * n];
        let mut after = end.to_vec();
        let parts = self.parts.chunks_exact(2 * n * n);
        for (z, part) in response.chunks_exact_mut(n).zip(parts).rev() {
            for (after, row) in after.iter().zip(part.chunks_exact(2 * n)) {
                z.iter_mut().zip(row).for_each(|(z, slope)| *z += after * slope);
            }
            after.copy_from_slice(z);
        }
        Ok(Some(response))
    }

    fn follow(&mut self, at: &Interval<f64>, count: usize, n: usize) -> Result<(), Failure> {
        let Flows { shooting, x, end, parts } = self;
        refill(x, at.nodes[..n].iter().copied());
        x.resize(2 * n, 0.0);
        end.resize(n, 0.0);
        parts.resize(count * 2 * n * n, 0.0);
        for (k, nodes) in parts.chunks_exact_mut(2 * n * n).enumerate() {
            let [first, last] = [k, k + 1].map(|k| at.span.at(k as f64 / count as f64));
            let span = Span { start: first, end: last, ..at.span };
            let part = Interval { span, nodes: x, ..*at };
            let block = Block { residual: end, nodes, numbers: &mut [] };
            let none = MonitoredFunctions::default();
            shooting.linearise(part, &[], block, none, &mut |_, _, _| {})?;
            // The residual is the end of the flow, since the right node is zero.
            x[..n].copy_from_slice(end);
        }
        Ok(())
    }
}

fn is_stiff(cause: &Failure) -> bool {
    matches!(cause, Failure::Flow(cause) if cause.is_stiff())
}
