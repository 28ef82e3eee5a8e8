//! Monitors of a discretised boundary-value problem, and their gradients.

use super::discretisation::DiscretisedProblem;
use super::duration_bound::DurationBound;
use super::extremes::{MonitoredExtremes, Place, pairs};
use super::layout::span;
use super::local::{Derivative, Gradient, Passes, Slope};
use super::mesh_error::MeshError;
use super::phase::Phase;
use super::residual::{residual_beside, residual_inside};
use super::work::{Work, gather_ends};
use crate::core::bvp::erased::{EndFunctions, Equations, Number, WatchNumber};
use crate::core::bvp::interval::Interval;
use crate::core::bvp::method::MethodWork;
use crate::core::bvp::terms::{Ends, Monitor, Watched};
use crate::core::failure::Failure;
use crate::core::problem::{FieldIn, Integral, Observable, Overall, Sighting};
use crate::core::scalar::Scalar;
use num_dual::Dual64;

/// The name of the monitor that estimates the mesh error.
pub(super) const MESH_ERROR: &str = "mesh_error";

/// A scalar at a position on a segment.
type Term = Sighting<(Watched, Place)>;

/// A scalar at a fixed position on a segment, and the factor with which the derivative of the scalar
/// enters the derivative of a monitor.
type Share = ((Watched, Place), f64);

/// The monitors of a problem, and the data from which they are computed: the extrema and the mesh
/// error of a solution.
pub(super) struct Monitors {
    all: Vec<Monitor>,
    pub extremes: MonitoredExtremes,
    pub mesh_error: MeshError,
    /// The longest allowed duration of trial solutions.
    pub longest: DurationBound,
}

impl Monitors {
    pub fn new(equations: &DiscretisedProblem) -> Self {
        let DiscretisedProblem { problem, method, layout, .. } = equations;
        let all: Vec<Monitor> = problem.monitors().into_iter().map(|(_, it)| it).collect();
        let extremes = MonitoredExtremes::of(&all, layout);
        Monitors {
            all,
            extremes,
            mesh_error: MeshError::new(method),
            longest: DurationBound::default(),
        }
    }

    /// Computes the value of a monitor for the solution loaded in `work`.
    pub fn evaluate(
        &mut self,
        equations: &mut DiscretisedProblem,
        monitor: usize,
        work: &mut Work<f64>,
    ) -> Result<f64, Failure> {
        self.watch_for(equations, monitor, work)?;
        Ok(match self.all.get(monitor) {
            Some(Monitor::Duration) => equations.duration(&work.numbers, |_| true),
            Some(Monitor::Ends(function)) => {
                gather_ends(&equations.layout, &work.nodes, &mut work.ends);
                of_ends(equations, *function, &work.ends, &work.q)
            }
            Some(Monitor::Integral(integral, watched)) => {
                let [sum, time] = sum_and_time(equations, *integral, watched, work)?;
                integral.of(sum, time)
            }
            Some(Monitor::Rising { through, value }) => {
                self.rising(through, value).map_or(0.0, |(rise, _)| rise.value)
            }
            Some(monitor) => self.overall(monitor).value(monitor),
            None => self.mesh_error.of(equations, work),
        })
    }

    /// Computes the extrema of the monitored scalars if a monitor needs them.
    pub fn watch_for(
        &mut self,
        equations: &mut DiscretisedProblem,
        monitor: usize,
        work: &Work<f64>,
    ) -> Result<(), Failure> {
        match self.all.get(monitor) {
            None | Some(Monitor::Duration | Monitor::Ends(_) | Monitor::Integral(..)) => Ok(()),
            Some(_) => self.find_extremes(equations, &work.nodes, (&work.q, &work.numbers), None),
        }
    }

    /// Computes the extrema of the monitored scalars if a monitor needs the extrema, and even rough
    /// positions are unknown.
    pub fn watch_roughly_for(
        &mut self,
        equations: &mut DiscretisedProblem,
        monitor: usize,
        work: &Work<f64>,
    ) -> Result<(), Failure> {
        if self.extremes.known(&work.nodes, &work.q, true) {
            return Ok(());
        }
        self.watch_for(equations, monitor, work)
    }

    /// Adds the gradient of a monitor at the point loaded in `work`.
    pub fn add_gradient(
        &mut self,
        equations: &mut DiscretisedProblem,
        monitor: usize,
        work: &mut Work<f64>,
        gradient: &mut Gradient,
    ) -> Result<(), Failure> {
        match self.all.get(monitor) {
            None => self.mesh_error.add_gradient(equations, work, gradient),
            Some(Monitor::Ends(function)) => {
                gradient.add(&equations.layout, &equations.layout.ends, None, |passes| {
                    Ok(of_ends(equations, *function, &passes.unknowns, &passes.q))
                })
            }
            Some(_) => self.add_derivative(equations, monitor, work, gradient),
        }
    }

