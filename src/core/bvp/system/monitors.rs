//! Monitors of a discretised boundary-value problem, and their gradients.

use super::equations::{Discretised, Work, gather_ends};
use super::extremes::Sighting;
use super::layout::span;
use super::local::{Gradient, Passes};
use crate::core::bvp::method::MethodWork;
use crate::core::bvp::{
    EndFunctions, Ends, Equations, Interval, Monitor, Number, WatchNumber, Watched,
};
use crate::core::chunk::Chunk;
use crate::core::failure::Failure;
use crate::core::measure::Integral;
use crate::core::scalar::Scalar;
use crate::core::scalar_field::FieldIn;
use crate::core::watch::Observable;
use num_dual::Dual64;

/// The name of the monitor that estimates the error of the mesh.
pub(super) const MESH_ERROR: &str = "mesh_error";

/// A scalar at a place, with the factor by which it counts.
type Term = (Watched, Sighting, f64);

impl Discretised {
    /// The value of a monitor at the arguments of `work`.
    pub fn evaluate_monitor(
        &mut self,
        monitor: usize,
        work: &mut Work<f64>,
    ) -> Result<f64, Failure> {
        self.watch_for(monitor, work)?;
        Ok(match self.monitors.get(monitor) {
            Some(Monitor::Duration) => self.duration(&work.numbers, |_| true),
            Some(Monitor::Ends(function)) => {
                gather_ends(&self.layout, &work.nodes, &mut work.ends);
                self.of_ends(*function, &work.ends, &work.q)
            }
            Some(Monitor::Integral(integral, watched)) => {
                let [sum, time] = self.sum_and_time(*integral, watched, work)?;
                integral.of(sum, time)
            }
            Some(Monitor::Rising(pairs)) => {
                self.rising(pairs).map_or(0.0, |(_, place)| place.value)
            }
            Some(monitor) => {
                self.terms(monitor).iter().flatten().map(|(_, s, factor)| factor * s.value).sum()
            }
            None => {
                self.largest_error(&work.nodes, &work.numbers).map_or(0.0, |largest| largest.error)
            }
        })
    }

    /// Finds the extremes, if a monitor asks for them.
    pub(super) fn watch_for(&mut self, monitor: usize, work: &Work<f64>) -> Result<(), Failure> {
        match self.monitors.get(monitor) {
            None | Some(Monitor::Duration | Monitor::Ends(_) | Monitor::Integral(..)) => Ok(()),
            Some(_) => self.find_extremes(&work.nodes, (&work.q, &work.numbers), None),
        }
    }

    /// Adds the gradient of a monitor at a point that `work` has loaded.
    pub fn add_monitor_gradient(
        &mut self,
        monitor: usize,
        work: &mut Work<f64>,
        gradient: &mut Gradient,
    ) -> Result<(), Failure> {
        self.watch_for(monitor, work)?;
        match self.monitors.get(monitor) {
            Some(Monitor::Duration) => self.add_duration(|_| true, 1.0, gradient),
            Some(Monitor::Ends(function)) => {
                gradient.add(&self.layout, &self.layout.ends, None, |passes| {
                    Ok(self.of_ends(*function, &passes.unknowns, &passes.q))
                })
            }
            Some(Monitor::Integral(integral, watched)) => {
                self.add_integral(*integral, watched, work, gradient)
            }
            Some(Monitor::Rising(pairs)) => {
                let Some(((through, value), sighting)) = self.rising(pairs) else {
                    return Ok(());
                };
                let value = Watched { observable: value, ..through };
                let [height, level] = self.rates(sighting, [through, value], work)?;
                // The place of a rise moves: `d v = ∂v − (v'/h') ∂h` at the fixed place.
                let ratio = level.eps / height.eps;
                self.add_term(&(value, sighting, 1.0), gradient)?;
                self.add_term(&(through, sighting, -ratio), gradient)
            }
            Some(monitor) => {
                let terms = self.terms(monitor);
                terms.iter().flatten().try_for_each(|term| self.add_term(term, gradient))
            }
            None => self.add_error_gradient(work, gradient),
        }
    }

    /// The duration of some segments together, from the numbers of all segments.
    pub fn duration(&self, numbers: &[f64], counts: impl Fn(usize) -> bool) -> f64 {
        let all = self.meshes.iter().enumerate().filter(|(s, _)| counts(*s));
        all.map(|(s, mesh)| self.duration_of(s, &numbers[self.layout.local(s)]) * mesh.end()).sum()
    }

    /// Adds a multiple of its gradient.
    fn add_duration(
        &self,
        counts: impl Fn(usize) -> bool,
        factor: f64,
        gradient: &mut Gradient,
    ) -> Result<(), Failure> {
        for (s, mesh) in self.meshes.iter().enumerate().filter(|(s, _)| counts(*s)) {
            gradient.add(&self.layout, &[], Some(s), |passes| {
                let duration = Chunk::residual(&*self.problem).duration_in(s, &passes.q);
                Ok(duration * (mesh.end() * factor))
            })?;
        }
        Ok(())
    }

    /// An integral of scalars at the arguments of `work`, and the time over which it goes.
    fn sum_and_time(
        &self,
        integral: Integral,
        watched: &[Watched],
        work: &mut Work<f64>,
    ) -> Result<[f64; 2], Failure> {
        let Work { nodes, numbers, local, .. } = work;
        let mut sum = 0.0;
        for at in self.layout.intervals().filter(|(s, _)| on_segment(watched, *s)) {
            let interval = self.interval(at, nodes, numbers);
            sum += self.share(integral, watched, interval, &mut local.method)?;
        }
        Ok([sum, self.duration(numbers, |s| on_segment(watched, s))])
    }

    /// The share of an interval in an integral.
    fn share<T: Number + WatchNumber>(
        &self,
        integral: Integral,
        watched: &[Watched],
        interval: Interval<T>,
        work: &mut MethodWork<T>,
    ) -> Result<T, Failure> {
        let (mut sum, problem) = (T::zero(), T::watches(interval.problem));
        self.method.quadrature(interval, work, &mut |weight, t, x| {
            for watched in watched.iter().filter(|w| w.segment == interval.span.segment) {
                sum += weight * integral.integrand(problem.watch_in(*watched, t, x, interval.q));
            }
        })?;
        Ok(sum)
    }

    /// By the chain rule: the gradients of the integral and of the time.
    fn add_integral(
        &self,
        integral: Integral,
        watched: &[Watched],
        work: &mut Work<f64>,
        gradient: &mut Gradient,
    ) -> Result<(), Failure> {
        let [sum, time] = self.sum_and_time(integral, watched, work)?;
        let slope =
            |of: [f64; 2]| integral.of(Dual64::new(sum, of[0]), Dual64::new(time, of[1])).eps;
        let (by_sum, by_time) = (slope([1.0, 0.0]), slope([0.0, 1.0]));
        for (s, j) in self.layout.intervals().filter(|(s, _)| on_segment(watched, *s)) {
            let unknowns = &self.layout.order[self.layout.interval(s, j)];
            gradient.add(&self.layout, unknowns, Some(s), |passes| {
                let Passes { unknowns, q, local, .. } = passes;
                let interval = self.alone((s, j), unknowns, q);
                Ok(self.share(integral, watched, interval, &mut local.method)? * by_sum)
            })?;
        }
        self.add_duration(|s| on_segment(watched, s), by_time, gradient)
    }

    /// A function of states at the ends, those where segments begin coming first.
    fn of_ends<T: Scalar>(&self, function: usize, ends: &[T], q: &[T]) -> T
    where
        dyn Equations: EndFunctions<T>,
    {
        let (start, end) = ends.split_at(self.layout.states);
        self.problem.of_ends_in(function, Ends { start, end }, q)
    }

    /// The watched scalars and places whose values make up a monitor.
    fn terms(&self, monitor: &Monitor) -> [Option<Term>; 2] {
        let extreme = |watched: &[Watched], sign: f64| {
            let of = |w: &Watched| {
                let seen = self.extremes.seen(*w);
                (*w, if sign > 0.0 { seen.largest } else { seen.smallest }, sign)
            };
            let size = |term: &Term| sign * term.1.value;
            watched.iter().map(of).max_by(|a, b| size(a).total_cmp(&size(b)))
        };
        match monitor {
            Monitor::Maximum(watched) => [extreme(watched, 1.0), None],
            Monitor::Minimum(watched) => {
                [extreme(watched, -1.0).map(|(w, place, _)| (w, place, 1.0)), None]
            }
            Monitor::Range(watched) => [extreme(watched, 1.0), extreme(watched, -1.0)],
            Monitor::Distance(watched) => [self.nearest(watched), None],
            Monitor::Penetration(watched) => {
                [self.nearest(watched).map(|(w, place, factor)| (w, place, -factor)), None]
            }
            _ => [None, None],
        }
    }