    /// Computes the derivatives of consecutive monitors, from the monitor at the position `first`,
    /// along the direction of `slope` at the point loaded in `work`, with an allowed error; where a
    /// computation fails, the derivative is NaN. Returns the positions in `out` of the derivatives
    /// that must be computed from gradients.
    pub fn slopes(
        &mut self,
        (equations, allowed): (&mut DiscretisedProblem, f64),
        first: usize,
        work: &mut Work<f64>,
        mut slope: Slope,
        out: &mut [f64],
    ) -> Vec<usize> {
        let (mut shares, mut others) = (Vec::new(), Vec::new());
        for k in 0..out.len() {
            // The positions of extrema have the full accuracy or are known.
            let watched = self.watch_roughly_for(equations, first + k, work);
            let value = equations.allowing(allowed, |equations| match self.all.get(first + k) {
                None | Some(Monitor::Ends(_)) => {
                    others.push(k);
                    Ok(f64::NAN)
                }
                Some(Monitor::Duration | Monitor::Integral(..)) => {
                    slope.value = 0.0;
                    let added = self.add_derivative(equations, first + k, work, &mut slope);
                    added.map(|()| slope.value)
                }
                Some(monitor) => watched.and_then(|()| {
                    let own = self.shares(equations, monitor, work)?;
                    shares.extend(own.into_iter().flatten().map(|share| (k, share)));
                    Ok(0.0)
                }),
            });
            out[k] = value.unwrap_or(f64::NAN);
        }
        equations.allowing(allowed, |equations| add_shares(equations, shares, slope, out));
        others
    }

    /// Adds a derivative of a monitor at the point loaded in `work`.
    pub fn add_derivative(
        &mut self,
        equations: &mut DiscretisedProblem,
        monitor: usize,
        work: &mut Work<f64>,
        derivative: &mut impl Derivative,
    ) -> Result<(), Failure> {
        self.watch_for(equations, monitor, work)?;
        match &self.all[monitor] {
            Monitor::Duration => add_duration(equations, |_| true, 1.0, derivative),
            Monitor::Integral(integral, watched) => {
                add_integral(equations, *integral, watched, work, derivative)
            }
            monitor => {
                let shares = self.shares(equations, monitor, work)?;
                let mut shares = shares.into_iter().flatten();
                shares.try_for_each(|share| add_share(equations, share, derivative))
            }
        }
    }

    /// Returns the shares of the derivative of a monitor that depends on extrema or crossings. At an
    /// inner extremum the derivative with respect to the position vanishes, and an extremum at an
    /// end of the segment keeps its position.
    fn shares(
        &self,
        equations: &DiscretisedProblem,
        monitor: &Monitor,
        work: &mut Work<f64>,
    ) -> Result<[Option<Share>; 2], Failure> {
        let Monitor::Rising { through, value } = monitor else {
            let terms = self.overall(monitor).terms(monitor);
            return Ok(terms.map(|term| term.map(|(term, factor)| (term.place, factor))));
        };
        let Some((rise, value)) = self.rising(through, value) else { return Ok([None; 2]) };
        let (through, place) = rise.place;
        let value = Watched { observable: value, ..through };
        let [height, level] = rates(equations, place, [through, value], work)?;
        // The place of an upward crossing moves: `d v = ∂v − (v'/h') ∂h` at the fixed place.
        Ok([Some(((value, place), 1.0)), Some((rise.place, -level.eps / height.eps))])
    }

    /// Returns the extrema of a monitor's scalar over all segments.
    fn overall(&self, monitor: &Monitor) -> Overall<(Watched, Place)> {
        let mut overall = Overall::default();
        for w in monitor.of_extremes() {
            if let Some(extremes) = self.extremes.of_scalar(*w) {
                let dips = extremes.dips(w.vanishes, w.free);
                overall.take(extremes, dips, |place| (*w, place));
            }
        }
        overall
    }

    /// Computes all left-hand sides in real numbers; also computes the extrema for monitors if the
    /// same computation gives both.
    pub fn residual(
        &mut self,
        equations: &mut DiscretisedProblem,
        phase: &Phase,
        work: &mut Work<f64>,
    ) -> Result<(), Failure> {
        self.longest.check(equations, &work.numbers)?;
        if equations.method.watches_with_residual() {
            let Work { nodes, q, numbers, r, .. } = &mut *work;
            self.find_extremes(equations, nodes, (q, numbers), Some(r))?;
        } else {
            residual_inside(equations, work)?;
        }
        residual_beside(equations, phase, work)
    }

    /// Computes the extrema and crossings of all monitored scalars in one pass over the intervals,
    /// and writes the intervals' residuals if requested.
    pub fn find_extremes(
        &mut self,
        equations: &mut DiscretisedProblem,
        nodes: &[f64],
        (q, numbers): (&[f64], &[f64]),
        mut residual: Option<&mut [f64]>,
    ) -> Result<(), Failure> {
        if residual.is_none() && self.extremes.known(nodes, q, equations.rough) {
            return Ok(());
        }
        let largest = self.mesh_error.largest(equations, nodes, numbers);
        let mesh_error = largest.map_or(0.0, |largest| largest.error);
        let DiscretisedProblem { problem, method, meshes, layout, rough, .. } = equations;
        let extremes = &mut self.extremes;
        extremes.begin(&**problem, q, mesh_error);
        for (s, j) in layout.intervals() {
            let r = residual.as_deref_mut().map(|r| &mut r[layout.equations(s, j)]);
            let (span, nodes) = (span(meshes, s, j), &nodes[layout.interval(s, j)]);
            let (watched, mut visit) = extremes.visitor(s, j);
            let q = &numbers[layout.local(s)];
            method.extrema(
                Interval { problem: &**problem, span, nodes, q },
                watched,
                r,
                &mut visit,
            )?;
        }
        extremes.end(nodes, q, *rough);
        Ok(())
    }

    /// Considers all upward zero crossings of a first scalar on all segments; returns the crossing
    /// at which a second scalar is largest, and the value of the second scalar there.
    fn rising(&self, through: &[Watched], value: &[Watched]) -> Option<(Term, Observable)> {
        let risen = pairs(through, value).filter_map(|(w, value)| {
            let Sighting { place, value: height } = self.extremes.risen(w, value)?;
            Some((Sighting { place: (w, place), value: height }, value))
        });
        risen.max_by(|a, b| a.0.value.total_cmp(&b.0.value))
    }
}

/// Adds a multiple of the gradient of the total duration of the selected segments.
fn add_duration(
    equations: &DiscretisedProblem,
    counts: impl Fn(usize) -> bool,
    factor: f64,
    derivative: &mut impl Derivative,
) -> Result<(), Failure> {
    for (s, mesh) in equations.meshes.iter().enumerate().filter(|(s, _)| counts(*s)) {
        derivative.add(&equations.layout, &[], Some(s), |passes| {
            let duration = Number::residual(&*equations.problem).duration_in(s, &passes.q);
            Ok(duration * (mesh.end() * factor))
        })?;
    }
    Ok(())
}

/// Computes an integral of scalars for the solution loaded in `work`, and the duration of the
/// integration.
fn sum_and_time(
    equations: &DiscretisedProblem,
    integral: Integral,
    watched: &[Vec<Watched>],
    work: &mut Work<f64>,
) -> Result<[f64; 2], Failure> {
    let Work { nodes, numbers, local, .. } = work;
    let mut sum = 0.0;
    for at in equations.layout.intervals().filter(|(s, _)| on_segment(watched, *s)) {
        let interval = equations.interval(at, nodes, numbers);
        sum += share(equations, integral, watched, interval, &mut local.method)?;
    }
    Ok([sum, equations.duration(numbers, |s| on_segment(watched, s))])
}

/// Computes the contribution of an interval to an integral.
fn share<T: Number + WatchNumber>(
    equations: &DiscretisedProblem,
    integral: Integral,
    watched: &[Vec<Watched>],
    interval: Interval<T>,
    work: &mut MethodWork<T>,
) -> Result<T, Failure> {
    let (mut sum, problem) = (T::zero(), T::watches(interval.problem));
    equations.method.quadrature(interval, work, &mut |weight, t, x| {
        for watched in watched.iter().flatten().filter(|w| w.segment == interval.span.segment) {
            sum += weight * integral.integrand(problem.watch_in(*watched, t, x, interval.q));
        }
    })?;
    Ok(sum)
}

/// Adds the derivatives of the integral and of the duration, combined by the chain rule.
fn add_integral(
    equations: &DiscretisedProblem,
    integral: Integral,
    watched: &[Vec<Watched>],
    work: &mut Work<f64>,
    derivative: &mut impl Derivative,
) -> Result<(), Failure> {
    let [sum, time] = sum_and_time(equations, integral, watched, work)?;
    let slope = |of: [f64; 2]| integral.of(Dual64::new(sum, of[0]), Dual64::new(time, of[1])).eps;
    let (by_sum, by_time) = (slope([1.0, 0.0]), slope([0.0, 1.0]));
    for (s, j) in equations.layout.intervals().filter(|(s, _)| on_segment(watched, *s)) {
        let unknowns = &equations.layout.order[equations.layout.interval(s, j)];
        derivative.add(&equations.layout, unknowns, Some(s), |passes| {
            let Passes { unknowns, q, local, .. } = passes;
            let interval = equations.alone((s, j), unknowns, q);
            Ok(share(equations, integral, watched, interval, &mut local.method)? * by_sum)
        })?;
    }
    add_duration(equations, |s| on_segment(watched, s), by_time, derivative)
}