    /// The least local minimum of scalars, at ends where that counts; where there is none, the
    /// largest value.
    fn nearest(&self, watched: &[(Watched, [bool; 2])]) -> Option<Term> {
        let candidates = watched.iter().flat_map(|(w, own)| {
            let seen = self.extremes.seen(*w);
            let at_end = seen.last.filter(|_| *own == [false; 2]);
            seen.dips(*own).chain(at_end).map(|place| (*w, place, 1.0))
        });
        let largest = watched.iter().map(|(w, _)| (*w, self.extremes.seen(*w).largest, 1.0));
        let by_value = |a: &Term, b: &Term| a.1.value.total_cmp(&b.1.value);
        candidates.min_by(by_value).or_else(|| largest.max_by(by_value))
    }

    /// Finds what is seen of all scalars that monitors ask for, in one pass over the intervals, and
    /// writes the intervals' residuals where these are asked for.
    pub(super) fn find_extremes(
        &mut self,
        nodes: &[f64],
        (q, numbers): (&[f64], &[f64]),
        mut residual: Option<&mut [f64]>,
    ) -> Result<(), Failure> {
        if residual.is_none() && self.extremes.known(nodes, q, self.rough) {
            return Ok(());
        }
        let mesh_error = self.largest_error(nodes, numbers).map_or(0.0, |largest| largest.error);
        let Discretised { problem, method, meshes, layout, extremes, rough, .. } = self;
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

    /// Which scalar rises through zero, of those on all segments with the largest value of another
    /// one, and where.
    fn rising(&self, pairs: &[(Watched, Observable)]) -> Option<((Watched, Observable), Sighting)> {
        let sighting = |pair: &(Watched, Observable)| self.extremes.risen(pair.0, pair.1);
        let risen = pairs.iter().filter_map(|pair| Some((*pair, sighting(pair)?)));
        risen.max_by(|a, b| a.1.value.total_cmp(&b.1.value))
    }

    /// Two scalars at a place of a segment, and their rates.
    fn rates(
        &self,
        Sighting { interval, place, .. }: Sighting,
        watched: [Watched; 2],
        work: &mut Work<f64>,
    ) -> Result<[Dual64; 2], Failure> {
        let segment = watched[0].segment;
        let n = self.layout.segments[segment].states;
        let at = self.interval((segment, interval), &work.nodes, &work.numbers);
        let (mut x, mut f) = (vec![0.0; n], vec![0.0; n]);
        self.method.value(at, place, &mut work.local.method, &mut x)?;
        let t = at.time(place);
        at.field().slope(t, &x, at.q, &mut f);
        let moving: Vec<Dual64> = x.iter().zip(&f).map(|(x, f)| Dual64::new(*x, *f)).collect();
        let q: Vec<Dual64> = at.q.iter().map(|q| Dual64::from(*q)).collect();
        let problem = Dual64::watches(&*self.problem);
        Ok(watched.map(|watched| problem.watch_in(watched, Dual64::new(t, 1.0), &moving, &q)))
    }

    /// At an extremum inside, the derivative by the place vanishes, and at an end the place is
    /// fixed: the gradient is that of the value at a fixed place.
    fn add_term(
        &self,
        (watched, sighting, factor): &Term,
        gradient: &mut Gradient,
    ) -> Result<(), Failure> {
        let (layout, segment) = (&self.layout, watched.segment);
        let (at, n) = ((segment, sighting.interval), layout.segments[segment].states);
        let unknowns = &layout.order[layout.interval(segment, sighting.interval)];
        gradient.add(layout, unknowns, Some(segment), |passes| {
            let Passes { unknowns, q, local, .. } = passes;
            let (interval, x) = (self.alone(at, unknowns, q), &mut local.x[..n]);
            self.method.value(interval, sighting.place, &mut local.method, x)?;
            let t = interval.time(sighting.place);
            Ok(Chunk::watches(interval.problem).watch_in(*watched, t, x, q) * *factor)
        })
    }
}

/// Whether any of these scalars is on a segment.
fn on_segment(watched: &[Watched], segment: usize) -> bool {
    watched.iter().any(|watched| watched.segment == segment)
}