/// Computes a function of the states at the starts of all segments and at the ends of all segments.
fn of_ends<T: Scalar>(equations: &DiscretisedProblem, function: usize, ends: &[T], q: &[T]) -> T
where
    dyn Equations: EndFunctions<T>,
{
    let (start, end) = ends.split_at(equations.layout.states);
    equations.problem.of_ends_in(function, Ends { start, end }, q)
}

/// Computes two scalars at a position on a segment, with their time derivatives.
fn rates(
    equations: &DiscretisedProblem,
    Place { interval, place }: Place,
    watched: [Watched; 2],
    work: &mut Work<f64>,
) -> Result<[Dual64; 2], Failure> {
    let segment = watched[0].segment;
    let n = equations.layout.segments[segment].states;
    let at = equations.interval((segment, interval), &work.nodes, &work.numbers);
    let (mut x, mut f) = (vec![0.0; n], vec![0.0; n]);
    equations.method.value(at, place, &mut work.local.method, &mut x)?;
    let t = at.time(place);
    at.field().slope(t, &x, at.q, &mut f);
    let moving: Vec<Dual64> = x.iter().zip(&f).map(|(x, f)| Dual64::new(*x, *f)).collect();
    let q: Vec<Dual64> = at.q.iter().map(|q| Dual64::from(*q)).collect();
    let problem = Dual64::watches(&*equations.problem);
    Ok(watched.map(|watched| problem.watch_in(watched, Dual64::new(t, 1.0), &moving, &q)))
}

/// Adds the derivatives of shares along a direction to the derivatives of monitors; each share is
/// preceded by the position of its monitor's derivative in `out`. The trajectory on an interval is
/// computed once.
fn add_shares(
    equations: &DiscretisedProblem,
    mut shares: Vec<(usize, Share)>,
    mut slope: Slope,
    out: &mut [f64],
) {
    let layout = &equations.layout;
    let at = |(_, ((watched, place), _)): &(usize, Share)| (watched.segment, place.interval);
    let place = |(_, ((_, place), _)): &(usize, Share)| place.place;
    shares.sort_by(|a, b| at(a).cmp(&at(b)).then(place(a).total_cmp(&place(b))));
    for group in shares.chunk_by(|a, b| at(a) == at(b)) {
        let places: Vec<f64> = group.iter().map(place).collect();
        let (segment, interval) = at(&group[0]);
        let unknowns = &layout.order[layout.interval(segment, interval)];
        let added = slope.add(layout, unknowns, Some(segment), |passes| {
            let Passes { unknowns, q, local, .. } = passes;
            let interval = equations.alone((segment, interval), unknowns, q);
            let x = &mut local.x[..layout.segments[segment].states];
            let problem = Dual64::watches(interval.problem);
            equations.method.values(interval, &places, &mut local.method, x, &mut |at, x| {
                let (k, ((watched, _), factor)) = group[at];
                let t = interval.time(places[at]);
                out[k] += problem.watch_in(watched, t, x, interval.q).eps * factor;
            })?;
            Ok(Dual64::from(0.0))
        });
        if added.is_err() {
            group.iter().for_each(|(k, _)| out[*k] = f64::NAN);
        }
    }
}

/// Adds the derivative of a share.
fn add_share<D: Derivative>(
    equations: &DiscretisedProblem,
    ((watched, Place { interval, place }), factor): Share,
    derivative: &mut D,
) -> Result<(), Failure> {
    let (layout, segment) = (&equations.layout, watched.segment);
    let (at, n) = ((segment, interval), layout.segments[segment].states);
    let unknowns = &layout.order[layout.interval(segment, interval)];
    derivative.add(layout, unknowns, Some(segment), |passes| {
        let Passes { unknowns, q, local, .. } = passes;
        let (interval, x) = (equations.alone(at, unknowns, q), &mut local.x[..n]);
        equations.method.value(interval, place, &mut local.method, x)?;
        let t = interval.time(place);
        Ok(D::Number::watches(interval.problem).watch_in(watched, t, x, q) * factor)
    })
}

/// Whether any of the given scalars belongs to a segment.
fn on_segment(watched: &[Vec<Watched>], segment: usize) -> bool {
    watched.iter().flatten().any(|watched| watched.segment == segment)
}
